// Effects that haptic engines offer beside friction, as CHAI3D 3.3.0 computes them (src/effects of
// github.com/chai3d/chai3d, commit 7c76b1f): cEffectMagnet, cEffectStickSlip, cEffectViscosity; held against what these
// answer (engine_answers_for_test.h). They say how a scene is
// to feel, and are no hypotheses about a measurement: the search for missing effects does not try them.
#pragma once

#include <memory>
#include <span>

#include "harness/rendering/effect.h"

namespace touchstone::renderers {

// A magnet: off the surface by a gap g it pulls towards it with k g up to the largest force F, then with a force that
// falls linearly to zero at the distance D; k is the renderer's stiffness. Inside, with `inside` 1, it pushes out by
// the same law of the depth, on top of the contact. A potential in the gap. Values: force_N, distance_m, inside. Needs
// gaps outside contact. (A step from one side of the law to the other at g = F/k has no jump.)
std::unique_ptr<rendering::Effect> make_magnet(std::span<const double> values);

// A spring from the place where the tip last stuck to where it is, of any direction; beyond the largest force it slips:
// the place is where the tip is then, and the force zero. Gives no energy: a slip loses what the spring held, and
// leaving the surface too. Values: stiffness_N_per_m, force_N.
std::unique_ptr<rendering::Effect> make_stick_slip(std::span<const double> values);

// -b v of the tip while in contact, along the normal too (it holds a tip back that leaves). Dissipates b v^2. Values:
// coefficient_N_s_per_m.
std::unique_ptr<rendering::Effect> make_viscosity(std::span<const double> values);

}  // namespace touchstone::renderers
