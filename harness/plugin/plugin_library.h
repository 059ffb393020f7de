// A plug-in's shared library, loaded into this process and checked: the functions of <touchstone/plugin.h> and nothing
// that could come of them. Loading runs the library's own start-up code: where that is not trusted, a child process
// does it (plugin_process.h).
#pragma once

#include <touchstone/plugin.h>

#include <filesystem>
#include <string>
#include <vector>

#include "harness/base/rooms.h"
#include "harness/plugin/plugin_description.h"

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

  // nullptr with the reason in `why` when the plug-in refuses or throws.
  touchstone_renderer* create(const touchstone_creation& creation, std::string& why) const;
  void destroy(touchstone_renderer* renderer) const noexcept;
  // False when the plug-in says that it failed, or throws; error() then says why.
  bool reset(touchstone_renderer* renderer) const noexcept;
  bool step(touchstone_renderer* renderer, const touchstone_tip& tip, touchstone_result& result) const noexcept;
  [[nodiscard]] std::string error(const touchstone_renderer* renderer) const;

 private:
  [[nodiscard]] void* symbol(const char* name) const;
  template <class Function>
  void find(Function*& function, const char* name) const {
    function = reinterpret_cast<Function*>(symbol(name));
  }
  void check_version() const;

  std::filesystem::path path_;
  void* handle_ = nullptr;
  std::vector<PluginDescription> descriptions_;
  decltype(touchstone_plugin_version)* version_ = nullptr;
  decltype(touchstone_describe)* describe_ = nullptr;
  decltype(touchstone_create)* create_ = nullptr;
  decltype(touchstone_reset)* reset_ = nullptr;
  decltype(touchstone_step)* step_ = nullptr;
  decltype(touchstone_destroy)* destroy_ = nullptr;
  decltype(touchstone_error)* error_ = nullptr;
};

}  // namespace touchstone::plugin
