#include "write_dataset.h"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/units.h"
#include "harness/recording/dataset.h"
#include "harness/recording/recording_file.h"
#include "packed_dataset.h"
#include "synthetic/surface_catalogue.h"

namespace touchstone::datasets {
using synthetic::make_mesh;
using synthetic::Tessellation;

namespace {

// The decimal nearest to the multiple, so that the shortest text of it is short.
double whole(double value, double unit) {
  const double per_unit = std::round(1.0 / unit);
  const double rounded = std::round(value * per_unit) / per_unit;
  return rounded == 0.0 ? 0.0 : rounded;  // no "-0"
}

void refuse_foreign_files(const std::filesystem::path& folder, const std::set<std::string>& own) {
  if (!std::filesystem::is_directory(folder)) return;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!own.contains(name)) {
      throw UsageError(fmt::format("{} holds '{}', which is no part of this data set: choose an empty or a new folder",
                                   folder.string(), name));
    }
  }
}

std::string instrument_text(const Recipe& recipe, double geometry_error_m) {
  const ForceSensor& f = recipe.sensor;
  const Tracker& p = recipe.tracker;
  return fmt::format(
      "{{\"schema\": \"touchstone-instrument/1\",\n"
      " \"force_noise_N\": {}, \"force_noise_time_constant_s\": {}, \"force_step_N\": [{}, {}, {}],\n"
      " \"position_noise_m\": {}, \"position_wander_m\": {}, \"position_wander_time_constant_s\": {},\n"
      " \"position_rate_Hz\": {}, \"geometry_error_m\": {}}}\n",
      whole(std::hypot(f.coloured_noise_N, f.white_noise_N), 1e-6), f.noise_time_constant_s, f.step_N.x(), f.step_N.y(),
      f.step_N.z(), whole(std::hypot(p.noise_m, p.wander_m), 1e-8), p.wander_m, p.wander_time_constant_s, p.rate_Hz,
      geometry_error_m);
}

std::string provenance_text(const Recipe& r, std::uint64_t seed, const Tessellation& mesh, const MeasuredScan& scan) {
  std::string parameters;
  for (const auto& [name, value] : r.parameters) parameters += fmt::format(" {} = {}", name, value);
  std::string notes;
  for (const std::string& note : scan.notes) notes += "- " + note + "\n";
  return fmt::format(
      "# Where this data comes from\n\n"
      "Computed, not measured: {}. Made, and made again to the bit, by\n\n"
      "    touchstone synth --dataset {} --seed {} --out FOLDER\n\n"
      "| what | value |\n|---|---|\n"
      "| surface | `{}`{} |\n| mesh | {} triangles, no further than {:.3g} m from the surface, in {} |\n"
      "| tip | ball, radius {} m |\n| object | rigid, {} |\n| friction | Coulomb, mu = {} |\n"
      "| force sensor | {} Hz, steps {:.6g} / {:.6g} / {:.6g} N along its x, y, z, noise {} N coloured ({} s) and {} N "
      "white, "
      "random-walk drift {} N per square root of a second |\n"
      "| tracker | {} Hz, {} m of noise and {} m of slow wander on every axis, orientation {} rad |\n"
      "| seed | {} |\n| samples | {} |\n\n"
      "`scan.csv` is what the instruments gave. `scan.exact.csv` is the truth at the same times, for a virtual probe "
      "of {} N/m:\n"
      "x, y, z the exact in-trajectory (equation 2 of Ruffaldi et al. 2006), px, py, pz the ball's centre on or above "
      "the\n"
      "surface (the exact out-trajectory), fx, fy, fz the exact force.\n\n"
      "How force and position were brought to common times:\n\n{}",
      r.object, r.name, seed, r.surface, parameters, mesh.mesh.triangle_count(), mesh.deviation_bound_m, r.mesh_unit,
      r.contact.tip_radius_m, r.motion.empty() ? "at rest" : r.motion, r.contact.mu, r.sensor.rate_Hz,
      r.sensor.step_N.x(), r.sensor.step_N.y(), r.sensor.step_N.z(), r.sensor.coloured_noise_N,
      r.sensor.noise_time_constant_s, r.sensor.white_noise_N, r.sensor.drift_N_per_sqrt_s, r.tracker.rate_Hz,
      r.tracker.noise_m, r.tracker.wander_m, r.tracker.orientation_noise_rad, seed, scan.recording.size(),
      r.stiffness_N_per_m, notes);
}

}  // namespace

recording::Recording in_whole_units(recording::Recording recording) {
  for (Vec3& p : recording.motion.p_W_m) p = p.unaryExpr([](double x) { return whole(x, position_unit_m); });
  for (Vec3& f : recording.f_W_N) f = f.unaryExpr([](double x) { return whole(x, force_unit_N); });
  for (Quat& q : recording.motion.q_WS) {
    q.coeffs() = q.coeffs().unaryExpr([](double x) { return whole(x, orientation_unit); });
    q.normalize();  // readers say so where a length is not 1
  }
  return recording;
}

void write_dataset(const Recipe& recipe, std::uint64_t seed, const std::filesystem::path& folder) {
  refuse_foreign_files(
      folder, {"dataset.json", "instrument.json", "scan.csv", "scan.exact.csv", "PROVENANCE.md", recipe.mesh_file});
  ensure_writable_folder(folder);
  const Tessellation made =
      recipe.mesh != nullptr ? recipe.mesh() : make_mesh(recipe.surface, recipe.parameters, recipe.triangles);
  const MeasuredScan scan = measure(make_scan(recipe, seed), recipe.sensor, recipe.tracker, seed, recipe.object_pose);
  save_mesh(made.mesh, folder / recipe.mesh_file, length_unit_factor(recipe.mesh_unit));
  save_recording(folder / "scan.csv", in_whole_units(scan.recording));
  save_rendered(folder / "scan.exact.csv", scan.exact_answer(recipe.contact.tip_radius_m, recipe.stiffness_N_per_m));
  write_file(folder / "instrument.json", instrument_text(recipe, made.deviation_bound_m));
  write_file(folder / "PROVENANCE.md", provenance_text(recipe, seed, made, scan));

  recording::Dataset dataset;
  dataset.folder = folder;
  dataset.object = recipe.object;
  dataset.mesh_file = recipe.mesh_file;
  dataset.mesh_unit = recipe.mesh_unit;
  dataset.tip_radius_m = recipe.contact.tip_radius_m;
  dataset.instrument = fmt::format("model of an ATI Nano17 at {} Hz and an optical tracker at {} Hz",
                                   recipe.sensor.rate_Hz, recipe.tracker.rate_Hz);
  dataset.instrument_file = "instrument.json";
  dataset.stiffness_N_per_m = recipe.stiffness_N_per_m;
  dataset.friction_coefficient = recipe.contact.mu;
  dataset.recordings = {{"scan.csv", recipe.shows, "scan.exact.csv", ""}};
  dataset.source =
      fmt::format("computed by touchstone synth --dataset {} --seed {}; see PROVENANCE.md", recipe.name, seed);
  dataset.licence = "Apache-2.0";
  pack_dataset(dataset);
}

}  // namespace touchstone::datasets
