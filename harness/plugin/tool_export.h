// Makes a plug-in of a renderer of tools that is written in C++ with this library: one line in one .cc of a shared
// library,
//
//   #include "harness/plugin/tool_export.h"
//   TOUCHSTONE_EXPORT_TOOL_RENDERERS(my_tool_renderer_entry());
//
// where my_tool_renderer_entry() returns a ToolRendererEntry; several are separated by commas. No exception leaves it.
#pragma once

#include <touchstone/plugin2.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "harness/base/error.h"
#include "harness/plugin/export_parts.h"
#include "harness/tool/tool_renderer_entry.h"

// Completes the C interface's type: what the plug-in hands out.
struct touchstone2_renderer {
  std::unique_ptr<touchstone::tool::ToolRenderer> renderer;
  std::string error;
};

namespace touchstone::plugin::tool_export {

// An entry and its description in C, which points into it.
class Exported {
 public:
  explicit Exported(tool::ToolRendererEntry entry)
      : entry_(std::move(entry)), parameters_(export_parts::parameters_of(entry_)) {
    if (!entry_.exact_normals) {
      limitations_.push_back({"rigid_motion", "its normals are the tool's own"});
    }
    description_ = export_parts::description_of(entry_, TOUCHSTONE2_TOOL, parameters_, limitations_);
    if (entry_.resolution_m) {
      // As the checks press: 3 N; with the initial parameters.
      description_.epsilon_m =
          entry_.resolution_m(rendering::Parameters(entry_.parameters, {}, entry_.name, "", ""), 3.0);
    }
  }
  Exported(const Exported&) = delete;
  Exported& operator=(const Exported&) = delete;

  [[nodiscard]] const touchstone2_description* description() const { return &description_; }

  [[nodiscard]] std::unique_ptr<tool::ToolRenderer> make(const touchstone2_creation& creation) const {
    if (creation.tool == nullptr) throw BadData("the program gave no tool");
    if (creation.body_count != 1) throw BadData("one body was expected");
    const touchstone2_tool& given = *creation.tool;
    tool::Tool tool;
    tool.mesh_T = export_parts::mesh_of(given.mesh);
    tool.mass.mass_kg = given.mass_kg;
    tool.mass.center_T_m = vector_of(given.center_T_m);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column)
        tool.mass.inertia_T_kg_m2(row, column) = given.inertia_T_kg_m2[3 * row + column];
    }
    return entry_.make(export_parts::given_parameters(entry_, creation.parameters, creation.parameter_count), tool,
                       export_parts::mesh_of(creation.bodies[0].mesh),
                       {given.stiffness_N_per_m, given.rotational_stiffness_Nm_per_rad});
  }

 private:
  tool::ToolRendererEntry entry_;
  std::vector<touchstone_parameter> parameters_;
  std::vector<touchstone_limitation> limitations_;
  touchstone2_description description_{};
};

inline int step(touchstone2_renderer& handle, const touchstone2_input& input, touchstone2_result& result) noexcept {
  const tool::ToolResult made =
      handle.renderer->step({input.t_s, {vector_of(input.tip.p_W_m), quaternion_of(input.tip.q_WB)}});
  if (made.status != tool::ToolStatus::ok) {
    handle.error =
        made.status == tool::ToolStatus::failed ? handle.renderer->failure() : "the renderer refused the pose";
    return 1;
  }
  copy(made.f_W_N, result.f_W_N);
  copy(made.torque_W_Nm, result.torque_W_Nm);
  result.proxy = pose_of(made.proxy.p_W_m, made.proxy.q_WT);
  result.contact = made.contact ? 1 : 0;
  result.contact_count = std::min(made.contacts.size(), result.contact_capacity);
  for (std::size_t i = 0; i < result.contact_count; ++i) {
    touchstone2_contact& contact = result.contacts[i];
    contact = {};
    copy(made.contacts[i].p_W_m, contact.p_W_m);
    copy(made.contacts[i].n_W, contact.n_W);
    copy(made.contacts[i].f_W_N, contact.f_W_N);
  }
  return 0;
}

}  // namespace touchstone::plugin::tool_export

#define TOUCHSTONE_EXPORT_TOOL_RENDERERS(...) \
  TOUCHSTONE_EXPORT_PLUGIN(TOUCHSTONE_PLUGIN_VERSION_2, touchstone2, touchstone2_input, tool_export, __VA_ARGS__)
