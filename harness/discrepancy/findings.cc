#include "harness/discrepancy/findings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "harness/discrepancy/friction_cone.h"
#include "harness/discrepancy/parameter_intervals.h"
#include "harness/rendering/smooth_field.h"

namespace touchstone::discrepancy {
using rendering::Candidate;
using rendering::NamedParameters;

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
    if (rendering::is_field_coefficient(name)) values.emplace_back(value, name);
  }
  std::vector<FoundParameter> found;
  if (values.empty()) return found;
  std::sort(values.begin(), values.end());
  const auto coefficient =
      std::ranges::find(candidate.parameters, values.front().second, &rendering::ParameterDeclaration::name);
  const std::string unit = coefficient->unit;
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
  const double excess = excess_over(search.draws, search.fit);
  for (const rendering::ParameterDeclaration& declared : candidate.parameters) {
    const auto value = entry->parameters.find(declared.name);
    if (value == entry->parameters.end()) continue;
    Interval interval =
        interval95(search.fit, search.parameters, search.draws, candidate.name, declared.name, excess, search.noisier);
    for (const NullFit& reading : search.readings) {
      const NamedParameters* const as_read = find_entry(reading.model, candidate.name);
      if (as_read == nullptr || !is_of_falling(declared.name)) continue;
      interval.low = std::min(interval.low, as_read->parameters.at(declared.name));
      interval.high = std::max(interval.high, as_read->parameters.at(declared.name));
    }
    // More than noise is left, and the interval wider than the values that there are.
    FoundParameter parameter{declared.name,
                             declared.unit,
                             value->second,
                             std::max(interval.low, declared.minimum),
                             std::min(interval.high, declared.maximum),
                             false,
                             ""};
    if (search.intervals_cut_short) parameter.undetermined = "no time was left for its interval";
    for (const Undetermined& one : search.undetermined) {
      if (one.effect == candidate.name && one.parameter == declared.name) parameter.undetermined = one.why;
    }
    if (!parameter.undetermined.empty()) {
      parameter.low95 = -std::numeric_limits<double>::infinity();
      parameter.high95 = std::numeric_limits<double>::infinity();
    }
    for (std::size_t i = 0; i < search.parameters.size(); ++i) {
      const FreeParameter& free = search.parameters[i];
      if (free.owner != candidate.name || free.name != declared.name) continue;
      parameter.at_bound = search.fit.at_bound[i];
      // An exponent of 1 changes nothing.
      if (!(is_size(free) || free.name == "exponent") || !parameter.undetermined.empty()) continue;
      const bool nothing = parameter.low95 <= declared.initial && declared.initial <= parameter.high95;
      parameter.size = nothing ? FoundParameter::Size::may_be_nothing : FoundParameter::Size::sure;
    }
    found.push_back(parameter);
  }
  return found;
}

bool may_be_nothing(const std::vector<FoundParameter>& parameters) {
  using Size = FoundParameter::Size;
  const auto has = [&](Size size) {
    return std::ranges::find(parameters, size, &FoundParameter::size) != parameters.end();
  };
  return has(Size::may_be_nothing) && !has(Size::sure);
}

std::string names(const std::vector<FoundEffect>& found) {
  std::vector<std::string> list;
  for (const FoundEffect& effect : found) {
    std::vector<std::string> indistinguishable;
    for (const Rival& rival : effect.rivals) {
      if (rival.indistinguishable) indistinguishable.push_back(rival.name);
    }
    list.push_back(indistinguishable.empty() ? effect.name
                                             : fmt::format("{} (or {}, indistinguishable here)", effect.name,
                                                           fmt::join(indistinguishable, " or ")));
  }
  return fmt::format("{}", fmt::join(list, " and "));
}

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

// What instrument and object do not repeat cannot be explained.
void say_repeat(Findings& findings) {
  const ForceGap& gap = findings.gap;
  if (!gap.repeat_floor_N || findings.search.data_fault) return;
  const double floor_N = *gap.repeat_floor_N;
  if (gap.holdout_after_N > std::max(floor_N, gap.repeat_within_N)) {
    findings.explanation +=
        fmt::format(" The held-out error of {:.4g} N is {:.3g} times what one recording does not repeat, {:.4g} N.",
                    gap.holdout_after_N, gap.holdout_after_N / floor_N, floor_N);
    return;
  }
  findings.explanation +=
      fmt::format(" The held-out error of {:.4g} N is within what one recording does not repeat, {:.4g} N.",
                  gap.holdout_after_N, floor_N);
}

// Noise is the least that could be left; these say whether more than that matters.
void say_floors(Findings& findings) {
  const ForceGap& gap = findings.gap;
  if (findings.search.data_fault) return;
  if (gap.tolerance_N) {
    findings.explanation +=
        fmt::format(" The held-out error of {:.4g} N is {} the tolerance of {:.4g} N.", gap.holdout_after_N,
                    gap.holdout_after_N <= *gap.tolerance_N ? "within" : "beyond", *gap.tolerance_N);
  }
  if (!gap.left_jnd) return;
  const bool more_than_noise = findings.code != "nothing-missing" && findings.code != "effects-explain";
  if (more_than_noise || gap.unnoticed_passes) {
    findings.explanation += fmt::format(
        " What is left is {:.2g} of what a fingertip just notices at these forces (RMS over the samples){}.",
        *gap.left_jnd,
        *gap.left_jnd > 1.0    ? ""
        : gap.unnoticed_passes ? ", which is good enough, as was asked for"
                               : "; if that is good enough, search with --tolerance noticed");
  }
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
  for (std::size_t e = 0; e < search.found.size(); ++e) {
    if (!may_be_nothing(findings.parameters[e])) continue;
    findings.explanation += fmt::format(
        " {} may be none: while so much is left that noise does not explain, the interval of its size holds that, and "
        "it "
        "may only make up for what is missing.",
        search.found[e].name);
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
  for (const std::string& name : search.within_mesh_tolerance) {
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

// "; friction added, which helps", or what else is said before the names. Empty where nothing was found.
std::string with_what_helps(const SearchResult& search, std::string_view before) {
  return search.found.empty() ? "" : fmt::format("{}{} added, which helps", before, names(search.found));
}

// The first sentences, of the gate or the verdict that decides.
std::string sentences(const Findings& findings) {
  const SearchResult& search = findings.search;
  const ForceGap& gap = findings.gap;
  const std::string_view code = findings.code;
  const std::string found = names(search.found);
  const std::string missing = "Something is missing that no known effect explains: ";
  if (code == "data-fault") return fmt::format("The data seem to be wrong: {} Nothing is named.", *search.data_fault);
  if (code == "line-left") {
    return fmt::format("{}{}. Means over {:.3g} Hz do not show it{}.", missing, describe(search.spectrum.peaks),
                       search.spectrum.from_Hz, with_what_helps(search, "; "));
  }
  if (code == "noise-exceeded") {
    return fmt::format(
        "{}on held-out data the error is {:.1f} times as large, in square, as the {} noise allows{}. See where it sits "
        "below.",
        missing, search.goodness, findings.instrument_declared ? "declared" : "estimated",
        with_what_helps(search, ", with "));
  }
  if (code == "structure-left") {
    return fmt::format(
        "{}a flexible regression on {}, learnt on the training data, predicts {:.0f} % of the squared residual on "
        "held-out data (noise and details that do not matter: at most {:.0f} %){}. See where it sits below.",
        missing, search.structure.view, 100.0 * search.structure.share, 100.0 * search.structure.bar,
        with_what_helps(search, ", with "));
  }
  if (code == "fast-residual") {
    return fmt::format(
        "{}from {:.3g} to {:.4g} Hz the residual is {:.2g} N, {:.1f} times what the declared noise gives{}.", missing,
        search.spectrum.from_Hz, search.spectrum.to_Hz, search.spectrum.raw_N,
        search.spectrum.raw_N / search.spectrum.null_N, with_what_helps(search, ", with "));
  }
  if (code == "law-holds") {
    return fmt::format(
        "{}a law that was learnt on the training data removes {:.0f} % of the held-out square beyond noise, its "
        "chi-squared falls by {:.0f} +- {:.0f}{}.",
        missing, 100.0 * search.law_share, search.law_gain, search.law_error, with_what_helps(search, ", with "));
  }
  if (code == "nothing-missing") {
    return fmt::format(
        "Nothing is missing: with its stiffness refitted the model leaves {:.4g} N of held-out error, as the noise "
        "does.",
        gap.holdout_after_N);
  }
  if (code == "indistinguishable") {
    return fmt::format("This recording cannot tell: {} fit the validation data equally well. {}",
                       fmt::join(findings.ambiguous.front(), ", "),
                       findings.next ? fmt::format("A recording of this motion would tell: {}.", findings.next->what)
                                     : "No motion of the repertoire separates them beyond the noise.");
  }
  if (code == "error-rises") {
    return fmt::format("{}{} fits, but on held-out data the error rises from {:.4g} N to {:.4g} N.", missing, found,
                       gap.holdout_before_N, gap.holdout_after_N);
  }
  if (code == "value-questioned") {
    return fmt::format(
        "{} {}, and the held-out error falls from {:.4g} N to {:.4g} N, but with values that are hard to believe: "
        "something else may act.",
        found, search.found.size() == 1 ? "fits" : "fit", gap.holdout_before_N, gap.holdout_after_N);
  }
  if (code == within_repeat) {
    return fmt::format("{} The noise of the sensor alone is less.",
                       search.found.empty()
                           ? "Nothing is missing that this object repeats."
                           : fmt::format("With {} nothing is missing that this object repeats.", found));
  }
  if (code == within_tolerance || code == not_noticed) {
    const std::string_view than = code == not_noticed ? "than a fingertip notices" : "than the tolerance allows";
    return fmt::format("{} no more is left {}. More is left than the noise of the sensor.",
                       found.empty() ? "Nothing is missing that matters:" : fmt::format("With {}", found), than);
  }
  return fmt::format("{} {} missing. With {} the held-out error falls from {:.4g} N to {:.4g} N.", found,
                     search.found.size() == 1 ? "was" : "were", search.found.size() == 1 ? "it" : "them",
                     gap.holdout_before_N, gap.holdout_after_N);
}

}  // namespace

void conclude(Findings& findings, const std::vector<Candidate>& candidates) {
  const SearchResult& search = findings.search;
  for (const FoundEffect& effect : search.found) {
    const Candidate* const candidate = find_candidate(candidates, effect.name);
    findings.parameters.push_back(candidate ? parameters_of(search, *candidate) : std::vector<FoundParameter>{});
    std::vector<std::string> indistinguishable{effect.name};
    for (const Rival& rival : effect.rivals) {
      if (rival.indistinguishable) indistinguishable.push_back(rival.name);
    }
    if (indistinguishable.size() > 1) findings.ambiguous.push_back(std::move(indistinguishable));
  }
  findings.gates = verdict_gates(findings);
  std::tie(findings.verdict, findings.code) = decide(findings, findings.gates);
  findings.explanation = sentences(findings);
  const auto acquits = {within_repeat, within_tolerance, not_noticed};
  if (std::ranges::find(acquits, findings.code) == acquits.end()) {  // there the noise does not matter
    warn_of_noise(findings);
    suggest_instrument(findings);
  }
  say_repeat(findings);
  say_floors(findings);
  if (!search.data_fault) findings.explanation = first_sentence(findings) + findings.explanation;
  say_law(findings);
  say_what_noise_raises(findings);
  say_what_is_open(findings);
}

}  // namespace touchstone::discrepancy
