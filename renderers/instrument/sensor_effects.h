// What the force sensor adds, in its own frame (turned by the recording's quaternion; without one, the object's):
//   force-bias       F + (fx, fy, fz)
//   force-drift      F + (fx, fy, fz) t, t from the recording's first time being zero or not: as recorded
//   gain-drift       F (1 + rate t), the same t
//   force-crosstalk  fx += c_xz fz, fy += c_yz fz
//   force-saturation every axis clipped at +- limit
//   time-lag         the reading at t is that of t - lag, linear between samples; before the first sample, the first.
//                    A tool that turns meanwhile turns the late reading with it
#pragma once

#include <memory>
#include <span>

#include "harness/rendering/effect_traits.h"
#include "harness/rendering/instrument_effect.h"

namespace touchstone::renderers {

std::unique_ptr<rendering::InstrumentEffect> make_force_bias(std::span<const double> values);        // fx_N, fy_N, fz_N
std::unique_ptr<rendering::InstrumentEffect> make_force_drift(std::span<const double> values);       // fx_N_per_s, ...
std::unique_ptr<rendering::InstrumentEffect> make_gain_drift(std::span<const double> values);        // rate_per_s
std::unique_ptr<rendering::InstrumentEffect> make_force_crosstalk(std::span<const double> values);   // c_xz, c_yz
std::unique_ptr<rendering::InstrumentEffect> make_force_saturation(std::span<const double> values);  // limit_N
std::unique_ptr<rendering::InstrumentEffect> make_time_lag(std::span<const double> values);          // lag_s

// What the search for missing effects is to know of them.
rendering::EffectTraits force_bias_traits();
rendering::EffectTraits force_drift_traits();
rendering::EffectTraits gain_drift_traits();
rendering::EffectTraits force_crosstalk_traits();
rendering::EffectTraits force_saturation_traits();
rendering::EffectTraits time_lag_traits();

}  // namespace touchstone::renderers
