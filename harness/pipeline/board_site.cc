#include "harness/pipeline/board_site.h"

#include <fmt/format.h>

#include <cmath>

#include "harness/base/markup.h"
#include "harness/pipeline/board_pictures.h"
#include "harness/pipeline/site_assets.h"
#include "harness/pipeline/verdict.h"
#include "harness/report/page_html.h"
#include "harness/report/quantity.h"

namespace touchstone::pipeline {
namespace {

// A cell with the number that its column is sorted by; what is no number sorts last.
std::string cell(const std::string& label, const std::string& html, double sorted_by) {
  return fmt::format("<td data-label=\"{}\" data-value=\"{}\">{}</td>", escape_html(label),
                     std::isfinite(sorted_by) ? fmt::format("{:.17g}", sorted_by) : "", html);
}

std::string quantity_or_dash(double value, std::string_view unit) {
  return std::isfinite(value) ? escape_html(report::display_quantity(value, unit)) : "&ndash;";
}

std::string head_of(const std::vector<std::string>& columns) {
  std::string out = "<thead><tr>";
  for (const std::string& column : columns)
    out += fmt::format("<th scope=\"col\"><button type=\"button\">{}</button></th>", escape_html(column));
  return out + "</tr></thead>";
}

// `floor_N` 0: there is none.
std::string score_cells(const Scores& s, double floor_N) {
  const std::string floor = floor_N > 0.0 ? "<span>" + quantity_or_dash(floor_N, "N") + "<small>" +
                                                times_floor(s.rms_force_error_N, floor_N) + " x</small></span>"
                                          : "&ndash;";
  return cell("error", quantity_or_dash(s.rms_force_error_N, "N"), s.rms_force_error_N) +
         cell("floor", floor, floor_N > 0.0 ? s.rms_force_error_N / floor_N : std::nan("")) +
         cell("felt",
              std::isfinite(s.rms_force_error_jnd) ? fmt::format("{:.3g} JND", s.rms_force_error_jnd) : "&ndash;",
              s.rms_force_error_jnd) +
         cell("operations", std::isfinite(s.mean_operations) ? fmt::format("{:.0f}", s.mean_operations) : "&ndash;",
              s.mean_operations) +
         cell("time", quantity_or_dash(s.median_us, "us"), s.median_us);
}

std::string entry_row(const Task& task, std::size_t i) {
  const Entry& entry = task.entries[i];
  std::string name = escape_html(entry.renderer);
  if (!entry.report.empty()) name = fmt::format("<a href=\"{}\">{}</a>", escape_html(entry.report), name);
  if (!entry.fitted.empty()) name += fmt::format("<small>fitted: {}</small>", escape_html(entry.fitted));
  const double last = std::nan("");
  if (entry.state != EntryState::ran) {
    return fmt::format("<tr class=\"out\">{}{}<td data-label=\"why\" colspan=\"5\" class=\"why\">{}: {}</td></tr>\n",
                       cell("rank", "&ndash;", last), cell("renderer", name, last),
                       entry.state == EntryState::failed ? "failed" : "does not enter", escape_html(entry.why));
  }
  double rank = last;
  if (task.ranking) {
    for (const RankedRenderer& one : task.ranking->order) {
      if (task.ranked[one.renderer] == i) rank = 0.5 * static_cast<double>(one.best_rank + one.worst_rank);
    }
  }
  return "<tr>" + cell("rank", escape_html(rank_text(task, i)), rank) + cell("renderer", name, last) +
         score_cells(entry.scores, task.floor ? task.floor->rms_N : 0.0) + "</tr>\n";
}

std::string task_section(const Task& task, std::size_t number) {
  std::string out = fmt::format("<section id=\"task-{}\"><h2>{}</h2>\n<p class=\"about\">{}</p>\n<p>{}</p>\n", number,
                                escape_html(task.name), escape_html(task.about), escape_html(verdict(task)));
  out += error_picture(task);
  out += "<table>" + head_of({"rank", "renderer", "error", "floor", "felt", "operations", "time"}) + "<tbody>\n";
  for (const std::size_t i : in_order(task)) out += entry_row(task, i);
  out += "</tbody></table>\n";
  std::string facts = fmt::format("Input: {}.", task.input);
  if (task.measured_rms_N > 0.0)
    facts += fmt::format(" RMS of the measured force: {}.", report::display_quantity(task.measured_rms_N, "N"));
  if (task.floor) {
    facts += fmt::format(" Floor: {} ({} to {}): {}.", report::display_quantity(task.floor->rms_N, "N"),
                         report::display_quantity(task.floor->low95_N, "N"),
                         report::display_quantity(task.floor->high95_N, "N"), task.floor->how);
  }
  if (task.repeat) facts += fmt::format(" A repeat of this motion sets a floor of {}.", task.repeat->how);
  if (!task.measured.empty()) facts += fmt::format(" Measured: {}.", task.measured);
  if (!task.licence.empty()) facts += fmt::format(" Licence: {}.", task.licence);
  return out + fmt::format("<p class=\"facts\">{}</p>\n</section>\n", escape_html(facts));
}

std::string overall_section(const Board& board) {
  const Overall& overall = *board.overall;
  std::string out = fmt::format("<section id=\"overall\"><h2>All recordings</h2>\n<p>{}</p>\n",
                                escape_html(verdict(overall, board.tasks.size())));
  out += error_picture(overall);
  out += "<table>" + head_of({"rank", "renderer", "error", "floor", "felt", "operations", "time"}) + "<tbody>\n";
  for (const RankedRenderer& one : overall.ranking.order) {
    const std::string mark = overall.pareto[one.renderer] ? " <small>Pareto front</small>" : "";
    out += "<tr>" + cell("rank", rank_text(one), 0.5 * static_cast<double>(one.best_rank + one.worst_rank)) +
           cell("renderer", escape_html(overall.renderers[one.renderer]) + mark, std::nan("")) +
           score_cells(overall.scores[one.renderer], overall.floor_N) + "</tr>\n";
  }
  out += "</tbody></table>\n";
  if (!overall.left_out.empty()) {
    out += "<p class=\"facts\">Not ranked over all recordings:</p><ul>";
    for (const std::string& line : overall.left_out) out += "<li>" + escape_html(line) + "</li>";
    out += "</ul>\n";
  }
  const std::string pareto = pareto_picture(overall);
  if (!pareto.empty()) out += "<h3>Error against cost</h3>\n" + pareto;
  return out + "</section>\n";
}

std::string changes_section(const SiteNotes& notes) {
  if (!notes.compared) return "";
  std::string out = "<section id=\"changes\"><h2>Changes since the last run</h2>\n";
  if (notes.changes.empty()) return out + "<p>None.</p></section>\n";
  out += "<ul>";
  for (const std::string& line : notes.changes) out += "<li>" + escape_html(line) + "</li>";
  return out + "</ul></section>\n";
}

std::string foot(const Board& board, const SiteNotes& notes) {
  std::string out =
      "<footer><p>Error: root mean square of the difference between rendered and measured force "
      "(Ruffaldi et al. 2006). Over several recordings it is the geometric mean. Felt: the same in just "
      "noticeable differences. Floor: what the right law scores on this input by simulation, and how many times that "
      "the error is. Operations: floating-point operations of a step, on average. Time: median "
      "of a step on this machine.";
  out += fmt::format(
      " Ranks are intervals: two renderers share a rank if the data cannot tell them apart; on each "
      "board the chance of one false difference is at most {:.0f} % (paired t tests of errors that are correlated in "
      "time, Shaffer's procedure). Intervals: paired block bootstrap, {} draws.",
      100.0 * board.options.level, board.options.draws);
  out += "</p>\n";
  if (!notes.links.empty()) {
    out += "<p>";
    for (const auto& [name, file] : notes.links)
      out += fmt::format("<a href=\"{}\">{}</a> ", escape_html(file), escape_html(name));
    out += "</p>\n";
  }
  const BuildInfo& build = notes.provenance.build;
  return out + fmt::format("<p>Touchstone {}, commit {}{}; made {}; <code>{}</code></p></footer>\n",
                           escape_html(build.version), escape_html(build.commit),
                           build.dirty ? " with uncommitted changes" : "", escape_html(notes.provenance.created_utc),
                           escape_html(notes.provenance.command));
}

}  // namespace

std::string site_html(const Board& board, const SiteNotes& notes) {
  std::string out = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n<style>{}</style></head>\n<body><main>\n"
      "<h1>{}</h1>\n",
      escape_html(board.title), site_style, escape_html(board.title));
  if (board.tasks.size() > 1) {
    out += "<nav>";
    if (board.overall) out += "<a href=\"#overall\">All recordings</a>";
    for (std::size_t i = 0; i < board.tasks.size(); ++i)
      out += fmt::format("<a href=\"#task-{}\">{}</a>", i, escape_html(board.tasks[i].name));
    out += "</nav>\n";
  }
  if (board.overall) out += overall_section(board);
  out += changes_section(notes);
  for (std::size_t i = 0; i < board.tasks.size(); ++i) out += task_section(board.tasks[i], i);
  out += foot(board, notes);
  out += fmt::format("</main>\n<script>{}</script></body></html>\n", site_script);
  return out;
}

}  // namespace touchstone::pipeline
