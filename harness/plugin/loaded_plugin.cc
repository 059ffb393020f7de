#include "harness/plugin/loaded_plugin.h"

#include <fmt/format.h>

#include "harness/plugin/plugin_in_process.h"

namespace touchstone::plugin {

LoadedPlugin::LoadedPlugin(const std::filesystem::path& library, const PluginOptions& options)
    : path_(library), options_(options) {
  if (options.in_process) {
    in_process_ = std::make_shared<const PluginLibrary>(library);
    descriptions_ = in_process_->descriptions();
    return;
  }
  if (options_.host.empty()) options_.host = find_plugin_host();
  descriptions_ = describe_plugin(library, options_.limits, options_.host);
}

PluginRun LoadedPlugin::make(std::shared_ptr<const PluginCreation> creation, std::size_t contact_capacity) const {
  const touchstone2_creation& made_of = creation->creation();
  const PluginDescription& description = descriptions_.at(made_of.index);
  auto connection = in_process_ ? make_plugin_in_process(in_process_, made_of)
                                : make_plugin_process(path_, description.version, made_of, contact_capacity,
                                                      options_.limits, options_.host);
  return {std::move(connection), fmt::format("{}: the renderer {}", path_.string(), description.name),
          std::move(creation), contact_capacity};
}

}  // namespace touchstone::plugin
