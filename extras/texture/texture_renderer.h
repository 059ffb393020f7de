// A texture model as a renderer: the god-object with the model's friction, and the model's vibration across the path.
//
// As the toolkit renders (TexturedSphere of HaTT, see texture_model.h): the speed is that of the tip through two
// low-pass filters of 20 Hz, its tangential part; the vibration is added along the direction in the surface across the
// motion, as the acceleration times an effective mass of handle and hand, 0.05 kg there. Below 1 mm/s it fades out,
// since a tip at rest has no direction; there it stops at 0.05 mm/s. Unlike there the friction remembers the path (Dahl
// 1968, the effect coulomb-friction) instead of growing with the speed up to mu / 0.004 s/mm, which is for the
// stability of one device: a recording of this renderer has the file's mu at every speed.
#pragma once

#include <memory>
#include <string>

#include "harness/rendering/renderer_entry.h"
#include "texture_model.h"

namespace touchstone::texture {

inline constexpr double default_effective_mass_kg = 0.05;

// `model` empty: a renderer that cannot be made; its make() throws BadData that says `why`.
rendering::RendererEntry texture_renderer_entry(std::shared_ptr<const TextureModel> model, const std::string& why = "");

}  // namespace touchstone::texture
