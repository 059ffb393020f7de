// A plug-in in a child process: what it does wrong does not take the program down. A crash, a hang and an early exit
// are found and told as such. The child is the small program touchstone-plugin-host.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <vector>

#include "harness/plugin/plugin_connection.h"
#include "harness/plugin/plugin_description.h"

namespace touchstone::plugin {

// After these the plug-in is said to hang, and killed.
struct PluginLimits {
  std::chrono::milliseconds step{10'000};    // one step or reset
  std::chrono::milliseconds create{60'000};  // loading the library and making a renderer
};

// Where touchstone-plugin-host is: TOUCHSTONE_PLUGIN_HOST, beside the running program, or in ../libexec/touchstone from
// there. Throws UsageError that names the places.
std::filesystem::path find_plugin_host();

// Loads the library in a child and tells what it describes. Throws BadData as PluginLibrary does, RendererFailed when
// the child crashes or hangs.
std::vector<PluginDescription> describe_plugin(const std::filesystem::path& library, const PluginLimits& limits,
                                               const std::filesystem::path& host);

// Copies all that the creation points to. `version`: of the interface that the library follows, for messages.
// `contact_capacity`: the most contacts that a step can answer. Throws as describe_plugin() does.
std::unique_ptr<PluginConnection> make_plugin_process(const std::filesystem::path& library, unsigned version,
                                                      const touchstone2_creation& creation,
                                                      std::size_t contact_capacity, const PluginLimits& limits,
                                                      const std::filesystem::path& host);

}  // namespace touchstone::plugin
