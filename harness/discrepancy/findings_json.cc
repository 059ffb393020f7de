#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "harness/discrepancy/findings.h"

namespace touchstone::discrepancy {
namespace {

nlohmann::json number(double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr); }

nlohmann::ordered_json gap_json(const Findings& findings) {
  nlohmann::ordered_json gap = {
      {"unit", "N"},
      {"train", {{"before", number(findings.gap.train_before_N)}, {"after", number(findings.gap.train_after_N)}}},
      {"holdout", {{"before", number(findings.gap.holdout_before_N)}, {"after", number(findings.gap.holdout_after_N)}}},
      {"noise_floor", number(findings.gap.noise_floor_N)}};
  if (findings.gap.means) {
    gap["holdout"]["means_over"] = findings.gap.means->count;
    gap["holdout"]["single_samples"] = {{"before", number(findings.gap.means->before_N)},
                                        {"after", number(findings.gap.means->after_N)}};
  }
  if (findings.gap.repeat_floor_N) gap["repeat_floor"] = number(*findings.gap.repeat_floor_N);
  if (findings.gap.tolerance_N) gap["tolerance"] = number(*findings.gap.tolerance_N);
  if (findings.gap.left_jnd) gap["left_jnd"] = number(*findings.gap.left_jnd);
  if (findings.gap.holdout_after_again_N) {
    gap["fresh_process_after"] = number(*findings.gap.holdout_after_again_N);
  }
  gap["shares"] = nlohmann::ordered_json::array();
  for (const GapShare& share : findings.shares) {
    gap["shares"].push_back({{"name", share.name}, {"share", number(share.share)}, {"left", number(share.left_N)}});
  }
  return gap;
}

nlohmann::ordered_json spectrum_json(const ResidualSpectrum& spectrum) {
  nlohmann::ordered_json out = {{"from_Hz", number(spectrum.from_Hz)},  {"to_Hz", number(spectrum.to_Hz)},
                                {"residual_N", number(spectrum.raw_N)}, {"most_of_noise_N", number(spectrum.null_N)},
                                {"share", number(spectrum.share)},      {"peaks", nlohmann::ordered_json::array()}};
  for (const SpectralPeak& peak : spectrum.peaks) {
    out["peaks"].push_back({{"name", peak.name},
                            {"frequency_Hz", number(peak.frequency_Hz)},
                            {"width_Hz", number(peak.width_Hz)},
                            {"rms_N", number(peak.rms_N)},
                            {"log10_false_alarm", number(peak.log10_false_alarm)},
                            {"acts", to_string(peak.acts)}});
  }
  return out;
}

nlohmann::ordered_json gates_json(const std::vector<VerdictGate>& gates) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const VerdictGate& gate : gates) {
    out.push_back({{"code", gate.code},
                   {"statistic", gate.statistic},
                   {"value", number(gate.value)},
                   {"limit", number(gate.limit)},
                   {"limit_from", gate.limit_from},
                   {"passed", gate.passed}});
  }
  return out;
}

nlohmann::ordered_json where_json(const std::vector<Regime>& where) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const Regime& regime : where) {
    out.push_back({{"regime", regime.name},
                   {"by", to_string(regime.kind)},
                   {"before", number(regime.before_N)},
                   {"after", number(regime.after_N)},
                   {"share_before", number(regime.share_before)},
                   {"error95", number(regime.error95_N)},
                   {"samples", regime.samples}});
  }
  return out;
}

}  // namespace

std::string findings_to_json(const Findings& findings, const std::string& trajectory_file) {
  using json = nlohmann::ordered_json;
  json root;
  root["schema"] = "touchstone-findings/1";
  root["verdict"] = to_string(findings.verdict);
  root["code"] = findings.code;
  root["explanation"] = findings.explanation;
  root["gates"] = gates_json(findings.gates);
  root["effects"] = json::array();
  for (std::size_t e = 0; e < findings.search.found.size(); ++e) {
    const FoundEffect& effect = findings.search.found[e];
    json entry;
    entry["name"] = effect.name;
    entry["side"] = effect.side == rendering::Side::contact ? "contact" : "instrument";
    entry["parameters"] = json::array();
    for (const FoundParameter& parameter : findings.parameters[e]) {
      json item;
      item["name"] = parameter.name;
      item["unit"] = parameter.unit;
      item["value"] = number(parameter.value);
      item["interval95"] = {number(parameter.low95), number(parameter.high95)};
      if (parameter.at_bound) item["at_bound"] = true;
      if (!parameter.undetermined.empty()) item["undetermined"] = parameter.undetermined;
      if (parameter.size == FoundParameter::Size::may_be_nothing) item["may_be_nothing"] = true;
      entry["parameters"].push_back(std::move(item));
    }
    entry["evidence"] = {{"validation_chi_squared_gain", number(effect.validation_gain)},
                         {"holdout_chi_squared_gain", number(effect.holdout_gain)},
                         {"holdout_standard_error", number(effect.holdout_error)},
                         {"contradicted", effect.contradicted()}};
    entry["rivals"] = json::array();
    for (const Rival& rival : effect.rivals) {
      if (rival.validation_gain_lost > 0.9 * effect.validation_gain) continue;  // explains next to nothing of it
      entry["rivals"].push_back({{"name", rival.name},
                                 {"evidence",
                                  {{"validation_chi_squared_lost", number(rival.validation_gain_lost)},
                                   {"standard_error", number(rival.error)},
                                   {"validation_rms_N", number(rival.validation_rms_N)},
                                   {"likelier_by", number(rival.log_likelihood_gain)},
                                   {"likelier_error", number(rival.likelier_error)},
                                   {"alike", rival.indistinguishable}}}});
    }
    root["effects"].push_back(std::move(entry));
  }
  root["ambiguous"] = findings.ambiguous;
  root["gap"] = gap_json(findings);
  root["questions"] = json::array();
  for (const Question& question : findings.search.questions) {
    root["questions"].push_back({{"effect", question.effect}, {"question", question.sentence}});
  }
  root["not_determined"] = findings.search.dropped;
  root["within_mesh_error"] = findings.search.within_mesh_tolerance;
  root["time_limit"] = {{"seconds", number(findings.search.time_limit_s)},
                        {"reached", !findings.search.not_tried.empty()},
                        {"not_tried", findings.search.not_tried}};
  root["goodness"] = {{"holdout_chi_squared_per_degree", number(findings.search.goodness)},
                      {"threshold", number(findings.search.goodness_threshold)},
                      {"where_the_model_is_the_truth", number(findings.search.null_goodness)}};
  root["structure"] = {{"view", findings.search.structure.view},
                       {"share", number(findings.search.structure.share)},
                       {"bar", number(findings.search.structure.bar)},
                       {"found", findings.search.structure.found()}};
  root["spectrum"] = spectrum_json(findings.search.spectrum);
  if (findings.law) root["empirical_law"] = law_json(findings.search.law, *findings.law);
  if (findings.search.data_fault) root["data_fault"] = *findings.search.data_fault;
  root["instrument"] = findings.instrument_declared ? "declared" : "estimated";
  if (findings.suggested_instrument) root["suggested_instrument"] = suggested_instrument_file;
  root["holdout"] = findings.blocks_held_back ? "alternating blocks of the one recording" : "a recording of its own";
  root["where"] = where_json(findings.where);
  if (findings.next && !findings.ambiguous.empty()) {
    root["next_experiment"] = {{"separates", findings.ambiguous.front()},
                               {"trajectory", trajectory_file},
                               {"why", fmt::format("{}: the predicted forces differ by {:.1f} times the noise",
                                                   findings.next->what, findings.next->separation)}};
  }
  root["steps"] = json::array();
  for (const SearchStep& step : findings.search.steps) {
    json trials = json::array();
    for (const Trial& trial : step.trials) {
      trials.push_back({{"name", trial.title()},
                        {"train_gain", number(trial.train_gain)},
                        {"train_error", number(trial.train_error)},
                        {"validation_gain", number(trial.validation_gain)},
                        {"validation_error", number(trial.validation_error)},
                        {"bar", number(trial.null_threshold)},
                        {"likelier", number(trial.log_likelihood_z)},
                        {"likelier_both", number(trial.likelier_both)},
                        {"deviance", number(trial.deviance)},
                        {"validation_rms_N", number(trial.validation_rms_N)},
                        {"verdict", trial.verdict.words}});
    }
    root["steps"].push_back({{"added", step.added},
                             {"removed", step.removed},
                             {"validation_rms_N", number(step.validation_rms_N)},
                             {"validation_chi_squared", number(step.validation_chi_squared)},
                             {"trials", std::move(trials)}});
  }
  return root.dump(2) + "\n";
}

}  // namespace touchstone::discrepancy
