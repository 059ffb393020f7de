#include "loop_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "harness/report/evaluation_page.h"
#include "harness/report/json_numbers.h"

namespace touchstone::loop {
using report::Line;
using report::LinePlot;
using report::Section;
using report::Table;
using report::Tone;
using servo::LoopEvaluation;
using servo::LoopSetup;
using servo::LoopTrace;
using servo::MassRun;
using servo::RecordedComparison;
using servo::Verdict;

namespace {

constexpr std::size_t plotted_pairs = 1500;
constexpr double close_up_s = 0.1;  // to both sides

nlohmann::json vibration_json(const servo::Vibration& own) {
  return {{"frequency_Hz", report::exact_number(own.frequency_Hz)},
          {"amplitude_N", report::exact_number(own.amplitude_N)},
          {"jnd", report::exact_number(own.jnd)},
          {"at_s", report::exact_number(own.at_s)}};
}

nlohmann::json sheet_json(const servo::DataSheet& sheet) {
  nlohmann::json figures = nlohmann::json::object();
  for (const auto& [name, figure] : sheet.figures)
    figures[name] = {{"value", figure.value}, {"source", figure.source}, {"read_in", figure.read_in}};
  return {{"name", sheet.name}, {"figures", figures}};
}

using Value = std::function<double(std::size_t)>;

// The whole series by the least and the largest of each of some hundred parts, so that no peak is lost.
Line thinned(std::string name, const std::vector<double>& t_s, const Value& value, Tone tone, bool dashed = false) {
  Line line{std::move(name), {}, {}, tone, dashed, false};
  const std::size_t part = std::max<std::size_t>(1, t_s.size() / plotted_pairs);
  for (std::size_t begin = 0; begin < t_s.size(); begin += part) {
    std::size_t least = begin, largest = begin;
    for (std::size_t i = begin; i < std::min(begin + part, t_s.size()); ++i) {
      if (value(i) < value(least)) least = i;
      if (value(i) > value(largest)) largest = i;
    }
    for (const std::size_t i : {std::min(least, largest), std::max(least, largest)}) {
      line.x.push_back(t_s[i]);
      line.y.push_back(value(i));
      if (least == largest) break;
    }
  }
  return line;
}

Line between(std::string name, const std::vector<double>& t_s, const Value& value, double from_s, double to_s,
             Tone tone, bool dashed = false) {
  Line line{std::move(name), {}, {}, tone, dashed, false};
  for (std::size_t i = 0; i < t_s.size(); ++i) {
    if (t_s[i] < from_s || t_s[i] > to_s) continue;
    line.x.push_back(t_s[i]);
    line.y.push_back(value(i));
  }
  return line;
}

Value size_of(const std::vector<Vec3>& series) {
  return [&series](std::size_t i) { return series[i].norm(); };
}
Value value_of(const std::vector<double>& series, double factor) {
  return [&series, factor](std::size_t i) { return factor * series[i]; };
}

Section pictures(const LoopEvaluation& evaluation) {
  const MassRun& worst = evaluation.worst();
  const LoopTrace &run = worst.run, &ideal = worst.ideal, &open = worst.open;
  Section section{"Over time", "", {}, false};
  const double at_s = worst.judgement.verdict == Verdict::stable && worst.judgement.kick_N > 0.0
                          ? worst.judgement.kick_at_s
                          : worst.judgement.buzz.at_s;
  LinePlot force{"Force of the renderer", "time [s]", "force [N]", {}, {}, {}, "", "time"};
  force.lines = {thinned("in the hand", run.t_s, size_of(run.commanded_W_N), Tone::rendered),
                 thinned("replayed open loop", open.t_s, size_of(open.commanded_W_N), Tone::reference, true)};
  force.note = "Open loop, the tip is where the hand means to be; in the hand, the wall pushes it back.";
  section.blocks.emplace_back(std::move(force));

  const double from_s = at_s - close_up_s, to_s = at_s + close_up_s;
  LinePlot close{"What the hand feels, where it is worst", "time [s]", "force on the hand [N]", {}, {}, {}, "", ""};
  close.lines = {between("this device", run.t_s, size_of(run.felt_W_N), from_s, to_s, Tone::rendered),
                 between("an ideal servo", ideal.t_s, size_of(ideal.felt_W_N), from_s, to_s, Tone::reference, true)};
  close.note =
      "The ideal servo is 16 times as fast and without latency: what it shows too is the renderer's own, or the "
      "encoder's.";
  close.half_width = true;
  section.blocks.emplace_back(std::move(close));

  LinePlot way{
      "How far the device is from where the hand means to be", "time [s]", "distance [mm]", {}, {}, {}, "", ""};
  const auto away_mm = [](const LoopTrace& trace) {
    return [&trace](std::size_t i) { return 1e3 * (trace.tip_W_m[i] - trace.intended_W_m[i]).norm(); };
  };
  way.lines = {thinned("this device", run.t_s, away_mm(run), Tone::rendered),
               thinned("an ideal servo", ideal.t_s, away_mm(ideal), Tone::reference, true)};
  way.half_width = true;
  section.blocks.emplace_back(std::move(way));

  LinePlot energy{"Energy since the beginning", "time [s]", "energy [mJ]", {}, {}, {}, "", "time"};
  energy.lines = {
      thinned("by the renderer, through the motors", run.t_s, value_of(run.by_actuator_J, 1e3), Tone::rendered),
      thinned("by the hand", run.t_s, value_of(run.by_hand_J, 1e3), Tone::measured),
      thinned("lost in the device", run.t_s, value_of(run.lost_J, 1e3), Tone::neutral, true)};
  energy.note = "A passive renderer never gives more than it took: its line stays below zero.";
  section.blocks.emplace_back(std::move(energy));
  return section;
}

Table::Cell figure(double value) { return report::number_cell(value, 3); }

Section figures_section(const LoopEvaluation& evaluation) {
  Section section{"Figures", "", {}, false};
  Table table;
  table.caption = "By mass of the device.";
  table.columns = {"mass [kg]",     "verdict",           "buzz [Hz]",     "buzz [N]", "buzz [JND]",
                   "ringing [JND]", "ideal servo [JND]", "encoder [JND]", "kick [N]", "energy given [mJ]",
                   "margin"};
  for (const MassRun& run : evaluation.runs) {
    const servo::Judgement& own = run.judgement;
    Table::Cell verdict = report::text_cell(std::string(name_of(own.verdict)));
    verdict.tone = tone_of(own.verdict);
    table.rows.push_back(
        {{figure(run.device_mass_kg), verdict, figure(own.buzz.frequency_Hz), figure(own.buzz.amplitude_N),
          figure(own.buzz.jnd), figure(own.ringing.jnd), figure(own.own.jnd), figure(own.encoder.jnd),
          figure(own.kick_N), figure(1e3 * own.energy_J), figure(run.stable_margin)},
         "",
         {}});
  }
  section.blocks.emplace_back(std::move(table));
  section.blocks.emplace_back(report::TextBlock{
      "Margin: the renderer's force may be this many times as large and the verdict stays stable. Buzz: what this "
      "servo "
      "adds to an ideal one and does not die away; ringing dies away. Ideal servo: what shakes there too. Encoder: its "
      "steps, felt while the hand moves. JND: just noticeable differences on the scale of vibration of touchstone "
      "perceive."});
  return section;
}

void add_sheet(Table& table, const servo::DataSheet& sheet, const std::vector<servo::FigureEntry>& entries) {
  for (const servo::FigureEntry& entry : entries) {
    const auto found = sheet.figures.find(entry.name);
    const auto none = sheet.not_published.find(entry.name);
    std::string source = none == sheet.not_published.end() ? "" : none->second;
    if (found != sheet.figures.end()) {
      source = found->second.source +
               (found->second.read_in.empty() ? " (from memory, not checked)" : "; read in: " + found->second.read_in);
    }
    table.rows.push_back({{report::text_cell(sheet.name), report::text_cell(std::string(entry.meaning)),
                           found == sheet.figures.end() ? report::number_cell("none") : figure(found->second.value),
                           report::text_cell(std::string(entry.unit)), report::text_cell(source)},
                          "",
                          {}});
  }
}

}  // namespace

Tone tone_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::stable:
      return Tone::good;
    case Verdict::buzzes:
      return Tone::warning;
    case Verdict::unstable:
      return Tone::error;
    case Verdict::cannot_tell:
      return Tone::neutral;
  }
  return Tone::neutral;
}

Section setup_section(const LoopSetup& setup) {
  Section section{fmt::format("Device and hand: {}, {}", setup.device.name, setup.grip.name), "", {}, true};
  const servo::LoopParameters& own = setup.parameters;
  report::Facts facts;
  facts.rows = {
      {"device", setup.device.name},
      {"grip", setup.grip.name},
      {"hand", fmt::format("{:g} kg, {:g} N s/m, {:g} N/m", own.hand_mass_kg, own.axis.hand_damping_N_s_per_m,
                           own.axis.hand_stiffness_N_per_m)},
      {"device's friction", fmt::format("{:g} N s/m and {:g} N", own.axis.damping_N_s_per_m, own.axis.friction_N)},
      {"servo", fmt::format("period {:g} ms, latency {:g} ms, jitter {:g} ms", 1e3 * own.period_s, 1e3 * own.latency_s,
                            1e3 * own.jitter_s)},
      {"position", fmt::format("steps of {:g} um", 1e6 * own.resolution_m)},
      {"force limit", fmt::format("{:g} N", own.force_limit_N)},
      {"virtual damping", fmt::format("{:g} N s/m", own.virtual_damping_N_s_per_m)}};
  for (const std::string& sentence : setup.assumed) facts.rows.emplace_back("assumed", sentence);
  section.blocks.emplace_back(std::move(facts));
  Table table;
  table.caption = "What is published. What --set gave comes before it.";
  table.columns = {"sheet", "figure", "value", "unit", "source"};
  add_sheet(table, setup.device, servo::device_entries());
  add_sheet(table, setup.grip, servo::grip_entries());
  section.blocks.emplace_back(std::move(table));
  return section;
}

Section not_modelled_section() {
  Section section{"What is not in the simulation", "", {}, true};
  section.blocks.emplace_back(
      report::TextBlock{"The mechanism: inertia and friction that change with place and direction, springiness of "
                        "links and cables, gravity, "
                        "backlash, stiction above Coulomb friction. The three axes are equal and independent. The hand "
                        "is one mass, damper "
                        "and spring that do not change; it does nothing on purpose when it feels something. "
                        "The torque of a tool turns nothing: its orientation is the path's. "
                        "A verdict of this page says what these equations do, not what your device does: try it there, "
                        "with a hand on the "
                        "power switch."});
  return section;
}

nlohmann::json to_json(const LoopEvaluation& evaluation, const LoopSetup& setup,
                       const std::optional<RecordedComparison>& recorded) {
  nlohmann::json runs = nlohmann::json::array();
  for (const MassRun& run : evaluation.runs) {
    const servo::Judgement& own = run.judgement;
    runs.push_back({{"device_mass_kg", run.device_mass_kg},
                    {"verdict", name_of(own.verdict)},
                    {"buzz", vibration_json(own.buzz)},
                    {"ringing", vibration_json(own.ringing)},
                    {"ideal_servo", vibration_json(own.own)},
                    {"encoder", vibration_json(own.encoder)},
                    {"kick_N", report::exact_number(own.kick_N)},
                    {"kick_at_s", report::exact_number(own.kick_at_s)},
                    {"energy_J", report::exact_number(own.energy_J)},
                    {"judged_s", report::exact_number(own.judged_s)},
                    {"thrown_out", own.thrown_out},
                    {"limited_share", report::exact_number(own.limited_share)},
                    {"device_felt_N", report::exact_number(own.device_felt_N)},
                    {"stable_margin", report::exact_number(run.stable_margin)}});
  }
  nlohmann::json whole{{"schema", "touchstone-loop/1"},
                       {"verdict", name_of(evaluation.verdict)},
                       {"sentence", evaluation.sentence},
                       {"stable_margin", report::exact_number(evaluation.stable_margin)},
                       {"real_time_factor", report::exact_number(evaluation.real_time_factor)},
                       {"runs", runs},
                       {"device", sheet_json(setup.device)},
                       {"grip", sheet_json(setup.grip)},
                       {"assumed", setup.assumed}};
  if (recorded) {
    whole["recording"] = {{"agrees", recorded->agrees},
                          {"sentence", recorded->sentence},
                          {"device_mass_kg", recorded->device_mass_kg},
                          {"shift_s", recorded->shift_s},
                          {"compared_s", recorded->compared_s},
                          {"motion_m", recorded->motion_m},
                          {"difference_m", recorded->difference_m},
                          {"force_N", recorded->force_N},
                          {"difference_N", recorded->difference_N},
                          {"difference_jnd", recorded->difference_jnd},
                          {"recorded", vibration_json(recorded->recorded)},
                          {"simulated", vibration_json(recorded->simulated)}};
  }
  return whole;
}

report::Page loop_page(const LoopEvaluation& evaluation, const LoopSetup& setup,
                       const std::optional<RecordedComparison>& recorded, const report::Provenance& provenance) {
  const servo::Judgement& worst = evaluation.worst().judgement;
  report::Page page;
  page.title = "Will it buzz?";
  page.subtitle = fmt::format("{} in a {} grip. {}", setup.device.name, setup.grip.name, evaluation.sentence);
  page.headlines = {
      {"verdict", std::string(name_of(evaluation.verdict)), "", "", tone_of(evaluation.verdict)},
      {"buzz", fmt::format("{:.2g}", worst.buzz.amplitude_N), "N",
       fmt::format("at {:.0f} Hz, {:.2g} JND", worst.buzz.frequency_Hz, worst.buzz.jnd), tone_of(evaluation.verdict)},
      {"kick at contact", fmt::format("{:.2g}", worst.kick_N), "N", "beyond what an ideal servo gives", Tone::neutral},
      {"margin", fmt::format("{:.2g}", evaluation.stable_margin), "times", "the force may be as large and stay stable",
       evaluation.stable_margin >= 2.0 ? Tone::good : Tone::warning}};
  page.sections = {pictures(evaluation), figures_section(evaluation), setup_section(setup), not_modelled_section(),
                   provenance_section(provenance)};
  if (recorded) {
    Section section{"Beside the recording", "", {}, false};
    section.blocks.emplace_back(report::TextBlock{recorded->sentence, recorded->agrees ? Tone::good : Tone::warning});
    page.sections.insert(page.sections.begin(), section);
  }
  return page;
}

}  // namespace touchstone::loop
