// What could stand in the place of an effect that was found: every other candidate is fitted there, to the end, and
// compared with it on the validation blocks, at the recorded positions and on the smoothed trajectory.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "harness/discrepancy/trial.h"

namespace touchstone::discrepancy {

// What stands in place of an effect that was found.
struct Rival {
  std::string name;
  rendering::Side side = rendering::Side::contact;
  rendering::Model model;
  double validation_gain_lost = 0.0;  // of chi-squared, against the found one
  double error = 0.0;                 // its standard error by blocks
  double validation_rms_N = 0.0;
  // What it gains of -2 ln likelihood on the validation blocks, each model with what it leaves counted as noise, and
  // the standard error of that by runs of blocks (Vuong 1989, theorem 5.1).
  double log_likelihood_gain = 0.0;
  double likelier_error = 0.0;
  bool indistinguishable = false;
  bool contains_found = false;   // the found one is a special case of it
  bool special_case = false;     // it is one of the found one
  bool of_settled_kind = false;  // weighed against the found one by likelihood or by force alone: no place to take
};

struct FoundEffect {
  std::string name;
  rendering::Side side = rendering::Side::contact;
  double validation_gain = 0.0;  // of chi-squared: what leaving it out costs
  double holdout_gain = 0.0;     // the same on the held-out blocks, which have not seen the search
  double holdout_error = 0.0;    // its standard error, by runs of blocks
  // Whether the held-out data are clearly better off without it.
  [[nodiscard]] bool contradicted() const { return holdout_gain < -2.0 * holdout_error; }
  std::vector<Rival> rivals;  // nearest first
};

// Entries that rivals had in earlier trials, where a fit starts near its end: by the name that was added and the
// rival's.
using WarmStart = std::function<const rendering::NamedParameters*(const std::string& rival, const std::string& added)>;

// What was weighed by likelihood or by force alone, so that equal fits at noisy positions do not count as equal.
struct DecidedPairs {
  std::set<std::string> laws;  // that took the place of a special case: none of their kind is indistinguishable
  std::set<std::pair<std::string, std::string>> places;  // the effect that took the place, and what it took it from
};

// Of every effect of the state's model, each with its rivals.
std::vector<FoundEffect> weigh_rivals(const SearchState& state, const WarmStart& warm_start,
                                      const DecidedPairs& decided,
                                      const std::function<void(const std::string&)>& report);

// The rival that does best of those that clearly do better in the place of a found effect, also along the likely
// motion, and the effect that it beats; or one that does as well with far fewer parameters, or a special case of the
// effect that does not clearly worse (whether the larger law takes its place is asked after that: nested_law.h), or one
// that does as well at the noisy positions and is more likely on the smoothed trajectory, or nullptr. `put_away`: those
// that do not return.
struct Swap {
  const FoundEffect* loser = nullptr;
  const Rival* winner = nullptr;
  bool by_likelihood = false;
};
Swap best_swap(const SearchState& state, const std::vector<FoundEffect>& found, const std::set<std::string>& put_away);

}  // namespace touchstone::discrepancy
