#include "harness/golden/comparison/comparison_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace touchstone::golden {
namespace {

std::string_view mark(Verdict verdict) { return verdict == Verdict::equal ? "ok" : to_string(verdict); }

}  // namespace

std::string to_table(const Comparison& comparison) {
  std::string text = fmt::format("verdict: {}", to_string(comparison.verdict));
  if (comparison.groups.empty()) {
    text += '\n';
  } else {
    text += fmt::format("   rows: {}   rows in which bits differ: {}\n", comparison.expected_rows, comparison.drift);
    text += fmt::format("{:<17} {:>4} {:>12} {:>12} {:>12} {:>9} {:>9} {:>10}  {}\n", "quantity", "unit", "rms error",
                        "p99", "max", "beyond", "drift", "used", "verdict");
  }
  for (const std::string& problem : comparison.problems) text += fmt::format("  {}\n", problem);
  for (const GroupResult& g : comparison.groups) {
    text += fmt::format("{:<17} {:>4} {:>12.4g} {:>12.4g} {:>12.4g} {:>9} {:>9} {:>9.3g}%  {}\n", g.group, g.unit,
                        g.rms, g.p99, g.max, g.beyond, g.drift, 100.0 * g.tolerance_used, mark(g.verdict));
    for (const Gate& gate : g.gates) {
      text += fmt::format("  gate {:<16} {:.6g}, limit {:.6g}: {}\n", gate.name, gate.value, gate.limit,
                          gate.passed() ? "ok" : "worse");
    }
    if (g.verdict != Verdict::equal) {
      text += fmt::format("  worst at row {}: expected ({:.9g}), obtained ({:.9g})\n", g.worst_row + 1,
                          fmt::join(g.worst_expected, ", "), fmt::join(g.worst_obtained, ", "));
    }
  }
  if (comparison.events.expected + comparison.events.obtained > 0) {
    text += fmt::format("contact events: expected {}, obtained {}, shift at most {:.4g} s, mean {:.4g} s\n",
                        comparison.events.expected, comparison.events.obtained, comparison.events.max_shift_s,
                        comparison.events.mean_shift_s);
  }
  return text;
}

nlohmann::json to_json(const Comparison& comparison) {
  nlohmann::json document{{"schema", "touchstone-comparison/1"},
                          {"verdict", to_string(comparison.verdict)},
                          {"drift", comparison.drift > 0},
                          {"drift_rows", comparison.drift},
                          {"rows", {{"expected", comparison.expected_rows}, {"obtained", comparison.obtained_rows}}},
                          {"problems", comparison.problems},
                          {"quantities", nlohmann::json::array()}};
  for (const GroupResult& g : comparison.groups) {
    nlohmann::json gates = nlohmann::json::array();
    for (const Gate& gate : g.gates) {
      gates.push_back({{"name", gate.name}, {"value", gate.value}, {"limit", gate.limit}, {"passed", gate.passed()}});
    }
    document["quantities"].push_back(
        {{"name", g.group},
         {"unit", g.unit},
         {"verdict", to_string(g.verdict)},
         {"rms", g.rms},
         {"p99", g.p99},
         {"max", g.max},
         {"peak", g.peak},
         {"beyond", g.beyond},
         {"drift_rows", g.drift},
         {"tolerance_used", g.tolerance_used},
         {"gates", gates},
         {"worst", {{"row", g.worst_row + 1}, {"expected", g.worst_expected}, {"obtained", g.worst_obtained}}}});
  }
  document["contact_events"] = {{"expected", comparison.events.expected},
                                {"obtained", comparison.events.obtained},
                                {"max_shift_s", comparison.events.max_shift_s},
                                {"mean_shift_s", comparison.events.mean_shift_s}};
  auto& metrics = document["metrics"] = nlohmann::json::object();
  for (const auto& [name, value] : metrics_of(comparison)) metrics[name] = value;
  return document;
}

std::string to_json_text(const Comparison& comparison) { return to_json(comparison).dump(2) + "\n"; }

std::vector<std::pair<std::string, double>> metrics_of(const Comparison& comparison) {
  std::vector<std::pair<std::string, double>> metrics;
  const auto add = [&](std::string name, double value) {
    if (std::isfinite(value)) metrics.emplace_back(std::move(name), value);
  };
  for (const GroupResult& g : comparison.groups) {
    if (g.quantity == Quantity::contact) continue;
    add(fmt::format("{}_rms_{}", g.group, g.unit), g.rms);
    add(fmt::format("{}_p99_{}", g.group, g.unit), g.p99);
    add(fmt::format("{}_max_{}", g.group, g.unit), g.max);
    if (g.quantity != Quantity::force) continue;
    for (std::size_t a = 0; a < 3; ++a)
      add(fmt::format("force_{}_rms_N", compared_quantity(Quantity::force).columns[a]), g.axis_rms[a]);
  }
  if (comparison.groups.empty()) return metrics;
  if (comparison.find("contact") != nullptr) {
    add("contact_flips", static_cast<double>(comparison.find("contact")->beyond));
    add("contact_shift_s", comparison.events.max_shift_s);
  }
  add("drift_samples", static_cast<double>(comparison.drift));
  add("tolerance_used", comparison.tolerance_used());
  return metrics;
}

}  // namespace touchstone::golden
