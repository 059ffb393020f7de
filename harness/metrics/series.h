// A signal over time in bounded memory: every sample up to a limit, beyond it the minimum and the maximum of equal runs
// of samples, so that no peak is lost at any length.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace touchstone::metrics {

// Finished series: points in order of time.
struct Series {
  std::string name;
  std::string unit;
  std::vector<double> t_s;
  std::vector<double> value;           // NaN where the samples were not finite: a gap in the plot
  std::uint64_t samples = 0;           // how many samples it stands for
  std::uint64_t samples_per_pair = 1;  // 1: every sample is a point; else each pair of points is the minimum and
                                       // maximum of this many samples
};

class SeriesRecorder {
 public:
  static constexpr std::size_t default_points = 8192;

  // Keeps at most `most_points` points (a power of two, at least 4; throws UsageError for another number).
  SeriesRecorder(std::string name, std::string unit, std::size_t most_points = default_points);

  void add(double t_s, double value);
  [[nodiscard]] Series series() const;

 private:
  struct Run {
    double t_min_s, minimum, t_max_s, maximum;
  };
  static void widen(Run& run, const Run& by);
  void halve();

  std::string name_;
  std::string unit_;
  std::size_t most_points_;
  std::vector<Run> runs_;
  std::uint64_t run_length_ = 1;
  std::uint64_t in_last_ = 0;
  std::uint64_t samples_ = 0;
};

}  // namespace touchstone::metrics
