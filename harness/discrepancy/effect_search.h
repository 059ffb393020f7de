// Which effects are missing: a stepwise search with joint fits, every add, swap and drop judged on held-out blocks.
//
// At each step every candidate is fitted jointly with the base parameters and the effects found so far, on the training
// blocks; it is scored on the held-out ones. The best is kept when it gains more than noise can, matters in practice
// and makes no regime worse; else the next is tried. Then effects that a better set no longer needs are dropped. Rivals
// that explain the held-out data as well are listed; when they cannot be told apart, that is the finding.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "harness/discrepancy/candidate_starts.h"
#include "harness/discrepancy/evidence.h"
#include "harness/discrepancy/joint_fit.h"
#include "harness/discrepancy/misfit.h"
#include "harness/discrepancy/parameter_intervals.h"
#include "harness/discrepancy/structure_detector.h"

namespace touchstone {

struct SearchSettings {
  double minimum_gain =
      60.0;  // of chi-squared, held-out and training: far beyond what noise gives a handful of parameters
  double minimum_share = 0.08;  // of the held-out chi-squared and of the held-out mean-square error that must go
  double gain_errors = 1.64;    // the held-out gain exceeds so many of its standard errors by runs of blocks
  double just_noticeable_share = 0.07;  // of the force: what removes more error than a hand can notice matters always
                                        // (Weber fraction of force, Jones 1989)
  double mesh_margin = 1.25;            // a displaced surface must exceed the mesh's declared error by so much
  double null_deviations = 5.0;         // above what the case's own nulls gain, in their standard deviations
  double worsening = 0.15;              // of the squared error that goes, no regime's may grow by more than this share
  double alike_gain = 0.1;    // two explanations whose held-out gains differ by less than this share of the gain, or
  double rival_gain = 0.5;    // what makes up for half of the gain may be alike once noise is out of the motion
  double alike_errors = 2.5;  // by less than so many standard errors, are alike
  double apart_share = 0.5;   // and so are two whose forces differ by less than this share of what noise leaves
  double likely_share = 0.5;  // of its gain that an effect must have along the likely motion too
  std::size_t most_effects = 4;
  int iterations = 12;
};

// One candidate's try at one step.
struct Trial {
  std::string name;
  Side side = Side::contact;
  JointFit fit;
  double train_gain = 0.0;  // of chi-squared against the model without it
  double holdout_gain = 0.0;
  double holdout_error = 0.0;  // standard error of that gain, by runs of blocks
  double deviance = 0.0;       // held out, with what this trial leaves counted as noise: the least is the best
  double holdout_rms_N = 0.0;  // of the 3-D force error, held-out samples
  double null_bar = 0.0;       // of the held-out gain, from the case's own nulls; 0 where they were not needed
  std::string verdict;         // why it was kept or not
};

struct SearchStep {
  double train_chi_squared = 0.0;  // of the model that the step starts from
  double holdout_chi_squared = 0.0;
  double holdout_rms_N = 0.0;
  std::vector<Trial> trials;  // best first
  std::string added;          // empty: none was strong enough
  std::string removed;        // what `added` took the place of; empty: nothing
};

// What stands in place of an effect that was found.
struct Rival {
  std::string name;
  Side side = Side::contact;
  Model model;
  double holdout_gain_lost = 0.0;  // of chi-squared, against the found one
  double error = 0.0;              // its standard error by blocks
  double holdout_rms_N = 0.0;
  bool alike = false;
};

struct FoundEffect {
  std::string name;
  Side side = Side::contact;
  double holdout_gain = 0.0;  // of chi-squared: what leaving it out costs
  std::vector<Rival> rivals;  // nearest first
};

struct SearchResult {
  Model start;
  Model base;                             // the start with its base parameters refitted
  Model model;                            // with the effects found
  JointFit fit;                           // of `model`, with covariance
  std::vector<NullFit> draws;             // `model` fitted again in the case's null worlds
  std::vector<FreeParameter> parameters;  // free in `fit`
  std::vector<SearchStep> steps;
  std::vector<FoundEffect> found;
  double goodness = 0.0;  // held-out chi-squared per degree of freedom of `model` under its own noise; 1: only noise
  double null_goodness = 0.0;  // the same in the worst world where `model` is the truth
  Structure structure;         // of what `model` leaves
  std::optional<std::string> data_fault;
  double noise_rms_N = 0.0;  // 3-D force error that the noise model expects of `model` on the held-out samples
};

using Report = std::function<void(const std::string&)>;

// Throws BadData when the starting model cannot run or has no stiffness to fit.
SearchResult search_effects(const SearchData& data, const Model& start, const std::vector<Candidate>& candidates,
                            const SearchSettings& settings, const Report& report);

}  // namespace touchstone
