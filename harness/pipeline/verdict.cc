#include "harness/pipeline/verdict.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "harness/report/console.h"
#include "harness/report/quantity.h"

namespace touchstone::pipeline {
namespace {

std::string and_list(const std::vector<std::string>& names) {
  if (names.size() < 2) return names.empty() ? "" : names.front();
  return fmt::format("{} and {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
}

// Those that nobody was told to be better than, best first. One that the data cannot tell from the first, but is told
// to be worse than another, is none of the best.
std::vector<std::size_t> the_best(const Ranking& ranking) {
  std::vector<std::size_t> out;
  for (const RankedRenderer& one : ranking.order) {
    if (one.best_rank == 1) out.push_back(one.renderer);
  }
  return out;
}

std::string percent(double share) { return fmt::format("{:.{}f} %", 100.0 * share, share < 0.1 ? 1 : 0); }

std::string of_measured(const Task& task, const Entry& entry) {
  std::string text = report::display_quantity(entry.scores.rms_force_error_N, "N");
  if (task.measured_rms_N > 0.0) {
    text += fmt::format(", {} of the measured {}", percent(entry.scores.rms_force_error_N / task.measured_rms_N),
                        report::display_quantity(task.measured_rms_N, "N"));
  }
  return text;
}

std::string who_is_within_one_jnd(const Task& task) {
  const auto which = within_one_jnd(task);
  if (which.empty()) return "";
  std::vector<std::string> names;
  for (const std::size_t i : which) names.push_back(task.entries[i].renderer);
  const auto felt = [&](std::size_t i) { return task.entries[i].scores.rms_force_error_jnd; };
  return fmt::format(
      " By the size of the force {} are within {:.2g} just noticeable differences of one another (RMS; single moments "
      "may be more).",
      and_list(names), felt(which[which.size() - 2]) + felt(which.back()));
}

std::string who_did_not_run(const Task& task) {
  std::string text;
  for (const EntryState state : {EntryState::does_not_enter, EntryState::failed}) {
    std::vector<std::string> names;
    for (const Entry& entry : task.entries) {
      if (entry.state == state) names.push_back(entry.renderer);
    }
    if (names.empty()) continue;
    const char* const what = state == EntryState::failed ? "failed"
                             : names.size() == 1         ? "does not enter"
                                                         : "do not enter";
    text += fmt::format(" {} {}.", and_list(names), what);
  }
  return text;
}

std::string number_or_dash(double value, const char* format) {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : std::string("-");
}

std::string against_repeat(const Task& task, const Entry& best) {
  if (!task.repeat) return "";
  return fmt::format(" A repeat of this motion sets a floor of {}: the best error is {} times that.",
                     report::display_quantity(task.repeat->rms_N, "N"),
                     times_floor(best.scores.rms_force_error_N, task.repeat->rms_N));
}

std::string against_floor(const Task& task, const Entry& best) {
  if (!task.floor) return "";
  const bool at_floor = best.scores.rms_force_error_N <= task.floor->high95_N;
  return fmt::format(" The floor of this input is {}{}.", report::display_quantity(task.floor->rms_N, "N"),
                     at_floor ? ": nothing that is better could be seen here" : "");
}

}  // namespace

std::string verdict(const Task& task) {
  if (!task.ranking) return "No renderer ran with a force to judge." + who_did_not_run(task);
  const Ranking& ranking = *task.ranking;
  const auto entry = [&](std::size_t place) -> const Entry& { return task.entries[task.ranked[place]]; };
  const std::vector<std::size_t> best = the_best(ranking);
  std::vector<std::string> names;
  for (const std::size_t place : best) names.push_back(entry(place).renderer);
  const Entry& first = entry(best.front());
  std::string text;
  if (ranking.order.size() == 1) {
    text = fmt::format("{}: RMS force error {}.", first.renderer, of_measured(task, first));
  } else if (!ranking.why_not.empty()) {
    text = fmt::format("Nothing is ranked: {}. The smallest RMS force error has {}: {}.", ranking.why_not,
                       names.front(), of_measured(task, first));
  } else if (best.size() == 1) {
    text = fmt::format("{} is best: RMS force error {}.", first.renderer, of_measured(task, first));
    const Entry& second = entry(ranking.order[1].renderer);
    text += fmt::format(" Next is {}, with {:.3g} times that.", second.renderer,
                        second.scores.rms_force_error_N / first.scores.rms_force_error_N);
  } else if (best.size() == ranking.order.size()) {
    text = fmt::format("The data cannot tell the {} renderers apart: RMS force error from {}.", best.size(),
                       of_measured(task, first));
  } else {
    text = fmt::format("{} are best, and the data cannot tell them apart: RMS force error from {}.", and_list(names),
                       of_measured(task, first));
  }
  const Entry& last = entry(ranking.order.back().renderer);
  if (best.size() < ranking.order.size() && ranking.order.size() > 2) {
    text += fmt::format(" Last is {} with {}.", last.renderer,
                        report::display_quantity(last.scores.rms_force_error_N, "N"));
  }
  return text + against_floor(task, first) + against_repeat(task, first) + who_is_within_one_jnd(task) +
         who_did_not_run(task);
}

std::string verdict(const Overall& overall, std::size_t tasks) {
  const std::vector<std::size_t> best = the_best(overall.ranking);
  std::vector<std::string> names;
  for (const std::size_t place : best) names.push_back(overall.renderers[place]);
  std::vector<std::string> front;
  for (std::size_t i = 0; i < overall.renderers.size(); ++i) {
    if (overall.pareto[i]) front.push_back(overall.renderers[i]);
  }
  std::string text =
      best.size() == 1
          ? fmt::format("Over {} recordings {} is best.", tasks, names.front())
          : fmt::format("Over {} recordings {} are best, and the data cannot tell them apart.", tasks, and_list(names));
  text += overall.ranking.datasets_resampled
              ? " This holds for objects and recordings like these."
              : fmt::format(" This holds for these recordings: {} are too few to say more.", tasks);
  if (!front.empty())
    text += fmt::format(" No other renderer beats {} in error, felt error and operations at once.", and_list(front));
  return text;
}

std::string short_table(const Task& task) {
  std::vector<std::vector<std::string>> rows{{"rank", "renderer", "error", "floor", "times", "felt", "flops", "us"}};
  for (const std::size_t i : in_order(task)) {
    const Entry& entry = task.entries[i];
    if (entry.state != EntryState::ran) {
      rows.push_back({"-", entry.renderer, entry.state == EntryState::failed ? "FAILED" : "no entry"});
      continue;
    }
    const Scores& s = entry.scores;
    rows.push_back({rank_text(task, i), entry.renderer,
                    std::isfinite(s.rms_force_error_N) ? report::display_quantity(s.rms_force_error_N, "N") : "-",
                    task.floor ? report::display_quantity(task.floor->rms_N, "N") : "-",
                    task.floor ? times_floor(s.rms_force_error_N, task.floor->rms_N) : "-",
                    number_or_dash(s.rms_force_error_jnd, "{:.3g} JND"), number_or_dash(s.mean_operations, "{:.0f}"),
                    number_or_dash(s.median_us, "{:.2f}")});
  }
  for (auto& row : rows) row.resize(rows.front().size());
  return report::align_columns(rows);
}

std::string times_floor(double error_N, double floor_N) {
  const double times = error_N / floor_N;
  return std::isfinite(times) ? fmt::format("{:.{}f}", times, times < 9.95 ? 1 : 0) : std::string("-");
}

std::string wrapped(std::string_view text, std::size_t width, std::size_t indent) {
  std::string out;
  std::size_t column = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const std::string_view word = text.substr(0, end);
    if (column > 0 && column + 1 + word.size() > width) {
      out += "\n" + std::string(indent, ' ');
      column = indent;
    } else if (column > 0) {
      out += ' ';
      ++column;
    }
    out += word;
    column += word.size();
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

std::size_t terminal_width() {
  std::size_t width = 80;
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) {
    width = size.ws_col;
  } else if (const char* const columns = std::getenv("COLUMNS")) {
    std::from_chars(columns, columns + std::strlen(columns), width);
  }
  return std::max<std::size_t>(width, 40);
}

}  // namespace touchstone::pipeline
