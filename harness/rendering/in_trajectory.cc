#include "harness/rendering/in_trajectory.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "harness/base/error.h"
#include "harness/stats/quantile.h"

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

DepthUnderForce depth_under_force(const recording::Recording& recording, const surface::Surface& surface,
                                  double tip_radius_m) {
  std::vector<double> depths_m, forces_N, fourth_differences_m;
  std::size_t in_a_row = 0;
  for (std::size_t i = 0; i < recording.size(); ++i) {
    const double force_N = recording.f_W_N[i].norm();
    if (!(force_N > default_contact_threshold_N)) {
      in_a_row = 0;
      continue;
    }
    depths_m.push_back(tip_radius_m - surface.signed_distance(recording.motion.p_W_m[i]));
    forces_N.push_back(force_N);
    if (++in_a_row < 5) continue;
    const double* const d = &depths_m.back() - 4;
    fourth_differences_m.push_back(std::abs(d[0] - 4.0 * d[1] + 6.0 * d[2] - 4.0 * d[3] + d[4]));
  }
  if (depths_m.size() < 5) return {std::nan(""), std::nan(""), 0.0};
  // Of a normal law: the median of its magnitude, and the sum of the squared weights.
  const double noise_m = fourth_differences_m.empty()
                             ? 0.0
                             : stats::upper_median(std::move(fourth_differences_m)) / (0.6745 * std::sqrt(70.0));
  return {stats::upper_median(std::move(depths_m)), stats::upper_median(std::move(forces_N)), noise_m};
}

}  // namespace touchstone::rendering
