// Faults of the settled force: what it makes of the right one, and what else it depends on.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "harness/renderer_faults/detectors.h"
#include "harness/renderer_faults/force_law.h"
#include "harness/renderer_faults/meshes.h"
#include "harness/renderer_faults/probe.h"
#include "harness/surface/moved_mesh.h"

namespace touchstone::renderer_faults {
namespace {

constexpr const char* turned_blocks = "the tops of blocks that look in 20 directions, pressed with up to 10 N";

std::string axis_name(std::size_t axis) { return {"xyz"[axis]}; }

// "x" along an axis of the world, else its components, the largest of which is positive.
std::string direction_name(const Vec3& axis) {
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  constexpr double upright = 1.0 - 1e-6;
  if (std::abs(axis[largest]) > upright) return axis_name(static_cast<std::size_t>(largest));
  const auto shown = [](double part) { return std::abs(part) < 0.005 ? 0.0 : part; };
  return fmt::format("({:.2f}, {:.2f}, {:.2f})", shown(axis.x()), shown(axis.y()), shown(axis.z()));
}

bool exchanged(const ForceMap& map) {
  return map.from[0] >= 0 && map.from[1] >= 0 && map.from[2] >= 0 && map.from != std::array<int, 3>{0, 1, 2};
}
bool lost(const ForceMap& map) {
  if (map.strongest_only) return true;
  for (std::size_t a = 0; a < 3; ++a) {
    if (map.from[a] < 0 || map.positive[a] == 0.0 || map.negative[a] == 0.0) return true;
  }
  return false;
}
bool mirrored(const ForceMap& map) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (map.positive[a] < 0.0 || map.negative[a] < 0.0) return true;
  }
  return false;
}

std::string off_sentence(const ForceFaults& faults) {
  return fmt::format("; it explains all but {:.2g} % of the force, {:.2g} % are off without it", 100.0 * faults.after,
                     100.0 * faults.before);
}

// What the force at this depth may differ by: a per cent, and twice the engine's epsilon.
double allowed_N(const Engine& engine, double depth_m) {
  return engine.stiffness_N_per_m * (0.01 * depth_m + 2.0 * engine.epsilon_m);
}

// Pressed and released between 0.2 and 0.8 mm in these steps: the mean force on the way down less that on the way up,
// as a share of the mean.
double release_share(const Engine& engine, double step_m) {
  Probe probe(engine, level_block());
  constexpr double shallow_m = 2e-4;
  constexpr double deep_m = 8e-4;
  probe.approach(place, Vec3::UnitZ(), shallow_m);
  const int steps = std::max(8, static_cast<int>((deep_m - shallow_m) / step_m));
  double down_N = 0.0;
  double up_N = 0.0;
  // The last sample before each turn is left out: there the way changes.
  for (int i = 0; i < 2 * steps; ++i) {
    const double share = 1.0 - std::abs(1.0 - static_cast<double>(i) / steps);
    const double now_N = probe.press(place, Vec3::UnitZ(), shallow_m + share * (deep_m - shallow_m)).f_W_N.z();
    if (i % steps == 0) continue;
    (i < steps ? down_N : up_N) += now_N;
  }
  return 2.0 * (down_N - up_N) / std::max(1e-12, std::abs(down_N + up_N));
}

}  // namespace

std::optional<Finding> find_mirrored_axis(const Engine& engine) {
  const ForceFaults faults = identify_force_map(engine);
  if (!faults.axes || !mirrored(faults.map)) return std::nullopt;
  std::string names;
  for (std::size_t a = 0; a < 3; ++a) {
    const double up = faults.map.positive[a];
    const double down = faults.map.negative[a];
    if (up >= 0.0 && down >= 0.0) continue;
    names += (names.empty() ? "" : ", ") + axis_name(a);
    if (up >= 0.0) names += " (where it should be negative)";
    if (down >= 0.0) names += " (where it should be positive)";
  }
  return Finding{"mirrored-axis", "the force has the wrong sign along " + names + off_sentence(faults), turned_blocks,
                 faults.before, "1"};
}

std::optional<Finding> find_exchanged_axes(const Engine& engine) {
  const ForceFaults faults = identify_force_map(engine);
  if (!faults.axes || !exchanged(faults.map)) return std::nullopt;
  std::string names;
  for (std::size_t a = 0; a < 3; ++a) names += axis_name(static_cast<std::size_t>(faults.map.from[a]));
  return Finding{"exchanged-axes", "x, y and z of the force are " + names + " of the right one" + off_sentence(faults),
                 turned_blocks, faults.before, "1"};
}

std::optional<Finding> find_lost_axis(const Engine& engine) {
  const ForceFaults faults = identify_force_map(engine);
  if (!faults.axes || !lost(faults.map)) return std::nullopt;
  if (faults.map.strongest_only)
    return Finding{"lost-axis", "only the strongest component of the force is given" + off_sentence(faults),
                   turned_blocks, faults.before, "1"};
  std::string names;
  for (std::size_t a = 0; a < 3; ++a) {
    const bool all = faults.map.from[a] < 0;
    const double up = faults.map.positive[a];
    const double down = faults.map.negative[a];
    if (all || up == 0.0 || down == 0.0)
      names += axis_name(a) + (all         ? ""
                               : up == 0.0 ? " (where it should be positive)"
                                           : " (where it should be negative)");
  }
  return Finding{"lost-axis", "the force is 0 along " + names + off_sentence(faults), turned_blocks, faults.before,
                 "1"};
}

std::optional<Finding> find_saturation(const Engine& engine) {
  const ForceFaults faults = identify_force_map(engine);
  if (!faults.saturated) return std::nullopt;
  const ForceMap& map = faults.map;
  if (!map.limits_components())
    return Finding{"saturation", fmt::format("the force never exceeds {:.4g} N", map.limit_N), turned_blocks,
                   map.limit_N, "N"};
  std::vector<std::string> limits;
  double lowest_N = no_limit_N;
  double highest_N = 0.0;
  bool all = true;
  for (Eigen::Index a = 0; a < 3; ++a) {
    Vec3 axis = map.limited.row(a);
    double up_N = map.most_N[a];
    double down_N = -map.least_N[a];
    if (axis.maxCoeff() < -axis.minCoeff()) {
      axis = -axis;
      std::swap(up_N, down_N);
    }
    for (const double limit_N : {up_N, down_N}) {
      all = all && std::isfinite(limit_N);
      if (!std::isfinite(limit_N)) continue;
      lowest_N = std::min(lowest_N, limit_N);
      highest_N = std::max(highest_N, limit_N);
    }
    const std::string name = direction_name(axis);
    if (std::isfinite(up_N) && std::abs(up_N - down_N) <= 1e-3 * up_N) {
      limits.push_back(fmt::format("{:.4g} N along {}, either way", up_N, name));
    } else {
      if (std::isfinite(up_N)) limits.push_back(fmt::format("{:.4g} N along {}", up_N, name));
      if (std::isfinite(down_N)) limits.push_back(fmt::format("{:.4g} N against {}", down_N, name));
    }
  }
  const bool same = all && highest_N < 1.001 * lowest_N;
  std::string what = fmt::format("the force is cut off at {}", fmt::join(limits, " and at "));
  if (same && map.limited.isIdentity())
    what = fmt::format("each component of the force is cut off at {:.4g} N", lowest_N);
  return Finding{"saturation",
                 what + ", and what is left points elsewhere: shorten all of the force, not a component of it",
                 turned_blocks, lowest_N, "N"};
}

std::optional<Finding> find_quantised(const Engine& engine) {
  const ForceFaults faults = identify_force_map(engine);
  if (!faults.quantised) return std::nullopt;
  return Finding{"quantised",
                 fmt::format("each component of the force is a multiple of {:.4g} N{}", faults.map.step_N,
                             faults.map.rounding == Rounding::nearest        ? ""
                             : faults.map.rounding == Rounding::towards_zero ? ", cut off towards 0"
                                                                             : ", cut off downwards") +
                     off_sentence(faults),
                 turned_blocks, faults.map.step_N, "N"};
}

std::optional<Finding> find_place_dependent(const Engine& engine) {
  constexpr double depth_m = 5.3e-4;
  struct Extreme {
    double force_N = 0.0;
    Vec3 at;
  };
  std::vector<Extreme> readings;
  const auto press = [&](const Vec3& shift, const Vec3& foot) {
    Probe probe(engine, moved(level_block(), Quat::Identity(), shift));
    readings.push_back({probe.approach(shift + foot, Vec3::UnitZ(), depth_m).f_W_N.norm(), shift + foot});
  };
  constexpr double out_m = 0.015;
  for (const Vec3& foot :
       {Vec3(place), Vec3(out_m, out_m, 0), Vec3(-out_m, out_m, 0), Vec3(out_m, -out_m, 0), Vec3(-out_m, -out_m, 0)})
    press(Vec3::Zero(), foot);
  if (find_limitation(engine.cannot, rendering::Ability::rigid_motion) == nullptr) {
    constexpr double far_m = 0.05;
    for (int axis = 0; axis < 3; ++axis) {
      press(far_m * Vec3::Unit(axis), place);
      press(-far_m * Vec3::Unit(axis), place);
    }
  }
  const auto [low, high] = std::ranges::minmax(readings, {}, &Extreme::force_N);
  // Where nothing is felt at a place, more is wrong than the stiffness.
  if (!(low.force_N > 0.0) || high.force_N - low.force_N <= allowed_N(engine, depth_m)) return std::nullopt;
  return Finding{
      "place-dependent",
      fmt::format("at one depth the force is {:.4g} N at ({:.3g}, {:.3g}, {:.3g}) m and {:.4g} N at ({:.3g}, "
                  "{:.3g}, {:.3g}) m",
                  low.force_N, low.at.x(), low.at.y(), low.at.z(), high.force_N, high.at.x(), high.at.y(), high.at.z()),
      fmt::format("a block 40 mm wide, here and there, the tip {:g} mm deep", 1e3 * depth_m),
      high.force_N / low.force_N, "1"};
}

std::optional<Finding> find_rate_dependent(const Engine& engine) {
  constexpr double depth_m = 5.3e-4;
  constexpr double pressed_m = 2e-3;
  // Settled after more than two samples the answer remembers, and its moving one is judged by its timing.
  constexpr int no_memory = 2;
  std::array<double, 3> rest_N{};
  std::array<double, 3> moving_N{};
  const std::array<double, 3> factors{0.1, 1.0, 10.0};
  // In four samples of the slowest loop, so that every loop ends at the same depth.
  const double speed_m_per_s = 0.5 * pressed_m * factors.front() * engine.rate_Hz;
  for (std::size_t i = 0; i < factors.size(); ++i) {
    Engine other = engine;
    other.rate_Hz = factors[i] * engine.rate_Hz;
    other.settle_samples = static_cast<int>(std::ceil(engine.settle_samples * std::max(1.0, factors[i])));
    Probe resting(other, level_block());
    resting.approach(place, Vec3::UnitZ(), depth_m);
    // At rest for long, also for what settles by its own clock.
    for (int sample = 0; sample < 40; ++sample) rest_N[i] = resting.press(place, Vec3::UnitZ(), depth_m).f_W_N.z();
    if (engine.settle_samples > no_memory) continue;
    other.settle_samples = 0;
    Probe moving(other, level_block());
    const double step_m = speed_m_per_s / other.rate_Hz;
    const int steps = static_cast<int>(std::round(2.0 * pressed_m / step_m));
    for (int step = 0; step <= steps; ++step)
      moving_N[i] = moving.press(place, Vec3::UnitZ(), -pressed_m + step_m * step).f_W_N.z();
  }
  for (const bool at_rest : {true, false}) {
    const auto& force_N = at_rest ? rest_N : moving_N;
    const auto [low, high] = std::ranges::minmax(force_N);
    if (high - low <= allowed_N(engine, at_rest ? depth_m : pressed_m)) continue;
    return Finding{
        "rate-dependent",
        fmt::format("{} the force is {:.4g} N in a loop of {:g} Hz, {:.4g} N at {:g} Hz and {:.4g} N at {:g} Hz",
                    at_rest ? "at rest" : fmt::format("pressed at {:g} m/s", speed_m_per_s), force_N[0],
                    factors[0] * engine.rate_Hz, force_N[1], engine.rate_Hz, force_N[2], factors[2] * engine.rate_Hz),
        "a block 40 mm wide, pressed from above with other times between the samples", high - low, "N"};
  }
  return std::nullopt;
}

std::optional<Finding> find_hysteresis(const Engine& engine) {
  constexpr double least = 0.01;
  constexpr double slow_m_per_s = 0.01;
  const double step_m = slow_m_per_s / engine.rate_Hz;
  const double epsilon = 2.0 * engine.epsilon_m / 5e-4;
  // In coarse and in fine steps: what swings by itself is no hysteresis.
  const double coarse = release_share(engine, 2e-5);
  const double fine = release_share(engine, 5e-6);
  double share = std::abs(fine) < std::abs(coarse) ? fine : coarse;
  bool at_rest = true;
  constexpr int no_memory = 2;
  if (std::abs(share) <= least + epsilon && engine.settle_samples <= no_memory) {
    Engine moving = engine;
    moving.settle_samples = 0;
    // What damping and lag do falls with the speed: at no speed, by the line through two.
    share = (4.0 * release_share(moving, 0.25 * step_m) - release_share(moving, step_m)) / 3.0;
    at_rest = false;
  }
  if (std::abs(share) <= least + epsilon) return std::nullopt;
  return Finding{
      "hysteresis",
      fmt::format("released, the force is {:.2g} % {} than pressed to the same depth, {}", 100.0 * std::abs(share),
                  share > 0.0 ? "less" : "more", at_rest ? "at rest too" : "however slowly the tip moves"),
      "a block 40 mm wide, pressed and released between 0.2 and 0.8 mm", share, "1"};
}

}  // namespace touchstone::renderer_faults
