// What a sliding tip meets goes with its speed and load (a texture's frequency with the speed): two recordings are
// compared where both slid alike, in cells of a third of an octave of the speed and half an octave of the load, with
// the real process's share of each (coarsened exact matching: Iacus, King and Porro 2012).
#pragma once

#include <optional>

#include "harness/perception/judge/vibration.h"

namespace touchstone::perception {

struct LikeWindows {
  BandPower real;
  BandPower rendered;
};

// The windows of both in which the hands slid alike, those of the rendered process as often as the real one's; nothing
// if there are hardly any.
std::optional<LikeWindows> like_windows(const BandPower& real, const BandPower& rendered);

}  // namespace touchstone::perception
