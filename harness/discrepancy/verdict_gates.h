// The gates that a model's residual passes, or does not, on its way to a verdict.
//
// A gate is one statistic of what the model leaves on held-out data, its limit, and where the limit comes from. All are
// judged; the first that does not pass decides. What one recording of the same motion does not repeat acquits: within
// it nothing is missing, whatever the declared noise of the sensor says, but for data at fault, lines and values that
// are hard to believe.
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

// A gate is not passed, but no more is left than a repeat leaves.
inline constexpr std::string_view within_repeat = "within-repeat";

// In the order in which they decide.
std::vector<VerdictGate> verdict_gates(const Findings& findings);

// The verdict of verdict_gates(findings) and the code of what decides: of a gate, `within_repeat`, or where all are
// passed "nothing-missing" or "effects-explain".
std::pair<FindingsVerdict, std::string_view> decide(const Findings& findings, const std::vector<VerdictGate>& gates);

}  // namespace touchstone::discrepancy
