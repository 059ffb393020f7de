#include "synthetic/tool/known_contacts.h"

#include <fmt/format.h>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/recording/recording_writer.h"
#include "harness/surface/mesh_file.h"
#include "synthetic/tool/scripted_path.h"

namespace touchstone::synthetic {

tool::KnownContacts known_contacts(std::string_view name, const Coupling& coupling) {
  ExactCase made = make_exact_case(name);
  tool::KnownContacts known{made.name, solid_tool(made.tool_T), std::move(made.object_W), made.free, made.handles, {}};
  for (const Pose& handle : known.handles) {
    const Equilibrium equilibrium = quasi_static_equilibrium(made.gaps, handle, coupling);
    if (!equilibrium.found)
      throw BadData(fmt::format("{}: no equilibrium was found with these stiffnesses; give softer ones", name));
    known.wrenches_W.push_back(equilibrium.wrench_W);
  }
  return known;
}

std::size_t write_exact_case(const ExactCase& exact_case, double duration_s, const std::filesystem::path& folder) {
  ensure_writable_folder(folder);
  save_mesh(exact_case.tool_T, folder / "tool.obj");
  save_mesh(exact_case.object_W, folder / "object.obj");
  constexpr double kRate_Hz = 1000.0;
  recording::TrajectoryWriter writer(folder / "path.csv", true);
  const auto samples = static_cast<std::size_t>(duration_s * kRate_Hz);
  for (std::size_t i = 0; i <= samples; ++i) {
    const double t_s = double(i) / kRate_Hz;
    const Pose pose = scripted_pose(exact_case, t_s, duration_s);
    writer.append(t_s, pose.p_W_m, pose.q_WT);
  }
  writer.commit();
  return samples + 1;
}

}  // namespace touchstone::synthetic
