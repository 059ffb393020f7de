// Which effects are missing: a stepwise search with joint fits, every add, swap and drop judged on validation blocks.
//
// At each step every candidate is fitted jointly with the base parameters and the effects found so far, on the training
// blocks; it is scored on the validation ones. The best is kept when it gains more than noise can, matters in practice
// and makes no regime worse; else the next is tried. Where none passes though something is clearly missing, two at once
// are. Then effects that a better set no longer needs are dropped. Rivals
// that explain the validation data as well are listed; when they cannot be told apart, that is the finding.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "harness/discrepancy/identifiability.h"
#include "harness/discrepancy/law_search.h"
#include "harness/discrepancy/parameter_intervals.h"
#include "harness/discrepancy/residual_spectrum.h"
#include "harness/discrepancy/rivals.h"
#include "harness/discrepancy/search_settings.h"
#include "harness/discrepancy/structure_detector.h"
#include "harness/discrepancy/trial.h"

namespace touchstone::discrepancy {

struct SearchStep {
  double train_chi_squared = 0.0;  // of the model that the step starts from
  double validation_chi_squared = 0.0;
  double validation_rms_N = 0.0;
  std::vector<Trial> trials;  // best first
  std::string added;          // empty: none was strong enough; of a pair "a and b"
  std::string removed;        // what `added` took the place of; empty: nothing
};

struct SearchResult {
  rendering::Model start;
  rendering::Model base;                  // the start with its base parameters refitted
  rendering::Model model;                 // with the effects found
  JointFit fit;                           // of `model`, with covariance
  std::vector<NullFit> draws;             // `model` fitted again to simulated null recordings
  std::vector<rendering::Model> noisier;  // and at noisier positions
  bool intervals_cut_short = false;       // by the time limit: too few draws for intervals
  std::vector<NullFit> readings;          // with what the forces alone tell of friction, read again from drawn samples
  std::vector<FreeParameter> parameters;  // free in `fit`
  std::vector<SearchStep> steps;
  std::vector<FoundEffect> found;                  // in the order of the model; what the start had is not among them
  std::vector<Undetermined> undetermined;          // values of them
  std::vector<std::string> dropped;                // helped, but no size of them is determined
  std::vector<std::string> within_mesh_tolerance;  // helped, but may be no more than the mesh's declared error
  std::vector<Question> questions;                 // on values of them
  double goodness = 0.0;  // held-out chi-squared per degree of freedom of `model` under its own noise; 1: only noise
  double null_goodness = 0.0;  // the same in the worst world where `model` is the truth
  double goodness_threshold = 0.0;
  double structured_threshold = 0.0;
  double law_threshold = 0.0;
  Structure structure;        // of what `model` leaves
  ResidualSpectrum spectrum;  // of the same, sample by sample
  UnknownLaw law;             // for what `model` leaves, where that may be more than noise
  double law_gain = 0.0;      // held-out chi-squared, of the law over `model`, by the misfit that that leaves
  double law_error = 0.0;     // standard error of it
  double law_share = 0.0;     // of the held-out squared error beyond noise that the law removes; 0 where none is beyond
  std::optional<std::string> data_fault;
  double time_limit_s = 0.0;           // infinite: none
  std::vector<std::string> not_tried;  // for lack of time; empty: the search came to its end
  double noise_rms_N = 0.0;  // 3-D force error that the noise model expects of `model` on the held-out samples

  // What the held-out data say of `model`: that more is left than noise leaves, or that what is left has structure.
  [[nodiscard]] bool leaves_too_much() const { return !(goodness < goodness_threshold); }
  [[nodiscard]] bool leaves_structure() const { return structure.found() && goodness > structured_threshold; }
  // That a law is worth seeking; and that the one which was learnt without them holds there, which noise does not do.
  [[nodiscard]] bool calls_for_law() const { return !(goodness <= law_threshold) || leaves_structure(); }
  [[nodiscard]] bool law_holds() const {
    constexpr double errors = 2.0;
    return law.found() && law_share >= least_law_share && law_gain > errors * law_error;
  }
};

using Report = std::function<void(const std::string&)>;

// Throws BadData when the starting model cannot run or has no stiffness to fit.
SearchResult search_effects(const SearchData& data, const rendering::Model& start,
                            const std::vector<rendering::Candidate>& candidates, const SearchSettings& settings,
                            const Report& report);

}  // namespace touchstone::discrepancy
