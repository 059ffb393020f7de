#include "harness/pipeline/discrepancy/page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "harness/discrepancy/effect_library.h"
#include "harness/discrepancy/model_edit.h"
#include "harness/rendering/model.h"
#include "harness/rendering/smooth_field.h"
#include "harness/rendering/surface_frame.h"

namespace touchstone::pipeline {
using discrepancy::Evidence;
using discrepancy::Findings;
using discrepancy::FindingsVerdict;
using discrepancy::FoundEffect;
using rendering::Prediction;
using report::Code;
using report::Line;
using report::LinePlot;
using report::Scene;
using report::Section;
using report::Table;
using report::TextBlock;
using report::Tone;
using surface::TriangleMesh;

namespace {

constexpr std::size_t most_plotted = 4000;

Table::Cell text(std::string value, Tone tone = Tone::neutral) { return {std::move(value), false, tone}; }
Table::Cell number(double value, const char* format = "{:.4g}") {
  return {fmt::format(fmt::runtime(format), value), true, Tone::neutral};
}

Tone tone_of(FindingsVerdict verdict) {
  return verdict == FindingsVerdict::consistent || verdict == FindingsVerdict::explained ? Tone::good : Tone::warning;
}

// Whether data that chose nothing agree with what was chosen.
Table held_out_table(const Findings& findings) {
  Table table{
      "What the held-out data say of each effect: the chi-squared that leaving it out costs there, the rest refitted",
      {"effect", "cost", "+-", "verdict"},
      {},
      ""};
  constexpr double clear = 2.0;  // standard errors, as in `contradicted`
  for (const FoundEffect& effect : findings.search.found) {
    const bool confirmed = effect.holdout_gain > clear * effect.holdout_error;
    table.rows.push_back(
        {{text(effect.name), number(effect.holdout_gain, "{:.0f}"), number(effect.holdout_error, "{:.0f}"),
          effect.contradicted() ? text("contradicted: better without it", Tone::warning)
          : confirmed           ? text("confirmed", Tone::good)
                                : text("cannot tell")},
         "",
         {}});
  }
  return table;
}

Table gates_table(const Findings& findings) {
  Table gates{"What decides the verdict: the first gate that is not passed",
              {"gate", "of what the model leaves", "value", "limit", "the limit is from", "passed"},
              {},
              ""};
  for (const discrepancy::VerdictGate& gate : findings.gates) {
    gates.rows.push_back(
        {{text(std::string(gate.code)), text(gate.statistic), number(gate.value), number(gate.limit),
          text(gate.limit_from), text(gate.passed ? "yes" : "no", gate.passed ? Tone::neutral : Tone::warning)},
         "",
         {}});
  }
  return gates;
}

Section what_section(const Findings& findings) {
  Section section{"What is missing", findings.explanation, {}, false};
  if (findings.search.data_fault) {
    section.blocks.emplace_back(TextBlock{
        fmt::format("A fault of the data: {}. Correct the recording and search again; what the tables below say of the "
                    "error stands, but nothing is learnt from it.",
                    *findings.search.data_fault),
        Tone::error});
  }
  if (!findings.search.found.empty()) {
    Table table{"Effects added, with 95 % intervals",
                {"effect", "belongs to", "parameter", "value", "interval", "unit"},
                {},
                ""};
    for (std::size_t e = 0; e < findings.search.found.size(); ++e) {
      const FoundEffect& effect = findings.search.found[e];
      for (const discrepancy::FoundParameter& p : findings.parameters[e]) {
        table.rows.push_back({{text(effect.name),
                               text(effect.side == rendering::Side::contact ? "the contact" : "the instrument"),
                               text(p.name),
                               number(p.value, "{:.5g}"),
                               {!p.undetermined.empty() ? "not determined"
                                : p.low95 == p.high95   ? "held fixed"
                                                        : fmt::format("{:.4g} to {:.4g}", p.low95, p.high95),
                                true, Tone::neutral},
                               text(p.unit)},
                              !p.undetermined.empty() ? "Not determined: " + p.undetermined + "."
                              : p.at_bound ? "At the bound of what is physical or of what this recording can show."
                                           : "",
                              {}});
      }
    }
    section.blocks.emplace_back(std::move(table));
    section.blocks.emplace_back(held_out_table(findings));
    for (const FoundEffect& effect : findings.search.found) {
      Table rivals{
          fmt::format("In place of {} (held-out RMS {:.4g} N): what else was tried, nearest first; chi-squared "
                      "counts squared errors in units of the noise",
                      effect.name, findings.gap.holdout_after_N),
          {"rival", "worse by, in validation chi-squared", "+-", "validation RMS [N]", "why it lost"},
          {},
          ""};
      for (const discrepancy::Rival& rival : effect.rivals) {
        if (rivals.rows.size() == 6) break;
        const std::string why = rival.indistinguishable ? "did not lose: explains the data equally well"
                                : rival.contains_found  ? "contains it, and does no better"
                                : rival.validation_gain_lost > 0.9 * effect.validation_gain
                                    ? "explains next to nothing of it"
                                : rival.validation_gain_lost < 0.0 ? "not clearly better"
                                                                   : "explains less";
        rivals.rows.push_back(
            {{text(rival.name), number(rival.validation_gain_lost, "{:.0f}"), number(rival.error, "{:.0f}"),
              number(rival.validation_rms_N), text(why, rival.indistinguishable ? Tone::warning : Tone::neutral)},
             "",
             {}});
      }
      section.blocks.emplace_back(std::move(rivals));
    }
  }
  if (findings.next && !findings.ambiguous.empty()) {
    section.blocks.emplace_back(TextBlock{
        fmt::format(
            "To tell {} apart, record the motion in next.csv ({}): there the explanations differ by {:.1f} times the "
            "noise.",
            fmt::join(findings.ambiguous.front(), " from "), findings.next->what, findings.next->separation),
        Tone::warning});
  }
  section.blocks.emplace_back(gates_table(findings));
  return section;
}

// From the error before to the residual, part by part.
Section gap_section(const Findings& findings) {
  Section section{
      "What closes the gap",
      "The held-out mean square of the force error, shared among what was changed: for each part the mean of "
      "what it takes away over all orders in which the parts can be added (Shapley's value). A part below "
      "zero only makes up for another one.",
      {},
      false};
  Table table{
      "From the starting model to the final one", {"part", "share of the disagreement", "RMS left [N]"}, {}, ""};
  table.rows.push_back({{text("starting model"), text(""), number(findings.gap.holdout_before_N)}, "", {}});
  for (const discrepancy::GapShare& share : findings.shares) {
    table.rows.push_back({{text(share.name), number(100.0 * share.share, "{:.1f} %"), number(share.left_N)}, "", {}});
  }
  table.rows.push_back({{text("of which noise gives"), text(""), number(findings.gap.noise_floor_N)}, "", {}});
  LinePlot fall;
  fall.title = "What is left, part by part";
  fall.x_label = "";
  fall.y_label = "held-out RMS [N]";
  Line left{"left", {}, {}, Tone::error, false, false};
  const auto stair = [&](const std::string& name, double rms_N) {
    const auto place = static_cast<double>(fall.x_names.size());
    fall.x_names.emplace_back(place, name);
    for (const double side : {-0.5, 0.5}) {
      left.x.push_back(place + side);
      left.y.push_back(rms_N);
    }
  };
  stair("starting model", findings.gap.holdout_before_N);
  for (const discrepancy::GapShare& share : findings.shares) stair(share.name, share.left_N);
  fall.lines = {std::move(left)};
  fall.levels = {{"noise", findings.gap.noise_floor_N}};
  section.blocks.emplace_back(std::move(fall));
  section.blocks.emplace_back(std::move(table));
  return section;
}

Section where_section(const Findings& findings) {
  Section section{
      "Where they disagree",
      "RMS of the force error on held-out data, of the starting model and of the final one. The share is that "
      "of the starting model's squared error among the rows of the same kind: they sum to 100 %.",
      {},
      false};
  Table table{"Held-out error by regime",
              {"by", "regime", "samples", "before [N]", "its 95 % [+- N]", "after [N]", "share of error before"},
              {},
              ""};
  for (const discrepancy::Regime& regime : findings.where) {
    table.rows.push_back({{text(to_string(regime.kind)),
                           text(regime.name),
                           {fmt::format("{}", regime.samples), true, Tone::neutral},
                           number(regime.before_N),
                           number(regime.error95_N),
                           number(regime.after_N),
                           number(100.0 * regime.share_before, "{:.0f} %")},
                          "",
                          {}});
  }
  section.blocks.emplace_back(std::move(table));
  return section;
}

// Lines and bands that means over blocks cannot show.
Section spectrum_section(const Findings& findings) {
  const discrepancy::ResidualSpectrum& spectrum = findings.search.spectrum;
  Section section{
      "Lines and bands of the residual",
      fmt::format("From {:.3g} to {:.4g} Hz the held-out residual of the final model is {:.3g} N RMS; where "
                  "only noise remains, simulated recordings show at most {:.3g} N.",
                  spectrum.from_Hz, spectrum.to_Hz, spectrum.raw_N, spectrum.null_N),
      {},
      spectrum.peaks.empty()};
  if (spectrum.peaks.empty()) return section;
  Table table{fmt::format("What stands out of the noise in {}",
                          findings.blocks_held_back ? "the recording" : "both recordings"),
              {"what", "frequency [Hz]", "width [Hz]", "RMS [N]", "acts", "false alarm, at most"},
              {},
              ""};
  for (const discrepancy::SpectralPeak& peak : spectrum.peaks) {
    table.rows.push_back({{text(peak.name), number(peak.frequency_Hz, "{:.4g}"), number(peak.width_Hz, "{:.2g}"),
                           number(peak.rms_N, "{:.3g}"), text(to_string(peak.acts)),
                           text(fmt::format("10^{:.0f}", std::floor(peak.log10_false_alarm)))},
                          "",
                          {}});
  }
  section.blocks.emplace_back(std::move(table));
  return section;
}

Section time_section(const Evidence& evidence, const Prediction& before, const Prediction& after) {
  const recording::Recording& recording = *evidence.recording;
  const std::size_t stride = std::max<std::size_t>(1, recording.size() / most_plotted);
  Section section{"Over time", "", {}, false};
  for (int axis = 0; axis < 3; ++axis) {
    Line measured{"measured", {}, {}, Tone::measured, false, false};
    Line old_model{"before", {}, {}, Tone::reference, true, false};
    Line new_model{"after", {}, {}, Tone::rendered, false, false};
    for (std::size_t i = 0; i < recording.size(); i += stride) {
      const double t_s = recording.motion.t_s[i];
      for (Line* line : {&measured, &old_model, &new_model}) line->x.push_back(t_s);
      measured.y.push_back(recording.f_W_N[i][axis]);
      old_model.y.push_back(before.f_W_N[i][axis]);
      new_model.y.push_back(after.f_W_N[i][axis]);
    }
    LinePlot plot;
    plot.title = fmt::format("Force along {}", "xyz"[axis]);
    plot.x_label = "time [s]";
    plot.y_label = fmt::format("f{} [N]", "xyz"[axis]);
    plot.lines = {measured, old_model, new_model};
    plot.link = "time";
    section.blocks.emplace_back(std::move(plot));
  }
  Line old_error{"before", {}, {}, Tone::reference, true, false};
  Line new_error{"after", {}, {}, Tone::error, false, false};
  for (std::size_t i = 0; i < recording.size(); i += stride) {
    for (Line* line : {&old_error, &new_error}) line->x.push_back(recording.motion.t_s[i]);
    old_error.y.push_back((recording.f_W_N[i] - before.f_W_N[i]).norm());
    new_error.y.push_back((recording.f_W_N[i] - after.f_W_N[i]).norm());
  }
  LinePlot plot;
  plot.title = "Force error";
  plot.x_label = "time [s]";
  plot.y_label = "|error| [N]";
  plot.lines = {old_error, new_error};
  plot.link = "time";
  section.blocks.emplace_back(std::move(plot));
  return section;
}

// The starting model's error at the vertices near the path.
Section place_section(const Evidence& evidence, const Prediction& before, const TriangleMesh& mesh) {
  const recording::Recording& recording = *evidence.recording;
  Scene scene;
  scene.title = "The starting model's error on the object";
  scene.unit = "m";
  scene.vertices = mesh.vertices_W_m;
  scene.triangles = mesh.triangles;
  scene.value_label = "|error| [N]";
  std::vector<double> sum(mesh.vertices_W_m.size(), 0.0);
  std::vector<double> weight(mesh.vertices_W_m.size(), 0.0);
  const double reach_m = 0.04 * mesh.bounds().diagonal().norm();
  Scene::Path path{"tip", {}, Tone::measured};
  const std::size_t stride = std::max<std::size_t>(1, recording.size() / 1500);
  for (std::size_t i = 0; i < recording.size(); i += stride) {
    const Vec3& p = recording.motion.p_W_m[i];
    path.points.push_back(p);
    if (before.n_W[i].isZero()) continue;
    const double error = (recording.f_W_N[i] - before.f_W_N[i]).norm();
    for (std::size_t v = 0; v < sum.size(); ++v) {
      const double distance = (mesh.vertices_W_m[v] - p).norm();
      if (distance > reach_m) continue;
      const double w = std::exp(-8.0 * distance * distance / (reach_m * reach_m));
      sum[v] += w * error;
      weight[v] += w;
    }
  }
  for (std::size_t v = 0; v < sum.size(); ++v) {
    scene.values.push_back(weight[v] > 0.0 ? sum[v] / weight[v] : std::numeric_limits<double>::quiet_NaN());
  }
  scene.paths.push_back(std::move(path));
  return {"On the object", "", {std::move(scene)}, false};
}

// The found fields at the vertices near the path.
std::optional<Section> field_section(const Findings& findings, const std::vector<rendering::Candidate>& candidates,
                                     const Evidence& evidence, const TriangleMesh& mesh) {
  const discrepancy::EffectLibrary library(candidates);
  Section section{"Fields over the surface",
                  "What differs over the surface, where the tip has been. Elsewhere the field is a continuation of its "
                  "neighbourhood.",
                  {},
                  false};
  const auto& path = evidence.recording->motion.p_W_m;
  const std::size_t stride = std::max<std::size_t>(1, path.size() / 3000);
  const double reach_m = 0.03 * mesh.bounds().diagonal().norm();
  for (const FoundEffect& effect : findings.search.found) {
    const rendering::NamedParameters& entry = *discrepancy::find_entry(findings.search.model, effect.name);
    if (!rendering::is_field(entry.parameters)) continue;
    const rendering::SmoothField field = rendering::field_of(entry.parameters, entry.place);
    const rendering::SurfaceFrame frame = rendering::frame_of(entry.parameters);
    const rendering::EffectTraits& traits = library.traits(effect.name);
    const bool height = traits.surface == rendering::EffectTraits::Surface::higher_by_field;
    Scene scene;
    scene.title = traits.map_title;
    scene.unit = "m";
    scene.vertices = mesh.vertices_W_m;
    scene.triangles = mesh.triangles;
    scene.value_label = height ? "height [mm]" : "factor";
    for (const Vec3& vertex : mesh.vertices_W_m) {
      bool near = false;
      for (std::size_t i = 0; i < path.size() && !near; i += stride) near = (path[i] - vertex).norm() < reach_m;
      const Vec3 place_m = frame.place(vertex);
      const double value = field.at(place_m.x(), place_m.y());
      scene.values.push_back(!near ? std::numeric_limits<double>::quiet_NaN() : height ? 1e3 * value : std::exp(value));
    }
    section.blocks.emplace_back(std::move(scene));
  }
  if (section.blocks.empty()) return std::nullopt;
  return section;
}

// What the residual follows, where nothing in the library explains it.
std::optional<Section> law_section(const Findings& findings) {
  if (!findings.law) return std::nullopt;
  const discrepancy::UnknownLaw& law = findings.search.law;
  Section section{
      "An empirical law for what is missing",
      fmt::format(
          "Found in the recording: it says what the force follows ({}), not why. It is no physics, and holds within "
          "the ranges below alone. Held out, the error falls from {:.4g} N with the effects above to {:.4g} N with "
          "the law; of the square that the starting model leaves beyond noise, its stiffness refitted, {:.0f} % is "
          "gone.",
          law_follows(law), findings.law->without_N, findings.law->with_N, 100.0 * findings.law->closed),
      {},
      false};
  std::string formulas;
  for (const std::string& line : law_formulas(law)) formulas += line + "\n";
  section.blocks.emplace_back(Code{"formulas (units: SI)", formulas});
  Table values{"Its values", {"piece", "parameter", "value", "unit", "what it is"}, {}, ""};
  for (const discrepancy::LawPiece& piece : law.pieces) {
    for (const rendering::ParameterDeclaration& p : piece.effect->parameters) {
      values.rows.push_back(
          {{text(piece.effect->summary), text(p.name), number(p.initial), text(p.unit), text(p.meaning)}, "", {}});
    }
  }
  section.blocks.emplace_back(std::move(values));
  Table ranges{"Seen in the recording: beyond, the law is a guess", {"variable", "from", "to", "unit"}, {}, ""};
  for (const discrepancy::SeenRange& range : law.seen)
    ranges.rows.push_back({{text(range.variable), number(range.low), number(range.high), text(range.unit)}, "", {}});
  section.blocks.emplace_back(std::move(ranges));
  if (!law.needless.empty()) {
    section.blocks.emplace_back(TextBlock{
        fmt::format("Beside the law these are not needed: {}.", fmt::join(law.needless, ", ")), Tone::warning});
  }
  section.blocks.emplace_back(Code{"empirical.json", model_to_json(law.model)});
  return section;
}

Section search_section(const Findings& findings) {
  Section section{"How the search went",
                  "Gains are of chi-squared over blocks, where a law is weighed against one that it contains of -2 ln "
                  "likelihood on the smoothed trajectory; the gain on the validation blocks decides.",
                  {},
                  true};
  std::size_t count = 0;
  for (const discrepancy::SearchStep& step : findings.search.steps) {
    Table table{fmt::format("Step {}: from a validation RMS of {:.4g} N{}", ++count, step.validation_rms_N,
                            step.added.empty()     ? ", nothing added"
                            : step.removed.empty() ? fmt::format(", {} added", step.added)
                                                   : fmt::format(", {} in place of {}", step.added, step.removed)),
                {"candidate", "training gain", "validation gain", "validation RMS [N]", "verdict"},
                {},
                ""};
    for (const discrepancy::Trial& trial : step.trials) {
      table.rows.push_back(
          {{text(trial.title()), number(trial.train_gain, "{:.0f}"), number(trial.validation_gain, "{:.0f}"),
            number(trial.validation_rms_N), text(trial.verdict.words)},
           "",
           {}});
    }
    section.blocks.emplace_back(std::move(table));
  }
  return section;
}

}  // namespace

report::Page discrepancy_page(const Findings& findings, const std::vector<rendering::Candidate>& candidates,
                              const Evidence& evidence, const Prediction& before, const Prediction& after,
                              const TriangleMesh& mesh, const report::Provenance& provenance) {
  report::Page page;
  page.title = "Where simulation and measurement disagree";
  page.subtitle =
      fmt::format("{} against {}, on {}", findings.search.start.source, evidence.recording->source, mesh.source);
  const discrepancy::ForceGap& gap = findings.gap;
  const std::string of =
      gap.means ? fmt::format("RMS, 3-D, of means over {} samples, ", gap.means->count) : "RMS, 3-D, ";
  page.headlines = {
      {"verdict", to_string(findings.verdict), "", "", tone_of(findings.verdict)},
      {"held-out error before", fmt::format("{:.4g}", gap.holdout_before_N), "N", of + "the model as given",
       Tone::neutral},
      {"held-out error after", fmt::format("{:.4g}", gap.holdout_after_N), "N", of + "the model written",
       Tone::neutral},
      {"expected of noise", fmt::format("{:.4g}", gap.noise_floor_N), "N",
       findings.instrument_declared ? "from the declared instrument" : "from noise estimated in the recording",
       Tone::neutral}};
  if (gap.repeat_floor_N) {
    page.headlines.push_back({"floor of a repeat", fmt::format("{:.4g}", *gap.repeat_floor_N), "N",
                              "what one recording does not repeat: RMS difference of two over the root of 2",
                              Tone::neutral});
  }
  if (gap.holdout_after_again_N) {
    page.headlines.push_back({"again from the files", fmt::format("{:.4g}", *gap.holdout_after_again_N), "N",
                              findings.blocks_held_back
                                  ? "by a fresh process from model.json alone, over the whole recording"
                                  : "by a fresh process from model.json alone, held out",
                              Tone::neutral});
  }
  page.sections.push_back(what_section(findings));
  if (!findings.search.found.empty()) page.sections.push_back(gap_section(findings));
  if (auto law = law_section(findings)) page.sections.push_back(std::move(*law));
  page.sections.push_back(where_section(findings));
  page.sections.push_back(spectrum_section(findings));
  page.sections.push_back(time_section(evidence, before, after));
  page.sections.push_back(place_section(evidence, before, mesh));
  if (auto fields = field_section(findings, candidates, evidence, mesh)) page.sections.push_back(std::move(*fields));
  page.sections.push_back(search_section(findings));
  report::Facts facts;
  facts.rows = {
      {"held out", findings.blocks_held_back ? "alternating blocks of the one recording" : "a recording of its own"},
      {"instrument", findings.instrument_declared ? "as declared" : "no description given: noise estimated"},
      {"command", provenance.command},
      {"made", provenance.created_utc},
      {"version", fmt::format("{} ({})", provenance.build.version, provenance.build.commit)},
      {"compiler", fmt::format("{}, {}", provenance.build.compiler, provenance.build.flags)}};
  for (const report::InputFile& input : provenance.inputs) {
    facts.rows.emplace_back(input.role, fmt::format("{} (SHA-256 {})", input.name, input.sha256));
  }
  Section last{"Model and provenance", "", {}, true};
  last.blocks.emplace_back(Code{"model.json", model_to_json(findings.search.model)});
  last.blocks.emplace_back(std::move(facts));
  page.sections.push_back(std::move(last));
  return page;
}

}  // namespace touchstone::pipeline
