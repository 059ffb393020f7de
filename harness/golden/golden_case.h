// A golden case: golden/<name>/case.json says what runs, golden/<name>/expected/<model>.h5 what must come out of each
// of its models, expected.summary.json the same in a few numbers that read well in a diff.
//   {"schema": "touchstone-golden-case/1", "name": "sphere-scan", "summary": "one line",
//    "surface": {"name": "sphere", "parameters": {"radius_m": 0.03}, "triangles": 2000},      (synthetic; or
//    "surface": {"mesh": "body.obj.gz", "unit": "mm"},                                          a file of the folder)
//    "trajectory": {"name": "hand-scan", "parameters": {}, "seed": 7, "rate_Hz": 1000, "offset_m": [0, 0, 0.03]},  (or
//    "trajectory": {"file": "in.h5"},)
//    "scale": 1, "speed": 1,
//    "models": {"god-object": {touchstone-model/1}, ...},
//    "tolerance": {as in a tolerance file, "reason" required}, "jnd_share": 0.05}
// "loop": {"device": "touch-x", "grip": "light", "set": {"mass_kg": 0.1}, "seed": 1} closes the loop of a hand that
// means to follow the trajectory (loop_case.h); device and grip are names or files of the folder.
// `scale` multiplies every length of the world (mesh and trajectory), `speed` runs the trajectory that many times
// faster. In place of "surface", "scene": {touchstone-scene/1} has several bodies, which are files of the folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "harness/base/json_reader.h"
#include "harness/base/vec.h"
#include "harness/golden/comparison/tolerance.h"

namespace touchstone::golden {

struct CaseSurface {
  std::string generator;  // empty where it is a file
  std::map<std::string, double, std::less<>> parameters;
  std::size_t triangles = 0;
  std::filesystem::path mesh;
  std::string unit = "m";
};

struct CaseTrajectory {
  std::string generator;  // empty where it is a file
  std::map<std::string, double, std::less<>> parameters;
  std::uint64_t seed = 1;
  double rate_Hz = 1000.0;
  Vec3 offset_W_m = Vec3::Zero();
  std::filesystem::path file;
};

struct CaseLoop {
  std::string device, grip;
  std::map<std::string, double, std::less<>> set;  // figures in place of the published ones
  std::uint64_t seed = 1;
};

struct GoldenCase {
  std::string name;
  std::string summary;
  std::filesystem::path folder;
  CaseSurface surface;
  // The text of a scene of several bodies, which takes the place of `surface`; empty where there is none.
  std::string scene;
  CaseTrajectory trajectory;
  std::optional<CaseLoop> loop;
  double scale = 1.0;
  double speed = 1.0;
  std::map<std::string, std::string> models;  // name to the text of its model
  Tolerance tolerance;
  double jnd_share = 0.0;  // the tolerance is at most this share of what a person could feel

  [[nodiscard]] std::filesystem::path expected(const std::string& model) const {
    return folder / "expected" / (model + ".h5");
  }
  [[nodiscard]] std::filesystem::path summary_file() const { return folder / "expected.summary.json"; }
};

// Whether a case may name files outside of its own folder.
enum class CaseFiles : std::uint8_t { own_folder, anywhere };

// "surface" and "trajectory" of a case; files are relative to `folder`. Throw BadData with the place.
CaseSurface read_case_surface(JsonObject object, const std::filesystem::path& folder, CaseFiles files);
CaseTrajectory read_case_trajectory(JsonObject object, const std::filesystem::path& folder, CaseFiles files);

// Throws BadData with the place for anything missing, unknown, or without a reason; the name must be the folder's.
GoldenCase load_case(const std::filesystem::path& folder);
// Every case below the folder, by name. Throws BadData for a folder without case.json. Names are lower case and
// those of the folders, so that none can stand twice.
std::vector<GoldenCase> load_cases(const std::filesystem::path& golden);

}  // namespace touchstone::golden
