#include "harness/baseline/golden_summary.h"

#include <fmt/format.h>

#include <cmath>
#include <span>

#include "harness/base/hash.h"
#include "harness/baseline/contact_events.h"
#include "harness/baseline/trajectory_columns.h"

namespace touchstone {

GoldenSummary summarise(const RenderedTrajectory& rendered) {
  GoldenSummary summary;
  summary.samples = rendered.size();
  double square = 0.0;
  for (std::size_t i = 0; i < rendered.size(); ++i) {
    const double force = rendered.f_W_N[i].norm();
    square += force * force;
    summary.peak_force_N = std::max(summary.peak_force_N, force);
    summary.mean_force_W_N += rendered.f_W_N[i] / static_cast<double>(rendered.size());
    if (rendered.contact[i] != 0) ++summary.contact_samples;
    if (i > 0) summary.contact_path_m += (rendered.contact_W_m[i] - rendered.contact_W_m[i - 1]).norm();
  }
  summary.rms_force_N = rendered.size() == 0 ? 0.0 : std::sqrt(square / static_cast<double>(rendered.size()));
  const TrajectoryColumns columns = columns_of(rendered, "");
  summary.contact_events = contact_changes(*columns.find("contact")).size();
  std::string hashes;
  for (const auto& column : columns.columns) hashes += column.name + sha256(std::as_bytes(std::span(column.values)));
  summary.sha256 = sha256(hashes);
  return summary;
}

std::string summaries_to_json(const std::string& case_name, const std::map<std::string, GoldenSummary>& models) {
  std::string text = fmt::format(
      "{{\n  \"schema\": \"touchstone-golden-summary/1\",\n  \"case\": \"{}\",\n  \"models\": {{", case_name);
  const char* separator = "";
  for (const auto& [name, s] : models) {
    text += fmt::format(
        "{}\n    \"{}\": {{\n      \"samples\": {},\n      \"contact_samples\": {},\n      \"contact_events\": {},\n"
        "      \"peak_force_N\": {:.9g},\n      \"rms_force_N\": {:.9g},\n      \"mean_fx_N\": {:.9g},\n"
        "      \"mean_fy_N\": {:.9g},\n      \"mean_fz_N\": {:.9g},\n      \"contact_path_m\": {:.9g},\n      "
        "\"sha256\": \"{}\"\n    }}",
        separator, name, s.samples, s.contact_samples, s.contact_events, s.peak_force_N, s.rms_force_N,
        s.mean_force_W_N.x(), s.mean_force_W_N.y(), s.mean_force_W_N.z(), s.contact_path_m, s.sha256);
    separator = ",";
  }
  return text + "\n  }\n}\n";
}

}  // namespace touchstone
