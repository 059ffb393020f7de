// Whether a law that was found is the special case of another one that acts, and laws of speed where nothing else
// passes.
//
// Laws of friction differ where the tip moves slowly, and there a tracker's noise hides where to it moves: at noisy
// positions both leave the same large error. Whether a coefficient falls with speed shows in forces outside of its
// cone (friction_cone.h), in both recordings by more than in any simulated world of the case in which it is steady.
// Other laws are compared by their likelihoods, each under the noise that it makes itself (a law with the larger
// coefficient expects the larger scatter of a tip that sticks), on the smoothed trajectory, whose speeds are not the
// noise's. The larger law takes the smaller one's place if its likelihood is higher on the training and on the
// validation data by more than in any simulated world of the case in which the smaller one is the truth (likelihood
// ratio of nested hypotheses by parametric bootstrap: Efron and Tibshirani 1993, chapter 16.4).
#pragma once

#include <string>
#include <vector>

#include "harness/discrepancy/trial.h"

namespace touchstone::discrepancy {

struct LargerLaw {
  std::string in_place_of;
  // Fitted on the smoothed trajectory; its gains are of -2 ln likelihood, its bar that of simulated recordings.
  Trial trial;
};

// Every law that contains one of the model's, its verdict empty where it passed, the best of those first.
std::vector<LargerLaw> weigh_larger_laws(const SearchState& state);

// Of the trials of a step of which none passed, those whose force goes with a derivative of the motion or turns over a
// path, weighed in the same way against the model as it stands: at noisy positions their force is mostly noise, and
// what they gain is lost in it. Those that pass, the most likely first; they remove their share of the validation error
// on the smoothed trajectory and make no regime worse there.
std::vector<Trial> weigh_by_likelihood(const SearchState& state, const std::vector<Trial>& trials);

// Whether another effect in the place of one of the model's is the more likely one: on the smoothed trajectory, each
// under the noise that it makes itself, on both kinds of blocks by more than in any simulated world in which the model
// is the truth (separate families of hypotheses: Cox 1961; by parametric bootstrap as above). At noisy positions a
// relaxation that ends within hundredths of a second does as well as damping: it passes less of the noise on.
// `with_other`: the model with the other effect, fitted; `parameters`: what is free in it.
bool likelier_in_place(const SearchState& state, const rendering::Model& with_other,
                       const std::vector<FreeParameter>& parameters);

}  // namespace touchstone::discrepancy
