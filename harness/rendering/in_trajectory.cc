#include "harness/rendering/in_trajectory.h"

#include <fmt/format.h>

#include <cmath>

#include "harness/base/error.h"

namespace touchstone::rendering {
using recording::InTrajectory;

namespace {

void need_stiffness(double stiffness_N_per_m) {
  if (!(stiffness_N_per_m > 0.0 && std::isfinite(stiffness_N_per_m))) {
    throw UsageError(fmt::format("an in-trajectory cannot be made with a stiffness of {} N/m; expected more than 0",
                                 stiffness_N_per_m));
  }
}

}  // namespace

InTrajectory synthesize_in_trajectory(const recording::OutTrajectory& out, double stiffness_N_per_m) {
  need_stiffness(stiffness_N_per_m);
  InTrajectory in{out.motion};
  for (std::size_t i = 0; i < out.size(); ++i) {
    in.motion.p_W_m[i] -= (out.normal_force_N[i] / stiffness_N_per_m) * out.n_W[i];
  }
  return in;
}

InTrajectory whole_force_in_trajectory(const recording::OutTrajectory& out, std::span<const Vec3> f_W_N,
                                       double stiffness_N_per_m) {
  need_stiffness(stiffness_N_per_m);
  if (f_W_N.size() != out.size()) {
    throw UsageError(
        fmt::format("an in-trajectory of the whole force needs a force for each of {} samples; {} are given",
                    out.size(), f_W_N.size()));
  }
  InTrajectory in{out.motion};
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (out.normal_force_N[i] > 0.0) in.motion.p_W_m[i] -= f_W_N[i] / stiffness_N_per_m;
  }
  return in;
}

InTrajectory measured_in_trajectory(const recording::Recording& recording) { return {recording.motion}; }

}  // namespace touchstone::rendering
