// The fast force of a sliding tip in third-octave bands, window by window: of a recording by a Hann window, and of a
// texture model what such a window shows of it on average, in the form that perceive's judgement of vibration takes
// (harness/perception/judge/vibration.h: within a band each frequency counts as its threshold says).
//
// The mean of |X_k|^2 is the density of the power under the window's own spectrum (Welch 1967, IEEE Trans. Audio
// Electroacoust. 15:70), here summed over sixteenths of a bin: no noise is drawn, and the mean has no error.
#pragma once

#include <vector>

#include "harness/perception/judge/vibration.h"
#include "slide_windows.h"
#include "texture_model.h"

namespace touchstone::texture {

// Recorded.
perception::FastForce recorded_bands(const SlideWindows& windows, const perception::Thresholds& thresholds);

// What the model gives on average at the speed and force of each window.
perception::FastForce expected_bands(const TextureModel& model, double effective_mass_kg, const SlideWindows& windows,
                                     const perception::Thresholds& thresholds);

}  // namespace touchstone::texture
