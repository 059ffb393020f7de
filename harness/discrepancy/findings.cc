#include "harness/discrepancy/findings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "harness/discrepancy/friction_cone.h"
#include "harness/discrepancy/parameter_intervals.h"
#include "harness/rendering/smooth_field.h"

namespace touchstone::discrepancy {
namespace {

const Candidate* find_candidate(const std::vector<Candidate>& candidates, const std::string& name) {
  const auto found =
      std::find_if(candidates.begin(), candidates.end(), [&](const Candidate& c) { return c.name == name; });
  return found == candidates.end() ? nullptr : &*found;
}

// Of a field the values that a tenth of its coefficients are below and above; the model file has them all.
std::vector<FoundParameter> field_summary(const SearchResult& search, const Candidate& candidate) {
  std::vector<std::pair<double, std::string>> values;
  const NamedParameters* const entry = find_entry(search.model, candidate.name);
  for (const auto& [name, value] : entry->parameters) {
    if (is_field_coefficient(name)) values.emplace_back(value, name);
  }
  std::vector<FoundParameter> found;
  if (values.empty()) return found;
  std::sort(values.begin(), values.end());
  const std::string unit = candidate.parameters.back().unit;
  for (const auto& [title, share] : {std::pair("low", 0.1), std::pair("high", 0.9)}) {
    const auto& [value, name] = values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
    const Interval interval = interval95(search.fit, search.parameters, {}, candidate.name, name);
    found.push_back({fmt::format("{} ({} %: {})", title, 100.0 * share, name), unit, value, interval.low, interval.high,
                     false, ""});
  }
  return found;
}

std::vector<FoundParameter> parameters_of(const SearchResult& search, const Candidate& candidate) {
  if (is_field(candidate.parameters)) return field_summary(search, candidate);
  std::vector<FoundParameter> found;
  const NamedParameters* const entry = find_entry(search.model, candidate.name);
  for (const ParameterDeclaration& declared : candidate.parameters) {
    const auto value = entry->parameters.find(declared.name);
    if (value == entry->parameters.end()) continue;
    Interval interval = interval95(search.fit, search.parameters, search.draws, candidate.name, declared.name);
    for (const NullFit& reading : search.readings) {
      const NamedParameters* const as_read = find_entry(reading.model, candidate.name);
      if (as_read == nullptr || !is_of_falling(declared.name)) continue;
      interval.low = std::min(interval.low, as_read->parameters.at(declared.name));
      interval.high = std::max(interval.high, as_read->parameters.at(declared.name));
    }
    FoundParameter parameter{declared.name, declared.unit, value->second, interval.low, interval.high, false, ""};
    for (const Undetermined& one : search.undetermined) {
      if (one.effect != candidate.name || one.parameter != declared.name) continue;
      parameter.undetermined = one.why;
      parameter.low95 = -std::numeric_limits<double>::infinity();
      parameter.high95 = std::numeric_limits<double>::infinity();
    }
    for (std::size_t i = 0; i < search.parameters.size(); ++i) {
      const FreeParameter& free = search.parameters[i];
      if (free.owner == candidate.name && free.name == declared.name) parameter.at_bound = search.fit.at_bound[i];
    }
    found.push_back(parameter);
  }
  return found;
}

std::string names(const std::vector<FoundEffect>& found) {
  std::vector<std::string> list;
  for (const FoundEffect& effect : found) {
    std::vector<std::string> alike;
    for (const Rival& rival : effect.rivals) {
      if (rival.alike) alike.push_back(rival.name);
    }
    list.push_back(alike.empty()
                       ? effect.name
                       : fmt::format("{} (or {}, indistinguishable here)", effect.name, fmt::join(alike, " or ")));
  }
  return fmt::format("{}", fmt::join(list, " and "));
}

nlohmann::json number(double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr); }

// An estimate of the noise that is several times the residual hides what is missing.
constexpr double noise_too_large = 2.0;

void warn_of_noise(Findings& findings) {
  const ForceGap& gap = findings.gap;
  if (findings.instrument_declared || !(gap.noise_floor_N > noise_too_large * gap.holdout_after_N)) return;
  findings.explanation += fmt::format(
      " The noise was estimated from the recording and expects {:.4g} N, {:.1f} times the residual: it is too large, "
      "and "
      "smaller effects are hidden by it; give the sensor's with --instrument.",
      gap.noise_floor_N, gap.noise_floor_N / gap.holdout_after_N);
}

// Positions that were low-passed and interpolated differ from sample to sample by far less than their noise.
void suggest_instrument(Findings& findings) {
  if (!findings.suggested_instrument) return;
  const InstrumentDescription& tracker = *findings.suggested_instrument;
  findings.explanation += fmt::format(
      " The tracker's noise was estimated from differences of the positions; their spectrum looks like a tracker of "
      "about {:.0f} Hz with {:.2g} um of noise, low-passed and interpolated, or like a tip that trembled. If that is "
      "your tracker, search again with --instrument {} and another --out, after adding how far the mesh may be off "
      "(geometry_error_m).",
      tracker.position_rate_Hz, 1e6 * tracker.position_noise_m, suggested_instrument_file);
}

// What instrument and object do not repeat cannot be explained: within it nothing is missing, whatever the declared
// noise of the sensor says.
void hold_against_repeat(Findings& findings) {
  const ForceGap& gap = findings.gap;
  if (!gap.repeat_floor_N || findings.search.data_fault) return;
  const double floor_N = *gap.repeat_floor_N;
  if (gap.holdout_after_N > std::max(floor_N, gap.repeat_within_N)) {
    findings.explanation +=
        fmt::format(" The held-out error of {:.4g} N is {:.3g} times what one recording does not repeat, {:.4g} N.",
                    gap.holdout_after_N, gap.holdout_after_N / floor_N, floor_N);
    return;
  }
  // A line stands out of the noise of every recording, and a value is no easier to believe.
  const bool stays = findings.search.spectrum.peaks_matter() || !findings.search.questions.empty();
  if (findings.verdict == FindingsVerdict::unexplained && !stays) {
    findings.verdict = findings.search.found.empty() ? FindingsVerdict::consistent : FindingsVerdict::explained;
    findings.explanation = fmt::format(
        "{} The noise of the sensor alone is less.",
        findings.search.found.empty()
            ? "Nothing is missing that this object repeats."
            : fmt::format("With {} nothing is missing that this object repeats.", names(findings.search.found)));
  }
  findings.explanation +=
      fmt::format(" The held-out error of {:.4g} N is within what one recording does not repeat, {:.4g} N.",
                  gap.holdout_after_N, floor_N);
}

// "coulomb-friction explains 41 % of the disagreement, stiffness-map 32 %; 0.19 N of 0.44 N is left, noise gives 0.11
// N." Empty where nothing was found.
std::string first_sentence(const Findings& findings) {
  if (findings.search.found.empty()) return "";
  constexpr double least_said = 0.005;  // less is 0 %
  std::vector<std::string> parts;
  for (const GapShare& share : findings.shares) {
    if (!(std::abs(share.share) >= least_said)) continue;
    parts.push_back(fmt::format("{}{} {:.0f} %{}", share.name,
                                !parts.empty()                      ? ""
                                : share.name.ends_with(" together") ? " explain"
                                                                    : " explains",
                                100.0 * share.share, parts.empty() ? " of the disagreement" : ""));
    if (share.share < 0.0) parts.back() += " (it had made up for another part)";
  }
  if (parts.empty()) return "";
  return fmt::format("{}; {:.2g} N of {:.2g} N is left, of which noise gives {:.2g} N. ", fmt::join(parts, ", "),
                     findings.gap.holdout_after_N, findings.gap.holdout_before_N, findings.gap.noise_floor_N);
}

// Of what nothing in the library explains.
void say_law(Findings& findings) {
  if (findings.verdict != FindingsVerdict::unexplained || findings.search.data_fault) findings.law.reset();
  if (!findings.law) return;
  const UnknownLaw& law = findings.search.law;
  std::vector<std::string> summaries;
  for (const LawPiece& piece : law.pieces) summaries.push_back(piece.effect->summary);
  findings.explanation += fmt::format(
      " An empirical law describes what is missing: {}; it follows {}. With it the held-out error falls from {:.4g} N "
      "to "
      "{:.4g} N{}; of the square that the starting model leaves beyond noise, its stiffness refitted, {:.0f} % is "
      "gone. "
      "It is no physics, and holds within what was recorded.",
      fmt::join(summaries, ", and "), law_follows(law), findings.law->without_N, findings.law->with_N,
      law.needless.empty() ? ""
                           : fmt::format(", and {} {} not needed beside it", fmt::join(law.needless, " and "),
                                         law.needless.size() == 1 ? "is" : "are"),
      100.0 * findings.law->closed);
}

// A model that follows the rate passes the tracker's noise on.
void say_what_noise_raises(Findings& findings) {
  if (!findings.gap.means || findings.search.data_fault) return;
  const SingleSamples& single = *findings.gap.means;
  const ResidualSpectrum& spectrum = findings.search.spectrum;
  findings.explanation += fmt::format(
      " These errors are of means over {} samples, as the search saw them. At single samples the error rises from "
      "{:.4g} N to {:.4g} N, since the model passes the noise of the positions on: above {:.3g} Hz it leaves {:.2g} N "
      "there, simulated noise {:.2g} N.",
      single.count, single.before_N, single.after_N, spectrum.from_Hz, spectrum.raw_N, spectrum.null_N);
}

void say_what_is_open(Findings& findings) {
  const SearchResult& search = findings.search;
  for (const FoundEffect& effect : search.found) {
    if (!effect.contradicted()) continue;
    findings.explanation += fmt::format(
        " The held-out data contradict {}: without it their chi-squared is lower by {:.0f} +- {:.0f}. It was chosen on "
        "other data and stays in the model.",
        effect.name, -effect.holdout_gain, effect.holdout_error);
  }
  for (const Undetermined& one : search.undetermined) {
    findings.explanation += fmt::format(" {} of {} is not determined: {}.", one.parameter, one.effect, one.why);
  }
  for (const auto* entries : {&search.start.effects, &search.start.instrument}) {
    for (const NamedParameters& entry : *entries) {
      if (!search.data_fault && find_entry(search.model, entry.name) == nullptr)
        findings.explanation += fmt::format(" {} of the starting model is not needed.", entry.name);
    }
  }
  for (const std::string& name : search.dropped) {
    findings.explanation +=
        fmt::format(" {} would help, but this recording does not determine its size: it is not named.", name);
  }
  for (const std::string& name : search.of_mesh) {
    findings.explanation +=
        fmt::format(" {} would help, but it may be no more than the mesh's declared error: it is not named.", name);
  }
  for (const Question& question : search.questions) {
    findings.explanation += fmt::format(" A value to question: {}: {}.", question.effect, question.sentence);
  }
  if (!search.not_tried.empty()) {
    // A search over many effects leaves a hundred trials: a reader needs to know that, and the file has them all.
    constexpr std::size_t most_named = 4;
    const std::size_t named = std::min(most_named, search.not_tried.size());
    const std::size_t more = search.not_tried.size() - named;
    findings.explanation += fmt::format(
        " The time limit of {:.4g} s ended the search: this is the best answer until then; not tried: {}{}.",
        search.time_limit_s,
        fmt::join(search.not_tried.begin(), std::next(search.not_tried.begin(), std::ptrdiff_t(named)), ", "),
        more > 0 ? fmt::format(" and {} more (time_limit.not_tried in findings.json)", more) : "");
  }
}

}  // namespace

void conclude(Findings& findings, const std::vector<Candidate>& candidates) {
  const SearchResult& search = findings.search;
  for (const FoundEffect& effect : search.found) {
    const Candidate* const candidate = find_candidate(candidates, effect.name);
    findings.parameters.push_back(candidate ? parameters_of(search, *candidate) : std::vector<FoundParameter>{});
    std::vector<std::string> alike{effect.name};
    for (const Rival& rival : effect.rivals) {
      if (rival.alike) alike.push_back(rival.name);
    }
    if (alike.size() > 1) findings.ambiguous.push_back(std::move(alike));
  }
  const bool noise_left = !search.leaves_too_much();
  if (search.data_fault) {
    findings.verdict = FindingsVerdict::unexplained;
    findings.explanation = fmt::format("The data seem to be wrong: {} Nothing is named.", *search.data_fault);
  } else if (search.spectrum.peaks_matter()) {
    findings.verdict = FindingsVerdict::unexplained;
    findings.explanation =
        fmt::format("Something is missing that no known effect explains: {}. Means over {:.3g} Hz do not show it{}.",
                    describe(search.spectrum.peaks), search.spectrum.from_Hz,
                    search.found.empty() ? "" : fmt::format("; {} added, which helps", names(search.found)));
  } else if (noise_left && search.leaves_structure()) {
    findings.verdict = FindingsVerdict::unexplained;
    findings.explanation = fmt::format(
        "Something is missing that no known effect explains: a flexible regression on {}, learnt on the training data, "
        "predicts {:.0f} % of the squared residual on held-out data (noise and details that do not matter: at "
        "most {:.0f} %){}. See where it sits below.",
        search.structure.view, 100.0 * search.structure.share, 100.0 * search.structure.bar,
        search.found.empty() ? "" : fmt::format(", with {} added, which helps", names(search.found)));
  } else if (!noise_left) {
    findings.verdict = FindingsVerdict::unexplained;
    findings.explanation = fmt::format(
        "Something is missing that no known effect explains: on held-out data the error is {:.1f} times as large, in "
        "square, as the {} noise allows{}. See where it sits below.",
        search.goodness, findings.instrument_declared ? "declared" : "estimated",
        search.found.empty() ? "" : fmt::format(", with {} added, which helps", names(search.found)));
  } else if (findings.instrument_declared && search.spectrum.far_above_noise()) {
    findings.verdict = FindingsVerdict::unexplained;
    findings.explanation = fmt::format(
        "Something is missing that no known effect explains: from {:.3g} to {:.4g} Hz the residual is {:.2g} N, {:.1f} "
        "times what the declared noise gives{}.",
        search.spectrum.from_Hz, search.spectrum.to_Hz, search.spectrum.raw_N,
        search.spectrum.raw_N / search.spectrum.null_N,
        search.found.empty() ? "" : fmt::format(", with {} added, which helps", names(search.found)));
  } else if (search.law_holds()) {
    findings.verdict = FindingsVerdict::unexplained;
    findings.explanation = fmt::format(
        "Something is missing that no known effect explains: a law that was learnt on the training data removes {:.0f} "
        "% of the held-out square beyond noise, its chi-squared falls by {:.0f} +- {:.0f}{}.",
        100.0 * search.law_share, search.law_gain, search.law_error,
        search.found.empty() ? "" : fmt::format(", with {} added, which helps", names(search.found)));
  } else if (search.found.empty()) {
    findings.verdict = FindingsVerdict::consistent;
    findings.explanation = fmt::format(
        "Nothing is missing: with its stiffness refitted the model leaves {:.4g} N of held-out error, as the noise "
        "does.",
        findings.gap.holdout_after_N);
  } else if (!findings.ambiguous.empty()) {
    findings.verdict = FindingsVerdict::not_identifiable;
    findings.explanation =
        fmt::format("This recording cannot tell: {} fit the validation data equally well. {}",
                    fmt::join(findings.ambiguous.front(), ", "),
                    findings.next ? fmt::format("A recording of this motion would tell: {}.", findings.next->what)
                                  : "No motion of the repertoire separates them beyond the noise.");
  } else if (findings.gap.rises()) {
    findings.verdict = FindingsVerdict::unexplained;
    findings.explanation = fmt::format(
        "Something is missing that no known effect explains: {} fits, but on held-out data the error rises from {:.4g} "
        "N to {:.4g} N.",
        names(search.found), findings.gap.holdout_before_N, findings.gap.holdout_after_N);
  } else if (!search.questions.empty()) {
    findings.verdict = FindingsVerdict::unexplained;
    findings.explanation = fmt::format(
        "{} {}, and the held-out error falls from {:.4g} N to {:.4g} N, but with values that are hard to believe: "
        "something else may act.",
        names(search.found), search.found.size() == 1 ? "fits" : "fit", findings.gap.holdout_before_N,
        findings.gap.holdout_after_N);
  } else {
    findings.verdict = FindingsVerdict::explained;
    findings.explanation =
        fmt::format("{} {} missing. With {} the held-out error falls from {:.4g} N to {:.4g} N.", names(search.found),
                    search.found.size() == 1 ? "was" : "were", search.found.size() == 1 ? "it" : "them",
                    findings.gap.holdout_before_N, findings.gap.holdout_after_N);
  }
  warn_of_noise(findings);
  suggest_instrument(findings);
  hold_against_repeat(findings);
  if (!search.data_fault) findings.explanation = first_sentence(findings) + findings.explanation;
  say_law(findings);
  say_what_noise_raises(findings);
  say_what_is_open(findings);
}

namespace {

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
  root["explanation"] = findings.explanation;
  root["effects"] = json::array();
  for (std::size_t e = 0; e < findings.search.found.size(); ++e) {
    const FoundEffect& effect = findings.search.found[e];
    json entry;
    entry["name"] = effect.name;
    entry["side"] = effect.side == Side::contact ? "contact" : "instrument";
    entry["parameters"] = json::array();
    for (const FoundParameter& parameter : findings.parameters[e]) {
      json item;
      item["name"] = parameter.name;
      item["unit"] = parameter.unit;
      item["value"] = number(parameter.value);
      item["interval95"] = {number(parameter.low95), number(parameter.high95)};
      if (parameter.at_bound) item["at_bound"] = true;
      if (!parameter.undetermined.empty()) item["undetermined"] = parameter.undetermined;
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
                                   {"likelier_by", number(rival.likelier_by)},
                                   {"likelier_error", number(rival.likelier_error)},
                                   {"alike", rival.alike}}}});
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
  root["within_mesh_error"] = findings.search.of_mesh;
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
                        {"bar", number(trial.null_bar)},
                        {"likelier", number(trial.likelier)},
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
