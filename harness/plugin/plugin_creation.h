// What a plug-in's renderer is made of: the C structures of <touchstone/plugin2.h> and all that they point to. It stays
// where it is for as long as the renderer lives.
#pragma once

#include <touchstone/plugin2.h>

#include <memory>
#include <string>
#include <vector>

#include "harness/plugin/plugin_description.h"
#include "harness/plugin/plugin_values.h"
#include "harness/rendering/parameters.h"
#include "harness/rendering/scene.h"
#include "harness/surface/triangle_mesh.h"

namespace touchstone::plugin {

class PluginCreation {
 public:
  // One body, at rest with its frame that of the world. `index` is the description's.
  PluginCreation(const PluginDescription& description, std::uint32_t index, const rendering::Parameters& parameters,
                 std::shared_ptr<const surface::TriangleMesh> object_W);
  // The bodies of a scene, each with its pose. Throws BadData that names the body for one without triangles.
  PluginCreation(const PluginDescription& description, std::uint32_t index, const rendering::Parameters& parameters,
                 std::shared_ptr<const rendering::BodyScene> scene);
  PluginCreation(const PluginCreation&) = delete;
  PluginCreation& operator=(const PluginCreation&) = delete;

  // `tool` without its mesh, which is the other.
  void set_tool(const touchstone2_tool& tool, std::shared_ptr<const surface::TriangleMesh> mesh_T);

  [[nodiscard]] const touchstone2_creation& creation() const noexcept { return creation_; }

 private:
  void set_model(const PluginDescription& description, std::uint32_t index, const rendering::Parameters& parameters);

  std::shared_ptr<const surface::TriangleMesh> object_W_;
  std::shared_ptr<const rendering::BodyScene> scene_;
  std::string model_;
  std::vector<double> parameters_;
  std::vector<touchstone2_body> bodies_;
  std::shared_ptr<const surface::TriangleMesh> tool_mesh_T_;
  touchstone2_tool tool_{};
  touchstone2_creation creation_{};
};

}  // namespace touchstone::plugin
