#include "harness/golden/golden_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>

#include "harness/base/error.h"

namespace touchstone::golden {
namespace {

// Names become test names and file names.
bool plain(const std::string& name) {
  return !name.empty() && std::ranges::all_of(name, [](unsigned char c) {
    return std::islower(c) != 0 || std::isdigit(c) != 0 || c == '-';
  });
}

std::map<std::string, double, std::less<>> read_numbers(JsonObject& object, const char* member) {
  std::map<std::string, double, std::less<>> parameters;
  if (!object.has(member)) return parameters;
  JsonObject values = object.object(member);
  for (const auto& key : values.keys()) parameters[key] = values.number(key);
  return parameters;
}

double positive(JsonObject& object, const char* key, double otherwise) {
  const double value = object.optional_number(key).value_or(otherwise);
  if (!(value > 0.0)) object.fail_at(key, fmt::format("a number above 0 was expected, got {}", value));
  return value;
}

std::size_t whole(JsonObject& object, const char* key, double value) {
  if (value < 0.0 || value != std::floor(value) || value > 1e12) object.fail_at(key, "a whole number was expected");
  return static_cast<std::size_t>(value);
}

std::filesystem::path file_of_case(JsonObject& object, const char* key, const std::filesystem::path& folder,
                                   CaseFiles files) {
  const std::filesystem::path file = object.text(key);
  if (files == CaseFiles::own_folder && file.has_parent_path())
    object.fail_at(key, "a file in the case's own folder was expected, without a path");
  return folder / file;
}

CaseLoop read_case_loop(JsonObject object) {
  CaseLoop loop;
  for (const auto& [key, name] : {std::pair{"device", &loop.device}, {"grip", &loop.grip}}) {
    *name = object.text(key);
    if (name->find('/') != std::string::npos)
      object.fail_at(key, "a name, or a file in the case's own folder was expected, without a path");
  }
  loop.set = read_numbers(object, "set");
  loop.seed = whole(object, "seed", object.optional_number("seed").value_or(1.0));
  object.finish();
  return loop;
}

}  // namespace

CaseSurface read_case_surface(JsonObject object, const std::filesystem::path& folder, CaseFiles files) {
  CaseSurface surface;
  if (object.has("mesh")) {
    surface.mesh = file_of_case(object, "mesh", folder, files);
    surface.unit = object.text("unit");
  } else {
    surface.generator = object.text("name");
    surface.parameters = read_numbers(object, "parameters");
    surface.triangles = whole(object, "triangles", object.number("triangles"));
  }
  object.finish();
  return surface;
}

CaseTrajectory read_case_trajectory(JsonObject object, const std::filesystem::path& folder, CaseFiles files) {
  CaseTrajectory trajectory;
  if (object.has("file")) {
    trajectory.file = file_of_case(object, "file", folder, files);
  } else {
    trajectory.generator = object.text("name");
    trajectory.parameters = read_numbers(object, "parameters");
    trajectory.seed = whole(object, "seed", object.optional_number("seed").value_or(1.0));
    trajectory.rate_Hz = positive(object, "rate_Hz", 1000.0);
  }
  if (object.has("offset_m")) {
    const auto offset = object.numbers("offset_m");
    if (offset.size() != 3) object.fail_at("offset_m", "three numbers were expected");
    trajectory.offset_W_m = Vec3(offset[0], offset[1], offset[2]);
  }
  object.finish();
  return trajectory;
}

GoldenCase load_case(const std::filesystem::path& folder) {
  const auto file = folder / "case.json";
  if (!std::filesystem::exists(file)) {
    throw BadData(fmt::format("{}: a golden case needs the file case.json", folder.string()));
  }
  const nlohmann::json document = load_json(file);
  JsonObject object(document, file.string(), "");
  object.schema("touchstone-golden-case/1");
  GoldenCase golden;
  golden.folder = folder;
  golden.name = object.text("name");
  if (golden.name != folder.filename().string() || !plain(golden.name)) {
    object.fail_at(
        "name",
        fmt::format(
            "the folder's name, of lower-case letters, digits and '-', was expected; got \"{}\" in the folder \"{}\"",
            golden.name, folder.filename().string()));
  }
  golden.summary = object.text("summary");
  if (object.has("scene") && !object.has("surface")) {
    golden.scene = object.raw("scene").dump();
  } else {
    golden.surface = read_case_surface(object.object("surface"), folder, CaseFiles::own_folder);
  }
  golden.trajectory = read_case_trajectory(object.object("trajectory"), folder, CaseFiles::own_folder);
  if (object.has("loop")) {
    if (!golden.scene.empty()) object.fail_at("loop", "a loop is closed over one surface, and this is a scene");
    golden.loop = read_case_loop(object.object("loop"));
  }
  golden.scale = positive(object, "scale", 1.0);
  golden.speed = positive(object, "speed", 1.0);
  JsonObject models = object.object("models");
  for (const auto& key : models.keys()) {
    if (!plain(key)) models.fail_at(key, "a model's name is of lower-case letters, digits and '-'");
    golden.models[key] = models.raw(key).dump();
  }
  if (golden.models.empty()) object.fail_at("models", "at least one model was expected");
  golden.tolerance = read_tolerance(object.object("tolerance"), default_tolerance());
  if (golden.tolerance.reason.empty()) object.fail_at("tolerance", "\"reason\" is missing: say why these limits");
  golden.jnd_share = positive(object, "jnd_share", 0.05);
  object.finish();
  return golden;
}

std::vector<GoldenCase> load_cases(const std::filesystem::path& golden) {
  std::error_code error;
  std::vector<std::filesystem::path> folders;
  for (const auto& entry : std::filesystem::directory_iterator(golden, error)) {
    if (entry.is_directory()) folders.push_back(entry.path());
  }
  if (error)
    throw BadData(fmt::format("{}: the folder of golden cases cannot be read: {}", golden.string(), error.message()));
  if (folders.empty()) throw BadData(fmt::format("{}: holds no golden case", golden.string()));
  std::ranges::sort(folders);
  std::vector<GoldenCase> cases;
  cases.reserve(folders.size());
  for (const auto& folder : folders) cases.push_back(load_case(folder));
  return cases;
}

}  // namespace touchstone::golden
