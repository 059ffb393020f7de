#include "harness/pipeline/evaluation/campaign.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "harness/base/atomic_file.h"
#include "harness/base/bundled_files.h"
#include "harness/base/error.h"
#include "harness/pipeline/board_site.h"
#include "harness/pipeline/evaluation/input_floor.h"
#include "harness/pipeline/evaluation/inputs.h"
#include "harness/pipeline/evaluation/run.h"
#include "harness/pipeline/verdict.h"
#include "harness/rendering/renderer_failed.h"
#include "harness/report/console.h"
#include "harness/report/metric_json.h"
#include "harness/report/provenance.h"
#include "harness/report/quantity.h"

namespace touchstone::pipeline {
using metrics::MetricResult;
using metrics::MetricStatus;
using recording::Dataset;
using rendering::Catalogue;
using rendering::Model;
using rendering::RendererEntry;

namespace {

bool has_parameter(const RendererEntry& entry, std::string_view name) {
  return std::ranges::any_of(entry.parameters, [name](const auto& parameter) { return parameter.name == name; });
}

// The renderer with the data set's stiffness and friction where it has such parameters.
Model default_model(const RendererEntry& entry, const Dataset& dataset, const std::string& origin) {
  Model model;
  model.renderer = entry.name;
  model.source = origin + entry.name;
  if (has_parameter(entry, "stiffness_N_per_m") && dataset.stiffness_N_per_m > 0.0)
    model.parameters["stiffness_N_per_m"] = dataset.stiffness_N_per_m;
  if (entry.needs_friction && dataset.friction_coefficient)
    model.parameters["mu_static"] = model.parameters["mu_dynamic"] = *dataset.friction_coefficient;
  return model;
}

std::vector<Model> default_models(const Catalogue& catalogue, const Dataset& dataset, const plugin::Plugins& plugins) {
  std::vector<Model> models;
  for (const RendererEntry& entry : catalogue.renderers()) {
    if (entry.needs_friction && !(dataset.friction_coefficient.value_or(0.0) > 0.0)) {
      fmt::print(stderr,
                 "{}: {} is left out: without friction it is the god-object, and the data set declares no "
                 "friction_coefficient\n",
                 dataset.folder.string(), entry.name);
      continue;
    }
    models.push_back(default_model(entry, dataset, "the catalogue's "));
  }
  for (const auto& entry : plugins.entries()) {
    models.push_back(default_model(*entry, dataset, "the plug-in's "));
    models.back().provided = entry;
  }
  return models;
}

// A file name without anything that a file system or a reader might mind.
std::string folder_name(std::string text) {
  for (char& c : text) {
    const bool plain =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
    if (!plain) c = '-';
  }
  return text.empty() ? "-" : text;
}

std::vector<std::filesystem::path> datasets_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> found;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (std::filesystem::exists(entry.path() / "dataset.json", error)) found.push_back(entry.path());
  }
  std::ranges::sort(found);
  return found;
}

}  // namespace

std::vector<std::filesystem::path> bundled_datasets() {
  if (const auto folder = find_bundled("datasets")) {
    if (auto found = datasets_in(*folder); !found.empty()) return found;
  }
  throw BadData(
      "the bundled data sets were not found beside the program; name one with --dataset, or give --recording, --mesh "
      "and --model");
}

namespace {

// A tip that a recording is evaluated with.
struct TipOfPlan {
  std::optional<double> radius_m;
  double probe_radius_m = 0.0;  // of the ball that a point stands for
  std::string words;            // for the group's name; empty where there is no choice
  std::string folder;           // added to the recording's
};

std::vector<TipOfPlan> tips_of_plan(const Catalogue& catalogue, const Dataset& dataset,
                                    const std::vector<ModelOfFile>& models, const EvaluationRequest& base) {
  const double ball_m = dataset.tip_radius_m;
  if (base.tip_radius_m) {
    const bool point = *base.tip_radius_m == 0.0 && ball_m > 0.0;
    return {{base.tip_radius_m, point ? ball_m : 0.0, point ? ", point of contact" : "", ""}};
  }
  const auto enters = [&](const ModelOfFile& model) { return can_have_tip(catalogue, model.first, ball_m); };
  if (std::ranges::all_of(models, enters)) return {{ball_m, 0.0, "", ""}};
  return {{ball_m, 0.0, fmt::format(", ball of {}", report::display_setting(ball_m, "m")), ""},
          {0.0, ball_m, ", point of contact", "-point"}};
}

}  // namespace

std::vector<PlannedEvaluation> plan_dataset(const Catalogue& catalogue, const std::filesystem::path& place,
                                            const std::vector<ModelOfFile>& given, const plugin::Plugins& plugins,
                                            const EvaluationRequest& base, bool in_trajectory_chosen) {
  const Dataset dataset = recording::load_dataset(place);
  std::vector<ModelOfFile> models = given;
  if (models.empty()) {
    for (Model& model : default_models(catalogue, dataset, plugins)) models.emplace_back(std::move(model), "");
  }
  const std::string name = std::filesystem::weakly_canonical(dataset.folder).filename().string();
  std::vector<PlannedEvaluation> plan;
  const auto add = [&](const recording::DatasetRecording& recording, const TipOfPlan& tip,
                       const ModelOfFile& given_model) {
    const auto& [model, file] = given_model;
    PlannedEvaluation one{base, {}, {}, {}, {}, {}};
    one.request.recording = dataset.path_of(recording.file);
    if (!recording.repeat.empty()) one.request.repeat = dataset.path_of(recording.repeat);
    one.request.mesh = dataset.path_of(dataset.mesh_file);
    one.request.mesh_unit = dataset.mesh_unit;
    one.request.model = model;
    one.request.model_file = file;
    if (!in_trajectory_chosen) one.request.in_trajectory = dataset.in_trajectory;
    one.request.tip_radius_m = tip.radius_m;
    one.request.probe_radius_m = tip.probe_radius_m;
    if (!one.request.stiffness_N_per_m && dataset.stiffness_N_per_m > 0.0) {
      one.request.stiffness_N_per_m = dataset.stiffness_N_per_m;
    }
    const std::string stem = std::filesystem::path(recording.file).stem().string();
    one.column = file.empty() ? model.renderer : file.stem().string();
    one.group = fmt::format("{} / {}{}", name, stem, tip.words);
    one.about = fmt::format("{}; {}", dataset.object, recording.shows);
    one.floor =
        FloorBasis{dataset.instrument_file.empty() ? std::filesystem::path() : dataset.path_of(dataset.instrument_file),
                   dataset.friction_coefficient};
    one.request.title = fmt::format("{} on {} ({})", one.column, dataset.object, recording.shows);
    one.folder = std::filesystem::path(folder_name(name)) / (folder_name(stem) + tip.folder) / folder_name(one.column);
    plan.push_back(std::move(one));
  };
  for (const recording::DatasetRecording& recording : dataset.recordings) {
    for (const TipOfPlan& tip : tips_of_plan(catalogue, dataset, models, base)) {
      for (const ModelOfFile& model : models) add(recording, tip, model);
    }
  }
  return plan;
}

std::vector<PlannedEvaluation> plan_recording(const EvaluationRequest& base, const std::vector<ModelOfFile>& models) {
  std::vector<PlannedEvaluation> out;
  for (const auto& [model, file] : models) {
    PlannedEvaluation one{base, base.recording.string(), file.stem().string(),
                          models.size() == 1 ? std::filesystem::path() : file.stem(), ""};
    one.request.model = model;
    one.request.model_file = file;
    const auto same = [&](const PlannedEvaluation& other) { return other.folder == one.folder; };
    if (std::ranges::any_of(out, same)) {
      throw UsageError(fmt::format("two models are named {}; their reports would share a folder", one.folder.string()));
    }
    out.push_back(std::move(one));
  }
  return out;
}

Evaluated evaluate_planned(const Catalogue& catalogue, const PlannedEvaluation& planned,
                           const std::filesystem::path& folder) {
  Evaluated done{"", planned.group, planned.column, folder, {}, {}, "", planned.about, {}, {}};
  try {
    pipeline::ErrorBinner binner;
    const ErrorSink errors = [&](const metrics::MetricSample& sample) {
      binner.add(sample.t_s, (sample.f_rendered_W_N - sample.f_measured_W_N).squaredNorm());
    };
    report::EvaluationResult result =
        folder.empty() ? run_evaluation(catalogue, planned.request, load_inputs(catalogue, planned.request), "", errors)
                       : evaluate_into(catalogue, planned.request, folder, errors);
    done.metrics = std::move(result.metrics);
    done.messages = std::move(result.messages);
    done.input = std::move(result.input);
    const auto error = std::ranges::find(done.metrics, "rms_force_error", &MetricResult::name);
    if (error != done.metrics.end() && error->status == MetricStatus::ok) done.errors = binner.errors();
  } catch (const rendering::RendererFailed& error) {
    done.failure = error.what();
    done.messages = {error.what()};
  } catch (const TipNotRepresentable& error) {
    done.does_not_enter = error.what();
  }
  for (MetricResult& metric : done.metrics) metric.series.reset(), metric.histogram.reset();
  return done;
}

std::vector<Evaluated> run_plan(const Catalogue& catalogue, const std::vector<PlannedEvaluation>& plan,
                                const std::filesystem::path& out) {
  std::vector<Evaluated> done;
  std::size_t begin = 0;  // of the group
  for (const PlannedEvaluation& one : plan) {
    if (begin < done.size() && done[begin].group != one.group) {
      fmt::print(stderr, "{}", group_messages(std::span(done).subspan(begin)));
      begin = done.size();
    }
    done.push_back(evaluate_planned(catalogue, one, out / one.folder));
  }
  fmt::print(stderr, "{}", group_messages(std::span(done).subspan(begin)));
  return done;
}

std::string group_messages(std::span<const Evaluated> group) {
  std::vector<std::pair<std::string, std::vector<std::string>>> said;  // in order, with who says it
  for (const Evaluated& one : group) {
    for (const std::string& message : one.messages) {
      const auto same = std::ranges::find(said, message, [](const auto& each) { return each.first; });
      (same == said.end() ? said.emplace_back(message, std::vector<std::string>{}) : *same)
          .second.push_back(one.column);
    }
  }
  std::string lines;
  for (const auto& [message, columns] : said) {
    const std::string name = group.front().group.substr(0, group.front().group.find(": "));
    if (message.starts_with(name + ": ")) {  // a reader's, which names its file
      lines += message + "\n";
      continue;
    }
    lines += columns.size() == group.size() ? fmt::format("{}: {}\n", name, message)
                                            : fmt::format("{}, {}: {}\n", name, fmt::join(columns, ", "), message);
  }
  return lines;
}

namespace {

double metric_or_nan(const std::vector<MetricResult>& metrics, std::string_view name) {
  const auto found = std::ranges::find(metrics, name, &MetricResult::name);
  return found == metrics.end() || found->status != MetricStatus::ok ? std::nan("") : found->value;
}

// A group's evaluations with the same input; those that did not run belong to the first.
struct SameInput {
  const std::string* hash = nullptr;  // null: none of them ran
  std::vector<const Evaluated*> evaluated;
};

std::vector<SameInput> by_input(std::span<const Evaluated> group) {
  std::vector<SameInput> out;
  for (const Evaluated& one : group) {
    if (one.input.hash.empty()) continue;
    const auto same = std::ranges::find_if(out, [&](const SameInput& own) { return *own.hash == one.input.hash; });
    SameInput& own = same == out.end() ? out.emplace_back(SameInput{&one.input.hash, {}}) : *same;
    own.evaluated.push_back(&one);
  }
  if (out.empty()) out.emplace_back();
  for (const Evaluated& one : group) {
    if (one.input.hash.empty()) out.front().evaluated.push_back(&one);
  }
  return out;
}

// Groups lie one behind the other.
std::vector<std::span<const Evaluated>> groups_of(const std::vector<Evaluated>& evaluated) {
  std::vector<std::span<const Evaluated>> out;
  for (std::size_t begin = 0, end = 0; begin < evaluated.size(); begin = end) {
    while (end < evaluated.size() && evaluated[end].group == evaluated[begin].group) ++end;
    out.push_back(std::span(evaluated).subspan(begin, end - begin));
  }
  return out;
}

std::string name_of_task(std::span<const Evaluated> group, const SameInput& own, std::size_t inputs) {
  const std::string& name = group.front().group;
  if (inputs < 2 || own.evaluated.empty()) return name;
  std::vector<std::string> columns;
  for (const Evaluated* const one : own.evaluated) columns.push_back(one->column);
  return fmt::format("{} (input of {})", name, fmt::join(columns, ", "));
}

}  // namespace

pipeline::Entry entry_of(const Evaluated& one, const std::filesystem::path& out) {
  pipeline::Entry entry;
  entry.renderer = one.column;
  if (!one.failure.empty()) {
    entry.state = pipeline::EntryState::failed;
    entry.why = one.failure;
    return entry;
  }
  if (!one.does_not_enter.empty()) {
    entry.state = pipeline::EntryState::does_not_enter;
    entry.why = one.does_not_enter;
    return entry;
  }
  entry.input = one.input;
  const auto value = [&](std::string_view name) { return metric_or_nan(one.metrics, name); };
  entry.scores = {value("rms_force_error"), value("rms_force_error_jnd"), value("rms_position_error"),
                  value("mean_operations"), value("max_operations"),      value("median_step_cost"),
                  value("p99_step_cost")};
  entry.errors = one.errors;
  entry.report = (one.folder / "report.html").lexically_relative(out).string();
  return entry;
}

pipeline::Board board_of(const std::vector<Evaluated>& evaluated, const std::filesystem::path& out) {
  pipeline::Board board;
  for (const auto& group : groups_of(evaluated)) {
    const std::vector<SameInput> inputs = by_input(group);
    for (const SameInput& own : inputs) {
      pipeline::Task task;
      task.name = name_of_task(group, own, inputs.size());
      task.about = group.front().about;
      for (const Evaluated* const one : own.evaluated) {
        task.entries.push_back(entry_of(*one, out));
        if (!one->input.hash.empty()) task.input = input_text(one->input);
        const auto error = std::ranges::find(one->metrics, "rms_force_error", &MetricResult::name);
        if (error != one->metrics.end() && error->reference) task.measured_rms_N = *error->reference;
        const auto floor = std::ranges::find(one->metrics, "repeat_floor_force", &MetricResult::name);
        if (floor != one->metrics.end()) {
          task.floor = pipeline::Floor{floor->value, floor->value, floor->value, "a repeat of the recording"};
        }
      }
      board.tasks.push_back(std::move(task));
    }
  }
  return board;
}

pipeline::Floor floor_of_plan(const Catalogue& catalogue, const std::string& law, EvaluationRequest request,
                              const FloorBasis& basis) {
  constexpr std::uint64_t seed = 1;
  request.model = Model{};
  request.model.renderer = law;  // only the tip and the stiffness are read of it
  request.model.parameters = {{"stiffness_N_per_m", request.stiffness_N_per_m.value_or(1.0)}};
  return floor_of(catalogue, floor_world(catalogue, request, basis.instrument, basis.friction), request.time_ranges,
                  seed);
}

void add_floors(const Catalogue& catalogue, const std::string& law, const std::vector<PlannedEvaluation>& plan,
                pipeline::Board& board) {
  for (pipeline::Task& task : board.tasks) {
    const auto own = std::ranges::find(plan, task.name, &PlannedEvaluation::group);
    if (task.floor || own == plan.end() || !own->floor) continue;
    try {
      task.floor = floor_of_plan(catalogue, law, own->request, *own->floor);
    } catch (const BadData& error) {  // no forces, no sample in the range, an instrument that cannot be read
      fmt::print(stderr, "note: {}: no floor: {}\n", task.name, error.what());
    }
  }
}

std::string summary_table(const std::vector<Evaluated>& evaluated) {
  std::string out;
  for (const auto& group : groups_of(evaluated)) {
    const std::vector<SameInput> inputs = by_input(group);
    for (const SameInput& own : inputs) {
      std::vector<std::pair<std::string, const std::vector<MetricResult>*>> columns;
      std::string lines;
      for (const Evaluated* const one : own.evaluated) {
        if (!one->failure.empty()) {
          lines += fmt::format("FAILED: {}: {}\n", one->column, one->failure);
        } else if (!one->does_not_enter.empty()) {
          lines += fmt::format("does not enter: {}: {}\n", one->column, one->does_not_enter);
        } else {
          columns.emplace_back(one->column, &one->metrics);
          lines += fmt::format("report: {}\n", (one->folder / "report.html").string());
        }
      }
      out += fmt::format("{}\n", name_of_task(group, own, inputs.size()));
      if (!own.evaluated.empty() && own.hash != nullptr)
        out += fmt::format("input: {}\n", input_text(own.evaluated.front()->input));
      out += fmt::format("\n{}\n{}\n", report::console_table(columns), lines);
    }
    if (inputs.size() > 1) out += "Different inputs are not compared: each has a table of its own.\n\n";
  }
  return out;
}

std::string write_overview(const Catalogue& catalogue, const std::vector<PlannedEvaluation>& plan,
                           const std::vector<Evaluated>& evaluated, const std::vector<std::string>& command_line,
                           const std::filesystem::path& out) {
  constexpr std::size_t few = 2;  // evaluations whose whole tables a terminal takes
  Board board = board_of(evaluated, out);
  board.title = evaluated.size() == 1 ? evaluated.front().column + " on " + evaluated.front().group
                                      : "Renderers held against recordings";
  add_floors(catalogue, "friction-cone", plan, board);
  rank_board(board, false);
  const std::string tables = summary_table(evaluated);
  write_file(out / "tables.txt", tables);
  write_file(out / "index.html",
             site_html(board, {report::make_provenance(command_line), {}, false, {{"tables", "tables.txt"}}}));
  std::string said;
  for (const Task& task : board.tasks) {
    said += fmt::format("{}\n{}\n\n", task.name, wrapped(verdict(task), terminal_width()));
    if (evaluated.size() > few) said += short_table(task) + "\n";
  }
  if (evaluated.size() <= few) said += tables;
  return said + fmt::format("every metric: {}\nall reports: {}\n", (out / "tables.txt").string(),
                            (out / "index.html").string());
}

bool is_invalid(const Evaluated& evaluated) {
  return !evaluated.failure.empty() || std::ranges::any_of(evaluated.metrics, [](const MetricResult& metric) {
    return metric.status == MetricStatus::invalid;
  });
}

std::string summary_json(const std::vector<Evaluated>& evaluated) {
  nlohmann::json list = nlohmann::json::array();
  for (const Evaluated& one : evaluated) {
    nlohmann::json metrics = nlohmann::json::array();
    for (const MetricResult& metric : one.metrics) metrics.push_back(report::metric_to_json(metric));
    list.push_back(
        {{"group", one.group}, {"name", one.column}, {"folder", one.folder.string()}, {"metrics", std::move(metrics)}});
    if (!one.failure.empty()) list.back()["failure"] = one.failure;
    if (!one.does_not_enter.empty()) list.back()["does_not_enter"] = one.does_not_enter;
    if (!one.input.hash.empty()) list.back()["input"] = input_to_json(one.input);
  }
  const nlohmann::json document{{"schema", "touchstone-evaluations/1"}, {"evaluations", std::move(list)}};
  return document.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace touchstone::pipeline
