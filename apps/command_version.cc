#include <fmt/format.h>

#include "apps/commands.h"
#include "harness/base/version.h"

namespace touchstone::apps {

void add_version(CLI::App& program, Run& run) {
  auto* const command = program.add_subcommand("version", "Print version, commit, compiler and flags");
  command->callback([&run] {
    run = [] {
      const BuildInfo& info = build_info();
      fmt::print("touchstone {}\ncommit   {}{}\ncompiler {}\nbuild    {} ({})\n", info.version, info.commit,
                 info.dirty ? " with uncommitted changes" : "", info.compiler, info.build_type, info.flags);
      return ExitStatus::passed;
    };
  });
}

}  // namespace touchstone::apps
