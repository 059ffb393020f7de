// Makes a plug-in of a renderer that is written in C++ with this library: one line in one .cc of a shared library,
//
//   #include "harness/plugin/plugin_export.h"
//   TOUCHSTONE_EXPORT_RENDERERS(my_renderer_entry());
//
// where my_renderer_entry() returns a RendererEntry; several are separated by commas. The plug-in makes its surface
// with Embree from the mesh that it receives, as the program does for its own renderers. No exception leaves it.
#pragma once

#include <touchstone/plugin.h>

#include <exception>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "harness/base/rooms.h"
#include "harness/rendering/renderer_entry.h"
#include "harness/surface/embree_surface.h"

// Completes the C interface's type: what the plug-in hands out.
struct touchstone_renderer {
  std::unique_ptr<touchstone::rendering::Renderer> renderer;
  std::string error;
};

namespace touchstone::plugin::plugin_export {

inline const char* name_of(Ability ability) {
  switch (ability) {
    case Ability::thin_shells:
      return "thin_shells";
    case Ability::large_jumps:
      return "large_jumps";
    case Ability::start_inside:
      return "start_inside";
    case Ability::continuous_force:
      return "continuous_force";
    case Ability::rigid_motion:
      return "rigid_motion";
    case Ability::unit_scale:
      return "unit_scale";
    case Ability::passive:
      return "passive";
    case Ability::surface_contact:
      return "surface_contact";
    case Ability::ball_tip:
      return "ball_tip";
    case Ability::analytic_surface:
      return "analytic_surface";
  }
  return "?";
}

// An entry and its description in C, which points into it.
class Exported {
 public:
  explicit Exported(RendererEntry entry) : entry_(std::move(entry)) {
    for (const ParameterDeclaration& p : entry_.parameters) {
      parameters_.push_back({p.name.c_str(), p.unit.c_str(), p.minimum, p.maximum, p.initial, p.meaning.c_str()});
    }
    for (const Limitation& limit : entry_.cannot)
      limitations_.push_back({name_of(limit.ability), limit.reason.c_str()});
    description_ = {TOUCHSTONE_PLUGIN_SIZES, entry_.name.c_str(), entry_.summary.c_str(), entry_.source.c_str(),
                    parameters_.data(),      parameters_.size(),  limitations_.data(),    limitations_.size()};
  }
  Exported(const Exported&) = delete;
  Exported& operator=(const Exported&) = delete;

  [[nodiscard]] const touchstone_description* description() const { return &description_; }

  [[nodiscard]] std::unique_ptr<Renderer> make(const touchstone_creation& creation) const {
    TriangleMesh mesh;
    mesh.source = "the program's mesh";
    for (std::size_t i = 0; i < creation.vertex_count; ++i) {
      const double* const v = creation.vertices_W_m + 3 * i;
      mesh.vertices_W_m.emplace_back(v[0], v[1], v[2]);
    }
    for (std::size_t i = 0; i < creation.triangle_count; ++i) {
      const std::int32_t* const t = creation.triangles + 3 * i;
      mesh.triangles.push_back({t[0], t[1], t[2]});
    }
    std::map<std::string, double> given;
    for (std::size_t i = 0; i < creation.parameter_count; ++i) {
      given[entry_.parameters.at(i).name] = creation.parameters[i];
    }
    return entry_.make(Parameters(entry_.parameters, given, "renderer " + entry_.name, "the program's model", ""),
                       make_embree_surface(mesh));
  }

 private:
  RendererEntry entry_;
  std::vector<touchstone_parameter> parameters_;
  std::vector<touchstone_limitation> limitations_;
  touchstone_description description_{};
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

inline touchstone_renderer* create(const ExportedList& list, const touchstone_creation& creation) noexcept {
  try {
    return new touchstone_renderer{list.at(creation.index)->make(creation), {}};
  } catch (const std::exception& error) {
    creation_error() = error.what();
    return nullptr;
  }
}

inline int reset(touchstone_renderer& handle) noexcept {
  try {
    handle.renderer->reset();
    return 0;
  } catch (const std::exception& error) {
    handle.error = error.what();
    return 1;
  }
}

inline void copy(const Vec3& from, double (&to)[3]) noexcept {
  for (int i = 0; i < 3; ++i) to[i] = from[i];
}

inline int step(touchstone_renderer& handle, const touchstone_tip& tip, touchstone_result& result) noexcept {
  const StepResult made = handle.renderer->step(
      {tip.t_s, {tip.p_W_m[0], tip.p_W_m[1], tip.p_W_m[2]}, {tip.q_WS[0], tip.q_WS[1], tip.q_WS[2], tip.q_WS[3]}});
  if (made.status != StepStatus::ok) {
    handle.error = made.status == StepStatus::failed ? handle.renderer->failure() : "the renderer refused the tip";
    return 1;
  }
  copy(made.f_W_N, result.f_W_N);
  copy(made.contact_W_m, result.contact_W_m);
  copy(made.n_W, result.n_W);
  result.depth_m = made.depth_m;
  result.contact = made.contact ? 1 : 0;
  result.reserved = 0;
  return 0;
}

}  // namespace touchstone::plugin::plugin_export

#define TOUCHSTONE_EXPORT_RENDERERS(...)                                                                              \
  static const touchstone::plugin::plugin_export::ExportedList& touchstone_exported() {                               \
    static const auto list = touchstone::plugin::plugin_export::export_all(__VA_ARGS__);                              \
    return list;                                                                                                      \
  }                                                                                                                   \
  extern "C" {                                                                                                        \
  uint32_t touchstone_plugin_version(void) { return TOUCHSTONE_PLUGIN_VERSION; }                                      \
  const touchstone_description* touchstone_describe(uint32_t index) {                                                 \
    return index < touchstone_exported().size() ? touchstone_exported()[index]->description() : nullptr;              \
  }                                                                                                                   \
  touchstone_renderer* touchstone_create(const touchstone_creation* creation) {                                       \
    return touchstone::plugin::plugin_export::create(touchstone_exported(), *creation);                               \
  }                                                                                                                   \
  int touchstone_reset(touchstone_renderer* renderer) { return touchstone::plugin::plugin_export::reset(*renderer); } \
  int touchstone_step(touchstone_renderer* renderer, const touchstone_tip* tip, touchstone_result* result) {          \
    return touchstone::plugin::plugin_export::step(*renderer, *tip, *result);                                         \
  }                                                                                                                   \
  void touchstone_destroy(touchstone_renderer* renderer) { delete renderer; }                                         \
  const char* touchstone_error(const touchstone_renderer* renderer) {                                                 \
    return renderer == nullptr ? touchstone::plugin::plugin_export::creation_error().c_str()                          \
                               : renderer->error.c_str();                                                             \
  }                                                                                                                   \
  }                                                                                                                   \
  static_assert(true)
