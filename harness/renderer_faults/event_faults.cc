// Faults of single samples, single faces and great depths.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "harness/renderer_faults/detectors.h"
#include "harness/renderer_faults/meshes.h"
#include "harness/renderer_faults/probe.h"
#include "harness/stats/quantile.h"
#include "harness/surface/sphere_mesh.h"

namespace touchstone::renderer_faults {

std::optional<Finding> find_dropout(const Engine& engine) {
  constexpr std::size_t steps = 30'000;
  constexpr double longest_s = 4.0;
  Probe probe(engine, level_block());
  const Vec3 from(-6e-3, 1.7e-3, 0.0);
  probe.approach(from, Vec3::UnitZ(), probe_depth_m);
  // At rest, so that a late answer has come.
  constexpr int rest = 300;
  for (int i = 0; i < rest; ++i) probe.press(from, Vec3::UnitZ(), probe_depth_m);
  using Clock = std::chrono::steady_clock;
  const auto began = Clock::now();
  std::vector<double> force_N;
  for (std::size_t i = 0; i < steps && std::chrono::duration<double>(Clock::now() - began).count() < longest_s; ++i)
    force_N.push_back(
        probe.press(from + Vec3(4e-7 * static_cast<double>(i), 0.0, 0.0), Vec3::UnitZ(), probe_depth_m).f_W_N.z());
  const double usual_N = stats::upper_median(force_N);
  if (!(usual_N > 0.0)) return std::nullopt;
  const auto is_out = [&](double f) { return !(f > 0.5 * usual_N); };
  // What has not come yet is not lost.
  force_N.erase(force_N.begin(), std::ranges::find_if_not(force_N, is_out));
  const auto out = std::ranges::count_if(force_N, is_out);
  constexpr double most = 0.1;
  if (out == 0 || static_cast<double>(out) > most * static_cast<double>(force_N.size())) return std::nullopt;
  const auto first = std::ranges::find_if(force_N, is_out) - force_N.begin();
  // Lost for good is no dropout.
  if (is_out(force_N.back()) && is_out(force_N[force_N.size() - 2])) return std::nullopt;
  return Finding{
      "dropout",
      fmt::format("in {} of {} samples of a slide over a plane the force of {:.3g} N is {:.3g} N, first in "
                  "sample {}",
                  out, force_N.size(), usual_N, force_N[static_cast<std::size_t>(first)], first),
      fmt::format("a block 40 mm wide, the tip {:g} mm deep, sliding by 0.4 um a sample", 1e3 * probe_depth_m),
      static_cast<double>(out) / static_cast<double>(force_N.size()), "1"};
}

std::optional<Finding> find_one_bad_face(const Engine& engine) {
  constexpr double depth_m = 4e-4;
  const surface::TriangleMesh ball = surface::sphere_mesh(half_side_m, 4);
  Probe probe(engine, ball);
  const auto press_in_middle = [&](std::size_t t) {
    Vec3 middle = Vec3::Zero();
    for (const std::int32_t corner : ball.triangles[t])
      middle += ball.vertices_W_m[static_cast<std::size_t>(corner)] / 3.0;
    probe.reset();
    return probe.approach(middle, ball.scaled_normal(t).normalized(), depth_m, 3).f_W_N;
  };
  std::vector<Vec3> force_N;
  std::vector<double> normal_N;
  for (std::size_t t = 0; t < ball.triangles.size(); ++t) {
    force_N.push_back(press_in_middle(t));
    normal_N.push_back(force_N.back().dot(ball.scaled_normal(t).normalized()));
  }
  const double usual_N = stats::upper_median(normal_N);
  if (!(usual_N > 0.0)) return std::nullopt;
  const double allowed_N = 0.25 * usual_N + 2.0 * engine.stiffness_N_per_m * engine.epsilon_m;
  const auto is_bad = [&](std::size_t t, const Vec3& f_N) {
    return !((f_N - usual_N * ball.scaled_normal(t).normalized()).norm() <= allowed_N);
  };
  // Bad whenever it is pressed: single samples are lost anywhere.
  constexpr int times = 3;
  std::vector<std::size_t> bad;
  for (std::size_t t = 0; t < force_N.size(); ++t) {
    bool again = is_bad(t, force_N[t]);
    for (int i = 0; again && i < times; ++i) again = is_bad(t, press_in_middle(t));
    if (again) bad.push_back(t);
  }
  // More than a few are no fault of single faces.
  if (bad.empty() || 20 * bad.size() > force_N.size()) return std::nullopt;
  const double there_N = normal_N[bad.front()];
  return Finding{
      "one-bad-face",
      fmt::format("on {} of {} faces, first on face {}, the force along the normal is {:.3g} N, {:.3g} N on the "
                  "others{}",
                  bad.size(), force_N.size(), bad.front(), there_N, usual_N, there_N < 0.0 ? ": it pulls inward" : ""),
      fmt::format("a ball of {} triangles, 20 mm in radius, each pressed in its middle {:g} mm deep", force_N.size(),
                  1e3 * depth_m),
      static_cast<double>(bad.front()), "face"};
}

std::optional<Finding> find_falls_through_block(const Engine& engine) {
  constexpr double deepest_m = 0.02;
  constexpr double step_m = 2e-4;
  constexpr double half_m = 0.1;
  const double bottom_m =
      std::max(4e-3, std::min(deepest_m, 10.0 / engine.stiffness_N_per_m)) + 2.0 * engine.tip_radius_m;
  Probe probe(engine, surface::box_mesh({-half_m, -half_m, -2.0 * half_m}, {half_m, half_m, 0.0}));
  probe.approach(place, Vec3::UnitZ(), -step_m);
  double most_N = 0.0;
  for (int i = 0; step_m * i < bottom_m; ++i) {
    const double depth_m = step_m * (i + 0.5);
    const double now_N = probe.press(place, Vec3::UnitZ(), depth_m).f_W_N.z();
    // Once lost it must stay so for some samples: a dropout comes back.
    const bool lost = !(now_N > 0.1 * most_N) && most_N > 0.0;
    if (lost && !(probe.press(place, Vec3::UnitZ(), depth_m).f_W_N.z() > 0.1 * most_N) &&
        !(probe.press(place, Vec3::UnitZ(), depth_m + step_m).f_W_N.z() > 0.1 * most_N)) {
      return Finding{"falls-through-block",
                     fmt::format("{:.3g} mm deep in a block 200 mm thick the force falls from {:.3g} to {:.3g} N",
                                 1e3 * depth_m, most_N, now_N),
                     "a block 200 mm wide, the tip pressed down on its middle in steps of 0.2 mm", depth_m, "m"};
    }
    most_N = std::max(most_N, now_N);
  }
  return std::nullopt;
}

}  // namespace touchstone::renderer_faults
