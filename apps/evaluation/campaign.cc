#include "apps/evaluation/campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/evaluation/run.h"
#include "harness/base/bundled_files.h"
#include "harness/base/error.h"
#include "harness/rendering/renderer_failed.h"
#include "harness/report/console.h"
#include "harness/report/metric_json.h"
#include "renderers/catalogue.h"

namespace touchstone {
namespace {

bool has_parameter(const RendererEntry& entry, std::string_view name) {
  return std::ranges::any_of(entry.parameters, [name](const auto& parameter) { return parameter.name == name; });
}

// A renderer that is nothing but its friction: at its default coefficient of 0 it is the god-object once more. With the
// others friction is what their model says.
bool needs_friction(const RendererEntry& entry) { return entry.name == "friction-cone"; }

// The renderer with the data set's stiffness and friction where it has such parameters.
Model default_model(const RendererEntry& entry, const Dataset& dataset, const std::string& origin) {
  Model model;
  model.renderer = entry.name;
  model.source = origin + entry.name;
  if (has_parameter(entry, "stiffness_N_per_m") && dataset.stiffness_N_per_m > 0.0)
    model.parameters["stiffness_N_per_m"] = dataset.stiffness_N_per_m;
  if (needs_friction(entry) && dataset.friction_coefficient)
    model.parameters["mu_static"] = model.parameters["mu_dynamic"] = *dataset.friction_coefficient;
  return model;
}

std::vector<Model> default_models(const Dataset& dataset, const Plugins& plugins) {
  std::vector<Model> models;
  for (const RendererEntry& entry : renderer_catalogue()) {
    if (needs_friction(entry) && !(dataset.friction_coefficient.value_or(0.0) > 0.0)) {
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

std::vector<PlannedEvaluation> plan_dataset(const std::filesystem::path& place, const std::vector<ModelOfFile>& given,
                                            const Plugins& plugins, const EvaluationRequest& base,
                                            bool in_trajectory_chosen) {
  const Dataset dataset = load_dataset(place);
  std::vector<ModelOfFile> models = given;
  if (models.empty()) {
    for (Model& model : default_models(dataset, plugins)) models.emplace_back(std::move(model), "");
  }
  const std::string name = std::filesystem::weakly_canonical(dataset.folder).filename().string();
  std::vector<PlannedEvaluation> plan;
  for (const DatasetRecording& recording : dataset.recordings) {
    for (const auto& [model, file] : models) {
      PlannedEvaluation one{base, {}, {}, {}};
      one.request.recording = dataset.path_of(recording.file);
      one.request.mesh = dataset.path_of(dataset.mesh_file);
      one.request.mesh_unit = dataset.mesh_unit;
      one.request.model = model;
      one.request.model_file = file;
      if (!in_trajectory_chosen) one.request.in_trajectory = dataset.in_trajectory;
      if (!one.request.tip_radius_m) one.request.tip_radius_m = dataset.tip_radius_m;
      if (!one.request.stiffness_N_per_m && dataset.stiffness_N_per_m > 0.0) {
        one.request.stiffness_N_per_m = dataset.stiffness_N_per_m;
      }
      const std::string stem = std::filesystem::path(recording.file).stem().string();
      one.column = file.empty() ? model.renderer : file.stem().string();
      one.group = fmt::format("{} / {}: {}", name, stem, recording.shows);
      one.request.title = fmt::format("{} on {} ({})", one.column, dataset.object, recording.shows);
      one.folder = std::filesystem::path(folder_name(name)) / folder_name(stem) / folder_name(one.column);
      plan.push_back(std::move(one));
    }
  }
  return plan;
}

std::vector<Evaluated> run_plan(const std::vector<PlannedEvaluation>& plan, const std::filesystem::path& out) {
  std::vector<Evaluated> done;
  std::size_t begin = 0;  // of the group
  for (const PlannedEvaluation& one : plan) {
    if (begin < done.size() && done[begin].group != one.group) {
      fmt::print(stderr, "{}", group_messages(std::span(done).subspan(begin)));
      begin = done.size();
    }
    const std::filesystem::path folder = out / one.folder;
    try {
      EvaluationResult result = evaluate_into(one.request, folder);
      done.push_back({"", one.group, one.column, folder, std::move(result.metrics), std::move(result.messages)});
    } catch (const RendererFailed& error) {
      done.push_back({error.what(), one.group, one.column, folder, {}, {error.what()}});
    }
    for (MetricResult& metric : done.back().metrics) metric.series.reset(), metric.histogram.reset();
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

std::string summary_table(const std::vector<Evaluated>& evaluated) {
  std::string out;
  for (std::size_t begin = 0; begin < evaluated.size();) {
    std::vector<std::pair<std::string, const std::vector<MetricResult>*>> columns;
    std::size_t end = begin;
    for (; end < evaluated.size() && evaluated[end].group == evaluated[begin].group; ++end) {
      if (evaluated[end].failure.empty()) columns.emplace_back(evaluated[end].column, &evaluated[end].metrics);
    }
    out += fmt::format("{}\n\n{}\n", evaluated[begin].group, console_table(columns));
    for (std::size_t i = begin; i < end; ++i) {
      if (!evaluated[i].failure.empty()) {
        out += fmt::format("FAILED: {}: {}\n", evaluated[i].column, evaluated[i].failure);
        continue;
      }
      out += fmt::format("report: {}\n", (evaluated[i].folder / "report.html").string());
    }
    out += "\n";
    begin = end;
  }
  return out;
}

std::string summary_json(const std::vector<Evaluated>& evaluated) {
  nlohmann::json list = nlohmann::json::array();
  for (const Evaluated& one : evaluated) {
    nlohmann::json metrics = nlohmann::json::array();
    for (const MetricResult& metric : one.metrics) metrics.push_back(metric_to_json(metric));
    list.push_back(
        {{"group", one.group}, {"name", one.column}, {"folder", one.folder.string()}, {"metrics", std::move(metrics)}});
    if (!one.failure.empty()) list.back()["failure"] = one.failure;
  }
  const nlohmann::json document{{"schema", "touchstone-evaluations/1"}, {"evaluations", std::move(list)}};
  return document.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace touchstone
