#include <fmt/format.h>

#include <memory>

#include "dataset_commands.h"
#include "harness/base/units.h"
#include "harness/recording/dataset.h"
#include "harness/surface/mesh_file.h"
#include "packed_dataset.h"

namespace touchstone::datasets {
namespace {

struct DatasetOptions {
  std::string folder;
  std::string out;
  std::string on_duplicate = "refuse";
  std::string on_gap = "keep";
};

// Prints what was found; true when nothing is wrong.
bool report(const recording::Dataset& dataset, const DatasetOptions& options) {
  recording::ClockPolicy clock;
  clock.on_duplicate = recording::parse_on_duplicate(options.on_duplicate);
  clock.on_gap = recording::parse_on_gap(options.on_gap);
  const auto bounds = [](const std::filesystem::path& file, const std::string& unit) {
    return surface::load_mesh(file, length_unit_factor(unit)).bounds();
  };
  const DatasetReport found = check_dataset(dataset, bounds, clock);
  fmt::print("{}: {}, {} files\n", dataset.folder.string(), dataset.object, dataset.files().size());
  for (const std::string& fact : found.facts) fmt::print("  {}\n", fact);
  for (const std::string& warning : found.warnings) fmt::print(stderr, "warning: {}\n", warning);
  for (const std::string& error : found.errors) fmt::print(stderr, "error: {}\n", error);
  const std::size_t count = found.errors.size();
  fmt::print("{}\n", count == 0 ? "as described" : fmt::format("{} error{}", count, count == 1 ? "" : "s"));
  return found.errors.empty();
}

ExitStatus check(const DatasetOptions& options) {
  return report(recording::load_dataset(options.folder), options) ? ExitStatus::passed : ExitStatus::bad_data;
}

ExitStatus pack(const DatasetOptions& options) {
  recording::Dataset dataset = recording::load_dataset(options.folder);
  pack_dataset(dataset);
  if (!report(dataset, options)) return ExitStatus::bad_data;
  if (!options.out.empty()) {
    archive_dataset(dataset, options.out);
    fmt::print("{}\n", options.out);
  }
  return ExitStatus::passed;
}

void add_common(CLI::App& command, DatasetOptions& options) {
  command.add_option("folder", options.folder, "The data set's folder, or its dataset.json")->required();
  command.add_option("--on-duplicate", options.on_duplicate, "Samples that repeat a time: refuse, first, mean")
      ->capture_default_str();
  command.add_option("--on-gap", options.on_gap, "Gaps in a recording's clock: refuse, keep (reported)")
      ->capture_default_str();
}

}  // namespace

void add_dataset(CLI::App& program, apps::Run& run) {
  auto* const command = program.add_subcommand(
      "dataset", "Check or pack a data set: a folder with dataset.json, the mesh and the recordings of one object");
  command->require_subcommand(1);
  const auto options = std::make_shared<DatasetOptions>();
  auto* const checking = command->add_subcommand(
      "check", "Every file is there, is what its hash says, can be read, and lies where the mesh is");
  add_common(*checking, *options);
  checking->footer("Exit status: 0 as described, 3 otherwise.\n\nExample:\n  touchstone dataset check golden/plane");
  checking->callback([&run, options] { run = [options] { return check(*options); }; });
  auto* const packing = command->add_subcommand("pack", "Write the hash of every file into dataset.json, then check");
  add_common(*packing, *options);
  packing->add_option("--out", options->out, "Also write the whole data set as one archive, .tar.gz");
  packing->footer(
      "Examples:\n  touchstone dataset pack my-plate\n  touchstone dataset pack my-plate --out my-plate.tar.gz");
  packing->callback([&run, options] { run = [options] { return pack(*options); }; });
  command->footer(
      "dataset.json:\n"
      "  {\"schema\": \"touchstone-dataset/1\", \"object\": \"acrylic plate\",\n"
      "   \"mesh\": {\"file\": \"plate.obj\", \"unit\": \"mm\"}, \"tip_radius_m\": 0.0,\n"
      "   \"instrument\": \"ATI Nano17, optical tracker\", \"stiffness_N_per_m\": 500,\n"
      "   \"in_trajectory\": \"synthesize\",\n"
      "   \"recordings\": [{\"file\": \"scan.csv\", \"shows\": \"a scan along y\", \"exact\": \"scan.exact.csv\"}],\n"
      "   \"source\": \"...\", \"licence\": \"...\"}\n"
      "optional: \"instrument_file\", and of a recording \"repeat\", the same motion again; \"pack\" adds \"sha256\".");
}

}  // namespace touchstone::datasets
