#include "contacts/known_contacts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <functional>

#include "contacts/scripted_path.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/recording/recording_writer.h"
#include "harness/surface/mesh_file.h"

namespace touchstone::contacts {
using tool::Pose;

namespace {

tool::KnownContacts known(ExactCase made, const std::function<Equilibrium(const Pose&)>& at_handle) {
  tool::KnownContacts known{
      made.name, tool::solid_tool(made.tool_T), std::move(made.object_W), made.free, std::move(made.handles), {}, {}};
  for (const Pose& handle : known.handles) {
    const Equilibrium equilibrium = at_handle(handle);
    if (!equilibrium.found)
      throw BadData(fmt::format("{}: no equilibrium was found with these stiffnesses; give softer ones", made.name));
    known.wrenches_W.push_back(equilibrium.wrench_W);
  }
  return known;
}

}  // namespace

tool::KnownContacts known_contacts(std::string_view name, const tool::Coupling& coupling,
                                   const tool::ContactShape& shape) {
  const ExactCase made = make_exact_case(name, shape);
  return known(made, [&](const Pose& handle) { return quasi_static_equilibrium(made.gaps, handle, coupling); });
}

std::vector<std::string> sliding_case_names() {
  std::vector<std::string> names = exact_case_names();
  std::erase_if(names, [](const std::string& name) { return !make_exact_case(name).goes_on_along_x; });
  return names;
}

tool::KnownContacts known_slides(std::string_view name, const tool::Coupling& coupling, double mu) {
  const ExactCase made = make_exact_case(name);
  if (!made.goes_on_along_x)
    throw UsageError(
        fmt::format("case '{}' cannot be slid; these can: {}", name, fmt::join(sliding_case_names(), ", ")));
  tool::KnownContacts slides = known(
      made, [&](const Pose& handle) { return sliding_equilibrium(made.gaps, handle, coupling, mu, Vec3::UnitX()); });
  for (const Pose& handle : slides.handles)
    slides.slid_from.push_back({handle.p_W_m - Vec3(slide_m, 0, 0), handle.q_WT});
  return slides;
}

std::size_t write_exact_case(const ExactCase& exact_case, double duration_s, const std::filesystem::path& folder) {
  ensure_writable_folder(folder);
  save_mesh(exact_case.tool_T, folder / "tool.obj");
  save_mesh(exact_case.object_W, folder / "object.obj");
  constexpr double rate_Hz = 1000.0;
  recording::TrajectoryWriter writer(folder / "path.csv", true);
  const auto samples = static_cast<std::size_t>(duration_s * rate_Hz);
  for (std::size_t i = 0; i <= samples; ++i) {
    const double t_s = double(i) / rate_Hz;
    const Pose pose = scripted_pose(exact_case, t_s, duration_s);
    writer.append(t_s, pose.p_W_m, pose.q_WT);
  }
  writer.commit();
  return samples + 1;
}

}  // namespace touchstone::contacts
