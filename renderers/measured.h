// The model's renderer as a comparison with a recording runs it, made from the catalogues of this folder.
#pragma once

#include <memory>

#include "harness/rendering/measured_renderer.h"
#include "harness/rendering/model.h"
#include "harness/surface/surface.h"

namespace touchstone::renderers {

// Throws BadData as make_renderer() does.
rendering::MeasuredRenderer make_measured_renderer(const rendering::Model& model,
                                                   const std::shared_ptr<const surface::Surface>& surface);

}  // namespace touchstone::renderers
