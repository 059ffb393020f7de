// What a plug-in says about one of its renderers, as C++ values; and the bytes in which the child process that loaded
// the library sends them to the program.
#pragma once

#include <touchstone/plugin2.h>

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "harness/rendering/limitation.h"
#include "harness/rendering/renderer.h"

namespace touchstone::plugin {

struct PluginDescription {
  unsigned version = TOUCHSTONE_PLUGIN_VERSION;  // of the interface that the library follows
  std::string name, summary, source;
  std::vector<rendering::ParameterDeclaration> parameters;
  std::vector<std::pair<std::string, std::string>> limitations;  // ability, reason
  bool renders_tools = false;                                    // else a point or a ball
  double epsilon_m = 0.0;     // lengths below it are nothing to the renderer; 0: none but rounding
  double world_unit_m = 1.0;  // one unit of the engine's own world
};

// Throws BadData, naming the library and the place, for texts that are missing, names that stand twice, ranges that are
// none.
PluginDescription read_description(const touchstone_description& description, const std::filesystem::path& library,
                                   std::uint32_t index);
PluginDescription read_description(const touchstone2_description& description, const std::filesystem::path& library,
                                   std::uint32_t index);

// Version 2 alone: one that lacks it is given one object at rest, as the program's own renderers of one object are.
inline constexpr std::string_view several_bodies = "several_bodies";
bool takes_several_bodies(const PluginDescription& description);

// Without several_bodies. Throws BadData for an ability that does not exist; lists those that do.
std::vector<rendering::Limitation> limitations_of(const PluginDescription& description,
                                                  const std::filesystem::path& library);

std::string pack(std::span<const PluginDescription> descriptions);
// Throws BadData when the bytes are not what pack() makes.
std::vector<PluginDescription> unpack(std::string_view bytes, const std::filesystem::path& library);

}  // namespace touchstone::plugin
