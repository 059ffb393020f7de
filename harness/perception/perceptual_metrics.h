// What an evaluation of a renderer may show of perception: errors in units of what can just be noticed, and the
// hardness of presses. Shao, Wu and Ouyang, eq 5, 9, 10, 12, 15.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "harness/metrics/metric.h"
#include "harness/metrics/moments.h"
#include "harness/metrics/series.h"
#include "harness/perception/filters/weber_law.h"
#include "harness/recording/trajectory.h"

namespace touchstone::perception {

// The force error of every sample over the just noticeable difference of the measured force (eq 12); vectors, so that a
// force of the right size in the wrong direction errs too. Streams.
// What a noticed sample is noticed by: friction (error along the way the foot slides), strength (along the measured
// force), or direction (the rest), whichever is largest; the note of noticeable_share says which prevails.
// Results: rms_force_error_jnd, max_force_error_jnd [JND], noticeable_share [1], felt_squared_error [JND^2] (eq 9).
class NoticeableForceError final : public metrics::Metric {
 public:
  explicit NoticeableForceError(const WeberLaw& law = fingertip_force);
  void add(const metrics::MetricSample& sample) override;
  [[nodiscard]] std::vector<metrics::MetricResult> results() override;

 private:
  void follow(const metrics::MetricSample& sample);

  WeberLaw law_;
  metrics::Moments error_jnd_;
  metrics::Moments noticeable_;
  metrics::Moments felt_squared_;
  metrics::SeriesRecorder series_;
  // The foot's way over the last 50 ms, and samples noticed by friction, strength, direction.
  Vec3 slide_W_m_per_s_ = Vec3::Zero();
  Vec3 foot_before_W_m_ = Vec3::Zero();
  double before_s_ = 0.0;
  bool has_before_ = false;
  std::array<std::size_t, 3> noticed_by_{};
};

// The presses of a recording as measured and as rendered on its path, along the measured force's direction.
// Results: rate_hardness [N/m], extended_rate_hardness [N/m] (both rendered, with the measured one as reference),
// rate_hardness_error [1] (RMS of the difference over the RMS measured), force_structural_similarity [1].
// Each is `missing` with the reason if the recording has no presses to judge by; nothing is thrown for that.
std::vector<metrics::MetricResult> press_metrics(const recording::Recording& measured,
                                                 std::span<const Vec3> f_rendered_W_N);

}  // namespace touchstone::perception
