// The gates that a model's residual passes, or does not, on its way to a verdict.
//
// A gate is one statistic of what the model leaves on held-out data, its limit, and where the limit comes from. All are
// judged; the first that does not pass decides. White noise is the strictest floor: every model of a real thing leaves
// more. So three more are stated, which never accuse and may acquit:
// what one recording of the same motion does not repeat: within it nothing is missing, whatever the declared noise of
// the sensor says, but for data at fault, lines and values that are hard to believe;
// the user's tolerance: within it nothing matters but data at fault and effects that cannot be told apart;
// what a fingertip would notice (Weber's law, perception/filters/weber_law.h): said always, a floor where it is asked
// for.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "harness/discrepancy/findings_verdict.h"

namespace touchstone::discrepancy {

struct Findings;

struct VerdictGate {
  std::string_view code;  // as findings.json has it; one that is given stays
  std::string statistic;  // what was measured, with its unit
  double value = 0.0;     // NaN: no number
  double limit = 0.0;
  std::string limit_from;
  bool passed = true;
};

// A gate is not passed, but no more is left than a repeat leaves, than the user's tolerance, than a fingertip notices.
inline constexpr std::string_view within_repeat = "within-repeat";
inline constexpr std::string_view within_tolerance = "within-tolerance";
inline constexpr std::string_view not_noticed = "not-noticed";

// In the order in which they decide.
std::vector<VerdictGate> verdict_gates(const Findings& findings);

// The verdict of verdict_gates(findings) and the code of what decides: of a gate, of a floor that acquits, or where
// all are passed "nothing-missing" or "effects-explain".
std::pair<FindingsVerdict, std::string_view> decide(const Findings& findings, const std::vector<VerdictGate>& gates);

}  // namespace touchstone::discrepancy
