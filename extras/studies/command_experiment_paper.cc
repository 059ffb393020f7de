#include "command_experiment_paper.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "experiments/paper_experiment.h"
#include "harness/base/atomic_file.h"
#include "harness/base/progress.h"
#include "harness/base/units.h"
#include "harness/pipeline/evaluation/campaign.h"
#include "harness/recording/recording_file.h"
#include "harness/surface/mesh_file.h"

namespace touchstone::studies {
namespace {

struct PaperCommandOptions {
  std::vector<std::string> datasets;
  std::string recording, mesh, mesh_unit = "m", average = "rms", samples = "all", in_trajectory = "synthesize", json;
  double stiffness_N_per_m = 500.0;  // the paper's 0.5 N/mm
};

std::vector<experiments::PaperScan> scans_of(const PaperCommandOptions& options) {
  std::vector<experiments::PaperScan> out;
  if (options.recording.empty() != options.mesh.empty())
    throw UsageError("--recording and --mesh belong together: a scan and the object that it was made over");
  if (!options.recording.empty()) {
    out.push_back({options.recording, recording::load_recording(options.recording),
                   surface::load_mesh(options.mesh, length_unit_factor(options.mesh_unit)), options.stiffness_N_per_m});
  }
  std::vector<std::filesystem::path> places(options.datasets.begin(), options.datasets.end());
  if (places.empty() && out.empty()) places = pipeline::bundled_datasets();
  for (const auto& place : places) {
    const recording::Dataset dataset = recording::load_dataset(place);
    const surface::TriangleMesh mesh =
        surface::load_mesh(dataset.path_of(dataset.mesh_file), length_unit_factor(dataset.mesh_unit));
    for (const recording::DatasetRecording& recording : dataset.recordings) {
      out.push_back(
          {fmt::format("{} / {}", std::filesystem::weakly_canonical(dataset.folder).filename().string(),
                       std::filesystem::path(recording.file).stem().string()),
           recording::load_recording(dataset.path_of(recording.file)), mesh, dataset.stiffness_N_per_m,
           dataset.instrument_file.empty() ? std::filesystem::path() : dataset.path_of(dataset.instrument_file),
           dataset.friction_coefficient, dataset.tip_radius_m});
    }
  }
  return out;
}

ExitStatus run_paper(const PaperCommandOptions& options) {
  experiments::PaperOptions paper;
  paper.average = options.average == "mean" ? experiments::Average::mean : experiments::Average::rms;
  paper.counted = options.samples == "contact" ? experiments::Counted::contact : experiments::Counted::all;
  paper.in_trajectory =
      recording::find_in_trajectory(options.in_trajectory).value_or(recording::InTrajectoryMode::synthesize);
  const auto scans = scans_of(options);
  std::vector<experiments::PaperResult> results;
  Progress progress("experiments of the 2006 paper", scans.size());
  for (const experiments::PaperScan& scan : scans) {
    results.push_back(experiments::run_paper_experiments(scan, paper));
    progress.update(results.size());
  }
  fmt::print("{}", experiments::paper_text(results));
  if (!options.json.empty()) write_file(options.json, experiments::paper_to_json(results, paper));
  return ExitStatus::passed;
}

}  // namespace

void add_paper_experiment(CLI::App& experiment, apps::Run& run) {
  auto* const command = experiment.add_subcommand(
      "paper",
      "All four experiments of Ruffaldi et al. 2006 with one definition on any data, and which findings hold on which");
  auto options = std::make_shared<PaperCommandOptions>();
  command->add_option("--dataset", options->datasets,
                      "Folder with dataset.json, may be given several times; not given: the bundled ones");
  command->add_option("--recording", options->recording, "Instead: a recording (CSV or HDF5)");
  command->add_option("--mesh", options->mesh, "and the object that it was made over");
  command->add_option("--mesh-unit", options->mesh_unit, "Unit of the mesh: m, mm, cm, km, um, in, ft")
      ->capture_default_str();
  command->add_option("--stiffness", options->stiffness_N_per_m, "Of the virtual probe, with --recording [N/m]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--average", options->average, "rms, or mean: equation 3 as it is printed")
      ->check(CLI::IsMember({"rms", "mean"}))
      ->capture_default_str();
  command->add_option("--samples", options->samples, "all, or contact: only those in which the probe touched")
      ->check(CLI::IsMember({"all", "contact"}))
      ->capture_default_str();
  command->add_option("--in-trajectory", options->in_trajectory, "synthesize (equation 2), whole-force or measured")
      ->check(CLI::IsMember({"synthesize", "whole-force", "measured"}))
      ->capture_default_str();
  command->add_option("--json", options->json, "Write the tables as JSON");
  command->footer(
      "Examples:\n  touchstone experiment paper\n  touchstone experiment paper --dataset my-plate --dataset my-cup\n"
      "  touchstone experiment paper --recording scan.csv --mesh cup.obj --mesh-unit mm --average mean --samples "
      "contact");
  command->callback([options, &run] { run = [options] { return run_paper(*options); }; });
}

}  // namespace touchstone::studies
