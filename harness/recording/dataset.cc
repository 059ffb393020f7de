#include "harness/recording/dataset.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/json_reader.h"
#include "harness/base/units.h"

namespace touchstone::recording {
namespace {

constexpr const char* description = "dataset.json";
constexpr const char* schema = "touchstone-dataset/1";

std::string file_name(JsonObject& object, std::string_view key, std::string name) {
  const std::filesystem::path path(name);
  const bool leads_out = std::ranges::any_of(path, [](const auto& part) { return part == ".."; });
  if (name.empty() || path.is_absolute() || leads_out || !path.has_filename()) {
    object.fail_at(key, fmt::format("'{}' is no file within the data set's folder; give a relative path", name));
  }
  return path.lexically_normal().generic_string();
}

std::string required_text(JsonObject& object, std::string_view key) {
  std::string text = object.text(key);
  if (text.empty()) object.fail_at(key, "is empty; say it, even if it is \"unknown\"");
  return text;
}

}  // namespace

std::vector<std::string> Dataset::files() const {
  std::vector<std::string> files{mesh_file};
  const auto add = [&](const std::string& file) {
    if (!file.empty() && std::ranges::find(files, file) == files.end()) files.push_back(file);
  };
  add(instrument_file);
  for (const DatasetRecording& recording : recordings) {
    add(recording.file);
    add(recording.exact);
    add(recording.repeat);
  }
  return files;
}

std::filesystem::path Dataset::own_path_of(const std::string& file) const {
  const auto path = path_of(file);
  const auto inside = std::filesystem::weakly_canonical(folder.empty() ? "." : folder);
  const auto real = std::filesystem::weakly_canonical(path);
  const auto [end, unused] = std::ranges::mismatch(inside, real);
  if (end != inside.end())
    throw BadData(
        fmt::format("{}: is a symbolic link that leads out of the data set's folder, to {}; copy the file here",
                    path.string(), real.string()));
  return path;
}

Dataset load_dataset(const std::filesystem::path& place) {
  std::error_code error;
  const bool is_description = place.filename() == description && !std::filesystem::is_directory(place, error);
  Dataset dataset;
  dataset.folder = is_description ? place.parent_path() : place;
  const std::filesystem::path file = dataset.folder / description;
  if (!std::filesystem::exists(file, error)) {
    throw BadData(
        fmt::format("{}: no {} there; a data set is a folder with one", dataset.folder.string(), description));
  }
  const nlohmann::json json = load_json(file);
  JsonObject root(json, file.string(), "");
  root.schema(schema);
  dataset.object = required_text(root, "object");
  JsonObject mesh = root.object("mesh");
  dataset.mesh_file = file_name(mesh, "file", mesh.text("file"));
  dataset.mesh_unit = mesh.text("unit");
  if (!is_mesh_unit(dataset.mesh_unit)) {
    mesh.fail_at("unit", fmt::format("unknown length unit '{}': use one of {}, in, ft", dataset.mesh_unit,
                                     known_units(Dimension::length)));
  }
  mesh.finish();
  dataset.tip_radius_m = root.number("tip_radius_m");
  if (dataset.tip_radius_m < 0.0) root.fail_at("tip_radius_m", "is negative; 0 is a point");
  dataset.instrument = required_text(root, "instrument");
  if (const auto name = root.optional_text("instrument_file")) {
    dataset.instrument_file = file_name(root, "instrument_file", *name);
  }
  dataset.stiffness_N_per_m = root.number("stiffness_N_per_m");
  if (!(dataset.stiffness_N_per_m > 0.0)) root.fail_at("stiffness_N_per_m", "must be above 0");
  dataset.friction_coefficient = root.optional_number("friction_coefficient");
  if (dataset.friction_coefficient && !(*dataset.friction_coefficient >= 0.0 && *dataset.friction_coefficient <= 5.0))
    root.fail_at("friction_coefficient", "must lie between 0 and 5");
  const std::string mode = root.text("in_trajectory");
  const std::optional<InTrajectoryMode> known = find_in_trajectory(mode);
  if (!known) {
    root.fail_at("in_trajectory", fmt::format("'{}' is unknown: use synthesize, whole-force or measured", mode));
  }
  dataset.in_trajectory = *known;
  for (JsonObject& entry : root.objects("recordings")) {
    DatasetRecording recording;
    recording.file = file_name(entry, "file", entry.text("file"));
    recording.shows = required_text(entry, "shows");
    if (const auto name = entry.optional_text("exact")) recording.exact = file_name(entry, "exact", *name);
    if (const auto name = entry.optional_text("repeat")) recording.repeat = file_name(entry, "repeat", *name);
    if (recording.repeat == recording.file)
      entry.fail_at("repeat", "is the recording itself; name another one of the same motion");
    entry.finish();
    if (std::ranges::find(dataset.recordings, recording.file, &DatasetRecording::file) != dataset.recordings.end()) {
      entry.fail_at("file", fmt::format("'{}' is listed twice", recording.file));
    }
    dataset.recordings.push_back(std::move(recording));
  }
  if (dataset.recordings.empty()) root.fail_at("recordings", "is empty; a data set has at least one recording");
  dataset.source = required_text(root, "source");
  dataset.licence = required_text(root, "licence");
  if (root.has("sha256")) {
    JsonObject hashes = root.object("sha256");
    for (const std::string& name : hashes.keys()) dataset.sha256[name] = hashes.text(name);
  }
  root.finish();
  return dataset;
}

std::string_view in_trajectory_name(InTrajectoryMode mode) {
  switch (mode) {
    case InTrajectoryMode::synthesize:
      return "synthesize";
    case InTrajectoryMode::whole_force:
      return "whole-force";
    case InTrajectoryMode::measured:
      return "measured";
  }
  return "";
}

std::optional<InTrajectoryMode> find_in_trajectory(std::string_view name) {
  for (const auto mode : {InTrajectoryMode::synthesize, InTrajectoryMode::whole_force, InTrajectoryMode::measured}) {
    if (in_trajectory_name(mode) == name) return mode;
  }
  return std::nullopt;
}

void save_dataset(const Dataset& dataset) {
  nlohmann::ordered_json json;
  json["schema"] = schema;
  json["object"] = dataset.object;
  json["mesh"]["file"] = dataset.mesh_file;
  json["mesh"]["unit"] = dataset.mesh_unit;
  json["tip_radius_m"] = dataset.tip_radius_m;
  json["instrument"] = dataset.instrument;
  if (!dataset.instrument_file.empty()) json["instrument_file"] = dataset.instrument_file;
  json["stiffness_N_per_m"] = dataset.stiffness_N_per_m;
  if (dataset.friction_coefficient) json["friction_coefficient"] = *dataset.friction_coefficient;
  json["in_trajectory"] = in_trajectory_name(dataset.in_trajectory);
  json["recordings"] = nlohmann::ordered_json::array();
  for (const DatasetRecording& recording : dataset.recordings) {
    nlohmann::ordered_json entry;
    entry["file"] = recording.file;
    entry["shows"] = recording.shows;
    if (!recording.exact.empty()) entry["exact"] = recording.exact;
    if (!recording.repeat.empty()) entry["repeat"] = recording.repeat;
    json["recordings"].push_back(std::move(entry));
  }
  json["source"] = dataset.source;
  json["licence"] = dataset.licence;
  if (!dataset.sha256.empty()) json["sha256"] = dataset.sha256;
  write_file(dataset.folder / description, json.dump(2) + "\n", Replace::inputs_too);
}

}  // namespace touchstone::recording
