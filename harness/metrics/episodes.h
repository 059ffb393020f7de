// Episodes of an error over a threshold: where, when, how long, how bad. Ruffaldi et al. 2006, section 3.3, find the
// list of cases that exceed a threshold instantaneous error more valuable than the RMS: they are the problematic
// geometric cases. The worst are kept, with the count and the time of all.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "harness/metrics/metric.h"
#include "harness/metrics/moments.h"

namespace touchstone::metrics {

struct Episode {
  double start_s = 0.0;           // first sample over the threshold
  double end_s = 0.0;             // first sample back under it; the last sample where the recording ends before
  double worst = 0.0;             // largest error
  double worst_t_s = 0.0;         // when
  Vec3 worst_W_m = Vec3::Zero();  // where: the surface contact point then
  std::uint64_t samples = 0;      // over the threshold
};

class EpisodeFinder {
 public:
  static constexpr std::size_t kept = 64;

  explicit EpisodeFinder(double threshold) : threshold_(threshold) {}

  void add(double t_s, double error, const Vec3& contact_W_m);
  // Closes an episode still open. Worst first; ties in order of time.
  [[nodiscard]] std::vector<Episode> worst();
  [[nodiscard]] std::uint64_t count() const { return count_ + (open_ ? 1 : 0); }
  [[nodiscard]] double total_s() const { return total_s_.value() + (open_ ? last_t_s_ - current_.start_s : 0.0); }

 private:
  void close(double t_s);

  double threshold_;
  bool open_ = false;
  Episode current_;
  double last_t_s_ = 0.0;
  std::uint64_t count_ = 0;
  CompensatedSum total_s_;
  std::vector<Episode> worst_;
};

// Results: position_episodes [1], time_over_position_threshold [s], or the same of the force.
class ErrorEpisodes final : public Metric {
 public:
  enum class Of { position, force };
  ErrorEpisodes(Of of, const MetricOptions& options);

  void add(const MetricSample& sample) override;
  [[nodiscard]] std::vector<MetricResult> results() override;
  [[nodiscard]] std::vector<Episode> worst() { return finder_.worst(); }
  [[nodiscard]] double threshold() const { return threshold_; }

 private:
  Of of_;
  double threshold_;
  EpisodeFinder finder_;
  Moments error_;
};

}  // namespace touchstone::metrics
