#include "harness/pipeline/discrepancy/golden_offer.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/recording/recording_file.h"
#include "harness/surface/mesh_file.h"

namespace touchstone::pipeline {

void write_golden_case(const std::filesystem::path& folder, const surface::TriangleMesh& mesh,
                       const recording::Recording& recording, const rendering::Model& found) {
  if (std::filesystem::exists(folder)) {
    throw UsageError(fmt::format("--golden {}: exists already; name a new folder", folder.string()));
  }
  ensure_writable_folder(folder);
  save_mesh(mesh, folder / "mesh.ply");
  save_trajectory(folder / "in.h5", recording::InTrajectory{recording.motion});
  rendering::Model contact = found;
  contact.instrument.clear();  // how a sensor reads is nothing that a renderer renders
  take_pictures_along(contact, folder);
  nlohmann::ordered_json root;
  root["schema"] = "touchstone-golden-case/1";
  root["name"] = folder.filename().string();
  root["summary"] = "a gap between simulation and measurement that was closed";
  root["surface"] = {{"mesh", "mesh.ply"}, {"unit", "m"}};
  root["trajectory"] = {{"file", "in.h5"}};
  root["scale"] = 1.0;
  root["speed"] = 1.0;
  // Far below what was closed and above what compilers change, at any scale.
  constexpr double relative = 1e-6;
  double force_N = 0.0;
  Box3 box;
  for (std::size_t i = 0; i < recording.size(); ++i) {
    force_N = std::max(force_N, recording.f_W_N[i].norm());
    box.extend(recording.motion.p_W_m[i]);
  }
  root["tolerance"] = {{"reason", "a millionth of the recording's force and size: far below the gap that was closed"},
                       {"force", {{"atol_N", relative * force_N}, {"rtol", relative}}},
                       {"contact_position", {{"atol_m", relative * box.diagonal().norm()}, {"rtol", relative}}}};
  root["jnd_share"] = 0.05;
  root["models"]["found"] = nlohmann::ordered_json::parse(model_to_json(contact, folder));
  write_file(folder / "case.json", root.dump(1) + "\n");
}

std::string golden_commands(const std::filesystem::path& folder) {
  const auto name = folder.filename().string();
  const auto parent = folder.has_parent_path() ? folder.parent_path().string() : std::string(".");
  return fmt::format(
      "  git add {2} && git commit -m 'golden case {0}'\n"
      "  touchstone check {0} --golden {1} --out pending\n"
      "  touchstone golden accept {0} --golden {1} --out pending --reason 'gap closed'\n",
      name, parent, folder.string());
}

}  // namespace touchstone::pipeline
