// Makes a plug-in of version 2 of the interface of a renderer that is written in C++ with this library and renders
// several bodies, each with a pose that may move (RendererEntry::make_scene): one line in one .cc of a shared library,
//
//   #include "harness/plugin/scene_export.h"
//   TOUCHSTONE_EXPORT_SCENE_RENDERERS(my_renderer_entry());
//
// where my_renderer_entry() returns a RendererEntry; several are separated by commas. Where the program gives one body
// that stands still in the world's frame, RendererEntry::make runs, as it does behind version 1. No exception leaves
// it.
#pragma once

#include <touchstone/plugin2.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "harness/base/error.h"
#include "harness/plugin/export_parts.h"
#include "harness/rendering/renderer_entry.h"
#include "harness/rendering/scene.h"
#include "harness/surface/embree_surface.h"

namespace touchstone::plugin::scene_export {

// A renderer, and where the program says that its bodies are.
struct OverBodies {
  std::unique_ptr<rendering::Renderer> renderer;
  std::vector<std::shared_ptr<rendering::BodyPose>> poses;  // of each body; empty where one stands still

  void reset() { renderer->reset(); }
};

}  // namespace touchstone::plugin::scene_export

// Completes the C interface's type: what the plug-in hands out.
struct touchstone2_renderer {
  std::unique_ptr<touchstone::plugin::scene_export::OverBodies> renderer;
  std::string error;
};

namespace touchstone::plugin::scene_export {

inline rendering::BodyPose body_pose(const touchstone2_pose& pose) noexcept {
  return {vector_of(pose.p_W_m), quaternion_of(pose.q_WB)};
}

class Exported : private export_parts::EntryInC<rendering::RendererEntry> {
 public:
  explicit Exported(rendering::RendererEntry entry) : EntryInC(std::move(entry)) {
    if (!entry_.make_scene) limitations_.push_back({"several_bodies", "it takes one object that stands still"});
    description_ = export_parts::description_of(entry_, TOUCHSTONE2_POINT, parameters_, limitations_);
    description_.epsilon_m = entry_.epsilon_m;
    description_.world_unit_m = entry_.world_unit_m;
  }

  [[nodiscard]] const touchstone2_description* description() const { return &description_; }

  [[nodiscard]] std::unique_ptr<OverBodies> make(const touchstone2_creation& creation) const {
    const rendering::Parameters parameters =
        export_parts::given_parameters(entry_, creation.parameters, creation.parameter_count);
    auto made = std::make_unique<OverBodies>();
    if (creation.body_count == 1 && creation.bodies[0].moves == 0 && at_origin(creation.bodies[0].pose)) {
      made->renderer = entry_.make(parameters, make_embree_surface(export_parts::mesh_of(creation.bodies[0].mesh)));
      return made;
    }
    if (!entry_.make_scene) throw BadData("the renderer " + entry_.name + " takes one object that stands still");
    auto scene = std::make_shared<rendering::BodyScene>();
    scene->source = "the program's scene";
    for (std::size_t i = 0; i < creation.body_count; ++i) {
      const touchstone2_body& body = creation.bodies[i];
      made->poses.push_back(std::make_shared<rendering::BodyPose>(body_pose(body.pose)));
      scene->bodies.push_back({body.name, make_embree_surface(export_parts::mesh_of(body.mesh)),
                               body.moves != 0 ? rendering::PoseTrack::following(made->poses.back())
                                               : rendering::PoseTrack(*made->poses.back())});
    }
    made->renderer = entry_.make_scene(parameters, std::move(scene));
    return made;
  }

 private:
  static bool at_origin(const touchstone2_pose& pose) {
    return std::ranges::equal(pose.p_W_m, identity_pose.p_W_m) && std::ranges::equal(pose.q_WB, identity_pose.q_WB);
  }

  touchstone2_description description_{};
};

inline int step(touchstone2_renderer& handle, const touchstone2_input& input, touchstone2_result& result) noexcept {
  OverBodies& over = *handle.renderer;
  for (std::size_t i = 0; i < over.poses.size(); ++i) *over.poses[i] = body_pose(input.bodies[i]);
  const rendering::StepResult made =
      over.renderer->step({input.t_s, vector_of(input.tip.p_W_m), quaternion_of(input.tip.q_WB)});
  if (made.status != rendering::StepStatus::ok) {
    handle.error =
        made.status == rendering::StepStatus::failed ? over.renderer->failure() : "the renderer refused the tip";
    return 1;
  }
  copy(made.f_W_N, result.f_W_N);
  copy(made.contact_W_m, result.proxy.p_W_m);
  copy(made.n_W, result.n_W);
  result.depth_m = made.depth_m;
  result.contact = made.contact ? 1 : 0;
  return 0;
}

}  // namespace touchstone::plugin::scene_export

#define TOUCHSTONE_EXPORT_SCENE_RENDERERS(...) \
  TOUCHSTONE_EXPORT_PLUGIN(TOUCHSTONE_PLUGIN_VERSION_2, touchstone2, touchstone2_input, scene_export, __VA_ARGS__)
