#include "submission.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "harness/base/error.h"
#include "harness/base/hash.h"
#include "harness/base/json_reader.h"
#include "harness/base/json_values.h"
#include "harness/base/version.h"
#include "harness/report/metric_json.h"

namespace touchstone::board {
namespace {

using nlohmann::json;

constexpr const char* submission_schema = "touchstone-submission/1";

json score_or_null(double value) { return std::isfinite(value) ? json(value) : json(); }

json entries_json(const pipeline::Board& board) {
  json out = json::array();
  for (const pipeline::Task& task : board.tasks) {
    for (const pipeline::Entry& entry : task.entries) {
      const pipeline::Scores& s = entry.scores;
      json one{{"task", task.name}, {"renderer", entry.renderer}, {"state", state_name(entry.state)}};
      if (entry.state == pipeline::EntryState::ran) {
        one["input_hash"] = entry.input.hash;
        one["rms_force_error_N"] = score_or_null(s.rms_force_error_N);
        one["rms_force_error_jnd"] = score_or_null(s.rms_force_error_jnd);
        one["rms_position_error_m"] = score_or_null(s.rms_position_error_m);
        one["mean_operations"] = score_or_null(s.mean_operations);
        one["max_operations"] = score_or_null(s.max_operations);
      }
      out.push_back(std::move(one));
    }
  }
  return out;
}

json files_json(const std::vector<std::filesystem::path>& files) {
  json out = json::array();
  for (const auto& file : files) out.push_back({{"name", file.filename().string()}, {"sha256", sha256_file(file)}});
  return out;
}

// Throws BadData unless each of the objects of `key` has the texts by which it is found again.
void expect_named(JsonObject& in, const char* key, const std::vector<const char*>& names) {
  for (JsonObject& one : in.objects(key)) {
    for (const char* const name : names) static_cast<void>(one.text(name));
  }
}

// Everything but the hash itself; json sorts its keys, so that the text is canonical.
std::string hash_of_contents(json document) {
  document.erase("sha256");
  return sha256(document.dump());
}

// Recordings, meshes and models that the two plans do not share, by task and renderer.
void compare_specifications(const std::string& claimed, const std::string& here, std::vector<std::string>& lines) {
  if (claimed == here) return;
  const auto cells = [](const std::string& text) {
    std::map<std::string, json> out;
    const json document = json::parse(text);
    for (const json& cell : document.at("cells"))
      out[fmt::format("{} on {}", cell.value("name", "floor"), cell.at("task").get<std::string>())] = cell;
    return out;
  };
  const auto before = cells(claimed);
  const auto now = cells(here);
  for (const auto& [name, cell] : before) {
    const auto found = now.find(name);
    if (found == now.end()) {
      lines.push_back(name + ": was not run here");
      continue;
    }
    for (const auto& [key, value] : cell.items()) {
      if (found->second.value(key, json()) != value)
        lines.push_back(fmt::format("{}: another {} than in the submission", name, key));
    }
  }
  for (const auto& [name, cell] : now) {
    if (!before.contains(name)) lines.push_back(name + ": is not in the submission");
  }
}

// A submission is one file: what a model names outside of it would not come along.
std::string text_of(const rendering::Model& model, const std::filesystem::path& file) {
  for (const rendering::NamedParameters& effect : model.effects) {
    if (!effect.image.empty()) {
      throw UsageError(fmt::format("{}: {}: a submission holds no pictures, and {} needs {}; leave this model out",
                                   file.string(), effect.place, effect.name, effect.image.string()));
    }
  }
  return model_to_json(model);
}

}  // namespace

std::string submission_to_json(const BoardPlan& plan, const pipeline::Board& board,
                               const std::vector<std::filesystem::path>& plugins,
                               const std::vector<std::filesystem::path>& sources) {
  const BoardRequest& request = plan.request;
  json models = json::array();
  for (const auto& [model, file] : request.models)
    models.push_back({{"name", file.stem().string()}, {"model", text_of(model, file)}});
  json document{{"schema", submission_schema},
                {"in_trajectory", request.in_trajectory_chosen ? in_trajectory_name(request.base.in_trajectory) : ""},
                {"tip", request.tip == BoardTip::point ? "point" : "dataset"},
                {"fit", request.fit},
                {"fit_range", request.fit_range.text()},
                {"score_range", request.base.time_ranges.text()},
                {"models", std::move(models)},
                {"specification", plan.specification},
                {"plugins", files_json(plugins)},
                {"sources", files_json(sources)},
                {"provenance", provenance_to_json(report::make_provenance(request.base.command_line))},
                {"entries", entries_json(board)}};
  document["sha256"] = hash_of_contents(document);
  return document.dump(1) + "\n";
}

Submission load_submission(const std::filesystem::path& file, const plugin::Plugins& plugins) {
  const json document = load_json(file);
  JsonObject in(document, file.string(), "");
  in.schema(submission_schema);
  if (in.text("sha256") != hash_of_contents(document)) {
    in.fail_at("sha256", "is not the hash of what the file holds: it was changed after it was made");
  }
  Submission out;
  const std::string mode = in.text("in_trajectory");
  out.in_trajectory_chosen = !mode.empty();
  const auto chosen = recording::find_in_trajectory(mode);
  if (out.in_trajectory_chosen && !chosen) in.fail_at("in_trajectory", fmt::format("'{}' is unknown", mode));
  out.in_trajectory = chosen.value_or(recording::InTrajectoryMode::synthesize);
  const std::string tip = in.text("tip");
  if (tip != "dataset" && tip != "point") in.fail_at("tip", fmt::format("dataset or point was expected, got {}", tip));
  out.tip = tip == "dataset" ? BoardTip::dataset : BoardTip::point;
  out.fit = texts_of(in, "fit");
  out.fit_range = in.text("fit_range");
  out.score_range = in.text("score_range");
  for (JsonObject& one : in.objects("models")) {
    const std::string name = one.text("name");
    rendering::Model model = rendering::parse_model(one.text("model"), name);
    plugins.provide(model);
    out.models.emplace_back(std::move(model), name + ".json");
  }
  out.specification = in.text("specification");
  const std::string place = file.string() + ": /specification";
  const json specification = parse_json(out.specification, place);
  JsonObject specified(specification, place, "");
  expect_named(specified, "cells", {"task"});
  for (JsonObject& one : in.objects("plugins"))
    out.plugins.push_back({"plug-in", one.text("name"), one.text("sha256"), 0});
  if (in.has("sources")) {  // a submission of before has none
    for (JsonObject& one : in.objects("sources"))
      out.sources.push_back({"source", one.text("name"), one.text("sha256"), 0});
  }
  expect_named(in, "entries", {"task", "renderer"});
  out.entries = in.raw("entries").dump();
  return out;
}

std::vector<std::string> files_not_as_claimed(const Submission& claimed,
                                              const std::vector<std::filesystem::path>& plugins,
                                              const std::vector<std::filesystem::path>& sources) {
  std::vector<std::string> lines;
  const auto compare = [&](const std::vector<report::InputFile>& wanted, const std::vector<std::filesystem::path>& here,
                           const char* what) {
    for (const report::InputFile& one : wanted) {
      if (std::ranges::none_of(here, [&](const auto& file) { return sha256_file(file) == one.sha256; }))
        lines.push_back(fmt::format("{} {} ({}) is not among the files here", what, one.name, one.sha256));
    }
  };
  compare(claimed.plugins, plugins, "the plug-in");
  compare(claimed.sources, sources, "the source");
  return lines;
}

std::vector<std::string> differences(const Submission& claimed, const BoardPlan& plan, const pipeline::Board& board) {
  std::vector<std::string> lines;
  compare_specifications(claimed.specification, plan.specification, lines);
  const json now = entries_json(board);
  for (const json& one : json::parse(claimed.entries)) {
    const auto found = std::ranges::find_if(now, [&](const json& other) {
      return other.at("task") == one.at("task") && other.at("renderer") == one.at("renderer");
    });
    if (found == now.end()) continue;  // said above
    for (const auto& [key, value] : one.items()) {
      const json here = found->value(key, json());
      if (here == value) continue;
      lines.push_back(fmt::format("{} on {}: {} is {} in the submission and {} here",
                                  one.at("renderer").get<std::string>(), one.at("task").get<std::string>(), key,
                                  value.dump(), here.dump()));
    }
  }
  return lines;
}

}  // namespace touchstone::board
