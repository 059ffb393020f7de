#include "board_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "harness/base/error.h"
#include "harness/base/hash.h"
#include "harness/pipeline/board_json.h"
#include "harness/pipeline/evaluation/inputs.h"
#include "harness/pipeline/fitting/fit.h"
#include "harness/recording_checks/repeat_floor.h"
#include "harness/rendering/renderer_failed.h"

namespace touchstone::board {
using rendering::Catalogue;
using runs::CaseRow;
using runs::CaseValue;

namespace {

// Columns of a row, in the order of the table.
enum Column : std::size_t {
  task_column,
  renderer_column,
  state_column,
  why_column,
  input_column,
  fitted_column,
  errors_column,
  report_column,
  measured_column,
  first_score_column
};
constexpr std::size_t score_count = 5;  // error, felt, position, mean and largest operations
constexpr std::size_t floor_column = first_score_column + score_count;
constexpr std::size_t repeat_column = floor_column + 3;  // RMS, and in words
constexpr std::size_t times_column = repeat_column + 2;
constexpr const char* floor_state = "floor";

recording::InTrajectoryMode mode_of(const BoardRequest& request, const recording::Dataset& dataset) {
  if (request.in_trajectory_chosen) return request.base.in_trajectory;
  // The law of an object with friction closes equation 1 with the whole force (in_trajectory.h).
  const bool friction = dataset.friction_coefficient.value_or(0.0) > 0.0;
  return dataset.in_trajectory == recording::InTrajectoryMode::synthesize ? pipeline::usual_in_trajectory(friction)
                                                                          : dataset.in_trajectory;
}

void add_dataset(const Catalogue& catalogue, const std::filesystem::path& place, BoardPlan& plan) {
  const BoardRequest& request = plan.request;
  const recording::Dataset dataset = recording::load_dataset(place);
  pipeline::EvaluationRequest base = request.base;
  base.in_trajectory = mode_of(request, dataset);
  base.tip_radius_m = request.tip == BoardTip::point ? 0.0 : dataset.tip_radius_m;
  for (pipeline::PlannedEvaluation& one :
       plan_dataset(catalogue, place, request.models, *request.plugins, base, true)) {
    // A model of a submission has a name and no file; what counts of it stands in the specification.
    if (!std::filesystem::exists(one.request.model_file)) one.request.model_file.clear();
    const auto known = std::ranges::find(plan.tasks, one.group, &BoardTask::name);
    auto task = static_cast<std::size_t>(known - plan.tasks.begin());
    if (known == plan.tasks.end()) {
      BoardTask own{one.group,  one.about, dataset.licence, dataset.instrument, "", dataset.friction_coefficient,
                    one.request};
      if (!dataset.instrument_file.empty()) own.instrument = dataset.path_of(dataset.instrument_file);
      plan.tasks.push_back(std::move(own));
      plan.cells.push_back({task, std::nullopt});
    } else if (known->request.recording != one.request.recording) {
      throw UsageError(fmt::format("two data sets are named {}; give them other folders", one.group));
    }
    plan.cells.push_back({task, std::move(one)});
  }
}

std::string specification_of(const BoardPlan& plan) {
  nlohmann::ordered_json cells = nlohmann::ordered_json::array();
  std::map<std::filesystem::path, std::string> hashes;
  const auto hash = [&](const std::filesystem::path& file) -> const std::string& {
    std::string& known = hashes[file];
    if (known.empty()) known = sha256_file(file);
    return known;
  };
  for (const BoardCell& cell : plan.cells) {
    const BoardTask& task = plan.tasks[cell.task];
    nlohmann::ordered_json one{{"task", task.name},
                               {"recording", hash(task.request.recording)},
                               {"mesh", hash(task.request.mesh)},
                               {"in_trajectory", in_trajectory_name(task.request.in_trajectory)},
                               {"tip_radius_m", task.request.tip_radius_m.value_or(0.0)}};
    if (!task.request.repeat.empty()) one["repeat"] = hash(task.request.repeat);
    if (cell.evaluation) {
      one["name"] = cell.evaluation->column;
      one["model"] = model_to_json(cell.evaluation->request.model);
    }
    cells.push_back(std::move(one));
  }
  const BoardRequest& request = plan.request;
  return nlohmann::ordered_json{{"cells", std::move(cells)},
                                {"fit", request.fit},
                                {"fit_range", request.fit_range.text()},
                                {"score_range", request.base.time_ranges.text()},
                                {"contact_threshold_N", request.base.contact_threshold_N}}
      .dump();
}

// Those of `fit` that the renderer has.
std::vector<std::string> fitted_parameters(const Catalogue& catalogue, const rendering::Model& model,
                                           const std::vector<std::string>& fit) {
  std::vector<std::string> out;
  for (const std::string& text : fit) {
    const std::string name = text.substr(0, text.find('='));
    const bool known = std::ranges::any_of(
        catalogue.find(model).parameters, [&](const rendering::ParameterDeclaration& one) { return one.name == name; });
    if (known) out.push_back(text);
  }
  return out;
}

std::string fit_cell(const Catalogue& catalogue, const BoardRequest& request, pipeline::PlannedEvaluation& planned) {
  const std::vector<std::string> parameters = fitted_parameters(catalogue, planned.request.model, request.fit);
  if (parameters.empty()) return "";
  pipeline::FitRequest fit;
  fit.evaluation = planned.request;
  fit.evaluation.time_ranges = {};
  fit.parameters = parameters;
  fit.fit_range = request.fit_range;
  fit.score_range = request.base.time_ranges;
  const pipeline::FitResult result = run_fit(catalogue, fit);
  planned.request.model = result.model;
  planned.request.model.provided = fit.evaluation.model.provided;
  std::string words;
  for (const pipeline::Estimate& one : result.estimates)
    words += fmt::format("{}{} {:.4g}", words.empty() ? "" : ", ", one.parameter.name, one.value);
  return words;
}

CaseValue number_of(double value) { return std::isfinite(value) ? CaseValue(value) : CaseValue(); }

void run_floor(const Catalogue& catalogue, const std::string& law, const BoardTask& task, CaseRow& row) {
  row.values[state_column] = std::string(floor_state);
  const pipeline::Floor floor = floor_of_plan(catalogue, law, task.request, {task.instrument, task.friction});
  row.values[why_column] = floor.how;
  row.values[floor_column] = floor.rms_N;
  row.values[floor_column + 1] = floor.low95_N;
  row.values[floor_column + 2] = floor.high95_N;
  if (task.request.repeat.empty()) return;
  try {
    const recording_checks::RepeatFloor repeat =
        recording_checks::repeat_floor_of_files(task.request.recording, task.request.repeat);
    row.values[repeat_column] = repeat.force_N;
    row.values[repeat_column + 1] = repeat.text();
  } catch (const BadData& error) {  // the instrument's floor holds without it
    row.values[why_column] = fmt::format("{}; no repeat: {}", floor.how, error.what());
  }
}

void run_cell(const Catalogue& catalogue, const BoardPlan& plan, const BoardCell& cell, CaseRow& row) {
  row.values.assign(times_column + 2, {});
  const BoardTask& task = plan.tasks[cell.task];
  row.values[task_column] = task.name;
  if (!cell.evaluation) {
    run_floor(catalogue, plan.request.floor_law, task, row);
    return;
  }
  pipeline::PlannedEvaluation planned = *cell.evaluation;
  row.values[renderer_column] = planned.column;
  pipeline::Evaluated done;
  std::string fitted;
  try {
    fitted = fit_cell(catalogue, plan.request, planned);
    done = pipeline::evaluate_planned(catalogue, planned,
                                      plan.request.reports ? plan.request.out / "reports" / planned.folder : "");
  } catch (const pipeline::TipNotRepresentable& error) {
    done.does_not_enter = error.what();
  } catch (const rendering::RendererFailed& error) {
    done.failure = error.what();
  } catch (const BadData& error) {  // it cannot take this object
    done.does_not_enter = error.what();
  }
  done.column = planned.column;
  const pipeline::Entry entry = pipeline::entry_of(done, plan.request.out);
  row.values[state_column] = std::string(state_name(entry.state));
  row.values[why_column] = entry.why;
  if (entry.state != pipeline::EntryState::ran) return;
  row.values[input_column] = input_to_json(entry.input).dump();
  row.values[fitted_column] = fitted;
  row.values[errors_column] = pipeline::errors_to_text(entry.errors);
  row.values[report_column] = plan.request.reports ? entry.report : std::string();
  const auto error = std::ranges::find(done.metrics, "rms_force_error", &metrics::MetricResult::name);
  if (error != done.metrics.end() && error->reference) row.values[measured_column] = number_of(*error->reference);
  const pipeline::Scores& s = entry.scores;
  std::size_t at = first_score_column;
  for (const double value :
       {s.rms_force_error_N, s.rms_force_error_jnd, s.rms_position_error_m, s.mean_operations, s.max_operations})
    row.values[at++] = number_of(value);
  row.values[times_column] = number_of(s.median_us);
  row.values[times_column + 1] = number_of(s.p99_us);
}

pipeline::Entry entry_of_row(const CaseRow& row) {
  pipeline::Entry entry;
  entry.renderer = runs::as_text(row.values[renderer_column]);
  const std::string source = fmt::format("row {}", row.number);
  if (!row.error.empty()) {
    entry.state = pipeline::EntryState::failed;
    entry.why = row.error;
    return entry;
  }
  const std::string state = runs::as_text(row.values[state_column]);
  if (state != state_name(pipeline::EntryState::ran)) {
    entry.state = state == state_name(pipeline::EntryState::failed) ? pipeline::EntryState::failed
                                                                    : pipeline::EntryState::does_not_enter;
    entry.why = runs::as_text(row.values[why_column]);
    return entry;
  }
  const nlohmann::json input = parse_json(runs::as_text(row.values[input_column]), source);
  entry.input = report::input_from_json(JsonObject(input, source, ""));
  entry.fitted = runs::as_text(row.values[fitted_column]);
  entry.errors = pipeline::errors_from_text(runs::as_text(row.values[errors_column]), source);
  entry.report = runs::as_text(row.values[report_column]);
  const auto number = [&](std::size_t column) { return runs::as_number(row.values[column]); };
  entry.scores = {number(first_score_column),     number(first_score_column + 1), number(first_score_column + 2),
                  number(first_score_column + 3), number(first_score_column + 4), number(times_column),
                  number(times_column + 1)};
  return entry;
}

}  // namespace

BoardPlan plan_board(const Catalogue& catalogue, const BoardRequest& request) {
  BoardPlan plan;
  plan.request = request;
  for (const auto& place : request.datasets) add_dataset(catalogue, place, plan);
  plan.specification = specification_of(plan);
  return plan;
}

runs::CaseTable board_table(const BoardPlan& plan) {
  using enum runs::CaseColumn::Type;
  runs::CaseTable table{plan.specification, plan.cells.size(), {}, "leaderboard", "--cases"};
  for (const char* const name : {"task", "renderer", "state", "why", "input", "fitted", "errors", "report"})
    table.columns.push_back({name, text});
  for (const char* const name :
       {"measured_rms_N", "rms_force_error_N", "rms_force_error_jnd", "rms_position_error_m", "mean_operations",
        "max_operations", "floor_N", "floor_low95_N", "floor_high95_N", "repeat_N"})
    table.columns.push_back({name, real});
  table.columns.push_back({"repeat", text});
  for (const char* const name : {"median_us", "p99_us"}) table.columns.push_back({name, real, true});
  return table;
}

runs::CaseJob board_job(const Catalogue& catalogue, const BoardPlan& plan) {
  runs::CaseJob job;
  job.what = "leaderboard";
  job.cases = plan.cells.size();
  job.alone = true;
  job.run = [&catalogue, &plan](CaseRow& row, const runs::PartDone&) {
    run_cell(catalogue, plan, plan.cells[row.number], row);
  };
  return job;
}

pipeline::Board board_of_rows(const BoardPlan& plan, const runs::CaseStore& store) {
  pipeline::Board board;
  for (const BoardTask& own : plan.tasks) {
    pipeline::Task task;
    task.name = own.name;
    task.about = own.about;
    task.licence = own.licence;
    task.measured = own.measured;
    board.tasks.push_back(std::move(task));
  }
  for (const CaseRow& row : store.rows(0, plan.cells.size())) {
    const BoardCell& cell = plan.cells[row.number];
    pipeline::Task& task = board.tasks[cell.task];
    if (!cell.evaluation) {
      if (row.error.empty()) {
        task.floor =
            pipeline::Floor{runs::as_number(row.values[floor_column]), runs::as_number(row.values[floor_column + 1]),
                            runs::as_number(row.values[floor_column + 2]), runs::as_text(row.values[why_column])};
        if (!std::holds_alternative<std::monostate>(row.values[repeat_column]))
          task.repeat = pipeline::RepeatOfTask{runs::as_number(row.values[repeat_column]),
                                               runs::as_text(row.values[repeat_column + 1])};
      }
      continue;
    }
    task.entries.push_back(entry_of_row(row));
    const pipeline::Entry& entry = task.entries.back();
    if (entry.state != pipeline::EntryState::ran) continue;
    task.input = input_text(entry.input);
    const double measured = runs::as_number(row.values[measured_column]);
    if (std::isfinite(measured)) task.measured_rms_N = measured;
  }
  return board;
}

}  // namespace touchstone::board
