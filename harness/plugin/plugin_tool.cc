#include "harness/plugin/plugin_tool.h"

#include <fmt/format.h>

#include <algorithm>

#include "harness/base/error.h"
#include "harness/plugin/plugin_run.h"
#include "harness/rendering/limitation.h"

namespace touchstone::plugin {
using surface::TriangleMesh;

namespace {

class PluginToolRenderer final : public tool::ToolRenderer {
 public:
  // What a result lists of its contacts; the wrench counts them all.
  static constexpr std::size_t most_contacts = 512;

  explicit PluginToolRenderer(PluginRun run) : run_(std::move(run)), contacts_(most_contacts) {}

 private:
  void do_reset() override { run_.reset(); }
  tool::ToolResult do_step(const tool::ToolState& state, double dt_s) noexcept override;
  [[nodiscard]] std::string do_failure() const override { return run_.failure(); }

  PluginRun run_;
  std::vector<tool::ToolContact> contacts_;
};

touchstone2_tool tool_of(const tool::MassFrame& mass, const tool::Coupling& coupling) {
  touchstone2_tool out{};
  out.size = sizeof out;
  out.mass_kg = mass.mass_kg;
  copy(mass.center_T_m, out.center_T_m);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      out.inertia_T_kg_m2[3 * row + column] = mass.inertia_T_kg_m2(row, column);
  }
  out.stiffness_N_per_m = coupling.stiffness_N_per_m;
  out.rotational_stiffness_Nm_per_rad = coupling.rotational_stiffness_Nm_per_rad;
  return out;
}

tool::ToolRendererEntry entry_of(const std::shared_ptr<const LoadedPlugin>& loaded, std::uint32_t index) {
  const PluginDescription& described = loaded->descriptions()[index];
  tool::ToolRendererEntry entry;
  entry.name = described.name;
  entry.summary = described.summary;
  entry.source = described.source;
  entry.parameters = described.parameters;
  entry.library = loaded->path();
  entry.exact_normals =
      find_limitation(limitations_of(described, loaded->path()), rendering::Ability::rigid_motion) == nullptr;
  entry.resolution_m = [epsilon_m = described.epsilon_m](const rendering::Parameters&, double /*force_N*/) {
    return epsilon_m;
  };
  entry.make = [loaded, index](const rendering::Parameters& parameters, const tool::Tool& tool,
                               const TriangleMesh& object_W,
                               const tool::Coupling& coupling) -> std::unique_ptr<tool::ToolRenderer> {
    auto creation = std::make_shared<PluginCreation>(loaded->descriptions()[index], index, parameters,
                                                     std::make_shared<const TriangleMesh>(object_W));
    creation->set_tool(tool_of(tool.mass, coupling), std::make_shared<const TriangleMesh>(tool.mesh_T));
    return std::make_unique<PluginToolRenderer>(loaded->make(std::move(creation), PluginToolRenderer::most_contacts));
  };
  return entry;
}

tool::ToolResult PluginToolRenderer::do_step(const tool::ToolState& state, double /*dt_s*/) noexcept {
  tool::ToolResult out;
  const touchstone2_result* const made = run_.step(state.t_s, pose_of(state.handle.p_W_m, state.handle.q_WT));
  if (made == nullptr) {
    out.status = tool::ToolStatus::failed;
    return out;
  }
  out.f_W_N = vector_of(made->f_W_N);
  out.torque_W_Nm = vector_of(made->torque_W_Nm);
  const double* const q = made->proxy.q_WB;
  out.proxy = {vector_of(made->proxy.p_W_m), Quat(q[0], q[1], q[2], q[3])};
  for (std::size_t i = 0; i < made->contact_count; ++i) {
    const touchstone2_contact& contact = made->contacts[i];
    contacts_[i] = {vector_of(contact.p_W_m), vector_of(contact.n_W), vector_of(contact.f_W_N)};
  }
  out.contacts = {contacts_.data(), made->contact_count};
  out.contact = made->contact != 0;
  return out;
}

}  // namespace

std::vector<tool::ToolRendererEntry> load_tool_plugin(const std::filesystem::path& library,
                                                      const PluginOptions& options) {
  const auto loaded = std::make_shared<const LoadedPlugin>(library, options);
  std::vector<tool::ToolRendererEntry> entries;
  for (std::uint32_t i = 0; i < loaded->descriptions().size(); ++i) {
    if (loaded->descriptions()[i].renders_tools) entries.push_back(entry_of(loaded, i));
  }
  return entries;
}

void add_tool_plugin(const std::filesystem::path& library, const PluginOptions& options,
                     std::vector<tool::ToolRendererEntry>& entries) {
  for (tool::ToolRendererEntry& entry : load_tool_plugin(library, options)) {
    if (std::ranges::find(entries, entry.name, &tool::ToolRendererEntry::name) != entries.end()) {
      throw BadData(fmt::format("{}: there is a renderer named {} already; give the plug-in's a name of its own",
                                library.string(), entry.name));
    }
    entries.push_back(std::move(entry));
  }
}

}  // namespace touchstone::plugin
