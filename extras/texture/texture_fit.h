// A texture model from a recording of a tip that slides over a flat sample.
//
// As the toolkit's models are made (Culbertson, Unwin and Kuchenbecker 2014, sections 3 and 4), with three differences:
// - The series are the windows of slide_windows.h; the toolkit cuts where the spectrum changes.
// - The filter is fitted to the force over an effective mass, not to an accelerometer's signal.
// - Windows of like speed and force are fitted as one filter, by Burg's method for segments (segment_burg.h). The range
//   of speeds and forces is halved until what lies in one part spans at most a sixth of the largest speed and force.
// All filters have one order, that with the least sum of Hurvich and Tsai's corrected criterion AICc (1989, Biometrika
// 76:297) over the parts, from 2 to 20, the largest of the toolkit's files. Friction is the slope of the least-squares
// line through the origin of friction over load.
//
// What lies below 10 Hz is the hand's and is taken out with the parabola of each window; below 50 Hz, or the rate over
// the order if that is more, the model is up to 1 dB off for it.
//
// Around the parts that were seen the rectangle is filled as in the toolkit's files: no noise at no speed and at no
// force, and at its far edges the filter of the nearest part.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "slide_windows.h"
#include "texture_model.h"

namespace touchstone::texture {

// What was seen at one speed and force.
struct FittedPart {
  double speed_m_per_s = 0.0;
  double force_N = 0.0;
  std::size_t windows = 0;
  double rms_N = 0.0;  // of the fast force, all axes
};

struct TextureFit {
  TextureModel model;
  std::vector<FittedPart> parts;
  std::size_t order = 0;
  std::size_t left_out = 0;  // windows at speeds and forces of which there were too few
};

// `windows` begin one after the other (step_share 1). Throws BadData if there are too few, with how much is needed, if
// there is no fast force, and if the force drives the motion.
TextureFit fit_texture(const SlideWindows& windows, double effective_mass_kg, const std::string& material);

std::string text_of(const TextureFit& fit, const SlideWindows& windows);

}  // namespace touchstone::texture
