#include "harness/discrepancy/verdict_gates.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "harness/discrepancy/findings.h"

namespace touchstone::discrepancy {
namespace {

constexpr std::string_view repeats = "repeat-exceeded";
constexpr std::string_view tolerance = "tolerance-exceeded";
constexpr std::string_view noticed = "noticed";
constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

VerdictGate data_gate(const SearchResult& search) {
  return {"data-fault",      "faults of the data themselves", search.data_fault ? 1.0 : 0.0, 0.0, "none is allowed",
          !search.data_fault};
}

VerdictGate line_gate(const ResidualSpectrum& spectrum) {
  return {"line-left",
          "share of the squared residual, sample by sample, in lines of its spectrum",
          spectrum.peaks.empty() ? 0.0 : spectrum.share,
          ResidualSpectrum::least_peak_share,
          "fixed: what matters; a line counts by its bound on false alarms in Gaussian noise",
          !spectrum.peaks_matter()};
}

VerdictGate noise_gate(const Findings& findings) {
  const SearchResult& search = findings.search;
  return {"noise-exceeded",
          "held-out chi-squared per degree of freedom",
          search.goodness,
          search.goodness_threshold,
          "simulated recordings in which the model is the truth, and a share above the largest",
          !search.leaves_too_much()};
}

VerdictGate structure_gate(const SearchResult& search) {
  return {"structure-left",
          "share of the squared residual that a regression on " +
              (search.structure.view.empty() ? std::string("the state") : search.structure.view) + " predicts",
          search.structure.share,
          search.structure.bar,
          "simulated recordings in which the model is the truth",
          !search.leaves_structure()};
}

VerdictGate fast_gate(const Findings& findings) {
  const ResidualSpectrum& spectrum = findings.search.spectrum;
  return {"fast-residual",
          "RMS residual above half of the block rate [N]",
          spectrum.raw_N,
          ResidualSpectrum::far_above * spectrum.null_N,
          findings.instrument_declared ? "a multiple of the most that simulated recordings show"
                                       : "not judged: the noise was estimated, not declared",
          !(findings.instrument_declared && spectrum.far_above_noise())};
}

VerdictGate law_gate(const SearchResult& search) {
  return {"law-holds",
          "share of the squared error beyond noise that a law learnt on other data removes",
          search.law_share,
          least_law_share,
          "fixed, and a gain of two standard errors",
          !search.law_holds()};
}

VerdictGate ambiguity_gate(const Findings& findings) {
  return {"indistinguishable",
          "groups of effects that fit equally well",
          static_cast<double>(findings.ambiguous.size()),
          0.0,
          "none is allowed",
          findings.ambiguous.empty()};
}

VerdictGate rise_gate(const Findings& findings) {
  const ForceGap& gap = findings.gap;
  return {"error-rises",
          "held-out error after over before",
          gap.holdout_before_N > 0.0 ? gap.holdout_after_N / gap.holdout_before_N : no_number,
          ForceGap::most_rise,
          "fixed: rounding of the error",
          findings.search.found.empty() || !gap.rises()};
}

VerdictGate value_gate(const SearchResult& search) {
  return {"value-questioned",
          "values that are hard to believe",
          static_cast<double>(search.questions.size()),
          0.0,
          "ranges of the effects' own declarations and what a recording can show",
          search.found.empty() || search.questions.empty()};
}

// Those that there are.
std::vector<VerdictGate> floors(const ForceGap& gap) {
  std::vector<VerdictGate> out;
  const auto add = [&](std::string_view code, std::string statistic, double value, double limit, std::string from) {
    out.push_back({code, std::move(statistic), value, limit, std::move(from), value <= limit});
  };
  if (gap.repeat_floor_N)
    add(repeats, "held-out error [N]", gap.holdout_after_N, std::max(*gap.repeat_floor_N, gap.repeat_within_N),
        "what one recording of the same motion does not repeat");
  if (gap.tolerance_N)
    add(tolerance, "held-out error [N]", gap.holdout_after_N, *gap.tolerance_N, "the user's tolerance");
  if (gap.left_jnd)
    add(noticed, "held-out error, RMS, in just noticeable differences of the measured force", *gap.left_jnd, 1.0,
        "a fingertip: 0.06 N, 20 % up to 2.5 N, 7 % above");
  return out;
}

bool is_floor(const VerdictGate& gate) {
  return gate.code == repeats || gate.code == tolerance || gate.code == noticed;
}

// The floor that what is left is within; "" if there is none. What the user said comes first.
std::string_view floor_that_holds(const Findings& findings, const std::vector<VerdictGate>& gates) {
  const auto passes = [&](std::string_view code) {
    return std::ranges::any_of(gates, [&](const VerdictGate& g) { return g.code == code && g.passed; });
  };
  if (passes(tolerance)) return within_tolerance;
  if (findings.gap.unnoticed_passes && passes(noticed)) return not_noticed;
  return passes(repeats) ? within_repeat : "";
}

// What no floor acquits of; a line stands out of the noise of every repeat, too, and there a value is no easier to
// believe.
bool stays(const VerdictGate& gate, std::string_view floor) {
  if (floor.empty() || gate.code == "data-fault" || gate.code == "indistinguishable") return true;
  return floor == within_repeat && (gate.code == "line-left" || gate.code == "value-questioned");
}

}  // namespace

std::vector<VerdictGate> verdict_gates(const Findings& findings) {
  const SearchResult& search = findings.search;
  std::vector<VerdictGate> gates{data_gate(search),        line_gate(search.spectrum), noise_gate(findings),
                                 structure_gate(search),   fast_gate(findings),        law_gate(search),
                                 ambiguity_gate(findings), rise_gate(findings),        value_gate(search)};
  for (VerdictGate& gate : floors(findings.gap)) gates.push_back(std::move(gate));
  return gates;
}

std::pair<FindingsVerdict, std::string_view> decide(const Findings& findings, const std::vector<VerdictGate>& gates) {
  const bool found = !findings.search.found.empty();
  const std::string_view floor = floor_that_holds(findings, gates);
  bool acquitted = false;
  for (const VerdictGate& gate : gates) {
    if (gate.passed || is_floor(gate)) continue;
    acquitted = true;
    if (!stays(gate, floor)) continue;
    return {gate.code == "indistinguishable" ? FindingsVerdict::not_identifiable : FindingsVerdict::unexplained,
            gate.code};
  }
  if (acquitted) return {found ? FindingsVerdict::explained : FindingsVerdict::consistent, floor};
  if (found) return {FindingsVerdict::explained, "effects-explain"};
  return {FindingsVerdict::consistent, "nothing-missing"};
}

}  // namespace touchstone::discrepancy
