// How each effect enters a fit: which of its parameters are free, within what physical bounds, at what scale, and from
// where the search starts. Effects say this of themselves (harness/rendering/effect_traits.h); here their plans meet a
// recording. One without a plan is fitted in all its declared parameters from their initial values.
#pragma once

#include <functional>
#include <vector>

#include "harness/discrepancy/free_parameter.h"
#include "harness/rendering/effect_traits.h"
#include "harness/rendering/predictor.h"

namespace touchstone::discrepancy {

// `force_floor_N`: a measured force above it is contact, whatever the model says.
rendering::RecordingScales measure_scales(const recording::Recording& recording,
                                          const rendering::Prediction& prediction, double force_floor_N,
                                          double stiffness_N_per_m, double position_noise_m);

struct CandidateFit {
  rendering::Side side = rendering::Side::contact;
  std::vector<FreeParameter> parameters;           // free ones
  std::vector<rendering::NamedParameters> starts;  // complete entries to start from
};

// `residual_W_N` and `normal_N` per sample of the current model, for effects whose start must be searched for
// (texture). Without starts and parameters where the recording cannot tell anything of the effect: one along the
// surface, of an indentation at one place. Throws BadData if the effect does not declare a parameter of its plan.
CandidateFit candidate_fit(const rendering::Candidate& candidate, const rendering::RecordingScales& scales,
                           const recording::Recording& recording, const rendering::Prediction& current);

// By how much an effect moves the surface along its normals, for those that do nothing else: what the mesh's makers
// declare as its error is not missing. Of a registration the RMS over the samples in contact (`n_W`; zero when free): a
// mesh that is off by as much makes up for it, however far it goes along the surface. Infinite for all other effects.
double surface_displacement_m(const rendering::EffectTraits& traits, const rendering::NamedParameters& entry,
                              const MotionColumns& motion, const std::vector<Vec3>& n_W);

}  // namespace touchstone::discrepancy
