// Where contact begins in a curve of force against displacement, such as an indentation by an atomic force microscope
// or a testing machine: its displacement counts from wherever the instrument does, so that z = 0 says nothing of the
// surface.
//
// The first approach is fitted by the force of free air, which may slope (drift, a bent lever, interference), and
// beyond a contact point z_c by the powers 1, 3/2 and 2 of the depth: a spring, a ball (Hertz 1882), a cone (Sneddon
// 1965). Of all points z_c the one that leaves the least square is taken (Lin, Dimitriadis and Horkay, J. Biomech. Eng.
// 129 (2007) 430, whose search this is, with their ball's power alone). A force that grows faster seems to begin
// deeper: with the cube of the depth by a third of it.
#pragma once

#include <optional>

#include "harness/recording/recording_file.h"

namespace touchstone::pipeline {

struct CurveZero {
  double z_W_m = 0.0;      // where contact begins
  double deepest_m = 0.0;  // below it, in the first approach
};

// Nothing where the recording is no curve along z (it moves aside by more than a thousandth of its way along z), where
// no point leaves less than half of the square that contact from the first sample on leaves, or where z = 0 serves as
// well: it leaves less than twice the square, or is off by less than a tenth of the depth (which changes a Hertzian
// modulus, by depth to the power of 3/2, by 15 %).
std::optional<CurveZero> find_curve_zero(const recording::Recording& recording);

}  // namespace touchstone::pipeline
