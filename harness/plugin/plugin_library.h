// A plug-in's shared library, loaded into this process and checked: the functions of <touchstone/plugin.h> or
// <touchstone/plugin2.h>, in the terms of the latter, and nothing that could come of them. Loading runs the library's
// own start-up code: where that is not trusted, a child process does it (plugin_process.h).
#pragma once

#include <touchstone/plugin2.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "harness/plugin/plugin_description.h"
#include "harness/plugin/plugin_functions.h"

namespace touchstone::plugin {

class PluginLibrary {
 public:
  // Throws BadData that says what is wrong: no such file, not a shared library, a function that is missing, a version
  // that this program does not know or that the library lies about, a description that makes no sense.
  explicit PluginLibrary(const std::filesystem::path& path);
  ~PluginLibrary();
  PluginLibrary(const PluginLibrary&) = delete;
  PluginLibrary& operator=(const PluginLibrary&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  [[nodiscard]] const std::vector<PluginDescription>& descriptions() const noexcept { return descriptions_; }

  // Which version of the interface it follows: 1 or 2.
  [[nodiscard]] unsigned version() const noexcept { return version_; }

  // nullptr with the reason in `why` when the plug-in refuses or throws.
  PluginHandle create(const touchstone2_creation& creation, std::string& why) const;
  void destroy(PluginHandle renderer) const noexcept;
  // False when the plug-in says that it failed, or throws; error() then says why.
  bool reset(PluginHandle renderer) const noexcept;
  bool step(PluginHandle renderer, const touchstone2_input& input, touchstone2_result& result) const noexcept;
  [[nodiscard]] std::string error(PluginHandle renderer) const;

 private:
  [[nodiscard]] void* symbol(const char* name) const;
  void load();

  std::filesystem::path path_;
  void* handle_ = nullptr;
  unsigned version_ = 0;
  std::unique_ptr<PluginFunctions> functions_;
  std::vector<PluginDescription> descriptions_;
};

}  // namespace touchstone::plugin
