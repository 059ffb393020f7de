#include "harness/plugin/plugin.h"

#include <fmt/format.h>

#include <algorithm>

#include "harness/base/error.h"
#include "harness/base/known_names.h"
#include "harness/plugin/plugin_creation.h"
#include "harness/plugin/plugin_renderer.h"

namespace touchstone::plugin {
using rendering::Model;
using rendering::RendererEntry;

namespace {

RendererEntry entry_of(const std::shared_ptr<const LoadedPlugin>& loaded, std::uint32_t index) {
  const PluginDescription& described = loaded->descriptions()[index];
  RendererEntry entry;
  entry.name = described.name;
  entry.summary = described.summary;
  entry.source = described.source;
  entry.parameters = described.parameters;
  entry.cannot = limitations_of(described, loaded->path());
  entry.epsilon_m = described.epsilon_m;
  entry.world_unit_m = described.world_unit_m;
  entry.library = loaded->path();
  entry.library_source = loaded->options().source;
  entry.make = [loaded, index](
                   const rendering::Parameters& parameters,
                   std::shared_ptr<const surface::Surface> surface) -> std::unique_ptr<rendering::Renderer> {
    const PluginDescription& description = loaded->descriptions()[index];
    const surface::TriangleMesh* const mesh = surface->mesh();
    if (mesh == nullptr) {
      throw BadData(fmt::format("{}: the renderer {} cannot run on a surface without triangles",
                                loaded->path().string(), description.name));
    }
    // The surface's own mesh, which lives as long as the surface.
    auto creation = std::make_shared<const PluginCreation>(description, index, parameters,
                                                           std::shared_ptr<const surface::TriangleMesh>(surface, mesh));
    return std::make_unique<PluginRenderer>(loaded->make(std::move(creation), 0));
  };
  if (takes_several_bodies(described)) {
    entry.make_scene = [loaded, index](
                           const rendering::Parameters& parameters,
                           std::shared_ptr<const rendering::BodyScene> scene) -> std::unique_ptr<rendering::Renderer> {
      auto creation = std::make_shared<const PluginCreation>(loaded->descriptions()[index], index, parameters, scene);
      return std::make_unique<PluginSceneRenderer>(loaded->make(std::move(creation), 0), std::move(scene));
    };
  }
  return entry;
}

}  // namespace

std::vector<std::shared_ptr<const RendererEntry>> load_plugin(const std::filesystem::path& library,
                                                              const PluginOptions& options) {
  const auto loaded = std::make_shared<const LoadedPlugin>(library, options);
  std::vector<std::shared_ptr<const RendererEntry>> entries;
  for (std::uint32_t i = 0; i < loaded->descriptions().size(); ++i) {
    if (!loaded->descriptions()[i].renders_tools)
      entries.push_back(std::make_shared<const RendererEntry>(entry_of(loaded, i)));
  }
  if (entries.empty()) {
    throw BadData(
        fmt::format("{}: has renderers of tools with a shape only ({} first); the command `touchstone tool` takes it",
                    library.string(), loaded->descriptions().front().name));
  }
  return entries;
}

void Plugins::load(const std::filesystem::path& library, const PluginOptions& options,
                   std::span<const std::string> known) {
  for (auto& entry : load_plugin(library, options)) {
    const auto same = [&](const std::shared_ptr<const RendererEntry>& other) { return other->name == entry->name; };
    const auto taken = std::ranges::find_if(entries_, same);
    if (taken != entries_.end()) {
      throw BadData(fmt::format("{}: {} has a renderer named {} too; rename one of them", library.string(),
                                from_[static_cast<std::size_t>(taken - entries_.begin())].string(), entry->name));
    }
    if (std::ranges::find(known, entry->name) != known.end()) {
      throw BadData(
          fmt::format("{}: {} is the name of a renderer of this program; give the plug-in's renderer a name of its own",
                      library.string(), entry->name));
    }
    entries_.push_back(std::move(entry));
    from_.push_back(library);
  }
}

void Plugins::provide(Model& model) const {
  for (const auto& entry : entries_) {
    if (entry->name == model.renderer) model.provided = entry;
  }
}

Model load_model(const std::filesystem::path& path, const Plugins& plugins, std::span<const std::string> known) {
  Model model = rendering::load_model(path);
  plugins.provide(model);
  if (model.provided || plugins.entries().empty()) return model;
  // Said here because only here it is known what the plug-ins have.
  std::vector<std::string> names(known.begin(), known.end());
  for (const auto& entry : plugins.entries()) names.push_back(entry->name);
  if (std::ranges::find(names, model.renderer) == names.end()) {
    throw BadData(fmt::format("{}: /renderer: {}", path.string(), unknown_name("renderer", model.renderer, names)));
  }
  return model;
}

}  // namespace touchstone::plugin
