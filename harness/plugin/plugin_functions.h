// The functions of a loaded library in the terms of version 2 of the interface, whichever version it follows.
#pragma once

#include <touchstone/plugin2.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "harness/plugin/plugin_description.h"

namespace touchstone::plugin {

// A renderer of the library, of either version's type.
using PluginHandle = void*;

// Each may throw what the plug-in throws.
class PluginFunctions {
 public:
  virtual ~PluginFunctions() = default;
  // Throws BadData for structures of another size, and as read_description() does.
  [[nodiscard]] virtual std::vector<PluginDescription> describe() = 0;
  // nullptr where it refuses.
  virtual PluginHandle create(const touchstone2_creation& creation) = 0;
  // 0 when it went well.
  virtual int reset(PluginHandle renderer) = 0;
  virtual int step(PluginHandle renderer, const touchstone2_input& input, touchstone2_result& result) = 0;
  virtual void destroy(PluginHandle renderer) = 0;
  virtual const char* error(PluginHandle renderer) = 0;
};

// An exported function by name; throws BadData that names it where there is none.
using FindSymbol = std::function<void*(const char*)>;

std::unique_ptr<PluginFunctions> plugin_functions_1(const std::filesystem::path& library, const FindSymbol& find);
std::unique_ptr<PluginFunctions> plugin_functions_2(const std::filesystem::path& library, const FindSymbol& find);

// More than any library has; one that describes more is not believed.
inline constexpr std::uint32_t most_plugin_renderers = 1000;

}  // namespace touchstone::plugin
