#include "harness/pipeline/board_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/json_reader.h"
#include "harness/report/json_numbers.h"
#include "harness/report/quantity.h"

namespace touchstone::pipeline {
namespace {

constexpr double most_samples = 9007199254740992.0;  // 2^53: what a JSON number counts exactly

using nlohmann::ordered_json;

ordered_json number(double value) { return std::isfinite(value) ? ordered_json(value) : ordered_json(); }

ordered_json scores_json(const Scores& s) {
  return {{"rms_force_error_N", number(s.rms_force_error_N)},
          {"rms_force_error_jnd", number(s.rms_force_error_jnd)},
          {"rms_position_error_m", number(s.rms_position_error_m)},
          {"mean_operations", number(s.mean_operations)},
          {"max_operations", number(s.max_operations)}};
}

// `name_of` of a place in the ranking.
template <typename NameOf>
ordered_json ranking_json(const Ranking& ranking, const NameOf& name_of) {
  ordered_json order = ordered_json::array();
  for (const RankedRenderer& one : ranking.order) {
    order.push_back({{"renderer", name_of(one.renderer)},
                     {"rank", {one.best_rank, one.worst_rank}},
                     {"score_N", number(std::exp(one.log_score))},
                     {"interval95_N", {number(std::exp(one.low95)), number(std::exp(one.high95))}}});
  }
  ordered_json groups = ordered_json::array();
  for (const auto& group : ranking.groups) {
    ordered_json names = ordered_json::array();
    for (const std::size_t place : group) names.push_back(name_of(place));
    groups.push_back(std::move(names));
  }
  ordered_json pairs = ordered_json::array();
  for (const PairOfRenderers& pair : ranking.pairs) {
    pairs.push_back({{"better", name_of(pair.better)},
                     {"other", name_of(pair.other)},
                     {"error_ratio", number(std::exp(pair.log_ratio))},
                     {"interval95", {number(std::exp(pair.low95)), number(std::exp(pair.high95))}},
                     {"t", number(pair.t)},
                     {"degrees", number(pair.degrees)},
                     {"p", number(pair.p)},
                     {"level", number(pair.level)},
                     {"told_apart", pair.told_apart}});
  }
  return {{"order", std::move(order)},        {"groups", std::move(groups)},
          {"pairs", std::move(pairs)},        {"datasets_resampled", ranking.datasets_resampled},
          {"block_bins", ranking.block_bins}, {"why_not", ranking.why_not}};
}

ordered_json entry_json(const Entry& entry) {
  ordered_json out{{"renderer", entry.renderer}, {"state", state_name(entry.state)}};
  if (!entry.why.empty()) out["why"] = entry.why;
  if (entry.state != EntryState::ran) return out;
  out["input_hash"] = entry.input.hash;
  out["scores"] = scores_json(entry.scores);
  if (!entry.fitted.empty()) out["fitted"] = entry.fitted;
  out["report"] = entry.report;
  return out;
}

ordered_json task_json(const Task& task) {
  ordered_json entries = ordered_json::array();
  for (const std::size_t i : in_order(task)) entries.push_back(entry_json(task.entries[i]));
  ordered_json out{{"name", task.name},         {"about", task.about},
                   {"input", task.input},       {"licence", task.licence},
                   {"measured", task.measured}, {"measured_rms_N", number(task.measured_rms_N)}};
  if (task.floor) {
    out["floor"] = {{"rms_N", number(task.floor->rms_N)},
                    {"interval95_N", {number(task.floor->low95_N), number(task.floor->high95_N)}},
                    {"how", task.floor->how}};
  }
  if (task.repeat) out["repeat"] = {{"rms_N", number(task.repeat->rms_N)}, {"how", task.repeat->how}};
  out["entries"] = std::move(entries);
  out["within_one_jnd"] = ordered_json::array();
  for (const std::size_t i : within_one_jnd(task)) out["within_one_jnd"].push_back(task.entries[i].renderer);
  if (task.ranking) {
    out["ranking"] =
        ranking_json(*task.ranking, [&](std::size_t place) { return task.entries[task.ranked[place]].renderer; });
  }
  return out;
}

std::optional<double> floor_N_of(JsonObject& task) {
  if (!task.has("floor")) return std::nullopt;
  JsonObject floor = task.object("floor");
  return floor.raw("rms_N").is_null() ? std::nullopt : std::optional(floor.number("rms_N"));
}

std::string floor_text(const std::optional<double>& floor_N) {
  return floor_N ? report::display_quantity(*floor_N, "N") : "none";
}

// Of a recording of both runs. Floors are simulated from one seed: any difference is one of recording, input or
// program.
void add_floor_change(const EarlierBoard& before, const Task& task, std::vector<std::string>& lines) {
  const auto old = before.floors_N.find(task.name);
  if (old == before.floors_N.end()) return;
  std::optional<double> now;
  if (task.floor && std::isfinite(task.floor->rms_N)) now = task.floor->rms_N;
  if (old->second == now) return;
  lines.push_back(fmt::format("floor of {}: {} before, {} now", task.name, floor_text(old->second), floor_text(now)));
}

EntryState state_of(JsonObject& in) {
  const std::string name = in.text("state");
  for (const EntryState state : {EntryState::ran, EntryState::does_not_enter, EntryState::failed}) {
    if (name == state_name(state)) return state;
  }
  in.fail_at("state", fmt::format("'{}' is unknown: ran, does-not-enter or failed was expected", name));
}

}  // namespace

std::string board_to_json(const Board& board) {
  ordered_json tasks = ordered_json::array();
  for (const Task& task : board.tasks) tasks.push_back(task_json(task));
  ordered_json out{{"schema", "touchstone-leaderboard/1"}, {"title", board.title},       {"level", board.options.level},
                   {"draws", board.options.draws},         {"seed", board.options.seed}, {"tasks", std::move(tasks)}};
  if (board.overall) {
    const Overall& overall = *board.overall;
    ordered_json renderers = ordered_json::array();
    for (std::size_t i = 0; i < overall.renderers.size(); ++i) {
      renderers.push_back({{"renderer", overall.renderers[i]},
                           {"scores", scores_json(overall.scores[i])},
                           {"pareto", static_cast<bool>(overall.pareto[i])}});
    }
    out["overall"] = {
        {"renderers", std::move(renderers)},
        {"ranking", ranking_json(overall.ranking, [&](std::size_t place) { return overall.renderers[place]; })},
        {"left_out", overall.left_out},
        {"floor_N", overall.floor_N > 0.0 ? number(overall.floor_N) : ordered_json()}};
  }
  return out.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string timings_to_json(const Board& board) {
  ordered_json entries = ordered_json::array();
  for (const Task& task : board.tasks) {
    for (const Entry& entry : task.entries) {
      if (entry.state != EntryState::ran) continue;
      entries.push_back({{"task", task.name},
                         {"renderer", entry.renderer},
                         {"median_us", number(entry.scores.median_us)},
                         {"p99_us", number(entry.scores.p99_us)}});
    }
  }
  ordered_json out{{"schema", "touchstone-leaderboard-timings/1"}, {"entries", std::move(entries)}};
  if (board.overall) {
    ordered_json front = ordered_json::array();
    for (std::size_t i = 0; i < board.overall->renderers.size(); ++i) {
      if (board.overall->pareto_timed[i]) front.push_back(board.overall->renderers[i]);
    }
    out["pareto_with_time"] = std::move(front);
  }
  return out.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

EarlierBoard load_earlier(const std::filesystem::path& file) {
  // Not load_json(): the new board may take the place of the earlier one.
  const nlohmann::json document = parse_json(read_file(file), file.string());
  JsonObject in(document, file.string(), "");
  in.schema("touchstone-leaderboard/1");
  EarlierBoard out;
  for (JsonObject& task : in.objects("tasks")) {
    const std::string name = task.text("name");
    out.floors_N[name] = floor_N_of(task);
    for (JsonObject& entry : task.objects("entries")) {
      EarlierEntry one{name, entry.text("renderer"), state_of(entry), std::nan(""), ""};
      if (one.state == EntryState::ran) {
        one.input_hash = entry.text("input_hash");
        JsonObject scores = entry.object("scores");
        if (!scores.raw("rms_force_error_N").is_null()) one.rms_force_error_N = scores.number("rms_force_error_N");
      }
      out.entries.push_back(std::move(one));
    }
  }
  return out;
}

std::vector<std::string> changes_since(const EarlierBoard& before, const Board& now) {
  std::vector<std::string> lines;
  const auto find = [&](const std::string& task, const std::string& renderer) {
    return std::ranges::find_if(before.entries,
                                [&](const EarlierEntry& one) { return one.task == task && one.renderer == renderer; });
  };
  std::size_t met = 0;
  for (const Task& task : now.tasks) {
    add_floor_change(before, task, lines);
    for (const Entry& entry : task.entries) {
      const std::string name = fmt::format("{} on {}", entry.renderer, task.name);
      const auto old = find(task.name, entry.renderer);
      if (old == before.entries.end()) {
        lines.push_back(name + ": new");
        continue;
      }
      ++met;
      if (old->state != entry.state) {
        lines.push_back(fmt::format("{}: {} before, {} now", name, state_name(old->state), state_name(entry.state)));
      } else if (entry.state == EntryState::ran && old->input_hash != entry.input.hash) {
        lines.push_back(name + ": another input than before, not compared");
      } else if (entry.state == EntryState::ran && !(old->rms_force_error_N == entry.scores.rms_force_error_N) &&
                 !(std::isnan(old->rms_force_error_N) && std::isnan(entry.scores.rms_force_error_N))) {
        lines.push_back(fmt::format("{}: RMS force error {} before, {} now", name,
                                    report::display_quantity(old->rms_force_error_N, "N"),
                                    report::display_quantity(entry.scores.rms_force_error_N, "N")));
      }
    }
  }
  if (met < before.entries.size())
    lines.push_back(fmt::format("{} entries of the last run are not in this one", before.entries.size() - met));
  return lines;
}

std::string errors_to_text(const BinnedErrors& errors) {
  return nlohmann::json{{"squares_N2", errors.squares_N2}, {"samples", errors.samples}}.dump();
}

BinnedErrors errors_from_text(std::string_view text, std::string_view source) {
  const nlohmann::json document = parse_json(text, source);
  JsonObject in(document, std::string(source), "");
  BinnedErrors out;
  out.squares_N2 = in.numbers("squares_N2");
  for (const double count : in.numbers("samples")) {
    if (!(count >= 0.0 && count <= most_samples))
      in.fail_at("samples", fmt::format("a count was expected, got {}", count));
    out.samples.push_back(static_cast<std::uint64_t>(count));
  }
  if (out.samples.size() != out.squares_N2.size()) in.fail_at("samples", "is not as long as squares_N2");
  in.finish();
  return out;
}

}  // namespace touchstone::pipeline
