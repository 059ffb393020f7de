#include "harness/pipeline/evaluation/perceived.h"

#include <fmt/format.h>

#include <algorithm>

#include "harness/metrics/result.h"

namespace touchstone::pipeline {
using metrics::MetricResult;

namespace {

constexpr std::size_t most_samples = 2'000'000;  // 300 MB

}  // namespace

const std::vector<std::string>& perceived_metrics() {
  static const std::vector<std::string> names{"perception",
                                              "rms_force_error_jnd",
                                              "max_force_error_jnd",
                                              "noticeable_share",
                                              "felt_squared_error",
                                              "rate_hardness",
                                              "extended_rate_hardness",
                                              "rate_hardness_error",
                                              "force_structural_similarity"};
  return names;
}

bool is_perceived_metric(std::string_view name) { return std::ranges::count(perceived_metrics(), name) > 0; }

void PerceivedQuality::add(const metrics::MetricSample& sample, const Vec3& p_W_m) {
  noticeable_.add(sample);
  cut_ = recording_.motion.t_s.size() == most_samples;
  if (cut_) return;
  recording_.motion.t_s.push_back(sample.t_s);
  recording_.motion.p_W_m.push_back(p_W_m);
  recording_.f_W_N.push_back(sample.f_measured_W_N);
  f_rendered_W_N_.push_back(sample.f_rendered_W_N);
}

std::vector<MetricResult> PerceivedQuality::results(std::span<const std::string> names, bool has_force) {
  std::vector<MetricResult> all = noticeable_.results();
  recording_.source = "the recording";
  for (MetricResult& result : perception::press_metrics(recording_, f_rendered_W_N_)) {
    if (cut_ && result.status == metrics::MetricStatus::ok)
      result.note += fmt::format("{}of the first {} samples", result.note.empty() ? "" : "; ", most_samples);
    all.push_back(std::move(result));
  }
  if (!has_force) {
    for (MetricResult& result : all)
      result = metrics::make_missing(result.name, result.unit, result.meaning, "the recording has no force");
  }
  if (!names.empty() && std::ranges::count(names, "perception") == 0)
    std::erase_if(all, [&](const MetricResult& result) { return std::ranges::count(names, result.name) == 0; });
  return all;
}

}  // namespace touchstone::pipeline
