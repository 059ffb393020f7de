// Makes a plug-in of a renderer that is written in C++ with this library: one line in one .cc of a shared library,
//
//   #include "harness/plugin/plugin_export.h"
//   TOUCHSTONE_EXPORT_RENDERERS(my_renderer_entry());
//
// where my_renderer_entry() returns a RendererEntry; several are separated by commas. The plug-in makes its surface
// with Embree from the mesh that it receives, as the program does for its own renderers. No exception leaves it.
#pragma once

#include <touchstone/plugin.h>

#include <memory>
#include <string>
#include <vector>

#include "harness/plugin/export_parts.h"
#include "harness/rendering/renderer_entry.h"
#include "harness/surface/embree_surface.h"

// Completes the C interface's type: what the plug-in hands out.
struct touchstone_renderer {
  std::unique_ptr<touchstone::rendering::Renderer> renderer;
  std::string error;
};

namespace touchstone::plugin::plugin_export {

class Exported : private export_parts::EntryInC<rendering::RendererEntry> {
 public:
  explicit Exported(rendering::RendererEntry entry) : EntryInC(std::move(entry)) {
    description_ = {TOUCHSTONE_PLUGIN_SIZES, entry_.name.c_str(), entry_.summary.c_str(), entry_.source.c_str(),
                    parameters_.data(),      parameters_.size(),  limitations_.data(),    limitations_.size()};
  }

  [[nodiscard]] const touchstone_description* description() const { return &description_; }

  [[nodiscard]] std::unique_ptr<rendering::Renderer> make(const touchstone_creation& creation) const {
    const surface::TriangleMesh mesh = export_parts::mesh_of(
        {creation.vertices_W_m, creation.vertex_count, creation.triangles, creation.triangle_count});
    return entry_.make(export_parts::given_parameters(entry_, creation.parameters, creation.parameter_count),
                       make_embree_surface(mesh));
  }

 private:
  touchstone_description description_{};
};

inline int step(touchstone_renderer& handle, const touchstone_tip& tip, touchstone_result& result) noexcept {
  const rendering::StepResult made = handle.renderer->step({tip.t_s, vector_of(tip.p_W_m), quaternion_of(tip.q_WS)});
  if (made.status != rendering::StepStatus::ok) {
    handle.error =
        made.status == rendering::StepStatus::failed ? handle.renderer->failure() : "the renderer refused the tip";
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

#define TOUCHSTONE_EXPORT_RENDERERS(...) \
  TOUCHSTONE_EXPORT_PLUGIN(TOUCHSTONE_PLUGIN_VERSION, touchstone, touchstone_tip, plugin_export, __VA_ARGS__)
