#include "hidden_physics/write_case.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "harness/base/atomic_file.h"
#include "harness/recording/recording_file.h"
#include "harness/surface/mesh_file.h"

namespace touchstone::hidden_physics {
namespace {

using json = nlohmann::ordered_json;

std::string corruption_name(Corruption corruption) {
  switch (corruption) {
    case Corruption::shuffled_blocks:
      return "shuffled blocks";
    case Corruption::negative_friction:
      return "negative friction";
    case Corruption::negative_mass:
      return "negative mass";
    case Corruption::none:
      break;
  }
  return "";
}

}  // namespace

void write_case(const BlindCase& plan, const std::filesystem::path& folder) {
  const std::filesystem::path place = folder / plan.id;
  ensure_writable_folder(place);
  surface::TriangleMesh mesh = plan.meshed.slab(plan.cells, 0.5 * plan.truth.half_side_m);
  for (Vec3& v : mesh.vertices_W_m) v = 1e-8 * (1e8 * v).array().round().matrix();
  save_mesh(mesh, place / "mesh.obj");
  const json model{{"schema", "touchstone-model/1"},
                   {"renderer", "god-object"},
                   {"parameters", {{"stiffness_N_per_m", plan.nominal_stiffness_N_per_m}}},
                   {"effects", json::array()},
                   {"instrument", json::array()}};
  write_file(place / "model.json", model.dump(1) + "\n");
  const DeclaredInstrument& d = plan.declared;
  const json instrument{{"schema", "touchstone-instrument/1"},
                        {"force_noise_N", d.force_noise_N},
                        {"force_noise_time_constant_s", d.force_noise_time_constant_s},
                        {"force_step_N", {d.force_step_N.x(), d.force_step_N.y(), d.force_step_N.z()}},
                        {"position_noise_m", d.position_noise_m},
                        {"position_rate_Hz", d.position_rate_Hz},
                        {"geometry_error_m", d.geometry_error_m}};
  write_file(place / "instrument.json", instrument.dump(1) + "\n");
  save_recording(place / "train.csv", record(plan, false));
  save_recording(place / "holdout.csv", record(plan, true));
}

std::string answers_to_json(const std::vector<BlindCase>& plans, std::uint64_t seed) {
  json root{{"schema", "touchstone-blind-answers/1"}, {"seed", seed}, {"cases", json::array()}};
  for (const BlindCase& plan : plans) {
    json entry{{"id", plan.id}, {"set", plan.set}, {"expected_verdict", plan.verdict}, {"effects", json::array()}};
    for (const HiddenEffect& effect : plan.effects) {
      entry["effects"].push_back({{"name", effect.name}, {"side", effect.side}, {"parameters", effect.parameters}});
    }
    if (!plan.ambiguous.empty()) entry["ambiguous"] = json::array({json(plan.ambiguous)});
    if (!plan.follows.empty()) entry["follows"] = plan.follows;
    if (plan.corruption != Corruption::none) entry["corruption"] = corruption_name(plan.corruption);
    entry["true_stiffness_N_per_m"] = plan.physics.stiffness_N_per_m;
    entry["presliding_m"] = plan.physics.presliding_m;
    root["cases"].push_back(std::move(entry));
  }
  return root.dump(1) + "\n";
}

}  // namespace touchstone::hidden_physics
