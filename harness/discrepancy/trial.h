// One candidate, or two together, tried at one step of a search: fitted jointly with all that was found before on the
// training blocks, scored on the validation ones.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "harness/discrepancy/search_state.h"

namespace touchstone::discrepancy {

// Why a trial was kept or not: what the search goes by, and the words for a reader.
struct TrialVerdict {
  enum class Kind {
    passed,                 // nothing speaks against it (yet)
    refused,                // as the words say; also what was not judged
    noisy_positions_alone,  // refused, since on the smoothed trajectory it does not help
    within_mesh_tolerance,  // refused, since all it does may be the error that the mesh's makers declare
    added,                  // it won against the other trials of its step
    added_apart,            // added in another way: the other trials of its step were not its rivals
  };
  Kind kind = Kind::passed;
  std::string words;

  TrialVerdict() = default;
  // Refused for this reason; passed if it is empty.
  TrialVerdict(std::string reason) : kind(reason.empty() ? Kind::passed : Kind::refused), words(std::move(reason)) {}
  TrialVerdict(const char* reason) : TrialVerdict(std::string(reason)) {}
  TrialVerdict(Kind kind_of, std::string words_of) : kind(kind_of), words(std::move(words_of)) {}

  [[nodiscard]] bool passed() const { return kind == Kind::passed; }
};

struct Trial {
  std::string name;
  std::string partner;  // the other effect of a pair; empty: none
  rendering::Side side = rendering::Side::contact;
  JointFit fit;
  std::vector<FreeParameter> parameters;  // free in it
  double train_gain = 0.0;                // of chi-squared against the model without it
  double train_error = 0.0;               // standard error of that gain, by runs of blocks
  double validation_gain = 0.0;
  double validation_error = 0.0;
  // What it gains of -2 ln likelihood, each model with what it leaves counted as noise, over the standard error of that
  // by runs of blocks (Vuong 1989, theorem 5.1), of all runs or trimmed: how surely it is the likelier.
  double log_likelihood_z = 0.0;  // on the validation blocks
  double likelier_both = 0.0;     // on both kinds
  double deviance =
      0.0;  // on the validation blocks, with what this trial leaves counted as noise: the least is the best
  double validation_rms_N = 0.0;  // of the 3-D force error, validation samples
  double null_threshold = 0.0;    // of the validation gain, from the case's own nulls; 0 where they were not needed
  TrialVerdict verdict;

  [[nodiscard]] std::vector<std::string> effects() const;
  [[nodiscard]] std::string title() const;  // "a", or "a and b"
};

// How the model that a step starts from does.
struct BaselineScore {
  std::vector<double> train_blocks;  // chi-squared of each
  std::vector<double> validation_blocks;
  SearchState::BlockDeviance deviances;
  double train_chi_squared = 0.0;
  double validation_chi_squared = 0.0;
  double validation_rms_N = 0.0;
};

BaselineScore baseline_score(const SearchState& state);

// The candidate's best fit in the place of what it contains, scored. Nothing where no fit is usable, or where the model
// has the candidate already.
std::optional<Trial> try_candidate(const SearchState& state, const BaselineScore& baseline,
                                   const rendering::Candidate& candidate);

// Of every candidate, in their order.
std::vector<Trial> try_candidates(const SearchState& state, const BaselineScore& baseline);

// Fills in what the trial's fit gains.
void score(const SearchState& state, const BaselineScore& baseline, Trial& trial);

// The state in which the trial's effects are known.
SearchState with_trial(const SearchState& state, const Trial& trial);

}  // namespace touchstone::discrepancy
