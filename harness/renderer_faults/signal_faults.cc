// Faults of the force as a signal: late, noisy, in the wrong frame, with energy of its own.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "harness/base/random.h"
#include "harness/renderer_faults/detectors.h"
#include "harness/renderer_faults/probe.h"
#include "harness/surface/moved_mesh.h"
#include "harness/surface/sphere_mesh.h"

namespace touchstone::renderer_faults {
namespace {

// Rounding of a force at this place, with room for the sums of one step.
double force_rounding_N(const Engine& engine) {
  return 1e4 * std::numeric_limits<double>::epsilon() * engine.stiffness_N_per_m * half_side_m;
}

}  // namespace

std::optional<Finding> find_noise(const Engine& engine) {
  Probe probe(engine, level_block());
  probe.approach(place, Vec3::UnitZ(), probe_depth_m);
  // At rest, after what relaxes has had time.
  const auto swing_N = [&](const auto& tip_at, int from, int steps) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (int i = 0; i < steps; ++i) {
      const double now_N = probe.press(tip_at(i), Vec3::UnitZ(), probe_depth_m).f_W_N.z();
      if (i < from) continue;
      low = std::min(low, now_N);
      high = std::max(high, now_N);
    }
    return high - low;
  };
  const double load_N = engine.stiffness_N_per_m * probe_depth_m;
  // What relaxes creeps: over the second half it has no more than a thousandth of the load left to lose.
  const double allowed_N = 1e-3 * load_N + force_rounding_N(engine) + engine.stiffness_N_per_m * engine.epsilon_m;
  const double at_rest_N = swing_N([](int) { return place; }, 2000, 4000);
  if (!(at_rest_N <= allowed_N)) {
    return Finding{"noise", fmt::format("with the tip at rest the force swings by {:.3g} N", at_rest_N),
                   fmt::format("a block 40 mm wide, the tip at rest {:g} mm deep", 1e3 * probe_depth_m), at_rest_N,
                   "N"};
  }
  const double sliding_N = swing_N([](int i) { return Vec3(place + Vec3(-3.7e-6 * i, 1.3e-6 * i, 0.0)); }, 100, 2000);
  if (sliding_N <= allowed_N) return std::nullopt;
  return Finding{"noise", fmt::format("over a level plane at one depth the normal force saws by {:.3g} N", sliding_N),
                 fmt::format("a block 40 mm wide, the tip sliding over its top {:g} mm deep in steps of 3.9 um",
                             1e3 * probe_depth_m),
                 sliding_N, "N"};
}

std::optional<Finding> find_wrong_frame(const Engine& engine) {
  const Quat turn = Quat(0.83, 0.31, -0.41, 0.22).normalized();
  const double allowed_N = force_rounding_N(engine);
  Probe here(engine, level_block());
  Probe turning(engine, level_block());
  Probe world(engine, moved(level_block(), turn, Vec3::Zero(), 1.0));
  Random random(202);
  for (int i = 0; i <= 60; ++i) {
    // Beside the surface, where rounding says whether there is contact.
    const double depth_m = std::min(i - 20, 20) * 2.5e-5 + 1.3e-6;
    // In steps of which no whole number is a usual pre-sliding path: none ends on the edge between stuck and sliding.
    const Vec3 foot = place + Vec3(1.37e-5 * std::max(0, i - 40), 0.0, 0.0);
    const Vec3 tip = foot + (engine.tip_radius_m - depth_m) * Vec3::UnitZ();
    const Vec3 f = here.to(tip).f_W_N;
    const Vec3 f_turning = turning.to(tip, random.rotation()).f_W_N;
    if (!((f_turning - f).norm() <= allowed_N)) {
      return Finding{
          "wrong-frame",
          fmt::format("the force turns with the tip: ({:.3g}, {:.3g}, {:.3g}) N where it is ({:.3g}, {:.3g}, "
                      "{:.3g}) N with the tip upright",
                      f_turning.x(), f_turning.y(), f_turning.z(), f.x(), f.y(), f.z()),
          "a block 40 mm wide pressed from above, the tip's orientation at random", (f_turning - f).norm(), "N"};
    }
    if (find_limitation(engine.cannot, rendering::Ability::rigid_motion) != nullptr) continue;
    const Vec3 f_world = turn.conjugate() * world.to(turn * tip).f_W_N;
    // An epsilon may lie another way in each.
    const double turned_N = engine.stiffness_N_per_m * (0.01 * probe_depth_m + 2.0 * engine.epsilon_m);
    if (!((f_world - f).norm() <= turned_N)) {
      return Finding{
          "wrong-frame",
          fmt::format(
              "with the world turned the force is not turned by the same rotation: ({:.3g}, {:.3g}, {:.3g}) N in "
              "the block's frame where it was ({:.3g}, {:.3g}, {:.3g}) N",
              f_world.x(), f_world.y(), f_world.z(), f.x(), f.y(), f.z()),
          "a block 40 mm wide pressed on its top, upright and turned", (f_world - f).norm(), "N"};
    }
  }
  return std::nullopt;
}

std::optional<Finding> find_energy_gained(const Engine& engine) {
  // Down, along a circle, and up again the way it came: over a level plane, where every force is easily right, and over
  // a ball.
  struct Case {
    surface::TriangleMesh mesh;
    const char* name;
    Vec3 top;
  };
  for (const Case& one :
       {Case{level_block(), "a block 40 mm wide", {0.0, 0.0, 0.0}},
        Case{surface::sphere_mesh(half_side_m, 4), "a ball 20 mm in radius", {0.0, 0.0, half_side_m}}}) {
    Probe probe(engine, one.mesh);
    // Slowly: what sampling alone explains falls with the size of the steps.
    constexpr int down = 2000;
    constexpr int round = 5000;
    constexpr int all = down + round + down;
    const auto tip_at = [&](int i) -> Vec3 {
      const double press = std::min({i, down, all - i}) / static_cast<double>(down);
      const double angle = 2.0 * M_PI * std::clamp(i - down, 0, round) / round;
      const double depth_m = press * (probe_depth_m + 1e-4) - 1e-4;
      return one.top +
             Vec3(5e-4 * std::cos(angle) + 1.1e-3, 5e-4 * std::sin(angle) + 0.7e-3, engine.tip_radius_m - depth_m);
    };
    double given_J = 0.0;
    double sampling_J = 0.0;
    rendering::StepResult last = probe.to(tip_at(0));
    for (int i = 1; i <= all; ++i) {
      const Vec3 step = tip_at(i) - tip_at(i - 1);
      const rendering::StepResult now = probe.to(tip_at(i));
      given_J += last.f_W_N.dot(step);
      // What a held force gives between two samples at most (harness/testing/renderer_conformance.h, invariant 6).
      if (last.contact || now.contact) sampling_J += 0.5 * engine.stiffness_N_per_m * step.squaredNorm();
      last = now;
    }
    const double allowed_J = sampling_J + engine.stiffness_N_per_m * probe_depth_m * (engine.epsilon_m + 1e-12);
    if (given_J <= allowed_J) continue;
    return Finding{"energy-gained",
                   fmt::format("a closed path gives {:.3g} J to the hand; sampling at 1 kHz explains {:.3g} J", given_J,
                               sampling_J),
                   fmt::format("{}, the tip down to {:g} mm, round a circle of 0.5 mm, and up again", one.name,
                               1e3 * probe_depth_m),
                   given_J, "J"};
  }
  return std::nullopt;
}

}  // namespace touchstone::renderer_faults
