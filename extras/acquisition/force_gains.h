// Do the axes of the force sensor have one gain? The tool's weight, turned to many orientations, is a known direction:
//   f = A g_S + b,   A = m (1 + E)
// with a full A has 12 unknowns and is linear in them; E is what gains of single axes and crosstalk make of a force.
// (The "shape from motion" calibration of force sensors: Voyles, Morrow and Khosla, J. Dyn. Sys. Meas. Control 119
// (1997), 229-235, with the orientations known.)
//   Poses do not tell m from a gain that all axes share: it is known if the tool was weighed. Otherwise any axis may be
// the right one, and the one that makes the recording worst counts.
//   The error that E makes of the session's forces f, sqrt(mean |E f|^2), is what matters: it may be a quarter of the
// contact force, as a bias, or 3 % of the force, where that is more (makers state 1 to 2 % of the range for a sound
// calibration).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "harness/recording/tool_load.h"

namespace touchstone::acquisition {
using recording::StaticPose;

inline constexpr double largest_gain_error = 0.03;  // of the force
// The motion that tells the gains.
inline constexpr std::string_view gain_poses =
    "hold the tool still with each axis of the sensor up and down and in between, ten poses or more, if need be with a "
    "weight on it";

struct ForceGains {
  bool determined = false;  // gravity pointed in directions of all three dimensions, in five poses or more
  std::size_t poses = 0;
  Mat3 mass_kg = Mat3::Zero();                // A
  double sigma_N = 0.0;                       // of one component of one pose
  Mat3 inverse_gravity_s4_m2 = Mat3::Zero();  // covariance of a row of A, over sigma_N^2

  // Gain and standard error of each axis (A's diagonal), over the middle one of the three or the weighed mass.
  [[nodiscard]] Vec3 gains(std::optional<double> weighed_kg) const;
  [[nodiscard]] Vec3 sigmas() const;
};
ForceGains identify_gains(const std::vector<StaticPose>& poses, const Vec3& gravity_W_m_per_s2);

// Root mean square error of these forces [N], in the sensor's frame, by what the poses know of the gains.
struct GainError {
  double error_N = 0.0, sigma_N = 0.0;  // NaN where the poses do not determine the gains
  double limit_N = 0.0;
  std::string fault;  // clearly beyond the limit: what to do
  std::string doubt;  // possibly beyond it (two standard errors): how the poses can tell
};
GainError gain_error(const ForceGains& gains, const std::vector<Vec3>& contact_force_S_N, double contact_force_N,
                     std::optional<double> weighed_kg);

}  // namespace touchstone::acquisition
