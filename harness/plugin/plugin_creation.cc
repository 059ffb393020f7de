#include "harness/plugin/plugin_creation.h"

#include <fmt/format.h>

#include "harness/base/error.h"
#include "harness/rendering/model.h"

namespace touchstone::plugin {
using rendering::Parameters;
using surface::TriangleMesh;

namespace {

static_assert(sizeof(Vec3) == 3 * sizeof(double));
static_assert(sizeof(std::array<std::int32_t, 3>) == 3 * sizeof(std::int32_t));

touchstone2_mesh mesh_of(const TriangleMesh& mesh) {
  return {mesh.vertices_W_m.empty() ? nullptr : mesh.vertices_W_m.front().data(), mesh.vertices_W_m.size(),
          mesh.triangles.empty() ? nullptr : mesh.triangles.front().data(), mesh.triangles.size()};
}

}  // namespace

PluginCreation::PluginCreation(const PluginDescription& description, std::uint32_t index, const Parameters& parameters,
                               std::shared_ptr<const TriangleMesh> object_W)
    : object_W_(std::move(object_W)) {
  bodies_ = {{sizeof(touchstone2_body), 0, "object", mesh_of(*object_W_), identity_pose}};
  set_model(description, index, parameters);
}

PluginCreation::PluginCreation(const PluginDescription& description, std::uint32_t index, const Parameters& parameters,
                               std::shared_ptr<const rendering::BodyScene> scene)
    : scene_(std::move(scene)) {
  for (const rendering::SceneBody& body : scene_->bodies) {
    if (body.surface_B->mesh() == nullptr) {
      throw BadData(fmt::format("{}: the body {} has no triangles; the renderer {} cannot run on it", scene_->source,
                                body.name, description.name));
    }
    const rendering::BodyPose pose = body.pose.first();
    bodies_.push_back({sizeof(touchstone2_body), body.pose.moves() ? 1U : 0U, body.name.c_str(),
                       mesh_of(*body.surface_B->mesh()), pose_of(pose.p_W_m, pose.q_WB)});
  }
  set_model(description, index, parameters);
}

void PluginCreation::set_model(const PluginDescription& description, std::uint32_t index,
                               const Parameters& parameters) {
  rendering::Model model;
  model.renderer = description.name;
  for (const rendering::ParameterDeclaration& declaration : description.parameters) {
    parameters_.push_back(parameters.at(declaration.name));
    model.parameters[declaration.name] = parameters_.back();
  }
  model_ = model_to_json(model);
  creation_ = {sizeof(touchstone2_creation), index,          model_.c_str(), parameters_.data(),
               parameters_.size(),           bodies_.data(), bodies_.size(), nullptr};
}

void PluginCreation::set_tool(const touchstone2_tool& tool, std::shared_ptr<const TriangleMesh> mesh_T) {
  tool_mesh_T_ = std::move(mesh_T);
  tool_ = tool;
  tool_.mesh = mesh_of(*tool_mesh_T_);
  creation_.tool = &tool_;
}

}  // namespace touchstone::plugin
