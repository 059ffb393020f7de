#include "tool_fitting/tool_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "harness/base/error.h"
#include "harness/perception/filters/weber_law.h"
#include "tool_metrics.h"

namespace touchstone::tool_fitting {
namespace {

using Part = ToolFitter::Part;

constexpr std::size_t fewest_samples = 400;

void require_wrench_and_pose(const recording::Recording& measured) {
  if (measured.motion.q_WS.empty()) {
    throw BadData(fmt::format("{}: no orientation: the columns qw, qx, qy and qz were expected", measured.source));
  }
  if (measured.torque_W_Nm.empty()) {
    throw BadData(fmt::format("{}: no torque: the columns tx_Nm, ty_Nm and tz_Nm were expected", measured.source));
  }
  if (measured.size() < fewest_samples) {
    throw BadData(fmt::format("{}: {} samples; at least {} are needed to fit and to judge on other parts",
                              measured.source, measured.size(), fewest_samples));
  }
  const auto zero = [](const Eigen::Vector3d& v) { return v.isZero(0.0); };
  if (std::ranges::all_of(measured.f_W_N, zero))
    throw BadData(fmt::format("{}: every force is zero: was it measured?", measured.source));
  if (std::ranges::all_of(measured.torque_W_Nm, zero))
    throw BadData(fmt::format("{}: every torque is zero: was it measured?", measured.source));
}

std::string joined(const std::vector<std::string>& parts, const char* last = " and ") {
  std::string text;
  for (std::size_t i = 0; i < parts.size(); ++i) text += (i == 0 ? "" : i + 1 == parts.size() ? last : ", ") + parts[i];
  return text;
}

std::vector<std::string> named(const ToolFit& fit) {
  std::vector<std::string> names;
  for (const ToolEffect& effect : fit.effects) {
    if (effect.named) names.push_back(effect.name);
  }
  return names;
}

std::vector<ToolEffect> effects_of(const ToolFitter& fitter, const ToolChoice& choice) {
  const std::vector<ToolEffectTraits>& known = tool_effects();
  std::vector<ToolEffect> effects;
  for (std::size_t e = 0; e < known.size(); ++e) {
    const ToolChoice::OfEffect& seen = choice.effects[e];
    const ToolFitter::Reported reported = fitter.reported(seen.with, e);
    ToolEffect effect{known[e].name,
                      known[e].what,
                      known[e].unit,
                      reported.values,
                      reported.standard_errors,
                      fitter.determined(seen.with, e),
                      seen.p,
                      seen.gain,
                      choice.best.effects[e],
                      {}};
    for (const std::size_t r : seen.rivals) effect.rivals.push_back(known[r].name);
    effects.push_back(std::move(effect));
  }
  return effects;
}

// More than the samples' own noise explains, and than a person notices: from nothing, and of the torque at the
// reference of its threshold (tool_metrics.h).
bool something_is_left(const ToolFit& fit) {
  constexpr double of_noise = 2.0;
  return fit.after.force_N > std::max(of_noise * fit.noise.force_N, perception::fingertip_force.absolute_threshold) ||
         fit.after.torque_Nm >
             std::max(of_noise * fit.noise.torque_Nm, tool::torque_weber_fraction * tool::torque_reference_Nm);
}

void add_remarks(const recording::Recording& measured, ToolFit& fit) {
  const bool grew = fit.after.force_N > fit.before.force_N || fit.after.torque_Nm > fit.before.torque_Nm;
  if (grew && !named(fit).empty())
    fit.remarks.emplace_back("on the blocks that the fit has not seen an error grew: do not use these values");
  double largest_N = 0.0;
  for (const Vec3& f : measured.f_W_N) largest_N = std::max(largest_N, f.norm());
  constexpr double touching = 0.2;  // of the largest force: more than biases and noise of a sensor that is in use
  if (measured.f_W_N.front().norm() > touching * largest_N) {
    fit.remarks.emplace_back(
        "the recording begins in contact: a proxy that begins inside the object may stay on a wrong "
        "side of it; begin above the object");
  }
  for (const ToolEffect& effect : fit.effects) {
    if (!effect.rivals.empty()) {
      fit.remarks.push_back(
          fmt::format("{} or {}: this motion cannot tell them apart; turn the tool and press from more "
                      "sides",
                      effect.name, joined(effect.rivals, " or ")));
    }
    for (std::size_t k = 0; k < effect.values.size(); ++k) {
      if (effect.determined[k]) continue;
      const std::string axis = effect.values.size() == 3 ? fmt::format(" along {}", "xyz"[k]) : "";
      fit.remarks.push_back(fmt::format(
          "{}{} is not determined by this motion: turn the tool and press from more sides", effect.name, axis));
    }
  }
}

std::string first_sentence(const ToolFit& fit) {
  const std::vector<std::string> names = named(fit);
  std::string text = "nothing of the instrument stands out";
  if (names.size() == 1) text = names[0] + " explains the difference";
  if (names.size() > 1) text = joined(names) + " explain the difference";
  if (fit.verdict == ToolVerdict::unexplained && !fit.misreading)
    text = names.empty() ? "no known effect of the instrument explains the difference"
                         : joined(names) + (names.size() == 1 ? " explains" : " explain") + " a part of the difference";
  text += fmt::format(
      ": on the blocks that the fit has not seen the force error goes from {:.3g} to {:.3g} N RMS, the "
      "torque error from {:.3g} to {:.3g} mNm\n",
      fit.before.force_N, fit.after.force_N, 1e3 * fit.before.torque_Nm, 1e3 * fit.after.torque_Nm);
  if (!fit.misreading) return text;
  const ToolMisreading& m = *fit.misreading;
  return fmt::format(
             "the recording is suspect ({}): {} (beside biases and weight alone {:.3g} N and {:.3g} mNm RMS are left, "
             "{:.3g} N and {:.3g} mNm as it is recorded)\n",
             m.name, m.what, m.read_so.force_N, 1e3 * m.read_so.torque_Nm, m.as_recorded.force_N,
             1e3 * m.as_recorded.torque_Nm) +
         "read as it is recorded, " + text;
}

}  // namespace

std::string to_string(ToolVerdict verdict) {
  switch (verdict) {
    case ToolVerdict::consistent:
      return "consistent";
    case ToolVerdict::explained:
      return "explained";
    case ToolVerdict::unexplained:
      return "unexplained";
    case ToolVerdict::not_identifiable:
      return "not-identifiable";
  }
  return "";
}

ToolFit fit_tool(const recording::Recording& measured, const MakeTool& make, const tool::Coupling& declared) {
  require_wrench_and_pose(measured);
  ToolFitter fitter(measured, make, declared);
  ToolFit fit;
  fit.declared = declared;
  fit.declared_W = fitter.declared();
  if (std::ranges::none_of(fit.declared_W, [](const Wrench& w) { return w.f_N != Vec3::Zero(); })) {
    throw BadData(
        fmt::format("{}: the renderer never touches along this path; are tool, object and path in one "
                    "frame and unit?",
                    measured.source));
  }
  const ToolChoice choice = choose_effects(fitter);
  fit.misreading = find_misreading(measured, make, declared, fitter, choice);
  fit.effects = effects_of(fitter, choice);
  fit.coupling = fitter.coupling(choice.best);
  fit.fitted_W = fitter.shown_W(choice.best);
  const ToolEffectSet nothing(fit.effects.size(), false);
  fit.before = fitter.errors(fitter.solve(nothing, ToolFitter::Effort::quick), Part::reporting);
  fit.after = fitter.errors(choice.best, Part::reporting);
  fit.noise = fitter.sample_noise();
  fit.noise.force_N *= std::numbers::sqrt3;
  fit.noise.torque_Nm *= std::numbers::sqrt3;
  const bool rivals = std::ranges::any_of(fit.effects, [](const ToolEffect& e) { return !e.rivals.empty(); });
  fit.verdict = named(fit).empty() ? ToolVerdict::consistent : ToolVerdict::explained;
  if (rivals) fit.verdict = ToolVerdict::not_identifiable;
  if (something_is_left(fit) || fit.misreading) fit.verdict = ToolVerdict::unexplained;
  add_remarks(measured, fit);
  return fit;
}

std::string tool_fit_text(const ToolFit& fit) {
  std::string text = first_sentence(fit);
  for (const ToolEffect& effect : fit.effects) {
    text += fmt::format("  {} {:<21}", effect.named ? "*" : " ", effect.name);
    for (std::size_t k = 0; k < effect.values.size(); ++k)
      text += fmt::format(" {:.4g} +- {:.2g}", effect.values[k], effect.standard_errors[k]);
    text += fmt::format(" {} (p {:.2g}; gain {:.2g} a sample, p {:.2g})\n", effect.unit, effect.p,
                        effect.gain.per_sample, effect.gain.p);
  }
  if (fit.verdict == ToolVerdict::unexplained && !fit.misreading) {
    text += fmt::format(
        "  left are {:.3g} N and {:.3g} mNm RMS, of which the samples' own noise is {:.3g} N and {:.3g} mNm\n",
        fit.after.force_N, 1e3 * fit.after.torque_Nm, fit.noise.force_N, 1e3 * fit.noise.torque_Nm);
  }
  for (const std::string& remark : fit.remarks) text += "  " + remark + "\n";
  return text;
}

std::string tool_fit_json(const ToolFit& fit) {
  nlohmann::ordered_json json{
      {"schema", "touchstone-tool-fit/1"},
      {"verdict", to_string(fit.verdict)},
      {"declared_stiffness_N_per_m", fit.declared.stiffness_N_per_m},
      {"declared_rotational_stiffness_Nm_per_rad", fit.declared.rotational_stiffness_Nm_per_rad},
      {"stiffness_N_per_m", fit.coupling.stiffness_N_per_m},
      {"rotational_stiffness_Nm_per_rad", fit.coupling.rotational_stiffness_Nm_per_rad},
      {"force_rms_before_N", fit.before.force_N},
      {"force_rms_after_N", fit.after.force_N},
      {"torque_rms_before_Nm", fit.before.torque_Nm},
      {"torque_rms_after_Nm", fit.after.torque_Nm},
      {"force_noise_rms_N", fit.noise.force_N},
      {"torque_noise_rms_Nm", fit.noise.torque_Nm},
      {"misreading", nullptr},
      {"effects", nlohmann::ordered_json::array()},
      {"ambiguous", nlohmann::ordered_json::array()},
      {"remarks", fit.remarks}};
  if (fit.misreading) json["misreading"] = {{"name", fit.misreading->name}, {"what", fit.misreading->what}};
  for (const ToolEffect& effect : fit.effects) {
    json["effects"].push_back({{"name", effect.name},
                               {"unit", effect.unit},
                               {"values", effect.values},
                               {"standard_errors", effect.standard_errors},
                               {"determined", effect.determined},
                               {"p", effect.p},
                               {"gain_per_sample", effect.gain.per_sample},
                               {"gain_p", effect.gain.p},
                               {"rivals", effect.rivals},
                               {"named", effect.named}});
    for (const std::string& rival : effect.rivals) json["ambiguous"].push_back({effect.name, rival});
  }
  return json.dump(2) + "\n";
}

}  // namespace touchstone::tool_fitting
