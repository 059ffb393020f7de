#include "harness/report/judgement_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/report/evaluation_page.h"
#include "harness/report/place_section.h"

namespace touchstone::report {
namespace {

namespace pc = perception;
using JudgedTableCell = Table::Cell;

JudgedTableCell judged_text(std::string text) { return {std::move(text), false, Tone::neutral}; }
JudgedTableCell judged_number(double value, const char* format = "{:.3g}") {
  return {std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "none", true, Tone::neutral};
}

Tone tone_of(pc::Verdict verdict) {
  switch (verdict) {
    case pc::Verdict::noticed:
      return Tone::warning;
    case pc::Verdict::not_noticed:
      return Tone::good;
    case pc::Verdict::cannot_tell:
      break;
  }
  return Tone::neutral;
}

std::vector<const pc::JudgedCondition*> by_rank(const pc::JudgedConditions& judged) {
  std::vector<const pc::JudgedCondition*> ranked;
  for (const auto& c : judged.conditions) ranked.push_back(&c);
  std::ranges::sort(ranked, {}, &pc::JudgedCondition::rank);
  return ranked;
}

Section verdict_section(const pc::JudgedConditions& judged) {
  Section section;
  section.title = "Would a person notice?";
  section.intro =
      "The share of right answers in a two-alternative forced choice against the real process: 50 % is guessing, 76 % "
      "one just noticeable difference (JND). Each line is a statement about one pair: other conditions do not enter. "
      "Conditions of one group are not told apart by these data.";
  Table table;
  table.columns = {"condition", "rank", "group", "told apart", "95 %", "d'", "verdict", "what gives it away"};
  // What holds for every condition is said once, below the table.
  std::vector<std::string> common = judged.conditions.front().judgement.remarks;
  for (const auto& c : judged.conditions)
    std::erase_if(common, [&](const std::string& r) { return std::ranges::count(c.judgement.remarks, r) == 0; });
  for (const auto* c : by_rank(judged)) {
    const pc::Judgement& j = c->judgement;
    std::string what = j.above_noise ? "no single channel" : "nothing above the noise of the recordings";
    Table::Row row;
    if (j.gives_away) {
      const auto& channel = j.channels[static_cast<std::size_t>(*j.gives_away)];
      what = fmt::format("{}: {}", pc::name_of(channel.channel), channel.what);
      if (!channel.remedy.empty()) row.detail = fmt::format("To change: {}. ", channel.remedy);
    }
    row.cells = {
        judged_text(c->name),
        judged_number(static_cast<double>(c->rank), "{:.0f}"),
        judged_number(static_cast<double>(c->group), "{:.0f}"),
        {pc::told_share(j), true, Tone::neutral},
        {fmt::format("{:.0f} to {:.0f}", 100.0 * j.noticed_low95, 100.0 * j.noticed_high95), true, Tone::neutral},
        judged_number(j.d_prime, "{:.2f}"),
        {std::string(pc::name_of(j.verdict)), true, tone_of(j.verdict)},
        judged_text(what)};
    for (const auto& remark : j.remarks) {
      if (std::ranges::count(common, remark) == 0) row.detail += remark + ". ";
    }
    table.rows.push_back(std::move(row));
  }
  section.blocks.emplace_back(std::move(table));
  for (const auto& remark : common) section.blocks.emplace_back(TextBlock{remark + ".", Tone::neutral});
  return section;
}

Section channel_section(const pc::JudgedConditions& judged) {
  Section section;
  section.title = "Channel by channel";
  section.intro =
      "Evidence in just noticeable differences, with its standard error. Force and stiffness are two cues of one "
      "curve: the stronger counts. \"-\": these recordings do not show the channel.";
  if (judged.conditions.size() > pc::keep_series_up_to)
    section.intro += fmt::format(" The {} conditions that are hardest to tell.", pc::keep_series_up_to);
  for (const auto* c : by_rank(judged)) {
    Table table;
    table.caption = c->name;
    table.columns = {"channel", "JND", "what differs"};
    for (const auto& channel : c->judgement.channels) {
      Table::Row row;
      row.cells = {judged_text(std::string(pc::name_of(channel.channel))),
                   {channel.known ? fmt::format("{:.2f} +- {:.2f}", channel.jnd, channel.standard_error) : "-", true,
                    Tone::neutral},
                   judged_text(channel.known ? channel.what : channel.why)};
      table.rows.push_back(std::move(row));
    }
    section.blocks.emplace_back(std::move(table));
    if (section.blocks.size() == pc::keep_series_up_to) break;
  }
  return section;
}

Section moment_section(const pc::JudgedConditions& judged) {
  Section section;
  section.title = "When and where";
  section.intro =
      "The mean force of every quarter of a second in contact against what the real process gives for the same motion.";
  LinePlot plot;
  plot.title = "Difference over time";
  plot.x_label = "time [s]";
  plot.y_label = "difference [JND]";
  plot.levels.emplace_back("1 JND", 1.0);
  constexpr Tone tones[] = {Tone::rendered, Tone::error, Tone::reference, Tone::good, Tone::warning, Tone::neutral};
  Table table;
  table.columns = {"condition", "noticed in", "strongest at", "there"};
  for (const auto& c : judged.conditions) {
    if (c.judgement.moments.empty()) continue;
    Line line;
    line.name = c.name;
    line.markers = true;
    line.tone = tones[plot.lines.size() % std::size(tones)];
    for (const auto& m : c.judgement.moments) {
      line.x.push_back(m.t_s);
      line.y.push_back(m.jnd);
    }
    plot.lines.push_back(std::move(line));
    Table::Row row;
    row.cells = {judged_text(c.name), judged_number(100.0 * c.judgement.noticed_share, "{:.0f} % of the contact"),
                 judged_number(c.strongest_s, "{:.2f} s"),
                 judged_text(fmt::format("({:.1f}, {:.1f}, {:.1f}) mm", 1e3 * c.strongest_W_m.x(),
                                         1e3 * c.strongest_W_m.y(), 1e3 * c.strongest_W_m.z()))};
    table.rows.push_back(std::move(row));
  }
  if (plot.lines.empty()) return section;
  section.blocks.emplace_back(std::move(plot));
  section.blocks.emplace_back(std::move(table));
  return section;
}

Section other_section(const pc::JudgedConditions& judged) {
  Section section;
  section.title = "Metrics of other authors, side by side";
  section.intro =
      "Each pair by itself. They compare samples of the same moment: hands that press deeper, faster or later count as "
      "differences. The distance keeps all components. Structural similarity follows the equations of HSSIM; its "
      "published windows and constants could not be had.";
  constexpr std::size_t side_by_side = 4;  // as many as a narrow page holds
  for (std::size_t first = 0; first < judged.conditions.size(); first += side_by_side) {
    const std::size_t end = std::min(judged.conditions.size(), first + side_by_side);
    if (judged.conditions[first].others.empty()) return section;
    Table table;
    table.columns = {"metric"};
    for (std::size_t c = first; c < end; ++c) table.columns.push_back(judged.conditions[c].name);
    for (std::size_t m = 0; m < judged.conditions[first].others.size(); ++m) {
      const pc::OtherMetric& named = judged.conditions[first].others[m];
      Table::Row row;
      row.cells = {judged_text(named.unit == "1" ? named.name : fmt::format("{} [{}]", named.name, named.unit))};
      for (std::size_t c = first; c < end; ++c) {
        const pc::OtherMetric& other = judged.conditions[c].others[m];
        row.cells.push_back(other.value ? judged_number(*other.value, "{:.4g}") : judged_text("none"));
        if (!other.why.empty()) row.detail += fmt::format("{}: {}. ", judged.conditions[c].name, other.why);
      }
      table.rows.push_back(std::move(row));
    }
    section.blocks.emplace_back(std::move(table));
  }
  return section;
}

Section threshold_section(const pc::JudgeOptions& options) {
  Section section;
  section.title = "Thresholds";
  section.intro = "What one just noticeable difference is. --thresholds replaces any of them.";
  section.folded = true;
  Table table;
  table.columns = {"constant", "value", "unit", "source"};
  pc::Thresholds thresholds = options.thresholds;
  for (const auto& entry : pc::threshold_entries()) {
    Table::Row row;
    row.cells = {judged_text(std::string(entry.name)), judged_number(entry.place(thresholds), "{:.4g}"),
                 judged_text(std::string(entry.unit)), judged_text(pc::source_of(entry))};
    table.rows.push_back(std::move(row));
  }
  section.blocks.emplace_back(std::move(table));
  LinePlot plot;
  plot.title = "Vibrating force that is just felt";
  plot.x_label = "frequency [Hz]";
  plot.y_label = "amplitude [N]";
  plot.log_x = true;
  plot.log_y = true;
  plot.note = std::string(pc::vibration_threshold_source());
  Line line;
  line.name = "threshold";
  for (const double f : pc::band_centres_Hz()) {
    line.x.push_back(f);
    line.y.push_back(thresholds.vibration_force_N(f));
  }
  plot.lines.push_back(std::move(line));
  section.blocks.emplace_back(std::move(plot));
  return section;
}

}  // namespace

Page judgement_page(const std::string& title, const pc::JudgedConditions& judged, const pc::JudgeOptions& options,
                    const std::vector<std::string>& notes, const Provenance& provenance) {
  Page page;
  page.title = title;
  page.subtitle =
      fmt::format("{} conditions, {} repeats of the real process", judged.conditions.size(), judged.floor.repeats);
  page.sections.push_back(verdict_section(judged));
  for (const auto& note : notes) page.sections.front().blocks.emplace_back(TextBlock{note, Tone::warning});
  page.sections.push_back(channel_section(judged));
  for (auto& section : place_sections(judged)) page.sections.push_back(std::move(section));
  for (auto section : {moment_section(judged), other_section(judged)}) {
    if (!section.blocks.empty()) page.sections.push_back(std::move(section));
  }
  page.sections.push_back(threshold_section(options));
  page.sections.push_back(provenance_section(provenance));
  return page;
}

}  // namespace touchstone::report
