#include "harness/golden/comparison/compared_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>

#include "harness/base/error.h"
#include "harness/golden/comparison/column_file.h"
#include "harness/golden/comparison/comparison_report.h"
#include "harness/recording_checks/pair_faults.h"

namespace touchstone::golden {

namespace {

void flip_forces(TrajectoryColumns& columns) {
  for (TrajectoryColumn& column : columns.columns) {
    const ComparedQuantity* const quantity = quantity_of_column(column.name);
    if (quantity == nullptr || (quantity->id != Quantity::force && quantity->id != Quantity::torque)) continue;
    for (double& value : column.values) value = -value;
  }
}

// Errors that the real thing has from one time to the next are none of the renderer's.
bool within(const recording_checks::RepeatFloor& floor, const Comparison& comparison) {
  if (!comparison.problems.empty() || comparison.bad_data) return false;
  return std::ranges::all_of(comparison.groups, [&](const GroupResult& group) {
    if (passes(group.verdict)) return true;
    if (group.quantity == Quantity::force) return group.rms <= floor.within_N;
    return group.quantity == Quantity::position && group.rms <= floor.position_m;
  });
}

}  // namespace

recording::Recording recording_of(const TrajectoryColumns& columns) {
  recording::Recording recording;
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
  const auto usable = [&](const std::vector<double>* column) {
    return column != nullptr && column->size() == columns.rows();
  };
  if (!std::ranges::all_of(q, usable)) return recording;
  for (std::size_t i = 0; i < columns.rows(); ++i) {
    recording.motion.q_WS.emplace_back((*q[0])[i], (*q[1])[i], (*q[2])[i], (*q[3])[i]);
  }
  return recording;
}

ComparedFiles compare_files(const CompareRequest& request) {
  ComparedFiles files;
  std::tie(files.expected, files.obtained) = load_columns(request.expected, request.obtained);
  if (request.flip_force) flip_forces(files.obtained);
  files.comparison = compare(files.expected, files.obtained, request.tolerance.value_or(default_tolerance()));
  if (!request.repeat.empty()) files.floor = recording_checks::repeat_floor_of_files(request.expected, request.repeat);
  files.within_floor = files.floor && within(*files.floor, files.comparison);
  files.passed = passes(files.comparison.verdict) || (files.within_floor && !request.tolerance);
  return files;
}

std::vector<std::string> ComparedFiles::explanations() const {
  std::vector<std::string> lines;
  if (passes(comparison.verdict) || comparison.bad_data) return lines;
  for (const recording_checks::RecordingFinding& finding :
       recording_checks::find_pair_faults(recording_of(expected), recording_of(obtained))) {
    lines.push_back(
        fmt::format("{}: {}: {}", obtained.source, to_string(finding.fault), recording_checks::finding_line(finding)));
  }
  return lines;
}

std::string ComparedFiles::text() const {
  std::string text = to_table(comparison);
  if (!floor) return text;
  const GroupResult* const force = comparison.find("force");
  return text + fmt::format("repeat floor: {}{}\n", floor->text(),
                            force == nullptr ? ""
                                             : fmt::format("; the force error of {:.3g} N is {}", force->rms,
                                                           floor->verdict(force->rms)));
}

std::string ComparedFiles::json() const {
  nlohmann::json document = to_json(comparison);
  if (floor) {
    document["repeat_floor"] = {{"force_N", floor->force_N},
                                {"position_m", floor->position_m},
                                {"shift_s", floor->shift_s},
                                {"unshifted_N", floor->unshifted_N},
                                {"steadiest_N", floor->steadiest_N},
                                {"least_steady_N", floor->least_steady_N},
                                {"within", within_floor}};
  }
  return document.dump(2) + "\n";
}

double ComparedFiles::metric(const std::string& name) const {
  const auto metrics = metrics_of(comparison);
  const auto found = std::find_if(metrics.begin(), metrics.end(), [&](const auto& m) { return m.first == name; });
  if (found != metrics.end()) return found->second;
  std::string known;
  for (const auto& [one, value] : metrics) known += ' ' + one;
  throw BadData(fmt::format("this comparison has no metric '{}'; it has:{}\n{}", name, known, to_table(comparison)));
}

}  // namespace touchstone::golden
