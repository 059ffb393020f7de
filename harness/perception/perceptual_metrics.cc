#include "harness/perception/perceptual_metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "harness/base/error.h"
#include "harness/metrics/result.h"
#include "harness/perception/distances/structural_similarity.h"
#include "harness/perception/features/rate_hardness.h"
#include "harness/perception/haptic_data_matrix.h"
#include "harness/stats/quantile.h"
#include "harness/stats/summary.h"

namespace touchstone::perception {
using metrics::MetricResult;
using metrics::MetricStatus;

NoticeableForceError::NoticeableForceError(const WeberLaw& law) : law_(law), series_("force error", "JND") {}

void NoticeableForceError::follow(const metrics::MetricSample& sample) {
  constexpr double memory_s = 0.05;
  const double step_s = sample.t_s - before_s_;
  if (has_before_ && step_s > 0.0 && sample.out_W_m.allFinite()) {
    const Vec3 now = (sample.out_W_m - foot_before_W_m_) / step_s;
    slide_W_m_per_s_ += std::min(1.0, step_s / memory_s) * (now - slide_W_m_per_s_);
  }
  foot_before_W_m_ = sample.out_W_m;
  before_s_ = sample.t_s;
  has_before_ = sample.out_W_m.allFinite();
}

void NoticeableForceError::add(const metrics::MetricSample& sample) {
  const double measured_N = sample.f_measured_W_N.norm();
  const double error_N = (sample.f_rendered_W_N - sample.f_measured_W_N).norm();
  const double jnd = error_N / law_.just_noticeable_difference(measured_N);
  const double steps = law_.steps(sample.f_rendered_W_N.norm()) - law_.steps(measured_N);
  error_jnd_.add(sample.t_s, jnd);
  noticeable_.add(sample.t_s, std::isfinite(jnd) ? (jnd > 1.0 ? 1.0 : 0.0) : jnd);
  felt_squared_.add(sample.t_s, steps * steps);
  series_.add(sample.t_s, jnd);
  follow(sample);
  if (!(jnd > 1.0)) return;
  constexpr double slides_m_per_s = 0.001;
  const Vec3 error = sample.f_rendered_W_N - sample.f_measured_W_N;
  const Vec3 way = slide_W_m_per_s_.norm() > slides_m_per_s ? Vec3(slide_W_m_per_s_.normalized()) : Vec3(Vec3::Zero());
  const double along_way = error.dot(way);
  const Vec3 pressing = sample.f_measured_W_N - sample.f_measured_W_N.dot(way) * way;
  const double along_force = pressing.norm() > 0.0 ? error.dot(pressing.normalized()) : 0.0;
  const double rest = std::sqrt(std::max(0.0, error.squaredNorm() - along_way * along_way - along_force * along_force));
  const std::array<double, 3> parts{std::abs(along_way), std::abs(along_force), rest};
  ++noticed_by_[static_cast<std::size_t>(std::max_element(parts.begin(), parts.end()) - parts.begin())];
}

std::vector<MetricResult> NoticeableForceError::results() {
  auto rms =
      make_result("rms_force_error_jnd", "JND",
                  "Root mean square of the force error over the just noticeable difference of the measured force.",
                  error_jnd_.rms(), error_jnd_);
  rms.series = series_.series();
  auto most = make_result("max_force_error_jnd", "JND", "The largest force error in just noticeable differences.",
                          error_jnd_.peak(), error_jnd_);
  if (most.status == MetricStatus::ok) most.t_s = error_jnd_.peak_t_s();
  auto share =
      make_result("noticeable_share", "1", "Share of the samples whose force error can be noticed (above 1 JND).",
                  noticeable_.mean(), noticeable_);
  auto felt =
      make_result("felt_squared_error", "JND^2",
                  "Mean square error of the force's magnitude on the scale of just noticeable differences (PMSE).",
                  felt_squared_.mean(), felt_squared_);
  const std::string law =
      fmt::format("Weber's law: {:.0f} % up to {} N, {:.0f} % above, nothing felt below {} N",
                  100.0 * law_.fraction_below, law_.breakpoint, 100.0 * law_.fraction_above, law_.absolute_threshold);
  for (auto* const result : {&rms, &most, &share, &felt}) {
    if (result->status == MetricStatus::ok) result->note = law;
  }
  if (share.status == MetricStatus::ok && share.value > 0.0) {
    constexpr std::array<const char*, 3> part_names{"friction", "the strength of the force",
                                                    "the direction of the force"};
    const auto most_of = std::max_element(noticed_by_.begin(), noticed_by_.end()) - noticed_by_.begin();
    share.note = fmt::format("a person would notice the force error in {:.2g} % of the scan, mostly as {}; {}",
                             100.0 * share.value, part_names[static_cast<std::size_t>(most_of)], law);
  }
  return {std::move(rms), std::move(most), std::move(share), std::move(felt)};
}

namespace {

struct Described {
  const char* name;
  const char* unit;
  const char* meaning;
};
constexpr std::array press{
    Described{"rate_hardness", "N/m",
              "Median rate-hardness of the rendered presses: force change over displacement change."},
    Described{"extended_rate_hardness", "N/m",
              "Rendered force rate over the velocity in the first 20 ms of contact, median of the contacts."},
    Described{"rate_hardness_error", "1",
              "RMS difference of rate-hardness, rendered from measured, over the RMS measured."},
    Described{"force_structural_similarity", "1",
              "Structural similarity of the force series in windows of 0.1 s (Wang et al. 2004)."}};

MetricResult value_of(const Described& metric, double value) {
  MetricResult result;
  result.name = metric.name;
  result.unit = metric.unit;
  result.meaning = metric.meaning;
  result.value = value;
  result.status = MetricStatus::ok;
  return result;
}

// Below this share of the force's changes that a straight line over the displacement's explains, force and displacement
// are not those of presses, and their ratio says nothing of hardness.
constexpr double press_share = 0.5;

// R^2 of y = c x; 0 where there is nothing to explain.
double share_explained(std::span<const double> x, std::span<const double> y) {
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += x[i] * x[i];
    xy += x[i] * y[i];
    yy += y[i] * y[i];
  }
  return xx > 0.0 && yy > 0.0 ? xy * xy / (xx * yy) : 0.0;
}

MetricResult missing(const Described& metric, const std::string& why) {
  return metrics::make_missing(metric.name, metric.unit, metric.meaning, why);
}

}  // namespace

std::vector<MetricResult> press_metrics(const recording::Recording& measured, std::span<const Vec3> f_rendered_W_N) {
  std::vector<MetricResult> results;
  HapticDataMatrix matrix;
  HapticDataMatrix rendered_matrix;
  try {
    const Vec3 outward = press_direction(measured);
    PressSignal signal = press_signal(measured, outward, fingertip_force.absolute_threshold);
    matrix = make_haptic_data_matrix(std::span(&signal, 1));
    signal.force_N.clear();
    for (const Vec3& f : f_rendered_W_N) signal.force_N.push_back(f.dot(outward));
    rendered_matrix = make_haptic_data_matrix(std::span(&signal, 1));
    if (matrix.size() <= 2 * default_rate_hardness_window)
      throw BadData("the recording is too short for rate-hardness");
  } catch (const BadData& error) {
    for (const auto& metric : press) results.push_back(missing(metric, error.what()));
    return results;
  }
  const MeasuringPart& real = matrix.parts.front();
  const MeasuringPart& rendered = rendered_matrix.parts.front();
  const auto real_hardness = rate_hardness(real.force_N, real.displacement_m, default_rate_hardness_window);
  const auto rendered_hardness = rate_hardness(rendered.force_N, real.displacement_m, default_rate_hardness_window);
  // Of presses alone: windows that begin and end in contact.
  std::vector<double> of_real;
  std::vector<double> of_rendered;
  std::vector<double> difference;
  std::vector<double> force_change_N;
  std::vector<double> displacement_change_m;
  for (std::size_t n = 0; n < real_hardness.values_N_per_m.size(); ++n) {
    const std::size_t end = n + default_rate_hardness_window;
    const bool pressed = std::min(real.force_N[n], real.force_N[end]) > fingertip_force.absolute_threshold;
    if (real_hardness.guarded[n] || !pressed) continue;
    of_real.push_back(real_hardness.values_N_per_m[n]);
    of_rendered.push_back(rendered_hardness.values_N_per_m[n]);
    difference.push_back(of_rendered.back() - of_real.back());
    force_change_N.push_back(real.force_N[end] - real.force_N[n]);
    displacement_change_m.push_back(real.displacement_m[end] - real.displacement_m[n]);
  }
  const double follows = share_explained(displacement_change_m, force_change_N);
  std::string unfit;
  if (of_real.empty()) {
    unfit = "the tip does not move along the force while it presses";
  } else if (!(follows >= press_share)) {
    unfit = fmt::format(
        "in contact the measured force does not follow the displacement ({:.0f} % of its change explained, {:.0f} % "
        "needed): strokes, or an object too stiff for the tracker",
        100.0 * follows, 100.0 * press_share);
  }
  const std::string guard =
      fmt::format("window {} samples; {} of them in contact and moving", default_rate_hardness_window, of_real.size());
  if (!unfit.empty()) {
    results = {missing(press[0], unfit)};
  } else {
    results = {value_of(press[0], stats::median(of_rendered))};
    results[0].note = guard;
    set_reference(results[0], stats::median(of_real), "median rate-hardness measured");
  }
  const auto extended = [&](const MeasuringPart& part) {
    return estimated_rate_hardness(part.force_N, part.displacement_m, matrix.rate_Hz,
                                   fingertip_force.absolute_threshold);
  };
  const auto interval = [](const RateHardnessEstimate& estimate) {
    return fmt::format("95 % {:.4g} to {:.4g} N/m over {} contacts", estimate.low95_N_per_m, estimate.high95_N_per_m,
                       estimate.contacts);
  };
  if (const auto rendered_extended = extended(rendered)) {
    results.push_back(value_of(press[1], rendered_extended->value_N_per_m));
    results.back().note = interval(*rendered_extended);
    if (const auto own = extended(real))
      set_reference(results.back(), own->value_N_per_m, "extended rate-hardness measured, " + interval(*own));
  } else {
    results.push_back(missing(press[1], "fewer than three contacts from free air, or contacts that do not agree"));
  }
  if (unfit.empty()) {
    results.push_back(value_of(press[2], stats::root_mean_square(difference) / stats::root_mean_square(of_real)));
    results.back().note = guard;
  } else {
    results.push_back(missing(press[2], unfit));
  }
  StructuralSimilarityConstants constants;
  constants.window = static_cast<std::size_t>(std::max(4.0, std::round(0.1 * matrix.rate_Hz)));
  constants.stride = std::max<std::size_t>(1, constants.window / 2);
  if (real.force_N.size() >= constants.window) {
    results.push_back(value_of(press[3], structural_similarity(real.force_N, rendered.force_N, constants)));
  } else {
    results.push_back(missing(press[3], "shorter than one window of 0.1 s"));
  }
  return results;
}

}  // namespace touchstone::perception
