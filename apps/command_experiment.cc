#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>

#include "apps/commands.h"
#include "apps/experiments/peer_comparison.h"
#include "harness/base/atomic_file.h"
#include "harness/base/progress.h"

namespace touchstone::apps {
namespace {

struct PeerOptions {
  std::string data, json;
};

ExitStatus peers_command(const PeerOptions& options) {
  const char* const folder = std::getenv("TOUCHSTONE_DATA_DIR");
  const std::filesystem::path peers = !options.data.empty() ? std::filesystem::path(options.data)
                                      : folder != nullptr   ? std::filesystem::path(folder) / "peers"
                                                            : std::filesystem::path();
  if (peers.empty() || !std::filesystem::is_directory(peers)) {
    fmt::print(stderr,
               "touchstone: {}: no folder with the libraries' answers; give --data or set TOUCHSTONE_DATA_DIR\n",
               peers.string());
    return ExitStatus::skipped;
  }
  std::vector<experiments::PeerCase> cases;
  Progress progress("peers", experiments::peer_meshes().size());
  for (const auto& mesh : experiments::peer_meshes()) {
    cases.push_back(experiments::compare_with_peers(peers, mesh));
    progress.update(cases.size());
  }
  fmt::print("{}", experiments::peer_table(cases));
  if (!options.json.empty()) write_file(options.json, experiments::peer_json(cases));
  return ExitStatus::passed;
}

}  // namespace

void add_experiment(CLI::App& program, Run& run) {
  auto* const command =
      program.add_subcommand("experiment", "Run a published or comparative experiment and print its table");
  command->require_subcommand(1);
  auto* const peers =
      command->add_subcommand("peers", "The god-object beside CHAI3D and HAPI: force error against the smooth surface");
  auto options = std::make_shared<PeerOptions>();
  peers->add_option("--data", options->data, "Folder with in/ and out/ (default: TOUCHSTONE_DATA_DIR/peers)");
  peers->add_option("--json", options->json, "Write the table as JSON");
  peers->footer(
      "Examples:\n  touchstone experiment peers\n  touchstone experiment peers --data ~/data/peers --json peers.json");
  peers->callback([options, &run] { run = [options] { return peers_command(*options); }; });
}

}  // namespace touchstone::apps
