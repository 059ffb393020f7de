// The predictor over the catalogue of renderers, contact effects and instrument entries.
#pragma once

#include <memory>

#include "harness/rendering/predictor.h"
#include "harness/surface/surface.h"

namespace touchstone::renderers {

// `motion`: the measured positions, which are the in-trajectory as they stand. The search for contact is done once per
// geometry and kept: for a renderer whose proxy does not depend on the stiffness (checked by running it at two), only
// effects and instrument run again when other parameters change. Predicting throws BadData naming the renderer and the
// time of a sample that it refuses, RendererFailed if it breaks down.
std::unique_ptr<rendering::Predictor> make_model_predictor(std::shared_ptr<const surface::Surface> surface,
                                                           MotionColumns motion);

}  // namespace touchstone::renderers
