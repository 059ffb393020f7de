// Faults of touching: where contact begins and where the contact point is.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "harness/renderer_faults/detectors.h"
#include "harness/renderer_faults/meshes.h"
#include "harness/renderer_faults/probe.h"
#include "harness/surface/box_mesh.h"

namespace touchstone::renderer_faults {
using rendering::StepResult;

namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();
// Rounding of places on a body of this size, with room for some sums.
constexpr double place_rounding_m = 1e3 * eps * half_side_m;

constexpr double touch_step_m = 1e-6;
constexpr double latest_m = 4e-4;
constexpr const char* coming_down = "a block 40 mm wide, the tip coming down on it in steps of 1 um";

struct Touch {
  double depth_m = latest_m;
  double force_N = 0.0;
};

// The first contact of a tip that comes down; none down to the latest depth reads as that depth.
Touch first_touch(const Engine& engine) {
  constexpr int from = 40;  // steps above the surface
  Probe probe(engine, level_block());
  probe.approach(place, Vec3::UnitZ(), -1e-3);
  for (int i = -from; touch_step_m * i < latest_m; ++i) {
    const double depth_m = touch_step_m * (i + 0.5);
    const StepResult now = probe.press(place, Vec3::UnitZ(), depth_m);
    if (now.contact) return {depth_m, now.f_W_N.norm()};
  }
  return {};
}

// How deep a tip that comes down has a force, which a coarse step of the force may delay.
double first_force_m(const Engine& engine) {
  constexpr double step_m = 5e-6;
  Probe probe(engine, level_block());
  probe.approach(place, Vec3::UnitZ(), -step_m);
  for (int i = 0; step_m * i < latest_m; ++i) {
    const double depth_m = step_m * (i + 0.5);
    if (probe.press(place, Vec3::UnitZ(), depth_m).f_W_N.z() > 0.0) return depth_m;
  }
  return latest_m;
}

// On the top of the block, away from its edges.
double rested_load_N(const Engine& engine) {
  Probe probe(engine, level_block());
  probe.approach(place, Vec3::UnitZ(), probe_depth_m);
  return probe.press(place, Vec3::UnitZ(), probe_depth_m).f_W_N.norm();
}

// At the surface and without a jump, but for the last step and what the engine declares.
bool within_epsilon(const Engine& engine, const Touch& touch) {
  const double allowed_m = touch_step_m + place_rounding_m + engine.epsilon_m;
  // A contact that is stiffer than its author says does not jump for that.
  const double most_N =
      std::max(engine.stiffness_N_per_m, rested_load_N(engine) / probe_depth_m) * allowed_m * (1.0 + engine.friction);
  return touch.depth_m > 0.0 && touch.depth_m <= allowed_m && touch.force_N <= most_N;
}

// A tip that has left the surface, by more than its last step and what the engine declares, has no force.
std::optional<Finding> find_lingering(const Engine& engine) {
  constexpr double step_m = 5e-5;
  Probe probe(engine, level_block());
  // The end of what fades, as a filter's force does, is nothing.
  constexpr double nothing = 1e-6;
  const double least_N = nothing * probe.approach(place, Vec3::UnitZ(), probe_depth_m).f_W_N.norm();
  for (int i = 0; i < 40; ++i) {
    const double above_m = -probe_depth_m + step_m * (i + 0.5);
    const StepResult now = probe.press(place, Vec3::UnitZ(), -above_m);
    // A proxy may be an epsilon above the surface, and the tip an epsilon above the proxy.
    if (above_m <= 2.0 * engine.epsilon_m || !(now.contact || now.f_W_N.norm() > least_N)) continue;
    return Finding{"gap-at-contact",
                   fmt::format("{:.3g} m above the surface that the tip has left there are still {:.3g} N", above_m,
                               now.f_W_N.norm()),
                   "a block 40 mm wide, the tip going up from it in steps of 50 um", -above_m, "m"};
  }
  return std::nullopt;
}

// In a body, where two walls are as deep, or where the centre of a ball is in a wall, so that the way to the nearest
// point has no direction: the answer on one side of it or on the other is right.
std::optional<Finding> find_tie_inside(const Engine& engine, double rounding_N) {
  const double r = engine.tip_radius_m;
  const Vec3 z = Vec3::UnitZ();
  struct Tie {
    surface::TriangleMesh body;
    Vec3 foot;
    double centre_m;  // below the top
    Vec3 beside;
    const char* name;
    const char* where;
  };
  // A ball rounds the edge, but where its centre is behind both walls.
  std::vector<Tie> ties{
      {level_block(),
       {half_side_m - probe_depth_m, place.y(), 0.0},
       probe_depth_m,
       Vec3::UnitX(),
       "as deep below the top as behind the side",
       "a block 40 mm wide, the tip coming down beside an edge"},
      {surface::box_mesh({-half_side_m, -half_side_m, -2.0 * probe_depth_m}, {half_side_m, half_side_m, 0.0}), place,
       probe_depth_m, z, "in the middle between two faces",
       "a plate 40 mm wide and 1 mm thick, the tip coming down on it"}};
  if (r > 0.0)
    ties.push_back({level_block(), place, 0.0, z, "its centre in the plane of the top",
                    "a block 40 mm wide, the ball coming down on it as deep as its radius"});
  constexpr double beside_m = 1e-6;
  // Where the force of an edge is rounded it changes by as much as the place, some times over.
  constexpr double steepest = 4.0;
  const double allowed_N = steepest * engine.stiffness_N_per_m * beside_m + rounding_N;
  for (const Tie& tie : ties) {
    const auto force_N = [&](double further_m) {
      Probe probe(engine, tie.body);
      return probe.approach(tie.foot - further_m * tie.beside, z, tie.centre_m + r).f_W_N;
    };
    const Vec3 there_N = force_N(0.0);
    const Vec3 deeper_N = force_N(beside_m);
    const Vec3 shallower_N = force_N(-beside_m);
    const double off_N = std::min((there_N - deeper_N).norm(), (there_N - shallower_N).norm());
    if (off_N <= allowed_N) continue;
    return Finding{"tie-break",
                   fmt::format("{}, the force is ({:.3g}, {:.3g}, {:.3g}) N, and ({:.3g}, {:.3g}, {:.3g}) or ({:.3g}, "
                               "{:.3g}, {:.3g}) N 1 um beside it",
                               tie.name, there_N.x(), there_N.y(), there_N.z(), deeper_N.x(), deeper_N.y(),
                               deeper_N.z(), shallower_N.x(), shallower_N.y(), shallower_N.z()),
                   tie.where, off_N, "N"};
  }
  return std::nullopt;
}

}  // namespace

std::optional<Finding> find_standoff(const Engine& engine) {
  Probe probe(engine, level_block());
  StepResult now = probe.approach(place, Vec3::UnitZ(), probe_depth_m);
  now = probe.press(place, Vec3::UnitZ(), probe_depth_m);
  const double above_m = now.contact_W_m.z() - engine.tip_radius_m;
  const double allowed_m = place_rounding_m + engine.epsilon_m;
  if (now.contact && std::abs(above_m) <= allowed_m) {
    // 0: the engine does not give it.
    if (now.depth_m == 0.0 || std::abs(now.depth_m - probe_depth_m) <= allowed_m + 0.01 * probe_depth_m)
      return std::nullopt;
    return Finding{"standoff",
                   fmt::format("the depth that it gives is {:.3g} m, of a tip {:g} m deep", now.depth_m, probe_depth_m),
                   fmt::format("a block 40 mm wide, its top at z = 0, the tip {:g} mm deep", 1e3 * probe_depth_m),
                   now.depth_m, "m"};
  }
  if (!now.contact) {
    return Finding{"standoff", "a tip pressed on the level top of a block touches nothing",
                   fmt::format("a block 40 mm wide, its top at z = 0, the tip {:g} mm deep", 1e3 * probe_depth_m), 0.0,
                   "m"};
  }
  return Finding{"standoff",
                 fmt::format("the surface contact point is {:.3g} m {} the surface ({:.3g} m are allowed)",
                             std::abs(above_m), above_m > 0.0 ? "above" : "below", allowed_m),
                 fmt::format("a block 40 mm wide, its top at z = 0, the tip {:g} mm deep", 1e3 * probe_depth_m),
                 above_m, "m"};
}

std::optional<Finding> find_gap_at_contact(const Engine& engine) {
  const Touch touch = first_touch(engine);
  if (within_epsilon(engine, touch)) return find_lingering(engine);
  if (touch.depth_m >= latest_m)
    return Finding{"gap-at-contact", "contact has not begun 0.4 mm below the surface", coming_down, latest_m, "m"};
  return Finding{"gap-at-contact",
                 fmt::format("contact begins {:.3g} m {} the surface, with {:.3g} N at once", std::abs(touch.depth_m),
                             touch.depth_m > 0.0 ? "below" : "above", touch.force_N),
                 coming_down, touch.depth_m, "m"};
}

std::optional<Finding> find_late_contact(const Engine& engine) {
  const Touch touch = first_touch(engine);
  if (touch.depth_m <= touch_step_m + place_rounding_m || !within_epsilon(engine, touch)) return std::nullopt;
  return Finding{
      "late-contact",
      fmt::format("contact begins {:.3g} m below the surface, within the {:.3g} m that it declares: no fault",
                  touch.depth_m, engine.epsilon_m),
      coming_down, touch.depth_m, "m"};
}

// Where the tip is neither in nor out, or two surface points are as close: what it is called there must not matter.
// Free places in the planes and lines of a block's walls, and on them, have no force. Inside, the answer beside it is
// right.
std::optional<Finding> find_tie_break(const Engine& engine) {
  const double r = engine.tip_radius_m;
  const double away_m = 5e-3 + r;
  const double rounding_N = engine.stiffness_N_per_m * (place_rounding_m + 2.0 * engine.epsilon_m);
  struct Tie {
    Vec3 foot;  // the tip is `height` above it
    Vec3 out;
    double height_m;
    const char* name;
  };
  const Vec3 x = Vec3::UnitX();
  const Vec3 z = Vec3::UnitZ();
  const Vec3 edge(half_side_m, place.y(), 0.0);
  const Vec3 corner(half_side_m, half_side_m, 0.0);
  const std::array ties{
      Tie{edge, x, away_m, "in the plane of the top, beside the block"},
      Tie{edge, z, away_m, "in the plane of a side, above the block"},
      Tie{corner, x, away_m, "on the line of an edge, beside the block"},
      Tie{corner, z, away_m, "on the line of two sides, above the block"},
      Tie{place, z, r, "on the top"},
      Tie{edge, z, r, "on an edge"},
      Tie{corner, z, r, "on a corner"},
  };
  for (const Tie& tie : ties) {
    Probe probe(engine, level_block());
    constexpr double from_m = 2e-3;
    for (const double above_m : {from_m, 0.5 * from_m}) probe.to(tie.foot + (tie.height_m + above_m) * tie.out);
    const Vec3 f_N = probe.to(tie.foot + tie.height_m * tie.out).f_W_N;
    if (f_N.norm() <= rounding_N) continue;
    return Finding{"tie-break", fmt::format("exactly {} a free tip has a force of {:.3g} N", tie.name, f_N.norm()),
                   "a block 40 mm wide, the tip coming from outside", f_N.norm(), "N"};
  }
  return find_tie_inside(engine, rounding_N);
}

std::optional<Finding> find_untouchable_triangles(const Engine& engine) {
  // Where contact begins late, and by the same figure in any unit, another detector says so.
  const bool begins_late = !within_epsilon(engine, first_touch(engine));
  // Both are the same plane sheet: what is felt must be the same whatever its triangles.
  for (const double unit : {1.0, 1e-3, 1e3}) {
    const bool felt = Probe(engine, nested_sheet(half_side_m, half_side_m), unit)
                          .approach(place, Vec3::UnitZ(), probe_depth_m)
                          .contact;
    if (begins_late && unit != 1.0 && !felt) continue;
    for (const double size_m : {1e-3, 1e-4, 1e-5, 1e-6, 1e-7}) {
      if (size_m * unit < 10.0 * engine.epsilon_m) continue;
      Probe coarse(engine, nested_sheet(half_side_m, half_side_m), unit);
      Probe fine(engine, nested_sheet(half_side_m, size_m), unit);
      // Down in the middle of the small ones, then over them and out over larger and larger ones.
      const Vec3 start(0.31 * size_m, 0.17 * size_m, 0.0);
      std::vector<Vec3> feet;
      feet.reserve(40);
      for (int i = 0; i < 40; ++i) feet.push_back(start * std::pow(0.5 * half_side_m / start.norm(), i / 39.0));
      double worst = 0.0;
      Vec3 worst_at = start;
      const auto compare = [&](const Vec3& at, const StepResult& expected, const StepResult& obtained) {
        const double off = (obtained.f_W_N - expected.f_W_N).norm() / expected.f_W_N.norm();
        if (!(off <= worst)) {
          worst = std::isfinite(off) ? off : 1.0;
          worst_at = at;
        }
      };
      compare(start, coarse.approach(start, Vec3::UnitZ(), probe_depth_m),
              fine.approach(start, Vec3::UnitZ(), probe_depth_m));
      for (const Vec3& foot : feet) {
        const StepResult expected = coarse.press(foot, Vec3::UnitZ(), probe_depth_m);
        compare(foot, expected, fine.press(foot, Vec3::UnitZ(), probe_depth_m));
      }
      if (worst <= 0.01) continue;
      return Finding{"untouchable-triangles",
                     fmt::format("on a plane sheet with triangles down to {:g} m the force is {:.0f} % off what it is "
                                 "on large ones, with lengths in units of {:g} m",
                                 size_m, 100.0 * worst, 1.0 / unit),
                     fmt::format("a sheet 40 mm wide whose squares halve towards the middle, lengths times {:g}, tip "
                                 "{:g} mm deep at ({:.3g}, {:.3g}) m",
                                 unit, 1e3 * probe_depth_m, worst_at.x(), worst_at.y()),
                     size_m, "m"};
    }
  }
  return std::nullopt;
}

std::optional<Finding> find_pops_through_shell(const Engine& engine) {
  constexpr double below_m = 5e-3;
  constexpr double step_m = 2e-5;
  const double late_m = std::max(engine.epsilon_m, first_force_m(engine)) + 2.0 * step_m;
  // What pulls inward everywhere lets nothing through: another detector says so.
  if (!(Probe(engine, level_block()).approach(place, Vec3::UnitZ(), probe_depth_m).f_W_N.z() > 0.0))
    return std::nullopt;
  for (const double thickness_m : {8e-3, 4e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 1e-5}) {
    Probe probe(engine, surface::box_mesh({-half_side_m, -half_side_m, -thickness_m}, {half_side_m, half_side_m, 0.0}));
    // Contact may begin late, as it does on a block, which is no pop: what counts is a force that was there and is
    // lost, and none below. Lost for a single sample is no way through.
    probe.approach(place, Vec3::UnitZ(), -step_m);
    const int steps = static_cast<int>(below_m / step_m);
    bool touched = false;
    for (int i = 0; i <= steps; ++i) {
      const double depth_m = step_m * (i + 0.5);
      const auto holds = [&](double at_m) {
        const StepResult now = probe.press(place, Vec3::UnitZ(), at_m);
        return now.contact && now.f_W_N.z() > 0.0;
      };
      if (holds(depth_m) || (touched && holds(depth_m + step_m / 3.0))) {
        touched = true;
        continue;
      }
      if (!touched && depth_m < std::max(thickness_m + engine.tip_radius_m, late_m)) continue;
      return Finding{"pops-through-shell",
                     fmt::format("a tip pushed into a plate {:g} mm thick is let through, or out below, {:.3g} mm deep",
                                 1e3 * thickness_m, 1e3 * depth_m),
                     fmt::format("a plate 40 mm wide and {:g} mm thick, the tip pushed down on its middle in steps of "
                                 "{:g} mm",
                                 1e3 * thickness_m, 1e3 * step_m),
                     thickness_m, "m"};
    }
  }
  return std::nullopt;
}

}  // namespace touchstone::renderer_faults
