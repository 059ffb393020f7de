#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>

#include "apps/plugin_flags.h"
#include "command_experiment_paper.h"
#include "command_experiment_scan.h"
#include "experiments/indentation_page.h"
#include "experiments/palpation_page.h"
#include "experiments/peer_comparison.h"
#include "experiments/perception_bench_page.h"
#include "experiments/renderer_cost.h"
#include "experiments/seeded_experiments.h"
#include "experiments/spring_page.h"
#include "experiments/spring_seed.h"
#include "experiments/voxel_page.h"
#include "harness/base/atomic_file.h"
#include "harness/base/progress.h"
#include "harness/recording/recording_file.h"
#include "harness/report/console.h"
#include "harness/report/page_html.h"
#include "harness/report/page_markdown.h"
#include "seeded_command.h"
#include "study_commands.h"

namespace touchstone::studies {
using report::Provenance;

namespace {

// The report for people, and its tables for documents.
void write_page(const std::filesystem::path& folder, const report::Page& page) {
  write_html(folder / "report.html", page);
  write_file(folder / "tables.md", tables_to_markdown(page));
}

struct PeerOptions {
  std::string data, json;
  apps::PluginFlags plugins;
};

ExitStatus peers_command(const PeerOptions& options) {
  const char* const folder = std::getenv("TOUCHSTONE_DATA_DIR");
  const bool has_folder = folder != nullptr && *folder != '\0';
  const std::filesystem::path peers = !options.data.empty() ? std::filesystem::path(options.data)
                                      : has_folder          ? std::filesystem::path(folder) / "peers"
                                                            : std::filesystem::path();
  if (peers.empty() || !std::filesystem::is_directory(peers)) {
    fmt::print(stderr, "touchstone: {}no folder with the libraries' answers; give --data or set TOUCHSTONE_DATA_DIR\n",
               peers.empty() ? "" : peers.string() + ": ");
    return ExitStatus::skipped;
  }
  std::vector<rendering::Model> besides;
  const plugin::Plugins plugins = options.plugins.load();
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
  SeededOptions seeded;
  std::size_t seeds = 100;
  std::uint64_t first_seed = 1;
};

void write_spring_report(const std::filesystem::path& out, const experiments::SpringExperiment& experiment,
                         const SeededRun& run) {
  write_file(out / "springs.json", experiments::spring_experiment_to_json(experiment));
  Provenance provenance = report::make_provenance(apps::command_line());
  provenance.inputs.push_back(*run.rows);
  write_page(out, experiments::spring_page(experiment, provenance));
  for (const auto& condition : experiments::spring_conditions(experiment.variants.front().variant.setup)) {
    std::string name = condition.device + (condition.linear ? "-linear" : "-quadratic");
    std::replace(name.begin(), name.end(), ' ', '-');
    write_file(out / (name + ".json"), model_to_json(condition.model));
  }
  fmt::print("the report has the others: {}\n", (out / "report.html").string());
}

ExitStatus run_springs(const SpringOptions& options) {
  using experiments::spring_findings;
  const SeededRun run =
      run_seeded(experiments::seeded_springs(options.first_seed, options.seeds), options.seeded, "springs");
  if (run.seeds.empty()) return run.status;
  std::vector<experiments::SpringSeed> seeds;
  for (const auto& own : run.seeds) {
    if (own.error.empty()) seeds.push_back(experiments::spring_seed_from_json(own.result.document));
  }
  const auto experiment = experiments::gather_springs(options.first_seed, seeds);
  std::vector<std::vector<std::string>> rows{{"share of seeds"}};
  for (const auto& own : experiment.variants) rows.front().push_back(own.variant.name);
  for (std::size_t f = 0; f < spring_findings().size(); ++f) {
    rows.push_back({spring_findings()[f].name});
    for (const auto& own : experiment.variants)
      rows.back().push_back(fmt::format("{:.0f} %", 100.0 * own.findings[f][0].value()));
  }
  fmt::print("{}", report::align_columns(rows));
  fmt::print("seeds {} to {}; features scaled by the rule reference-norm\n", options.first_seed,
             options.first_seed + options.seeds - 1);
  if (!options.seeded.out.empty()) write_spring_report(options.seeded.out, experiment, run);
  return run.status;
}

void add_springs(CLI::App& experiment, apps::Run& run) {
  auto* const command = experiment.add_subcommand(
      "springs", "Two spring models on three devices against a real spring (Shao, Wu and Ouyang): which findings hold");
  auto options = std::make_shared<SpringOptions>();
  command->add_option("--out", options->seeded.out,
                      "Folder for report.html, tables.md, springs.json and the six model files");
  command->add_option("--seeds", options->seeds, "How many seeds")->check(CLI::Range(1, 100000))->capture_default_str();
  command->add_option("--first-seed", options->first_seed, "The first of them")->capture_default_str();
  add_seeded_flags(*command, options->seeded, "springs");
  command->footer(
      "One seed after the other, each on all cores. A run that stopped goes on where it was.\n"
      "Examples:\n  touchstone experiment springs --out springs\n  touchstone experiment springs --seeds 10 --out "
      "quick\n" +
      seeded_examples("springs"));
  command->callback([options, &run] { run = [options] { return run_springs(*options); }; });
}

struct PalpationOptions {
  std::string recording, out;
  std::size_t presses = 10;
};

ExitStatus run_palpation(const PalpationOptions& options) {
  ensure_writable_folder(options.out);
  const std::filesystem::path out = options.out;
  const recording::Recording recording = recording::load_recording(options.recording);
  const auto comparisons = experiments::compare_rows(recording, options.presses, experiments::raster_options());
  Provenance provenance = report::make_provenance(apps::command_line());
  provenance.inputs.push_back(report::describe_input("recording", options.recording));
  write_file(out / "palpation.json", experiments::palpation_to_json(recording, comparisons));
  write_page(out, experiments::palpation_page(recording, comparisons, provenance));
  std::size_t nearer = 0;
  for (const auto& own : comparisons) nearer += own.same() < own.rendered() ? 1 : 0;
  fmt::print("{} of {} rows lie nearer to the next one as measured than as one spring on one plane renders it; {}\n",
             nearer, comparisons.size(), (out / "report.html").string());
  return ExitStatus::passed;
}

void add_palpation(CLI::App& experiment, apps::Run& run) {
  auto* const command = experiment.add_subcommand(
      "palpation",
      "Rows of a real raster of presses: nearer to their neighbours than to a rendering without the object's shape?");
  auto options = std::make_shared<PalpationOptions>();
  command->add_option("--recording", options->recording, "Raster along x, pressing along -z (CSV or HDF5)")->required();
  command->add_option("--presses", options->presses, "Presses of a row that are compared")
      ->check(CLI::Range(2, 1000))
      ->capture_default_str();
  command->add_option("--out", options->out, "Folder for report.html, tables.md and palpation.json")->required();
  command->footer("Example:\n  touchstone experiment palpation --recording raster.csv --out palpation");
  command->callback([options, &run] { run = [options] { return run_palpation(*options); }; });
}

struct IndentationOptions {
  std::string curve, out;
};

ExitStatus run_indentation(const IndentationOptions& options) {
  ensure_writable_folder(options.out);
  const std::filesystem::path out = options.out;
  const auto approach = experiments::read_approach(options.curve);
  const auto comparisons = experiments::compare_indentation(approach);
  Provenance provenance = report::make_provenance(apps::command_line());
  provenance.inputs.push_back(report::describe_input("curve", options.curve));
  write_file(out / "indentation.json", experiments::indentation_to_json(approach, comparisons));
  write_page(out, experiments::indentation_page(approach, comparisons, provenance));
  fmt::print("in {} of {} pairs the record measured again lies nearer than every rendering; {}\n",
             experiments::measured_nearest(comparisons), comparisons.size(), (out / "report.html").string());
  return ExitStatus::passed;
}

void add_indentation(CLI::App& experiment, apps::Run& run) {
  auto* const command = experiment.add_subcommand(
      "indentation", "A real AFM indentation: nearer to itself measured again than to what power laws make of it?");
  auto options = std::make_shared<IndentationOptions>();
  command->add_option("--curve", options->curve, "Force-distance curve, the .tab format of afmformats")->required();
  command->add_option("--out", options->out, "Folder for report.html, tables.md and indentation.json")->required();
  command->footer("Example:\n  touchstone experiment indentation --curve curve.tab --out indentation");
  command->callback([options, &run] { run = [options] { return run_indentation(*options); }; });
}

struct VoxelOptions {
  SeededOptions seeded;
  std::size_t seeds = 1;
  experiments::VoxelExperimentOptions experiment;
};

ExitStatus run_voxel(const VoxelOptions& options) {
  const auto seeded = experiments::seeded_voxel(options.experiment, options.seeds);
  const SeededRun run = run_seeded(seeded, options.seeded, "voxel");
  if (run.seeds.empty()) return run.status;
  const auto& first = run.seeds.front().result;
  const auto experiment = experiments::voxel_from(first.document, first.times);
  const auto spread = experiments::stored_spread(seeded, run.seeds);
  fmt::print("{}{}", experiments::voxel_table(experiment), experiments::spread_table(spread));
  if (options.seeded.out.empty()) return run.status;
  const std::filesystem::path out = options.seeded.out;
  write_file(out / "voxel.json", experiments::voxel_experiment_to_json(experiment));
  Provenance provenance = report::make_provenance(apps::command_line());
  provenance.inputs.push_back(*run.rows);
  report::Page page = experiments::voxel_page(experiment, provenance);
  page.sections.insert(page.sections.begin() + 1, experiments::spread_section(spread));
  write_page(out, page);
  fmt::print("report: {}\n", (out / "report.html").string());
  return run.status;
}

void add_voxel(CLI::App& experiment, apps::Run& run) {
  auto* const command = experiment.add_subcommand(
      "voxel", "The proxy against a voxel grid (Ruffaldi et al. 2006, table 1): error, operations, time, memory");
  auto options = std::make_shared<VoxelOptions>();
  command->add_option("--out", options->seeded.out, "Folder for report.html, tables.md and voxel.json");
  command->add_option("--seed", options->experiment.seed, "Of the scan")->capture_default_str();
  command->add_option("--seeds", options->seeds, "How many seeds, from --seed on; the tables are of the first")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--triangles", options->experiment.triangles, "Of the body's mesh")
      ->check(CLI::Range(100, 2000000))
      ->capture_default_str();
  add_seeded_flags(*command, options->seeded, "voxel");
  command->footer(
      "One seed after the other: it measures times. Times are those of the run that made the row.\n"
      "Examples:\n  touchstone experiment voxel\n  touchstone experiment voxel --out voxel --triangles 140000 --seed "
      "7 --seeds 5\n" +
      seeded_examples("voxel"));
  command->callback([options, &run] { run = [options] { return run_voxel(*options); }; });
}

struct CostCommandOptions {
  std::string out;
  experiments::CostOptions cost;
};

ExitStatus run_cost(const CostCommandOptions& options) {
  if (!options.out.empty()) ensure_writable_folder(options.out);
  Progress progress("renderer costs", experiments::cost_cases(options.cost));
  const auto costs = experiments::measure_costs(options.cost, [&progress](std::size_t done) { progress.update(done); });
  fmt::print("{}", experiments::cost_table(costs));
  if (options.out.empty()) return ExitStatus::passed;
  const std::filesystem::path out = options.out;
  write_file(out / "cost.json", experiments::cost_to_json(costs));
  write_page(out, experiments::cost_page(costs, report::make_provenance(apps::command_line())));
  fmt::print("report: {}\n", (out / "report.html").string());
  return ExitStatus::passed;
}

void add_cost(CLI::App& experiment, apps::Run& run) {
  auto* const command = experiment.add_subcommand(
      "cost", "Floating-point operations and microseconds per step of every renderer over the size of the mesh");
  auto options = std::make_shared<CostCommandOptions>();
  command->add_option("--out", options->out, "Folder for report.html, tables.md and cost.json");
  command->add_option("--triangles", options->cost.triangles, "Sizes of the mesh")
      ->delimiter(',')
      ->check(CLI::Range(100, 4000000))
      ->capture_default_str();
  command->add_option("--steps", options->cost.steps, "Steps at 1 kHz")
      ->check(CLI::Range(100, 10000000))
      ->capture_default_str();
  command->footer(
      "Examples:\n  touchstone experiment cost\n  touchstone experiment cost --triangles 1000,1000000 --out cost");
  command->callback([options, &run] { run = [options] { return run_cost(*options); }; });
}

struct PerceptionBenchCommand {
  SeededOptions seeded;
  experiments::PerceptionBenchOptions bench;
};

ExitStatus run_perception(const PerceptionBenchCommand& options) {
  const SeededRun run = run_seeded(experiments::seeded_perception(options.bench), options.seeded, "perception");
  if (run.seeds.empty()) return run.status;
  const auto bench = experiments::stored_bench(options.bench, experiments::BenchTruth::thresholds, run.seeds);
  const auto published = experiments::stored_bench(options.bench, experiments::BenchTruth::experiments, run.seeds);
  fmt::print("Answers by the judge's own thresholds:\n{}\n", experiments::perception_bench_table(bench));
  fmt::print("Answers by published experiments:\n{}\n", experiments::perception_bench_table(published));
  if (options.seeded.out.empty()) return run.status;
  const std::filesystem::path out = options.seeded.out;
  write_file(out / "perception-bench.json", experiments::perception_bench_to_json(bench, published));
  Provenance provenance = report::make_provenance(apps::command_line());
  provenance.inputs.push_back(*run.rows);
  write_page(out, experiments::perception_bench_page(bench, published, provenance));
  fmt::print("report: {}\n", (out / "report.html").string());
  return run.status;
}

void add_perception_bench(CLI::App& experiment, apps::Run& run) {
  auto* const command = experiment.add_subcommand(
      "perception",
      "Every metric of perception on presses with planted differences: by the thresholds and by published experiments");
  auto options = std::make_shared<PerceptionBenchCommand>();
  command->add_option("--out", options->seeded.out, "Folder for report.html, tables.md and perception-bench.json");
  command->add_option("--seeds", options->bench.seeds, "How many seeds, each through every setup")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command->add_option("--first-seed", options->bench.first_seed, "The first of them")->capture_default_str();
  command->add_flag("!--judge-only", options->bench.other_metrics, "Leave the metrics of other authors out: faster");
  add_seeded_flags(*command, options->seeded, "perception");
  command->footer(
      "One seed after the other, each on all cores. A run that stopped goes on where it was.\n"
      "Examples:\n  touchstone experiment perception --seeds 1\n  touchstone experiment perception --out perception "
      "--seeds 20 --first-seed 1000\n" +
      seeded_examples("perception"));
  command->callback([options, &run] { run = [options] { return run_perception(*options); }; });
}

}  // namespace

void add_experiment(CLI::App& program, apps::Run& run) {
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
  add_indentation(*command, run);
  add_perception_bench(*command, run);
  add_voxel(*command, run);
  add_cost(*command, run);
  add_scan_experiments(*command, run);
  add_paper_experiment(*command, run);
}

}  // namespace touchstone::studies
