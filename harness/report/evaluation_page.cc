#include "harness/report/evaluation_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/report/metric_json.h"
#include "harness/report/quantity.h"

namespace touchstone::report {
using metrics::MetricResult;
using metrics::MetricStatus;
using metrics::Series;

namespace {

constexpr const char* time_link = "time";
constexpr const char* time_label = "time [s]";
constexpr std::size_t listed_episodes = 12;

const MetricResult* find(const std::vector<MetricResult>& metrics, std::string_view name) {
  const auto found = std::ranges::find(metrics, name, &MetricResult::name);
  return found == metrics.end() ? nullptr : &*found;
}

const Series* find(const std::vector<Series>& signals, std::string_view name) {
  const auto found = std::ranges::find(signals, name, &Series::name);
  return found == signals.end() ? nullptr : &*found;
}

double largest(const Series& series) {
  double most = 0.0;
  for (const double value : series.value) {
    if (std::isfinite(value)) most = std::max(most, std::abs(value));
  }
  return most;
}

std::string reduction_note(const Series& series) {
  if (series.samples_per_pair <= 1) return "";
  return fmt::format("{} samples, drawn as the minimum and the maximum of every {}: no peak is left out.",
                     series.samples, series.samples_per_pair);
}

Headline headline(const EvaluationResult& result, std::string_view name, std::string label, Tone tone,
                  const std::string& note) {
  Headline out{std::move(label), "-", "", note, tone};
  const MetricResult* const metric = find(result.metrics, name);
  if (metric == nullptr || metric->status != MetricStatus::ok) {
    out.note = metric == nullptr ? "not chosen" : fmt::format("{}: {}", status_name(metric->status), metric->note);
    out.tone = Tone::warning;
    return out;
  }
  const DisplayUnit unit = display_unit(metric->unit, metric->value);
  out.value = display_number(metric->value * unit.factor);
  out.unit = unit.name == "1" ? "" : unit.name;
  if (metric->reference) {
    out.note =
        fmt::format("{}{} {}", note.empty() ? "" : note + " ", display_quantity(*metric->reference, metric->unit),
                    metric->reference_meaning.substr(0, metric->reference_meaning.find(':')));
  }
  return out;
}

std::vector<Headline> headlines(const EvaluationResult& result) {
  return {headline(result, "rms_force_error", "RMS force error", Tone::error, "against"),
          headline(result, "mean_force_error", "Mean force error, equation 3", Tone::error, "against"),
          headline(result, "mean_force_angle_error", "Mean angle of the force", Tone::error,
                   "0 deg: same direction as measured"),
          headline(result, "rms_position_error", "RMS position error", Tone::measured, "of the surface contact point"),
          headline(result, "median_step_cost", "Median cost of a step", Tone::rendered, "on this machine")};
}

Section force_section(const EvaluationResult& result) {
  Section section{
      "Force over time",
      "The force on the probe along each axis of the object's frame: what the sensor measured and what the "
      "renderer answered at the same instants. Drag to zoom; all plots over time move together; double-click "
      "to see everything again.",
      {},
      false};
  for (const char* const axis : {"x", "y", "z"}) {
    const Series* const measured = find(result.signals, fmt::format("measured_{}", axis));
    const Series* const rendered = find(result.signals, fmt::format("rendered_{}", axis));
    if (rendered == nullptr) continue;
    const DisplayUnit unit = display_unit("N", std::max(measured ? largest(*measured) : 0.0, largest(*rendered)));
    LinePlot plot{fmt::format("Force along {}", axis),
                  time_label,
                  fmt::format("F{} [{}]", axis, unit.name),
                  {},
                  {},
                  {},
                  reduction_note(*rendered),
                  time_link,
                  230,
                  false};
    if (measured != nullptr) plot.lines.push_back(line_of(*measured, "measured", Tone::measured, unit.factor));
    plot.lines.push_back(line_of(*rendered, "rendered", Tone::rendered, unit.factor));
    section.blocks.emplace_back(std::move(plot));
  }
  return section;
}

void add_error_plot(Section& section, const MetricResult* metric, std::string title, double threshold) {
  if (metric == nullptr || !metric->series) return;
  const DisplayUnit unit = display_unit(metric->unit, largest(*metric->series));
  LinePlot plot{std::move(title),
                time_label,
                fmt::format("error [{}]", unit.name),
                {},
                {},
                {},
                reduction_note(*metric->series),
                time_link,
                230,
                false};
  plot.lines.push_back(line_of(*metric->series, metric->series->name, Tone::error, unit.factor));
  if (threshold > 0.0 && threshold <= 3.0 * largest(*metric->series)) {
    plot.levels.emplace_back(fmt::format("threshold {}", display_setting(threshold, metric->unit)),
                             threshold * unit.factor);
  }
  section.blocks.emplace_back(std::move(plot));
}

void add_histogram(Section& section, const MetricResult* metric, std::string title) {
  if (metric == nullptr || !metric->histogram || !(metric->histogram->width > 0.0)) return;
  const metrics::Histogram& histogram = *metric->histogram;
  const DisplayUnit unit = display_unit(histogram.unit, histogram.width * static_cast<double>(histogram.counts.size()));
  BarPlot plot{std::move(title),
               fmt::format("[{}]", unit.name),
               "samples",
               0.0,
               histogram.width * unit.factor,
               {},
               true,
               "",
               240,
               true};
  plot.heights.assign(histogram.counts.begin(), histogram.counts.end());
  plot.note = fmt::format("{} samples in bars {} wide; the count is logarithmic, so that rare large errors show.",
                          histogram.total(), display_setting(histogram.width, histogram.unit));
  section.blocks.emplace_back(std::move(plot));
}

Section error_section(const EvaluationResult& result) {
  Section section{
      "Error over time and its distribution",
      "The force error is the length of the difference between the two force vectors; the position error is "
      "the distance between the rendered surface contact point and the out-trajectory, where the real probe was.",
      {},
      false};
  const MetricResult* const force = find(result.metrics, "rms_force_error");
  const MetricResult* const position = find(result.metrics, "rms_position_error");
  add_error_plot(section, force, "Force error", result.force_threshold_N);
  add_error_plot(section, position, "Position error", result.position_threshold_m);
  add_histogram(section, force, "How often which force error");
  add_histogram(section, position, "How often which position error");
  return section;
}

// Would a person notice the error, where, when, and as what?
Section noticed_section(const EvaluationResult& result) {
  Section section{"Would a person notice?",
                  "Force errors in just noticeable differences (JND) of the measured force. More than one is noticed. "
                  "What else gives a rendering away (vibration, delay, direction) says touchstone perceive.",
                  {},
                  false};
  const MetricResult* const share = find(result.metrics, "noticeable_share");
  if (share == nullptr || share->status != MetricStatus::ok) return section;
  section.blocks.emplace_back(
      TextBlock{fmt::format("{:.0f} % of the scan: {}.", 100.0 * share->value,
                            share->note.empty() ? "no force error can be noticed" : share->note),
                share->value > 0.0 ? Tone::warning : Tone::good});
  add_error_plot(section, find(result.metrics, "rms_force_error_jnd"), "Force error as it is felt", 1.0);
  const std::vector<double>& noticed = result.object.noticed_share;
  if (std::ranges::any_of(noticed, [](double v) { return std::isfinite(v); })) {
    Scene scene = object_scene(result.object, result.path_W_m, {});
    scene.title = "Where a person would notice the error";
    scene.value_label = "share of the contact there [%]";
    scene.values.clear();
    for (const double value : noticed) scene.values.push_back(100.0 * value);
    section.blocks.emplace_back(std::move(scene));
  }
  return section;
}

// The zoom leaves as much room on either side as the episode is long, and at least some samples.
std::pair<double, double> zoom_of(const metrics::Episode& episode) {
  const double margin = std::max(episode.end_s - episode.start_s, 0.05);
  return {episode.start_s - margin, episode.end_s + margin};
}

void add_episodes(Section& section, const EvaluationResult& result, const std::string& of, double threshold,
                  const std::string& unit) {
  Table table{fmt::format("Worst {} errors over {}", of, display_setting(threshold, unit)),
              {"worst error", "at", "from", "lasted", "where (x, y, z)"},
              {},
              time_link};
  for (const EpisodeView& view : result.episodes) {
    if (view.of != of || table.rows.size() == listed_episodes) continue;
    const metrics::Episode& e = view.episode;
    const DisplayUnit length = display_unit("m", e.worst_W_m.cwiseAbs().maxCoeff());
    const Vec3 where = e.worst_W_m * length.factor;
    table.rows.push_back(
        {{{display_quantity(e.worst, unit), true},
          {fmt::format("{:.4f} s", e.worst_t_s), true},
          {fmt::format("{:.4f} s", e.start_s), true},
          {display_quantity(e.end_s - e.start_s, "s"), true},
          {fmt::format("{:.3f}, {:.3f}, {:.3f} {}", where.x(), where.y(), where.z(), length.name), true}},
         "",
         zoom_of(e)});
  }
  if (table.rows.empty()) {
    section.blocks.emplace_back(
        TextBlock{fmt::format("No {} error exceeds {}.", of, display_setting(threshold, unit)), Tone::good});
    return;
  }
  section.blocks.emplace_back(std::move(table));
}

void add_close_ups(Section& section, const EvaluationResult& result) {
  for (const EpisodeView& view : result.episodes) {
    if (view.signals.empty()) continue;
    double most = 0.0;
    for (const Series& signal : view.signals) most = std::max(most, largest(signal));
    const DisplayUnit unit = display_unit(view.signals.front().unit, most);
    LinePlot plot{fmt::format("{} error of {} at {:.3f} s", view.of == "force" ? "Force" : "Position",
                              display_quantity(view.episode.worst, view.unit), view.episode.worst_t_s),
                  time_label,
                  fmt::format("[{}]", unit.name),
                  {},
                  {},
                  {{view.episode.start_s, view.episode.end_s}},
                  "",
                  "",
                  250,
                  true};
    for (const Series& signal : view.signals) {
      const Tone tone = signal.name.starts_with("measured")   ? Tone::measured
                        : signal.name.starts_with("rendered") ? Tone::rendered
                                                              : Tone::error;
      plot.lines.push_back(line_of(signal, signal.name, tone, unit.factor));
    }
    section.blocks.emplace_back(std::move(plot));
  }
}

Section episode_section(const EvaluationResult& result) {
  Section section{
      "Worst episodes",
      "Parts where the error stays above a threshold: the problematic places that a mean hides. \"show\" zooms "
      "the plots over time to the episode; the close-ups below have every sample, the shaded part is over the "
      "threshold.",
      {},
      false};
  if (find(result.metrics, "force_episodes") != nullptr)
    add_episodes(section, result, "force", result.force_threshold_N, "N");
  if (find(result.metrics, "position_episodes") != nullptr)
    add_episodes(section, result, "position", result.position_threshold_m, "m");
  add_close_ups(section, result);
  return section;
}

Section cost_section(const EvaluationResult& result) {
  Section section{
      "Cost of a step",
      "The time that the renderer took for each step, on the machine that made this report: it compares renderers "
      "within one run, not across machines. A 1 kHz servo loop has 1000 us for everything.",
      {},
      false};
  const MetricResult* const cost = find(result.metrics, "mean_step_cost");
  if (cost == nullptr || !cost->series) return section;
  const DisplayUnit unit = display_unit("us", largest(*cost->series));
  LinePlot plot{"Cost over time",
                time_label,
                fmt::format("[{}]", unit.name),
                {},
                {},
                {},
                reduction_note(*cost->series),
                time_link,
                240,
                true};
  plot.lines.push_back(line_of(*cost->series, "cost", Tone::rendered, unit.factor));
  section.blocks.emplace_back(std::move(plot));
  add_histogram(section, cost, "How often which cost");
  return section;
}

}  // namespace

Line line_of(const Series& series, std::string name, Tone tone, double factor) {
  Line line{std::move(name), series.t_s, series.value, tone, false, false};
  for (double& value : line.y) value *= factor;
  return line;
}

Table metrics_table(const std::vector<MetricResult>& metrics) {
  Table table{"", {"metric", "value", "to hold it against"}, {}, ""};
  for (const MetricResult& metric : metrics) {
    const bool ok = metric.status == MetricStatus::ok;
    std::string detail = metric.meaning;
    if (metric.t_s) detail += fmt::format(" At t = {:.4f} s.", *metric.t_s);
    if (!metric.note.empty()) detail += fmt::format(" ({})", metric.note);
    std::string reference;
    if (metric.reference) {
      reference = fmt::format("{} ({})", display_quantity(*metric.reference, metric.unit),
                              metric.reference_meaning.substr(0, metric.reference_meaning.find(':')));
    }
    table.rows.push_back({{{metric.name},
                           {ok ? display_quantity(metric.value, metric.unit) : status_name(metric.status), true,
                            ok ? Tone::neutral : Tone::warning},
                           {reference}},
                          detail,
                          std::nullopt});
  }
  return table;
}

Section provenance_section(const Provenance& provenance) {
  Section section{"Provenance",
                  "What this was made from: with the same inputs, version and command the numbers are the same.",
                  {},
                  false};
  Table inputs{"Inputs", {"what", "file", "bytes", "SHA-256"}, {}, ""};
  for (const InputFile& input : provenance.inputs) {
    inputs.rows.push_back(
        {{{input.role}, {input.name}, {fmt::format("{}", input.bytes), true}, {input.sha256}}, "", std::nullopt});
  }
  if (!inputs.rows.empty()) section.blocks.emplace_back(std::move(inputs));
  const BuildInfo& build = provenance.build;
  section.blocks.emplace_back(Facts{{{"Command", provenance.command},
                                     {"Made", provenance.created_utc},
                                     {"Touchstone", build.version},
                                     {"Commit", build.commit + (build.dirty ? " with uncommitted changes" : "")},
                                     {"Compiler", build.compiler},
                                     {"Build", fmt::format("{} ({})", build.build_type, build.flags)}}});
  return section;
}

Scene object_scene(const ObjectView& object, const std::vector<Vec3>& path_W_m,
                   const std::vector<EpisodeView>& episodes) {
  Box3 box;
  for (const Vec3& v : object.vertices_W_m) box.extend(v);
  for (const Vec3& p : path_W_m) box.extend(p);
  const DisplayUnit length = display_unit("m", box.isEmpty() ? 0.0 : box.sizes().maxCoeff());
  double most = 0.0;
  for (const double value : object.error) most = std::isfinite(value) ? std::max(most, value) : most;
  const DisplayUnit unit = display_unit(object.error_unit, most);
  Scene scene;
  scene.title = fmt::format("Mean {} on the object", object.error_name);
  scene.unit = length.name;
  scene.triangles = object.triangles;
  scene.value_label = fmt::format("{} [{}]", object.error_name, unit.name);
  scene.note = "Grey: not touched. The line is the out-trajectory, where the real probe was. " + object.note;
  for (const Vec3& v : object.vertices_W_m) scene.vertices.push_back(v * length.factor);
  for (const double value : object.error) scene.values.push_back(value * unit.factor);
  Scene::Path path{"out-trajectory", {}, Tone::neutral};
  for (const Vec3& p : path_W_m) path.points.push_back(p * length.factor);
  scene.paths.push_back(std::move(path));
  for (const EpisodeView& view : episodes) {
    if (scene.marks.size() == listed_episodes) break;
    scene.marks.push_back({view.episode.worst_W_m * length.factor,
                           fmt::format("{} error {} at {:.3f} s", view.of,
                                       display_quantity(view.episode.worst, view.unit), view.episode.worst_t_s)});
  }
  return scene;
}

Page evaluation_page(const EvaluationResult& result) {
  Page page;
  page.title = result.title;
  page.subtitle =
      "A measured probe trajectory was replayed through a haptic renderer; forces, positions and cost are held "
      "against what was measured.";
  page.headlines = headlines(result);
  Section what{"What was evaluated", "", {}, false};
  for (const std::string& message : result.messages) what.blocks.emplace_back(TextBlock{message, Tone::warning});
  what.blocks.emplace_back(Facts{result.settings});
  page.sections.push_back(std::move(what));
  page.sections.push_back(force_section(result));
  if (!result.object.vertices_W_m.empty()) {
    page.sections.push_back({"Where on the object",
                             "Turn it with the mouse, zoom with the wheel.",
                             {object_scene(result.object, result.path_W_m, result.episodes)},
                             false});
  }
  page.sections.push_back(noticed_section(result));
  page.sections.push_back(error_section(result));
  page.sections.push_back(episode_section(result));
  page.sections.push_back({"All metrics", "", {metrics_table(result.metrics)}, false});
  page.sections.push_back(cost_section(result));
  page.sections.push_back(
      {"Model", "The renderer with its parameters, as every command reads it.", {Code{"", result.model}}, false});
  page.sections.push_back(provenance_section(result.provenance));
  std::erase_if(page.sections, [](const Section& section) { return section.blocks.empty(); });
  page.footer = fmt::format(
      "Touchstone {}. Metrics after Ruffaldi, Morris, Edmunds, Barbagli and Pai, \"Standardized "
      "evaluation of haptic rendering systems\", 2006.",
      result.provenance.build.version);
  return page;
}

}  // namespace touchstone::report
