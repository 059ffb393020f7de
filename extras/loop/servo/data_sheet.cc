#include "servo/data_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "harness/base/bundled_files.h"
#include "harness/base/error.h"
#include "harness/base/json_reader.h"
#include "harness/base/known_names.h"

namespace touchstone::servo {
namespace {

std::filesystem::path& sheets_folder() {
  static std::filesystem::path folder = find_bundled("loop").value_or("");
  return folder;
}

std::vector<std::string> names_in(std::string_view kind) {
  std::vector<std::string> names;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(sheets_folder() / kind, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->path().extension() == ".json") names.push_back(entry->path().stem().string());
  }
  std::ranges::sort(names);
  return names;
}

DataSheet load_sheet(const std::filesystem::path& file, std::string_view schema,
                     const std::vector<FigureEntry>& entries) {
  const nlohmann::json document = load_json(file);
  JsonObject root(document, file.string(), "");
  root.schema(schema);
  DataSheet sheet;
  sheet.file = file;
  sheet.name = root.text("name");
  JsonObject figures = root.object("figures");
  for (const FigureEntry& entry : entries) {
    const std::string name(entry.name);
    if (!figures.has(name)) continue;
    JsonObject figure = figures.object(name);
    Figure own{figure.number("value"), figure.text("source"), figure.optional_text("read_in").value_or("")};
    figure.finish();
    if (own.value < 0.0 || (entry.above_zero && own.value == 0.0)) {
      figure.fail_at("value", fmt::format("{} {}; {} was expected", own.value, entry.unit,
                                          entry.above_zero ? "above 0" : "0 or more"));
    }
    if (own.source.empty()) figure.fail_at("source", "where the figure comes from was expected");
    sheet.figures.emplace(name, std::move(own));
  }
  figures.finish();
  if (root.has("not_published")) {
    JsonObject unknown = root.object("not_published");
    for (const FigureEntry& entry : entries) {
      if (auto why = unknown.optional_text(entry.name)) sheet.not_published.emplace(entry.name, *why);
    }
    unknown.finish();
  }
  root.finish();
  return sheet;
}

DataSheet find_sheet(const std::string& wanted, std::string_view what, std::string_view folder,
                     const std::vector<FigureEntry>& entries) {
  const std::string schema = fmt::format("touchstone-{}/1", what);
  if (wanted.ends_with(".json")) return load_sheet(wanted, schema, entries);
  const auto names = names_in(folder);
  if (names.empty()) {
    throw UsageError(
        fmt::format("{} {}: the sheets that come with the program are not found; give a file NAME.json", what, wanted));
  }
  if (std::ranges::find(names, wanted) == names.end()) {
    throw UsageError(unknown_name(what, wanted, names) + fmt::format("; or a file NAME.json ({})", schema));
  }
  return load_sheet(sheets_folder() / folder / (wanted + ".json"), schema, entries);
}

}  // namespace

const std::vector<FigureEntry>& device_entries() {
  static const std::vector<FigureEntry> entries{
      {"mass_kg", "kg", "apparent mass at the tip", true},
      {"damping_N_s_per_m", "N s/m", "viscous friction at the tip"},
      {"friction_N", "N", "Coulomb friction at the tip, along each axis"},
      {"resolution_m", "m", "step of the measured position, along each axis"},
      {"force_limit_N", "N", "largest force that is commanded", true},
      {"actuator_bandwidth_Hz", "Hz", "corner frequency of motor and amplifier (first order)", true},
      {"period_s", "s", "period of the servo loop", true},
      {"latency_s", "s", "from the sampling of the position to the force"},
      {"jitter_s", "s", "the sampling comes late by up to this, evenly spread; below one period"},
      {"velocity_cutoff_Hz", "Hz", "corner frequency of the velocity filter (first order)", true},
      {"stable_stiffness_N_per_m", "N/m", "published largest stable stiffness, to compare with", true},
  };
  return entries;
}

const std::vector<FigureEntry>& grip_entries() {
  static const std::vector<FigureEntry> entries{
      {"mass_kg", "kg", "mass of the hand that goes with the device"},
      {"damping_N_s_per_m", "N s/m", "damper between the device and where the hand means to be"},
      {"stiffness_N_per_m", "N/m", "spring between the device and where the hand means to be"},
  };
  return entries;
}

std::optional<double> DataSheet::value(std::string_view name) const {
  const auto found = figures.find(name);
  return found == figures.end() ? std::nullopt : std::optional(found->second.value);
}

void use_sheets_in(const std::filesystem::path& folder) { sheets_folder() = folder; }

std::vector<std::string> device_names() { return names_in("devices"); }
std::vector<std::string> grip_names() { return names_in("grips"); }

DataSheet find_device(const std::string& wanted) { return find_sheet(wanted, "device", "devices", device_entries()); }
DataSheet find_grip(const std::string& wanted) { return find_sheet(wanted, "grip", "grips", grip_entries()); }

}  // namespace touchstone::servo
