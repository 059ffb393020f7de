#include "harness/plugin/plugin.h"

#include <fmt/format.h>

#include <algorithm>

#include "harness/base/error.h"
#include "harness/base/known_names.h"
#include "harness/plugin/plugin_in_process.h"
#include "harness/plugin/plugin_renderer.h"

namespace touchstone::plugin {
namespace {

static_assert(sizeof(Vec3) == 3 * sizeof(double));
static_assert(sizeof(std::array<std::int32_t, 3>) == 3 * sizeof(std::int32_t));

// What a creation points to besides the mesh.
struct CreationTexts {
  std::string model;
  std::vector<double> parameters;
};

CreationTexts texts_of(const PluginDescription& description, const Parameters& parameters) {
  CreationTexts out;
  Model model;
  model.renderer = description.name;
  for (const ParameterDeclaration& declaration : description.parameters) {
    out.parameters.push_back(parameters.at(declaration.name));
    model.parameters[declaration.name] = out.parameters.back();
  }
  out.model = model_to_json(model);
  return out;
}

RendererEntry entry_of(const PluginDescription& description, std::uint32_t index, const std::filesystem::path& path,
                       const std::shared_ptr<const PluginLibrary>& library, const PluginOptions& options) {
  RendererEntry entry;
  entry.name = description.name;
  entry.summary = description.summary;
  entry.source = description.source;
  entry.parameters = description.parameters;
  entry.cannot = limitations_of(description, path);
  entry.library = path;
  entry.library_source = options.source;
  entry.make = [=](const Parameters& parameters, std::shared_ptr<const Surface> surface) -> std::unique_ptr<Renderer> {
    const TriangleMesh* const mesh = surface->mesh();
    if (mesh == nullptr) {
      throw BadData(fmt::format("{}: the renderer {} cannot run on a surface without triangles", path.string(),
                                description.name));
    }
    const CreationTexts texts = texts_of(description, parameters);
    const touchstone_creation creation{index,
                                       0,
                                       texts.model.c_str(),
                                       texts.parameters.data(),
                                       texts.parameters.size(),
                                       mesh->vertices_W_m.empty() ? nullptr : mesh->vertices_W_m.front().data(),
                                       mesh->vertices_W_m.size(),
                                       mesh->triangles.empty() ? nullptr : mesh->triangles.front().data(),
                                       mesh->triangles.size()};
    auto connection = library ? make_plugin_in_process(library, creation)
                              : make_plugin_process(path, creation, options.limits, options.host);
    return std::make_unique<PluginRenderer>(
        std::move(connection), fmt::format("{}: the renderer {}", path.string(), description.name), std::move(surface));
  };
  return entry;
}

}  // namespace

std::vector<std::shared_ptr<const RendererEntry>> load_plugin(const std::filesystem::path& library,
                                                              const PluginOptions& options) {
  PluginOptions chosen = options;
  std::shared_ptr<const PluginLibrary> loaded;
  std::vector<PluginDescription> descriptions;
  if (options.in_process) {
    loaded = std::make_shared<const PluginLibrary>(library);
    descriptions = loaded->descriptions();
  } else {
    if (chosen.host.empty()) chosen.host = find_plugin_host();
    descriptions = describe_plugin(library, chosen.limits, chosen.host);
  }
  std::vector<std::shared_ptr<const RendererEntry>> entries;
  entries.reserve(descriptions.size());
  for (std::uint32_t i = 0; i < descriptions.size(); ++i) {
    entries.push_back(std::make_shared<const RendererEntry>(entry_of(descriptions[i], i, library, loaded, chosen)));
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
