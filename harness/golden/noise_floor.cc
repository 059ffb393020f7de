#include "harness/golden/noise_floor.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "harness/base/atomic_file.h"
#include "harness/base/hash.h"
#include "harness/base/json_reader.h"
#include "harness/base/json_values.h"
#include "harness/base/other_program.h"
#include "harness/base/progress.h"
#include "harness/base/scratch_folder.h"
#include "harness/golden/comparison/column_file.h"
#include "harness/golden/comparison/compare.h"
#include "harness/golden/golden_file.h"
#include "harness/golden/golden_summary.h"
#include "harness/recording/recording_file.h"

namespace touchstone::golden {

namespace {

constexpr double most_of_tolerance = 0.1;
constexpr std::uint64_t most_rows = 1ULL << 53;  // what a JSON number counts exactly
constexpr const char* schema = "touchstone-golden-floor/1";

void run_render(const std::string& program, const std::string& golden, const std::string& one,
                const std::filesystem::path& to) {
  const auto end = run_other({{program, "golden", "render", one, "--golden", golden, "--to", to.string()}});
  if (!end) throw UsageError(fmt::format("--program {}: cannot be run", program));
  if (end->status != 0) throw BadData(fmt::format("{} golden render {}: failed", program, one));
}

struct Floor {
  double force_max_N = 0.0;
  double contact_position_max_m = 0.0;
  std::size_t drift_rows = 0;
  std::size_t rows = 0;
  double of_tolerance = 0.0;
};

void widen(Floor& floor, const Comparison& comparison) {
  floor.of_tolerance = std::max(floor.of_tolerance, comparison.tolerance_used());
  floor.drift_rows = std::max(floor.drift_rows, comparison.drift);
  floor.rows = comparison.expected_rows;
  if (const auto* const force = comparison.find("force")) floor.force_max_N = std::max(floor.force_max_N, force->max);
  if (const auto* const contact = comparison.find("contact_position"))
    floor.contact_position_max_m = std::max(floor.contact_position_max_m, contact->max);
}

std::string golden_hash(const GoldenCase& one, const std::string& model) {
  return summarise(recording::load_rendered(one.expected(model))).sha256;
}

std::string tolerance_hash(const GoldenCase& one) { return sha256(to_json(one.tolerance).dump()); }

nlohmann::json entry_of(const GoldenCase& one, const std::string& model, const Floor& floor) {
  return {{"case", one.name},
          {"model", model},
          {"force_max_N", floor.force_max_N},
          {"contact_position_max_m", floor.contact_position_max_m},
          {"drift_rows", floor.drift_rows},
          {"rows", floor.rows},
          {"of_tolerance", floor.of_tolerance},
          {"golden_sha256", golden_hash(one, model)},
          {"tolerance_sha256", tolerance_hash(one)}};
}

// What `json` has of cases that still are in the folder `golden`, but were not measured now, with the commit that each
// was measured at. Floors of other compilers, flags or processors do not go into one file with these.
nlohmann::json kept_floors(const std::filesystem::path& json, const std::string& golden,
                           const nlohmann::json& measured) {
  nlohmann::json kept = nlohmann::json::array();
  if (!std::filesystem::exists(json)) return kept;
  // An earlier result of this command, which it adds to: no input that must stay as it is.
  const nlohmann::json before = nlohmann::json::parse(read_file(json), nullptr, false);
  if (before.is_discarded() || !before.contains("floors"))
    throw BadData(
        fmt::format("{}: is no file of this command ({} was expected); name another one", json.string(), schema));
  const auto built = [](const nlohmann::json& programs) {
    std::vector<std::array<std::string, 4>> all;
    for (const auto& program : programs)
      all.push_back({program.at("compiler"), program.at("flags"), program.at("cpu"), program.at("version")});
    return all;
  };
  const auto now = [&](const nlohmann::json& old) {
    return std::any_of(measured["floors"].begin(), measured["floors"].end(), [&](const auto& floor) {
      return floor["case"] == old["case"] && floor["model"] == old["model"];
    });
  };
  for (nlohmann::json floor : before.at("floors")) {
    if (now(floor) || !std::filesystem::exists(std::filesystem::path(golden) / floor.at("case") / "case.json"))
      continue;
    if (!floor.contains("commit")) floor["commit"] = before.at("programs").at(0).at("commit");
    kept.push_back(std::move(floor));
  }
  if (!kept.empty() && built(before.at("programs")) != built(measured["programs"])) {
    throw UsageError(
        fmt::format("--json {}: was measured with programs of other compilers, flags, processors or versions; "
                    "measure every case, or name another file",
                    json.string()));
  }
  return kept;
}

// Adds a line of the table; false where the tolerance is too tight.
bool add_floor(std::string& table, const std::string& name, const std::string& model, const Floor& floor) {
  const bool wide_enough = floor.of_tolerance <= most_of_tolerance;
  table += fmt::format("{:<28} {:<24} {:>10.3g} {:>12.3g} {:>6} of {:<6} {:>12.3g}% {:>10}\n", name, model,
                       floor.force_max_N, floor.contact_position_max_m, floor.drift_rows, floor.rows,
                       100.0 * floor.of_tolerance, wide_enough ? "ok" : "TOO TIGHT");
  return wide_enough;
}

std::string heading() {
  return fmt::format("{:<28} {:<24} {:>10} {:>12} {:>16} {:>13}\n", "case", "model", "force [N]", "proxy [m]",
                     "rows differ", "of tolerance");
}

}  // namespace

NoiseFloors measure_noise_floors(const std::vector<GoldenCase>& cases, const std::string& golden,
                                 const std::vector<std::string>& programs, const std::filesystem::path& json) {
  const ScratchFolder scratch;
  bool good = true;
  nlohmann::json document{
      {"schema", schema}, {"programs", nlohmann::json::array()}, {"floors", nlohmann::json::array()}};
  std::string table = heading();
  Progress progress("noise floor", cases.size());
  for (std::size_t c = 0; c < cases.size(); ++c) {
    const GoldenCase& one = cases[c];
    for (std::size_t p = 0; p < programs.size(); ++p)
      run_render(programs[p], golden, one.name, scratch.path() / std::to_string(p));
    for (const auto& [model, text] : one.models) {
      const TrajectoryColumns expected = load_columns(one.expected(model));
      Floor floor;
      for (std::size_t p = 0; p < programs.size(); ++p) {
        const auto file = scratch.path() / std::to_string(p) / one.name / (model + ".h5");
        widen(floor, compare(expected, load_columns(file), one.tolerance));
        if (document["programs"].size() <= p) {
          auto made_by = read_provenance(file);
          for (const char* const key : {"compiler", "flags", "cpu", "version", "commit"})
            document["programs"][p][key] = made_by[key];
        }
      }
      good = add_floor(table, one.name, model, floor) && good;
      document["floors"].push_back(entry_of(one, model, floor));
      document["floors"].back()["commit"] = document["programs"][0]["commit"];
    }
    progress.update(c + 1);
  }
  if (!json.empty()) {
    for (nlohmann::json& floor : kept_floors(json, golden, document)) document["floors"].push_back(std::move(floor));
    std::multimap<std::pair<std::string, std::string>, nlohmann::json> sorted;
    for (nlohmann::json& floor : document["floors"]) {
      const std::pair<std::string, std::string> key(floor.at("case"), floor.at("model"));
      sorted.emplace(key, std::move(floor));
    }
    document["floors"] = nlohmann::json::array();
    for (auto& [key, floor] : sorted) document["floors"].push_back(std::move(floor));
    write_file(json, document.dump(1) + "\n");
  }
  return {good ? ExitStatus::passed : ExitStatus::failed, std::move(table)};
}

NoiseFloors judge_noise_floors(const std::vector<GoldenCase>& cases, const std::filesystem::path& json) {
  if (!std::filesystem::exists(json)) {
    return {ExitStatus::skipped,
            fmt::format("skipped: {}: no noise floor was measured yet; ci/golden-floor does\n", json.string())};
  }
  const nlohmann::json document = load_json(json);
  JsonObject root(document, json.string(), "");
  if (root.text("schema") != schema) throw BadData(fmt::format("{}: /schema: expected {}", json.string(), schema));
  static_cast<void>(root.raw("programs"));
  std::map<std::pair<std::string, std::string>, JsonObject> known;
  for (JsonObject& entry : root.objects("floors"))
    known.emplace(std::pair(entry.text("case"), entry.text("model")), entry);
  root.finish();
  bool good = true;
  std::string without;
  std::string table = heading();
  for (const GoldenCase& one : cases) {
    for (const auto& [model, text] : one.models) {
      const auto found = known.find({one.name, model});
      if (found == known.end() || found->second.text("golden_sha256") != golden_hash(one, model) ||
          found->second.text("tolerance_sha256") != tolerance_hash(one)) {
        without += fmt::format("  {} {}: {}\n", one.name, model,
                               found == known.end() ? "never measured" : "measured for another golden or tolerance");
        continue;
      }
      JsonObject& entry = found->second;
      good = add_floor(table, one.name, model,
                       {entry.number("force_max_N"), entry.number("contact_position_max_m"),
                        count_of(entry, "drift_rows", most_rows), count_of(entry, "rows", most_rows),
                        entry.number("of_tolerance")}) &&
             good;
    }
  }
  if (!good) return {ExitStatus::failed, std::move(table)};
  if (without.empty()) return {ExitStatus::passed, std::move(table)};
  table += fmt::format("skipped, no noise floor is known for:\n{}measure them with ci/golden-floor\n", without);
  return {ExitStatus::skipped, std::move(table)};
}

}  // namespace touchstone::golden
