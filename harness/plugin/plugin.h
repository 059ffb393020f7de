// Renderers from plug-ins (<touchstone/plugin.h>), as entries like those of the catalogue: every command, golden case
// and test that runs a model runs them. Loading is explicit, and nothing global remembers it: a model carries the entry
// that provides its renderer.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "harness/plugin/loaded_plugin.h"
#include "harness/rendering/model.h"
#include "harness/rendering/renderer_entry.h"

namespace touchstone::plugin {

// The renderers of points and balls of one library. Throws as LoadedPlugin does, and BadData for a library that has
// none.
std::vector<std::shared_ptr<const rendering::RendererEntry>> load_plugin(const std::filesystem::path& library,
                                                                         const PluginOptions& options);

class Plugins {
 public:
  // Adds the library's renderers. Throws as load_plugin() does, and BadData for a name that is taken: by another
  // plug-in or in `known`, the names of the program's own renderers.
  void load(const std::filesystem::path& library, const PluginOptions& options, std::span<const std::string> known);

  [[nodiscard]] const std::vector<std::shared_ptr<const rendering::RendererEntry>>& entries() const noexcept {
    return entries_;
  }
  // Gives the model the entry of the plug-in that has its renderer, if one does.
  void provide(rendering::Model& model) const;

 private:
  std::vector<std::shared_ptr<const rendering::RendererEntry>> entries_;
  std::vector<std::filesystem::path> from_;  // the library of each
};

// rendering::load_model(), with the renderer from a plug-in if one has it. `known`: the names of the program's own
// renderers. Throws BadData, with the place in the file, for a renderer that neither has.
rendering::Model load_model(const std::filesystem::path& path, const Plugins& plugins,
                            std::span<const std::string> known);

}  // namespace touchstone::plugin
