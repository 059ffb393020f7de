#include <fmt/format.h>

#include <memory>

#include "apps/commands.h"
#include "harness/base/progress.h"
#include "harness/recording/convert.h"

namespace touchstone::apps {
namespace {

struct ConvertOptions {
  std::string in;
  std::string out;
  recording::ColumnUnits units;
  std::string on_duplicate = "refuse";
  std::string on_gap = "keep";
};

ExitStatus convert(const ConvertOptions& options) {
  recording::ClockPolicy clock;
  clock.on_duplicate = recording::parse_on_duplicate(options.on_duplicate);
  clock.on_gap = recording::parse_on_gap(options.on_gap);
  recording::Conversion result;
  {
    Progress progress("converting " + options.in, 0);
    result = convert_recording(options.in, options.out, options.units, clock,
                               [&](std::uint64_t samples) { progress.update(samples); });
  }
  for (const std::string& note : result.notes) fmt::print(stderr, "note: {}\n", note);
  fmt::print("{}: {}\n", options.out, result.clock.summary());
  return ExitStatus::passed;
}

}  // namespace

void add_convert(CLI::App& program, Run& run) {
  auto* const command =
      program.add_subcommand("convert", "Convert a recording or rendered file between CSV and HDF5, or to other units");
  const auto options = std::make_shared<ConvertOptions>();
  command->add_option("in", options->in, "The file to read: .csv, .csv.gz, .h5 or .hdf5")->required();
  command->add_option("out", options->out, "The file to write; its extension says the format")->required();
  command->add_option("--time-unit", options->units.time, "Unit of the time column: s, ms, us")->capture_default_str();
  command->add_option("--length-unit", options->units.length, "Unit of positions: m, cm, mm, um, km")
      ->capture_default_str();
  command->add_option("--force-unit", options->units.force, "Unit of forces: N, mN, kN")->capture_default_str();
  command->add_option("--torque-unit", options->units.torque, "Unit of torques: Nm, Nmm, mNm")->capture_default_str();
  command->add_option("--on-duplicate", options->on_duplicate, "Samples that repeat a time: refuse, first, mean")
      ->capture_default_str();
  command->add_option("--on-gap", options->on_gap, "Gaps in the clock: refuse, keep (reported)")->capture_default_str();
  command->footer(
      "Every value is checked on the way; a file with something wrong is refused and nothing is written.\n\n"
      "Examples:\n"
      "  touchstone convert run7.csv run7.h5\n"
      "  touchstone convert run7.h5 run7-mm.csv --length-unit mm --time-unit ms\n"
      "  touchstone convert logger.csv clean.csv --on-duplicate mean");
  command->callback([&run, options] { run = [options] { return convert(*options); }; });
}

}  // namespace touchstone::apps
