#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/commands.h"
#include "harness/base/atomic_file.h"
#include "harness/base/freed_memory.h"
#include "harness/baseline/column_file.h"
#include "harness/baseline/comparison_report.h"
#include "harness/baseline/error_regimes.h"
#include "harness/sanity/pair_faults.h"
#include "harness/sanity/repeat_floor.h"

namespace touchstone::apps {
namespace {

struct CompareOptions {
  std::string expected, obtained, repeat, tolerance, json, print;
  bool where = false, flip_force = false;
};

void flip_forces(TrajectoryColumns& columns) {
  for (TrajectoryColumn& column : columns.columns) {
    const ComparedQuantity* const quantity = quantity_of_column(column.name);
    if (quantity == nullptr || (quantity->name != "force" && quantity->name != "torque")) continue;
    for (double& value : column.values) value = -value;
  }
}

// Without force where a column is missing, or where rows differ in number.
Recording recording_of(const TrajectoryColumns& columns) {
  Recording recording;
  recording.source = columns.source;
  std::vector<const std::vector<double>*> needed;
  for (const char* const name : {"t", "x", "y", "z", "fx", "fy", "fz"}) {
    needed.push_back(columns.find(name));
    if (needed.back() == nullptr || needed.back()->size() != columns.rows()) return recording;
  }
  const auto& n = needed;
  recording.motion.t_s = *n[0];
  for (std::size_t i = 0; i < columns.rows(); ++i) {
    recording.motion.p_W_m.emplace_back((*n[1])[i], (*n[2])[i], (*n[3])[i]);
    recording.f_W_N.emplace_back((*n[4])[i], (*n[5])[i], (*n[6])[i]);
  }
  std::vector<const std::vector<double>*> q;
  for (const char* const name : {"qw", "qx", "qy", "qz"}) q.push_back(columns.find(name));
  if (std::ranges::count(q, nullptr) > 0) return recording;
  for (std::size_t i = 0; i < columns.rows(); ++i) {
    recording.motion.q_WS.emplace_back((*q[0])[i], (*q[1])[i], (*q[2])[i], (*q[3])[i]);
  }
  return recording;
}

// Whether a fault of the file explains why it differs: a line each, with the repair.
void explain(const TrajectoryColumns& expected, const TrajectoryColumns& obtained) {
  for (const sanity::SanityFinding& finding :
       sanity::find_pair_faults(recording_of(expected), recording_of(obtained))) {
    fmt::print(stderr, "warning: {}: {}: {}\n", obtained.source, finding.fault, sanity::sanity_line(finding));
  }
}

// Errors that the real thing has from one time to the next are none of the renderer's.
bool within(const sanity::RepeatFloor& floor, const Comparison& comparison) {
  if (!comparison.problems.empty() || comparison.bad_data) return false;
  return std::ranges::all_of(comparison.groups, [&](const GroupResult& group) {
    if (passes(group.verdict)) return true;
    if (group.group == "force") return group.rms <= floor.force_N;
    return group.group == "position" && group.rms <= floor.position_m;
  });
}

ExitStatus compare_command(const CompareOptions& options) {
  take_memory_in_huge_pages(std::size_t{16} << 20);
  const Tolerance tolerance = options.tolerance.empty() ? default_tolerance() : load_tolerance(options.tolerance);
  auto [expected, obtained] = load_columns(options.expected, options.obtained);
  if (options.flip_force) flip_forces(obtained);
  const Comparison comparison = compare(expected, obtained, tolerance);
  std::optional<sanity::RepeatFloor> floor;
  if (!options.repeat.empty()) floor = sanity::repeat_floor_of_files(options.expected, options.repeat);
  const GroupResult* const force = comparison.find("force");
  if (!options.json.empty()) {
    nlohmann::json document = to_json(comparison);
    if (floor) {
      document["repeat_floor"] = {{"force_N", floor->force_N},           {"position_m", floor->position_m},
                                  {"shift_s", floor->shift_s},           {"unshifted_N", floor->unshifted_N},
                                  {"steadiest_N", floor->steadiest_N},   {"least_steady_N", floor->least_steady_N},
                                  {"within", within(*floor, comparison)}};
    }
    write_file(options.json, document.dump(2) + "\n");
  }
  if (options.print.empty()) {
    fmt::print("{}", to_table(comparison));
    if (floor) {
      fmt::print("repeat floor: {}{}\n", floor->text(),
                 force == nullptr
                     ? ""
                     : fmt::format("; the force error of {:.3g} N is {}", force->rms, floor->verdict(force->rms)));
    }
    if (options.where) fmt::print("{}", to_table(locate_error(expected, obtained)));
  } else {
    const auto metrics = metrics_of(comparison);
    const auto found =
        std::find_if(metrics.begin(), metrics.end(), [&](const auto& m) { return m.first == options.print; });
    if (found == metrics.end()) {
      std::string known;
      for (const auto& [name, value] : metrics) known += ' ' + name;
      throw BadData(
          fmt::format("this comparison has no metric '{}'; it has:{}\n{}", options.print, known, to_table(comparison)));
    }
    fmt::print("{:.17g}\n", found->second);
  }
  if (passes(comparison.verdict)) return ExitStatus::passed;
  if (!comparison.bad_data) explain(expected, obtained);
  if (floor && options.tolerance.empty() && within(*floor, comparison)) return ExitStatus::passed;
  return comparison.bad_data ? ExitStatus::bad_data : ExitStatus::failed;
}

}  // namespace

void add_compare(CLI::App& program, Run& run) {
  auto* const command = program.add_subcommand("compare", "Compare two recordings, rendered files or goldens");
  auto options = std::make_shared<CompareOptions>();
  command->add_option("EXPECTED", options->expected, "CSV (also .gz) or HDF5")->required();
  command->add_option("OBTAINED", options->obtained, "CSV (also .gz) or HDF5")->required();
  command->add_option("--tolerance", options->tolerance,
                      "Tolerance file (touchstone-tolerance/1); without it 1e-6 N, 1e-7 m, relative 1e-6");
  command->add_option("--repeat", options->repeat,
                      "A second recording of the same motion as EXPECTED: what they differ by is the floor; without "
                      "--tolerance an RMS error of force and position within it passes");
  command->add_flag("--flip-force", options->flip_force, "OBTAINED has the force BY the probe: negate it");
  command->add_option("--json", options->json, "Write the comparison as JSON");
  command->add_option("--print", options->print, "Print this metric alone, for instance force_rms_N");
  command->add_flag("--where", options->where,
                    "Say by axis, by what the tip does and where on the object the force error sits");
  command->footer(
      "Passes only when both have the same columns and number of rows, every value is finite and every error is "
      "within\n"
      "tolerance. Exit status 1: beyond tolerance, or a column or rows that only one side has; 3: a NaN or nothing to "
      "compare.\n"
      "If it fails, faults of OBTAINED are tried (force reversed or in another frame, unit, clock) and named with "
      "their "
      "repair.\n"
      "Examples:\n"
      "  touchstone compare golden.h5 rendered.csv\n"
      "  touchstone compare expected.csv obtained.csv --tolerance tolerance.json --json comparison.json\n"
      "  touchstone compare expected.csv obtained.csv --print force_rms_N\n"
      "  touchstone compare run1.csv rendered.csv --repeat run2.csv");
  command->callback([options, &run] { run = [options] { return compare_command(*options); }; });
}

}  // namespace touchstone::apps
