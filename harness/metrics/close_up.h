// The worst episodes at full rate, with some samples before and after, while a recording streams by once: what a plot
// of the whole recording cannot show.
#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include "harness/metrics/metric.h"

namespace touchstone::metrics {

struct CloseUp {
  double worst = 0.0;
  double worst_t_s = 0.0;
  std::vector<Series> signals;  // "measured magnitude", "rendered magnitude", "force error" [N]
};

class CloseUpRecorder {
 public:
  static constexpr std::size_t margin = 60;  // samples before and after; episodes closer than this share a close-up
  static constexpr std::size_t kept = 6;

  explicit CloseUpRecorder(double force_threshold_N) : threshold_N_(force_threshold_N) {}

  void add(const MetricSample& sample);
  // Worst first.
  [[nodiscard]] std::vector<CloseUp> worst();

 private:
  struct Point {
    double t_s, measured_N, rendered_N, error_N;
  };
  struct Clip {
    double worst = 0.0;
    double worst_t_s = 0.0;
    SeriesRecorder measured{"measured magnitude", "N", 1024};
    SeriesRecorder rendered{"rendered magnitude", "N", 1024};
    SeriesRecorder error{"force error", "N", 1024};
    void add(const Point& point);
  };
  void close();

  double threshold_N_;
  std::deque<Point> before_;
  bool open_ = false;
  std::size_t quiet_ = 0;  // samples since the error was last over the threshold
  Clip clip_;
  std::vector<Clip> worst_;
};

}  // namespace touchstone::metrics
