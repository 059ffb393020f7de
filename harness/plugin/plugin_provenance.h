// Where a plug-in's result came from: the library's hash, and the commit and state of its repository as it runs.
#pragma once

#include <map>
#include <string>

#include "harness/rendering/renderer_entry.h"

namespace touchstone::plugin {

// plugin_library (the file's absolute path), plugin_sha256, plugin_commit, plugin_state: "clean", "changed: <path>", or
// why nothing is known. Changes of a golden case's expected results are none. Empty for a renderer that is no
// plug-in's. Throws BadData where the library cannot be read any more.
std::map<std::string, std::string> plugin_provenance(const rendering::RendererEntry& entry);

}  // namespace touchstone::plugin
