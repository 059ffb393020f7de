// What the search found, in words and numbers: the verdict, and the file findings.json ("touchstone-findings/1").
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "harness/discrepancy/effect_search.h"
#include "harness/discrepancy/findings_verdict.h"
#include "harness/discrepancy/gap_shares.h"
#include "harness/discrepancy/instrument_description.h"
#include "harness/discrepancy/law_report.h"
#include "harness/discrepancy/next_experiment.h"
#include "harness/discrepancy/regimes.h"
#include "harness/discrepancy/verdict_gates.h"

namespace touchstone::discrepancy {

// What single samples leave where means over `count` of them are told of.
struct SingleSamples {
  std::size_t count = 1;
  double before_N = 0.0;
  double after_N = 0.0;
};

struct ForceGap {
  double train_before_N = 0.0;
  double train_after_N = 0.0;
  double holdout_before_N = 0.0;
  double holdout_after_N = 0.0;
  std::optional<double> holdout_after_again_N;  // by a fresh process from the written model; over the whole recording
  std::optional<double> repeat_floor_N;         // what one recording does not repeat (recording_checks/repeat_floor.h)
  double repeat_within_N = 0.0;                 // up to here an error is as large by chance
  // What is left is held against the user's tolerance, too, and what a fingertip would notice of it is said.
  std::optional<double> tolerance_N;
  // RMS over the held-out samples of the error in just noticeable differences of the measured force.
  std::optional<double> left_jnd;
  bool unnoticed_passes = false;  // an error below one of them is good enough: the user said so

  void apply_repeat_floor(double floor_N, double within_N) noexcept {
    repeat_floor_N = floor_N, repeat_within_N = within_N;
  }
  double noise_floor_N = 0.0;          // what the noise model expects of the final model, held out
  std::optional<SingleSamples> means;  // empty: the held-out errors are those of single samples
  // Weighed by noise an explanation may gain where the plain error of force stays as it was, but not where that grows.
  static constexpr double most_rise = 1.01;
  [[nodiscard]] bool rises() const { return holdout_after_N > most_rise * holdout_before_N; }
};

struct FoundParameter {
  std::string name;
  std::string unit;
  double value = 0.0;
  double low95 = 0.0;
  double high95 = 0.0;  // infinite: open
  bool at_bound = false;
  std::string undetermined;  // why the recording does not determine it; empty: it does
  // It says how much of the effect there is, and its interval holds the value at which there is none of it.
  enum class Size : std::uint8_t { none, sure, may_be_nothing } size = Size::none;
};

struct Findings {
  FindingsVerdict verdict = FindingsVerdict::consistent;
  std::string_view code;    // what decided: of a gate, or of the verdict (verdict_gates.h)
  std::string explanation;  // a paragraph for a reader
  std::vector<VerdictGate> gates;
  SearchResult search;
  std::vector<std::vector<FoundParameter>> parameters;  // by effect, in the order of search.found
  std::vector<std::vector<std::string>> ambiguous;
  ForceGap gap;
  std::vector<GapShare> shares;  // of the held-out gap; largest first
  std::optional<LawGap> law;     // of search.law, where it helps on the held-out data; empty: none is given
  std::vector<Regime> where;
  std::optional<NextExperiment> next;
  bool instrument_declared = true;
  // What the spectrum of the positions suggests, where none is declared and the estimate sees less
  // (tracker_spectrum.h); empty: nothing.
  std::optional<InstrumentDescription> suggested_instrument;
  bool blocks_held_back = false;  // no second recording: blocks of the one were held out
};

// The file beside findings.json that holds the suggested instrument.
inline constexpr const char* suggested_instrument_file = "suggested-instrument.json";

// Fills verdict, code, gates, explanation, parameters and ambiguous from `search` and the declared candidates.
void conclude(Findings& findings, const std::vector<rendering::Candidate>& candidates);

// `trajectory_file`: the name under which the proposed trajectory was written, empty if none.
std::string findings_to_json(const Findings& findings, const std::string& trajectory_file);

}  // namespace touchstone::discrepancy
