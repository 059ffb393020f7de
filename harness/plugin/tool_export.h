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
#include <exception>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "harness/base/error.h"
#include "harness/plugin/plugin_creation.h"
#include "harness/tool/tool_renderer_entry.h"

// Completes the C interface's type: what the plug-in hands out.
struct touchstone2_renderer {
  std::unique_ptr<touchstone::tool::ToolRenderer> renderer;
  std::string error;
};

namespace touchstone::plugin::tool_export {

inline TriangleMesh mesh_of(const touchstone2_mesh& given) {
  TriangleMesh mesh;
  mesh.source = "the program's mesh";
  for (std::size_t i = 0; i < given.vertex_count; ++i) {
    const double* const v = given.vertices_m + 3 * i;
    mesh.vertices_W_m.emplace_back(v[0], v[1], v[2]);
  }
  for (std::size_t i = 0; i < given.triangle_count; ++i) {
    const std::int32_t* const t = given.triangles + 3 * i;
    mesh.triangles.push_back({t[0], t[1], t[2]});
  }
  return mesh;
}

// An entry and its description in C, which points into it.
class Exported {
 public:
  explicit Exported(tool::ToolRendererEntry entry) : entry_(std::move(entry)) {
    for (const ParameterDeclaration& p : entry_.parameters) {
      parameters_.push_back({p.name.c_str(), p.unit.c_str(), p.minimum, p.maximum, p.initial, p.meaning.c_str()});
    }
    if (!entry_.exact_normals) {
      limitations_.push_back({"rigid_motion", "its normals are the tool's own"});
    }
    description_.size = sizeof description_;
    description_.tip_kind = TOUCHSTONE2_TOOL;
    description_.name = entry_.name.c_str();
    description_.summary = entry_.summary.c_str();
    description_.source = entry_.source.c_str();
    description_.parameters = parameters_.data();
    description_.parameter_count = parameters_.size();
    description_.limitations = limitations_.data();
    description_.limitation_count = limitations_.size();
    if (entry_.resolution_m) {
      // As the checks press: 3 N; with the initial parameters.
      description_.epsilon_m = entry_.resolution_m(Parameters(entry_.parameters, {}, entry_.name, "", ""), 3.0);
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
    tool.mesh_T = mesh_of(given.mesh);
    tool.mass.mass_kg = given.mass_kg;
    tool.mass.center_T_m = vector_of(given.center_T_m);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column)
        tool.mass.inertia_T_kg_m2(row, column) = given.inertia_T_kg_m2[3 * row + column];
    }
    std::map<std::string, double> values;
    for (std::size_t i = 0; i < creation.parameter_count; ++i)
      values[entry_.parameters.at(i).name] = creation.parameters[i];
    return entry_.make(Parameters(entry_.parameters, values, "renderer " + entry_.name, "the program's model", ""),
                       tool, mesh_of(creation.bodies[0].mesh),
                       {given.stiffness_N_per_m, given.rotational_stiffness_Nm_per_rad});
  }

 private:
  tool::ToolRendererEntry entry_;
  std::vector<touchstone_parameter> parameters_;
  std::vector<touchstone_limitation> limitations_;
  touchstone2_description description_{};
};

using ExportedList = std::vector<std::unique_ptr<const Exported>>;

template <class... Entries>
ExportedList export_all(Entries... entries) {
  ExportedList list;
  (list.push_back(std::make_unique<const Exported>(std::move(entries))), ...);
  return list;
}

inline std::string& creation_error() {
  thread_local std::string text;
  return text;
}

inline touchstone2_renderer* create(const ExportedList& list, const touchstone2_creation& creation) noexcept {
  try {
    return new touchstone2_renderer{list.at(creation.index)->make(creation), {}};
  } catch (const std::exception& error) {
    creation_error() = error.what();
    return nullptr;
  }
}

inline int reset(touchstone2_renderer& handle) noexcept {
  try {
    handle.renderer->reset();
    return 0;
  } catch (const std::exception& error) {
    handle.error = error.what();
    return 1;
  }
}

inline int step(touchstone2_renderer& handle, const touchstone2_input& input, touchstone2_result& result) noexcept {
  const double* const q = input.tip.q_WB;
  const tool::ToolResult made =
      handle.renderer->step({input.t_s, {vector_of(input.tip.p_W_m), Quat(q[0], q[1], q[2], q[3])}});
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

#define TOUCHSTONE_EXPORT_TOOL_RENDERERS(...)                                                                         \
  static const touchstone::plugin::tool_export::ExportedList& touchstone_exported_tools() {                           \
    static const auto list = touchstone::plugin::tool_export::export_all(__VA_ARGS__);                                \
    return list;                                                                                                      \
  }                                                                                                                   \
  extern "C" {                                                                                                        \
  uint32_t touchstone_plugin_version(void) { return TOUCHSTONE_PLUGIN_VERSION_2; }                                    \
  const touchstone2_description* touchstone2_describe(uint32_t index) {                                               \
    return index < touchstone_exported_tools().size() ? touchstone_exported_tools()[index]->description() : nullptr;  \
  }                                                                                                                   \
  touchstone2_renderer* touchstone2_create(const touchstone2_creation* creation) {                                    \
    return touchstone::plugin::tool_export::create(touchstone_exported_tools(), *creation);                           \
  }                                                                                                                   \
  int touchstone2_reset(touchstone2_renderer* renderer) { return touchstone::plugin::tool_export::reset(*renderer); } \
  int touchstone2_step(touchstone2_renderer* renderer, const touchstone2_input* input, touchstone2_result* result) {  \
    return touchstone::plugin::tool_export::step(*renderer, *input, *result);                                         \
  }                                                                                                                   \
  void touchstone2_destroy(touchstone2_renderer* renderer) { delete renderer; }                                       \
  const char* touchstone2_error(const touchstone2_renderer* renderer) {                                               \
    return renderer == nullptr ? touchstone::plugin::tool_export::creation_error().c_str() : renderer->error.c_str(); \
  }                                                                                                                   \
  }                                                                                                                   \
  static_assert(true)
