#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>

#include "apps/command_experiment_scan.h"
#include "apps/commands.h"
#include "apps/experiments/palpation_page.h"
#include "apps/experiments/peer_comparison.h"
#include "apps/experiments/spring_page.h"
#include "apps/experiments/voxel_page.h"
#include "apps/plugin_flags.h"
#include "harness/base/atomic_file.h"
#include "harness/base/progress.h"
#include "harness/recording/recording_file.h"
#include "harness/report/console.h"
#include "harness/report/page_html.h"

namespace touchstone::apps {
namespace {

struct PeerOptions {
  std::string data, json;
  PluginFlags plugins;
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
  std::vector<Model> besides;
  const Plugins plugins = options.plugins.load();
  for (const auto& entry : plugins.entries()) besides.push_back(experiments::peer_model(entry));
  std::vector<experiments::PeerCase> cases;
  Progress progress("peers", experiments::peer_meshes().size());
  for (const auto& mesh : experiments::peer_meshes()) {
    cases.push_back(experiments::compare_with_peers(peers, mesh, besides));
    progress.update(cases.size());
  }
  fmt::print("{}", experiments::peer_table(cases));
  if (!options.json.empty()) write_file(options.json, experiments::peer_json(cases));
  return ExitStatus::passed;
}

struct SpringOptions {
  std::string out;
  std::size_t seeds = 100;
  std::uint64_t first_seed = 1;
};

ExitStatus run_springs(const SpringOptions& options) {
  using experiments::spring_findings;
  ensure_writable_folder(options.out);
  const std::filesystem::path out = options.out;
  Progress progress("spring experiment", 0);
  const auto experiment = experiments::run_spring_experiment(
      options.first_seed, options.seeds, [&progress](std::size_t done, std::size_t) { progress.update(done); });
  write_file(out / "springs.json", experiments::spring_experiment_to_json(experiment));
  write_html(out / "report.html", experiments::spring_page(experiment, make_provenance(command_line())));
  for (const auto& condition : experiments::spring_conditions(experiment.variants.front().variant.setup)) {
    std::string name = condition.device + (condition.linear ? "-linear" : "-quadratic");
    std::replace(name.begin(), name.end(), ' ', '-');
    write_file(out / (name + ".json"), model_to_json(condition.model));
  }

  std::vector<std::vector<std::string>> rows{{"share of seeds"}};
  for (const auto& own : experiment.variants) rows.front().push_back(own.variant.name);
  for (std::size_t f = 0; f < spring_findings().size(); ++f) {
    rows.push_back({spring_findings()[f].name});
    for (const auto& own : experiment.variants)
      rows.back().push_back(fmt::format("{:.0f} %", 100.0 * own.findings[f][0].value()));
  }
  fmt::print("{}", align_columns(rows));
  fmt::print("seeds {} to {}; features scaled by the rule reference-norm; the report has the others: {}\n",
             options.first_seed, options.first_seed + options.seeds - 1, (out / "report.html").string());
  return ExitStatus::passed;
}

void add_springs(CLI::App& experiment, Run& run) {
  auto* const command = experiment.add_subcommand(
      "springs", "Two spring models on three devices against a real spring (Shao, Wu and Ouyang): which findings hold");
  auto options = std::make_shared<SpringOptions>();
  command->add_option("--out", options->out, "Folder for report.html, springs.json and the six model files")
      ->required();
  command->add_option("--seeds", options->seeds, "How many seeds")->check(CLI::Range(1, 100000))->capture_default_str();
  command->add_option("--first-seed", options->first_seed, "The first of them")->capture_default_str();
  command->footer(
      "Examples:\n  touchstone experiment springs --out springs\n  touchstone experiment springs --seeds 10 --out "
      "quick");
  command->callback([options, &run] { run = [options] { return run_springs(*options); }; });
}

struct PalpationOptions {
  std::string recording, out;
  std::size_t presses = 10;
};

ExitStatus run_palpation(const PalpationOptions& options) {
  ensure_writable_folder(options.out);
  const std::filesystem::path out = options.out;
  const Recording recording = load_recording(options.recording);
  const auto comparisons = experiments::compare_rows(recording, options.presses, experiments::raster_options());
  Provenance provenance = make_provenance(command_line());
  provenance.inputs.push_back(describe_input("recording", options.recording));
  write_file(out / "palpation.json", experiments::palpation_to_json(recording, comparisons));
  write_html(out / "report.html", experiments::palpation_page(recording, comparisons, provenance));
  std::size_t nearer = 0;
  for (const auto& own : comparisons) nearer += own.same() < own.rendered() ? 1 : 0;
  fmt::print("{} of {} rows lie nearer to the next one as measured than as one spring on one plane renders it; {}\n",
             nearer, comparisons.size(), (out / "report.html").string());
  return ExitStatus::passed;
}

void add_palpation(CLI::App& experiment, Run& run) {
  auto* const command = experiment.add_subcommand(
      "palpation",
      "Rows of a real raster of presses: nearer to their neighbours than to a rendering without the object's shape?");
  auto options = std::make_shared<PalpationOptions>();
  command->add_option("--recording", options->recording, "Raster along x, pressing along -z (CSV or HDF5)")->required();
  command->add_option("--presses", options->presses, "Presses of a row that are compared")
      ->check(CLI::Range(2, 1000))
      ->capture_default_str();
  command->add_option("--out", options->out, "Folder for report.html and palpation.json")->required();
  command->footer("Example:\n  touchstone experiment palpation --recording raster.csv --out palpation");
  command->callback([options, &run] { run = [options] { return run_palpation(*options); }; });
}

struct VoxelOptions {
  std::string out;
  experiments::VoxelExperimentOptions experiment;
};

ExitStatus run_voxel(const VoxelOptions& options) {
  if (!options.out.empty()) ensure_writable_folder(options.out);
  Progress progress("voxel experiment", 1 + 2 * options.experiment.resolutions.size());
  const auto experiment = experiments::run_voxel_experiment(
      options.experiment, [&progress](std::size_t done, std::size_t) { progress.update(done); });
  fmt::print("{}", experiments::voxel_table(experiment));
  if (options.out.empty()) return ExitStatus::passed;
  const std::filesystem::path out = options.out;
  write_file(out / "voxel.json", experiments::voxel_experiment_to_json(experiment));
  write_html(out / "report.html", experiments::voxel_page(experiment, make_provenance(command_line())));
  fmt::print("report: {}\n", (out / "report.html").string());
  return ExitStatus::passed;
}

void add_voxel(CLI::App& experiment, Run& run) {
  auto* const command = experiment.add_subcommand(
      "voxel", "The proxy against a voxel grid (Ruffaldi et al. 2006, table 1): error, operations, time, memory");
  auto options = std::make_shared<VoxelOptions>();
  command->add_option("--out", options->out, "Folder for report.html and voxel.json");
  command->add_option("--seed", options->experiment.seed, "Of the scan")->capture_default_str();
  command->add_option("--triangles", options->experiment.triangles, "Of the body's mesh")
      ->check(CLI::Range(100, 2000000))
      ->capture_default_str();
  command->footer(
      "Examples:\n  touchstone experiment voxel\n  touchstone experiment voxel --out voxel --triangles 140000 --seed "
      "7");
  command->callback([options, &run] { run = [options] { return run_voxel(*options); }; });
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
  options->plugins.add_to(*peers);
  peers->footer(
      "Examples:\n  touchstone experiment peers\n  touchstone experiment peers --plugin ./libmine.so\n  touchstone "
      "experiment peers --data ~/data/peers --json peers.json");
  peers->callback([options, &run] { run = [options] { return peers_command(*options); }; });
  add_springs(*command, run);
  add_palpation(*command, run);
  add_voxel(*command, run);
  add_scan_experiments(*command, run);
}

}  // namespace touchstone::apps
