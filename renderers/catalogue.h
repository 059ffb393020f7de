// The renderers and contact effects that this program knows: a new one is two files and one line in the .cc.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "harness/rendering/catalogue.h"
#include "harness/rendering/limitation.h"
#include "harness/rendering/model.h"
#include "harness/rendering/parameters.h"
#include "harness/rendering/renderer.h"
#include "harness/rendering/renderer_entry.h"
#include "harness/surface/surface.h"

namespace touchstone::renderers {

const std::vector<rendering::RendererEntry>& renderer_catalogue();
// The model's plug-in entry where it has one (Model::provided), else the catalogue's. Throws BadData that lists the
// known names.
const rendering::RendererEntry& find_renderer(const rendering::Model& model);

// What model files may say under "effects" and "instrument", and set there.
const std::vector<rendering::NamedDeclaration>& effect_catalogue();
const std::vector<rendering::NamedDeclaration>& instrument_declarations();

// The model's renderer with its effects over the surface. Throws BadData, with the place in the model file, for an
// unknown renderer, effect or instrument entry, for a parameter that nothing reads or that is out of range, and for a
// surface that the renderer cannot run on. Instrument entries are checked, not run.
std::unique_ptr<rendering::Renderer> make_renderer(const rendering::Model& model,
                                                   std::shared_ptr<const surface::Surface> surface);

// The same over a scene (harness/rendering/catalogue.h). A plug-in that renders bodies with poses gets them as they
// are.
std::unique_ptr<rendering::Renderer> make_scene_renderer(const rendering::Model& model,
                                                         std::shared_ptr<const rendering::BodyScene> scene);

rendering::CountedRenderer make_counted_renderer(const rendering::Model& model,
                                                 std::shared_ptr<const surface::Surface> surface);

// All of the above as the harness takes it (harness/rendering/catalogue.h).
const rendering::Catalogue& built_in_catalogue();

}  // namespace touchstone::renderers
