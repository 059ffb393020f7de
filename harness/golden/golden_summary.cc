#include "harness/golden/golden_summary.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "harness/base/hash.h"
#include "harness/base/json_reader.h"
#include "harness/golden/comparison/contact_events.h"
#include "harness/golden/comparison/trajectory_columns.h"

namespace touchstone::golden {
namespace {

std::string operations_text(const std::optional<RunOperations>& operations) {
  if (!operations) return "";
  return fmt::format(",\n      \"operations\": {},\n      \"operations_max_step\": {}", operations->total,
                     operations->max_per_step);
}

std::uint64_t count_of(JsonObject& object, std::string_view key) {
  const nlohmann::json& value = object.raw(key);
  if (!value.is_number_unsigned()) object.fail_at(key, "expected a whole number of operations");
  return value.get<std::uint64_t>();
}

double share(std::uint64_t golden, std::uint64_t obtained) {
  return golden == 0 ? static_cast<double>(obtained)
                     : (static_cast<double>(obtained) - static_cast<double>(golden)) / static_cast<double>(golden);
}

}  // namespace

GoldenSummary summarise(const recording::RenderedTrajectory& rendered) {
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
        "\"sha256\": \"{}\"{}\n    }}",
        separator, name, s.samples, s.contact_samples, s.contact_events, s.peak_force_N, s.rms_force_N,
        s.mean_force_W_N.x(), s.mean_force_W_N.y(), s.mean_force_W_N.z(), s.contact_path_m, s.sha256,
        operations_text(s.operations));
    separator = ",";
  }
  return text + "\n  }\n}\n";
}

std::map<std::string, RunOperations> load_operations(const std::filesystem::path& summary_file) {
  std::map<std::string, RunOperations> operations;
  if (!std::filesystem::exists(summary_file)) return operations;
  const nlohmann::json document = load_json(summary_file);
  JsonObject root(document, summary_file.string(), "");
  JsonObject models = root.object("models");
  for (const std::string& name : models.keys()) {
    JsonObject model = models.object(name);
    if (model.has("operations"))
      operations[name] = {count_of(model, "operations"), count_of(model, "operations_max_step")};
  }
  return operations;
}

std::optional<OperationsChange> operations_change(const std::optional<RunOperations>& golden,
                                                  const std::optional<RunOperations>& obtained) {
  if (golden == obtained) return std::nullopt;
  if (!golden) return OperationsChange{Verdict::missing, "operations: counted now, the golden has none"};
  if (!obtained)
    return OperationsChange{Verdict::missing, "operations: the golden has them, this run cannot be counted"};
  const double total = share(golden->total, obtained->total);
  const double most = share(golden->max_per_step, obtained->max_per_step);
  return OperationsChange{
      total <= 0.0 && most <= 0.0 ? Verdict::better : Verdict::worse,
      fmt::format("operations: {} ({:+.3g}%) where the golden takes {}, in the most expensive step {} "
                  "({:+.3g}%) for {}",
                  obtained->total, 100.0 * total, golden->total, obtained->max_per_step, 100.0 * most,
                  golden->max_per_step)};
}

}  // namespace touchstone::golden
