// A plug-in's library and how its renderers are reached: in this process, or each in a child of its own.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "harness/plugin/plugin_creation.h"
#include "harness/plugin/plugin_description.h"
#include "harness/plugin/plugin_library.h"
#include "harness/plugin/plugin_process.h"
#include "harness/plugin/plugin_run.h"

namespace touchstone::plugin {

struct PluginOptions {
  // In this process a step costs a function call, and a plug-in that crashes or hangs takes the program with it. Else
  // each renderer has a child process, and a step costs about a microsecond more (bench_plugin).
  bool in_process = false;
  PluginLimits limits;
  std::filesystem::path host;  // find_plugin_host() where empty
  // The folder of its sources, for provenance; the library's own where empty.
  std::filesystem::path source;
};

class LoadedPlugin {
 public:
  // Throws BadData for a library that is none, lacks functions, follows or claims a wrong version, or describes what
  // makes no sense; RendererFailed when it crashes or hangs while it is loaded.
  LoadedPlugin(const std::filesystem::path& library, const PluginOptions& options);

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  [[nodiscard]] const PluginOptions& options() const noexcept { return options_; }
  [[nodiscard]] const std::vector<PluginDescription>& descriptions() const noexcept { return descriptions_; }

  // Makes the renderer descriptions()[creation->index()]. A step answers at most `contact_capacity` contacts.
  [[nodiscard]] PluginRun make(std::shared_ptr<const PluginCreation> creation, std::size_t contact_capacity) const;

 private:
  std::filesystem::path path_;
  PluginOptions options_;
  std::shared_ptr<const PluginLibrary> in_process_;
  std::vector<PluginDescription> descriptions_;
};

}  // namespace touchstone::plugin
