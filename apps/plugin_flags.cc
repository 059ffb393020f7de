#include "apps/plugin_flags.h"

#include <fmt/format.h>

#include <cmath>

#include "harness/base/error.h"
#include "renderers/catalogue.h"

namespace touchstone::apps {
using plugin::PluginOptions;
using plugin::Plugins;

void PluginFlags::add_to(CLI::App& command) {
  command.add_option(
      "--plugin", libraries,
      "Shared library with renderers of your own (docs/how-to/your-own-renderer.md); model files may then name "
      "them. May be given several times");
  command.add_option("--plugin-source", source,
                     "Folder of the plug-ins' sources, whose commit and state a golden names; the library's own folder "
                     "where not given");
  command.add_flag("--plugin-in-process", in_process,
                   "Run plug-ins in this process: nothing added to the cost of a step, but a crash ends the run");
  command
      .add_option("--plugin-time-limit", step_limit_s,
                  "A plug-in that does not return from a step within this many seconds hangs, and is ended")
      ->capture_default_str();
}

PluginOptions PluginFlags::options() const {
  constexpr double longest_s = 1e6;
  if (!(step_limit_s >= 1e-3 && step_limit_s <= longest_s)) {
    throw UsageError(fmt::format("--plugin-time-limit {}: a number of seconds from 0.001 to {} was expected",
                                 step_limit_s, longest_s));
  }
  PluginOptions options;
  options.in_process = in_process;
  options.source = source;
  options.limits.step = std::chrono::milliseconds(std::llround(1e3 * step_limit_s));
  return options;
}

Plugins PluginFlags::load() const {
  const PluginOptions chosen = options();
  const std::vector<std::string> known = renderer_names(renderers::built_in_catalogue());
  Plugins plugins;
  for (const std::string& library : libraries) plugins.load(library, chosen, known);
  return plugins;
}

rendering::Model load_model(const std::filesystem::path& path, const Plugins& plugins) {
  return plugin::load_model(path, plugins, renderer_names(renderers::built_in_catalogue()));
}

}  // namespace touchstone::apps
