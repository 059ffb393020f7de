// A data set: a folder that holds everything needed to evaluate renderers on one object, described by dataset.json
// (schema touchstone-dataset/1), as the public repository of Ruffaldi et al. 2006 meant it: the object's mesh, what the
// probe was, and the recordings. Every file it names lies in the folder and is named with its SHA-256.
//
//   {"schema": "touchstone-dataset/1",
//    "object": "acrylic plate, 160 mm x 120 mm",
//    "mesh": {"file": "plate.obj", "unit": "mm"},
//    "tip_radius_m": 0.0,
//    "instrument": "ATI Nano17 at 5 kHz, optical tracker at 60 Hz",
//    "instrument_file": "instrument.json",                        (optional; touchstone-instrument/1)
//    "stiffness_N_per_m": 500,
//    "friction_coefficient": 0.2,                                 (optional; of tip and object, where it is known)
//    "in_trajectory": "synthesize",                               (or "whole-force"; "measured" for compliant objects)
//    "recordings": [{"file": "scan.csv", "shows": "a scan along y with taps at both ends",
//                    "exact": "scan.exact.csv",                   (optional: the exact answer)
//                    "repeat": "again.csv"}],                     (optional: the same motion again)
//    "source": "who measured or made it, and how",
//    "licence": "CC0-1.0",
//    "sha256": {"plate.obj": "...", "instrument.json": "...", "scan.csv": "...", "scan.exact.csv": "..."}}
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone::recording {

// How the path that a renderer gets is made of a recording; harness/rendering/in_trajectory.h derives when each is
// right.
enum class InTrajectoryMode : std::uint8_t {
  synthesize,   // p_in = p_out - F_n / k, the normal force (Ruffaldi et al. 2006, equation 2)
  whole_force,  // p_in = p_out - F / k, friction included
  measured,     // the measured positions as they are
};

// "synthesize", "whole-force", "measured": as data sets and command lines spell them.
std::string_view in_trajectory_name(InTrajectoryMode mode);
// Empty for any other text.
std::optional<InTrajectoryMode> find_in_trajectory(std::string_view name);

struct DatasetRecording {
  std::string file;
  std::string shows;
  std::string exact;   // "" where there is none
  std::string repeat;  // the same motion recorded again: what differs no renderer can be blamed for; or ""
};

struct Dataset {
  std::filesystem::path folder;
  std::string object;
  std::string mesh_file;
  std::string mesh_unit;
  double tip_radius_m = 0.0;
  std::string instrument;
  std::string instrument_file;  // "" where there is none
  double stiffness_N_per_m = 0.0;
  std::optional<double> friction_coefficient;
  InTrajectoryMode in_trajectory = InTrajectoryMode::synthesize;
  std::vector<DatasetRecording> recordings;
  std::string source;
  std::string licence;
  std::map<std::string, std::string> sha256;

  [[nodiscard]] std::filesystem::path path_of(const std::string& file) const { return folder / file; }
  // The same for what is handed on: throws BadData where a symbolic link leads out of the data set's folder, to a file
  // that nobody meant to give away.
  [[nodiscard]] std::filesystem::path own_path_of(const std::string& file) const;
  // Every file that the description names, each once: mesh, instrument, recordings, exact answers, repeats.
  [[nodiscard]] std::vector<std::string> files() const;
};

// `place` is the folder or its dataset.json. Throws BadData naming the place in the JSON; a file name that leads out of
// the folder is refused. Does not look at the files.
Dataset load_dataset(const std::filesystem::path& place);
// Rewrites dataset.json atomically.
void save_dataset(const Dataset& dataset);

}  // namespace touchstone::recording
