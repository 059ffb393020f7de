#include "harness/pipeline/board.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/base/error.h"
#include "harness/pipeline/pareto.h"

namespace touchstone::pipeline {
namespace {

void rank_task(Task& task, const RankingOptions& options) {
  DatasetErrors errors;
  for (std::size_t i = 0; i < task.entries.size(); ++i) {
    const Entry& own = task.entries[i];
    if (own.state != EntryState::ran || own.errors.size() == 0) continue;
    if (!task.ranked.empty()) {
      const Entry& first = task.entries[task.ranked.front()];
      if (const std::string why = why_not_comparable(first.input, own.input); !why.empty()) {
        throw UsageError(
            fmt::format("{}: {} and {} are not compared: {}", task.name, first.renderer, own.renderer, why));
      }
    }
    task.ranked.push_back(i);
    errors.push_back(own.errors);
  }
  if (!errors.empty()) task.ranking = rank_renderers({errors}, options);
}

const Entry* entry_of(const Task& task, const std::string& renderer) {
  const auto found = std::ranges::find(task.entries, renderer, &Entry::renderer);
  return found == task.entries.end() ? nullptr : &*found;
}

bool counted(const Task& task, const std::string& renderer) {
  return std::isfinite(entry_of(task, renderer)->scores.mean_operations);
}

// The tasks over which operations are comparable: all those on which every renderer is counted that is counted
// anywhere. (Renderers that walk are not counted on meshes that cannot be walked on, plug-ins nowhere.)
std::vector<bool> counted_tasks(const Board& board, const std::vector<std::string>& renderers) {
  std::vector<bool> out(board.tasks.size(), true);
  for (const std::string& renderer : renderers) {
    if (!std::ranges::any_of(board.tasks, [&](const Task& task) { return counted(task, renderer); })) continue;
    for (std::size_t t = 0; t < out.size(); ++t) out[t] = out[t] && counted(board.tasks[t], renderer);
  }
  return out;
}

// Over tasks: errors relative to nothing, so as geometric means of what each task scored; operations (over the
// `counted` tasks) and times as means.
Scores overall_scores(const Board& board, const std::string& renderer, const std::vector<bool>& counted) {
  Scores sum;
  double counts = 0.0;
  double log_error = 0.0;
  double log_felt = 0.0;
  double squared_position = 0.0;
  for (const Task& task : board.tasks) {
    const Scores& own = entry_of(task, renderer)->scores;
    log_error += std::log(own.rms_force_error_N);
    log_felt += std::log(own.rms_force_error_jnd);
    squared_position += own.rms_position_error_m * own.rms_position_error_m;
    if (counted[static_cast<std::size_t>(&task - board.tasks.data())]) {
      counts += 1.0;
      sum.mean_operations += own.mean_operations;
      sum.max_operations =
          std::isnan(own.max_operations) ? own.max_operations : std::max(sum.max_operations, own.max_operations);
    }
    sum.median_us += own.median_us;
    sum.p99_us += own.p99_us;
  }
  const auto n = static_cast<double>(board.tasks.size());
  sum.rms_force_error_N = std::exp(log_error / n);
  sum.rms_force_error_jnd = std::exp(log_felt / n);
  sum.rms_position_error_m = std::sqrt(squared_position / n);
  sum.mean_operations /= counts;  // not a number where nothing is counted
  if (counts == 0.0) sum.max_operations = sum.mean_operations;
  sum.median_us /= n;
  sum.p99_us /= n;
  return sum;
}

// Why a renderer has no place in the overall ranking; empty if it has.
std::string left_out(const Board& board, const std::string& renderer) {
  for (const Task& task : board.tasks) {
    const Entry* const own = entry_of(task, renderer);
    if (own == nullptr) return fmt::format("{}: was not run on {}", renderer, task.name);
    if (own->state == EntryState::does_not_enter) return fmt::format("{}: does not enter {}", renderer, task.name);
    if (own->state == EntryState::failed) return fmt::format("{}: failed on {}", renderer, task.name);
    if (own->errors.size() == 0) return fmt::format("{}: has no force errors on {}", renderer, task.name);
  }
  return "";
}

std::optional<Overall> rank_overall(const Board& board) {
  Overall out;
  std::vector<std::string> all;
  for (const Task& task : board.tasks) {
    for (const Entry& entry : task.entries) {
      if (std::ranges::count(all, entry.renderer) == 0) all.push_back(entry.renderer);
    }
  }
  for (const std::string& renderer : all) {
    const std::string why = left_out(board, renderer);
    if (why.empty()) {
      out.renderers.push_back(renderer);
    } else {
      out.left_out.push_back(why);
    }
  }
  if (out.renderers.size() < 2) return std::nullopt;
  std::vector<DatasetErrors> errors;
  for (const Task& task : board.tasks) {
    errors.emplace_back();
    for (const std::string& renderer : out.renderers) errors.back().push_back(entry_of(task, renderer)->errors);
  }
  out.ranking = rank_renderers(errors, board.options);
  std::vector<std::vector<double>> costs;
  std::vector<std::vector<double>> timed;
  const std::vector<bool> counted = counted_tasks(board, out.renderers);
  for (const std::string& renderer : out.renderers) {
    out.scores.push_back(overall_scores(board, renderer, counted));
    const Scores& own = out.scores.back();
    costs.push_back({own.rms_force_error_N, own.rms_force_error_jnd, own.mean_operations});
    timed.push_back({own.rms_force_error_N, own.rms_force_error_jnd, own.mean_operations, own.median_us});
  }
  double log_floor = 0.0;
  bool floors = true;
  for (const Task& task : board.tasks) {
    floors = floors && task.floor && task.floor->rms_N > 0.0;
    if (floors) log_floor += std::log(task.floor->rms_N) / static_cast<double>(board.tasks.size());
  }
  if (floors) out.floor_N = std::exp(log_floor);
  out.pareto = pareto_front(costs);
  out.pareto_timed = pareto_front(timed);
  return out;
}

}  // namespace

const char* state_name(EntryState state) {
  switch (state) {
    case EntryState::ran:
      return "ran";
    case EntryState::does_not_enter:
      return "does-not-enter";
    case EntryState::failed:
      return "failed";
  }
  return "";
}

void rank_board(Board& board, bool overall) {
  for (Task& task : board.tasks) {
    task.ranked.clear();
    task.ranking.reset();
    rank_task(task, board.options);
  }
  board.overall.reset();
  if (overall && !board.tasks.empty()) board.overall = rank_overall(board);
}

std::vector<std::size_t> in_order(const Task& task) {
  std::vector<std::size_t> out;
  if (task.ranking) {
    for (const RankedRenderer& one : task.ranking->order) out.push_back(task.ranked[one.renderer]);
  }
  for (const EntryState state : {EntryState::ran, EntryState::does_not_enter, EntryState::failed}) {
    for (std::size_t i = 0; i < task.entries.size(); ++i) {
      if (task.entries[i].state == state && std::ranges::count(out, i) == 0) out.push_back(i);
    }
  }
  return out;
}

std::string rank_text(const RankedRenderer& ranked) {
  return ranked.best_rank == ranked.worst_rank ? fmt::format("{}", ranked.best_rank)
                                               : fmt::format("{}-{}", ranked.best_rank, ranked.worst_rank);
}

std::vector<std::size_t> within_one_jnd(const Task& task) {
  const auto felt = [&](std::size_t i) { return task.entries[i].scores.rms_force_error_jnd; };
  std::vector<std::size_t> which;
  for (std::size_t i = 0; i < task.entries.size(); ++i) {
    if (task.entries[i].state == EntryState::ran && std::isfinite(felt(i))) which.push_back(i);
  }
  std::ranges::stable_sort(which, {}, felt);
  while (which.size() > 1 && felt(which[which.size() - 2]) + felt(which.back()) > 1.0) which.pop_back();
  if (which.size() < 2) which.clear();
  return which;
}

std::string rank_text(const Task& task, std::size_t entry) {
  if (!task.ranking) return "";
  for (const RankedRenderer& one : task.ranking->order) {
    if (task.ranked[one.renderer] == entry) return rank_text(one);
  }
  return "";
}

}  // namespace touchstone::pipeline
