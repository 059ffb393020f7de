// A plug-in's renderer in this process: no overhead and no protection. What crashes there crashes the program.
#pragma once

#include <memory>

#include "harness/plugin/plugin_connection.h"
#include "harness/plugin/plugin_library.h"

namespace touchstone::plugin {

// Throws RendererFailed when the plug-in makes none. The creation's arrays must outlive the connection.
std::unique_ptr<PluginConnection> make_plugin_in_process(std::shared_ptr<const PluginLibrary> library,
                                                         const touchstone2_creation& creation);

}  // namespace touchstone::plugin
