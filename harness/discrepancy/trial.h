// One candidate, or two together, tried at one step of a search: fitted jointly with all that was found before on the
// training blocks, scored on the validation ones.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "harness/base/rooms.h"
#include "harness/discrepancy/search_state.h"

namespace touchstone::discrepancy {

struct Trial {
  std::string name;
  std::string partner;  // the other effect of a pair; empty: none
  Side side = Side::contact;
  JointFit fit;
  std::vector<FreeParameter> parameters;  // free in it
  double train_gain = 0.0;                // of chi-squared against the model without it
  double train_error = 0.0;               // standard error of that gain, by runs of blocks
  double validation_gain = 0.0;
  double validation_error = 0.0;
  double deviance =
      0.0;  // on the validation blocks, with what this trial leaves counted as noise: the least is the best
  double validation_rms_N = 0.0;  // of the 3-D force error, validation samples
  double null_bar = 0.0;          // of the validation gain, from the case's own nulls; 0 where they were not needed
  std::string verdict;            // why it was kept or not

  [[nodiscard]] std::vector<std::string> effects() const;
  [[nodiscard]] std::string title() const;  // "a", or "a and b"
};

// How the model that a step starts from does.
struct Standing {
  std::vector<double> train_blocks;  // chi-squared of each
  std::vector<double> validation_blocks;
  double train_chi_squared = 0.0;
  double validation_chi_squared = 0.0;
  double validation_rms_N = 0.0;
};

Standing standing_of(const SearchState& state);

// The candidate's best fit in the place of what it contains, scored. Nothing where no fit is usable, or where the model
// has the candidate already.
std::optional<Trial> try_candidate(const SearchState& state, const Standing& standing, const Candidate& candidate);

// Of every candidate, in their order.
std::vector<Trial> try_candidates(const SearchState& state, const Standing& standing);

// Fills in what the trial's fit gains.
void score(const SearchState& state, const Standing& standing, Trial& trial);

// The state in which the trial's effects are known.
SearchState with_trial(const SearchState& state, const Trial& trial);

}  // namespace touchstone::discrepancy
