// How far a run is from the exact answer on the analytic surface behind its mesh: the metric that tells whether a
// change against a baseline is for the better.
#pragma once

#include <optional>
#include <string>

#include "harness/golden/catalogues.h"
#include "harness/recording/trajectory.h"
#include "harness/rendering/model.h"
#include "harness/surface/surface.h"

namespace touchstone::golden {

struct ExactError {
  double force_rms_N = 0.0;
  double force_max_N = 0.0;
  double contact_rms_m = 0.0;  // of the surface contact point, over the samples in contact on both sides
};

// `scale` is that of the run's world over the analytic surface's. For god-object and spring-linear without effects (the
// exact answer is that of a frictionless god-object at rest, synthetic/surfaces/exact_contact.h); nothing for others.
std::optional<ExactError> exact_error(const Catalogues& catalogues, const surface::Surface& analytic, double scale,
                                      const rendering::Model& model, const recording::RenderedTrajectory& run);

// The difference between two such errors as a sentence; empty when neither is known.
std::string exact_comparison(const std::optional<ExactError>& golden, const std::optional<ExactError>& obtained);

}  // namespace touchstone::golden
