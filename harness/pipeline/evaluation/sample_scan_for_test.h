// A frictionless scan of a plate with an answer known to rounding, written as the files that the commands read: for the
// tests of this folder.
#pragma once

#include <cmath>
#include <filesystem>
#include <functional>
#include <string>

#include "harness/base/random.h"
#include "harness/pipeline/evaluation/request.h"
#include "harness/recording/recording_file.h"
#include "harness/surface/mesh_file.h"
#include "renderers/catalogue.h"

namespace touchstone::pipeline {

// The catalogue that the tests run on.
inline const rendering::Catalogue& built_in() { return renderers::built_in_catalogue(); }

inline std::filesystem::path fresh_folder(const std::string& name) {
  auto folder = std::filesystem::temp_directory_path() / (name + "-" + std::to_string(::getpid()));
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

// A plate of 100 mm x 100 mm at z = 0 in two triangles, outward +z.
inline surface::TriangleMesh plate() {
  surface::TriangleMesh mesh;
  mesh.vertices_W_m = {{0, 0, 0}, {0.1, 0, 0}, {0.1, 0.1, 0}, {0, 0.1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

// Strokes along y at 1 kHz for ten seconds, pressed with about 1 N for 1.5 s of every 2 s and lifted in between.
// `compliant_N_per_m` > 0: positions sink in by force over stiffness (for measured in-trajectories); else they stay on
// the plate.
inline recording::Recording scan(double compliant_N_per_m) {
  recording::Recording recording;
  recording.source = "scan";
  for (int i = 0; i < 10'000; ++i) {
    const double t = 0.001 * i;
    const double phase = std::fmod(t, 2.0) / 2.0;
    const double press = phase < 0.75 ? std::sin(phase / 0.75 * M_PI) : 0.0;
    const double lift = phase < 0.75 ? 0.0 : 0.005 * std::sin((phase - 0.75) / 0.25 * M_PI);
    const double force = press * (1.0 + 0.3 * std::sin(3.0 * t));
    const double depth = compliant_N_per_m > 0.0 ? force / compliant_N_per_m : 0.0;
    recording.motion.t_s.push_back(t);
    recording.motion.p_W_m.emplace_back(0.05 + 0.01 * std::sin(0.7 * t), 0.05 + 0.03 * std::sin(1.1 * t), lift - depth);
    recording.f_W_N.emplace_back(0.0, 0.0, force);
  }
  return recording;
}

// The request for these files in `folder`: rec.csv, mesh.obj in `unit`, god-object at `stiffness`.
inline EvaluationRequest write_scan(const std::filesystem::path& folder, const recording::Recording& recording,
                                    double stiffness_N_per_m, const std::string& unit = "m", double unit_m = 1.0) {
  save_recording(folder / "rec.csv", recording);
  save_mesh(plate(), folder / "mesh.obj", unit_m);
  EvaluationRequest request;
  request.recording = folder / "rec.csv";
  request.mesh = folder / "mesh.obj";
  request.mesh_unit = unit;
  request.model.renderer = "god-object";
  request.model.parameters["stiffness_N_per_m"] = stiffness_N_per_m;
  request.model.source = "test";
  return request;
}

}  // namespace touchstone::pipeline
