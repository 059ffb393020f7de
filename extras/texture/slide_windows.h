// What a tip meets that slides over a flat sample: the parts of a recording in which speed and normal force hardly
// change, and the fast force in them.
//
// Speed, direction and normal force are those of the recording under a Hann window of 0.1 s, which lets little through
// from 20 Hz on. The fast force is what a parabola over the window leaves of the measured force along the normal, along
// the motion and across it: so a path may bend while friction turns with it.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "harness/base/vec.h"
#include "harness/recording/trajectory.h"

namespace touchstone::texture {

struct SlideWindow {
  double start_s = 0.0;
  double speed_m_per_s = 0.0;  // means over the window
  double load_N = 0.0;
  double friction_N = 0.0;                    // against the motion
  std::array<std::vector<double>, 3> fast_N;  // along the normal, against the motion, across it
};

struct SlideWindows {
  std::string source;
  double rate_Hz = 0.0;
  double window_s = 0.0;
  double sliding_s = 0.0;  // in contact and moving, even or not
  std::vector<SlideWindow> windows;
};

// Windows of 0.256 s that begin every `step_share` of that. `normal_W`: outward, out of the sample. Throws BadData with
// file and row for samples that do not come at one rate or exceed 1e9 N, and if no window is even, with what was found.
SlideWindows slide_windows(const recording::Recording& recording, const Vec3& normal_W, double step_share);

// What a constant, a line and a parabola over the window [first, first + length) leave of one axis.
std::vector<double> without_parabola(const std::vector<double>& x, std::size_t first, std::size_t length);

}  // namespace touchstone::texture
