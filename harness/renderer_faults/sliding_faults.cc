// Faults of sliding: what edges, joints and triangles do to the force, and friction.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "harness/renderer_faults/detectors.h"
#include "harness/renderer_faults/meshes.h"
#include "harness/renderer_faults/probe.h"
#include "harness/surface/box_mesh.h"
#include "harness/surface/sphere_mesh.h"

namespace touchstone::renderer_faults {
using surface::TriangleMesh;

namespace {

// Along x from -start to start over what lies at x = 0, `depth_m` below planes given by their falling angle on the
// right.
struct Slide {
  double angle_rad = 0.0;
  double depth_m = 7.5e-4;
  double start_m = 6e-3;
  double step_m = 2e-5;
};

struct SlideResult {
  double worst_N = 0.0;  // off the right force, beyond what friction may add
  double at_x_m = 0.0;
};

// Past what is at the joint by twice the depth the right answer is that of one plane alone: k d along its normal.
SlideResult slide_over(const Engine& engine, const TriangleMesh& mesh, const Slide& slide) {
  Probe probe(engine, mesh);
  const Vec3 n_right(std::sin(slide.angle_rad), 0.0, std::cos(slide.angle_rad));
  const double y = 0.0017;
  const auto foot = [&](double x) { return Vec3(x, y, x > 0.0 ? -x * std::tan(slide.angle_rad) : 0.0); };
  probe.approach(foot(-slide.start_m), Vec3::UnitZ(), slide.depth_m);
  // The load is that of a tip that came to rest: in the last step of the way down a damped contact has more.
  constexpr int rest = 100;
  double load_N = 0.0;
  for (int i = 0; i < rest; ++i)
    load_N = probe.press(foot(-slide.start_m), Vec3::UnitZ(), slide.depth_m).f_W_N.dot(Vec3::UnitZ());
  SlideResult result;
  // What is not felt on a plane does not stick: another detector says so.
  constexpr double least = 0.05;
  if (!(load_N > least * engine.stiffness_N_per_m * slide.depth_m)) return result;
  // What holds back a tip that slides over a plane, as a damper does, is measured where the slide begins.
  Vec3 before = Vec3::Zero();
  const double begun_m = -slide.start_m + 10.0 * slide.step_m;
  const double reach_m = 2.0 * slide.depth_m + engine.tip_radius_m;
  const int steps = static_cast<int>(std::round(2.0 * slide.start_m / slide.step_m));
  for (int i = 0; i <= steps; ++i) {
    const double x = slide.step_m * i - slide.start_m;
    const Vec3& n = x > 0.0 ? n_right : Vec3(Vec3::UnitZ());
    const rendering::StepResult now = probe.press(foot(x), n, slide.depth_m);
    if (std::abs(x) < reach_m) continue;
    const double normal_N = now.f_W_N.dot(n);
    const Vec3 tangent_N = now.f_W_N - normal_N * n;
    if (x < begun_m) before = tangent_N;
    const double sideways_N = std::min(tangent_N.norm(), (tangent_N - before).norm());
    const double off_N = std::max(std::abs(normal_N - load_N), sideways_N - engine.friction * load_N);
    if (off_N <= result.worst_N) continue;
    result = {off_N, x};
    if (std::isnan(off_N)) break;
  }
  return result;
}

// 1 % of the load, which is below what anyone notices; the engine's own epsilon on top.
double allowed_N(const Engine& engine, const Slide& slide) {
  return engine.stiffness_N_per_m * (0.01 * slide.depth_m + engine.epsilon_m);
}

// On the level block, of a tip that came to rest.
Vec3 rested_force_N(const Engine& engine, double depth_m) {
  Probe probe(engine, level_block());
  probe.approach(place, Vec3::UnitZ(), depth_m);
  constexpr int rest = 100;
  Vec3 last = Vec3::Zero();
  for (int i = 0; i < rest; ++i) last = probe.press(place, Vec3::UnitZ(), depth_m).f_W_N;
  return last;
}

// An edge between two triangles, its bend and a direction across it.
struct Crossing {
  Vec3 middle;
  Vec3 n;       // mean of both normals
  Vec3 across;  // from the first triangle to the second, unit length
  double bend_rad = 0.0;
};

std::vector<Crossing> crossings(const TriangleMesh& mesh) {
  std::map<std::pair<std::int32_t, std::int32_t>, std::size_t> first;
  std::vector<Crossing> found;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int32_t a = mesh.triangles[t][i];
      const std::int32_t b = mesh.triangles[t][(i + 1) % 3];
      const auto other = first.find({b, a});
      if (other == first.end()) {
        first[{a, b}] = t;
        continue;
      }
      const Vec3 n_first = mesh.scaled_normal(other->second).normalized();
      const Vec3 n_second = mesh.scaled_normal(t).normalized();
      const Vec3 p = mesh.vertices_W_m[static_cast<std::size_t>(a)];
      const Vec3 q = mesh.vertices_W_m[static_cast<std::size_t>(b)];
      Crossing crossing;
      // Not in the middle: there two other edges may be as near.
      crossing.middle = 0.55 * p + 0.45 * q;
      crossing.n = (n_first + n_second).normalized();
      // In triangle t the edge runs a to b with the triangle on its left.
      crossing.across = crossing.n.cross((q - p).normalized()).normalized();
      crossing.bend_rad = std::atan2(n_first.cross(n_second).norm(), n_first.dot(n_second));
      found.push_back(crossing);
    }
  }
  return found;
}

// Largest tangential over normal force in a slow drag over a level block, its first steps included.
double friction_felt(const Engine& engine, double unit) {
  Probe probe(engine, level_block(), unit);
  const Vec3 from(-5e-3, 1.7e-3, 0.0);
  probe.approach(from, Vec3::UnitZ(), probe_depth_m);
  double most = 0.0;
  for (int i = 1; i <= 1000; ++i) {
    const rendering::StepResult now = probe.press(from + Vec3(1e-5 * i, 0.0, 0.0), Vec3::UnitZ(), probe_depth_m);
    if (now.f_W_N.z() > 0.0) most = std::max(most, -now.f_W_N.x() / now.f_W_N.z());
  }
  return most;
}

// The centre of a ball that slides at one height over the level top of a block, and on past its edge at x = 0, rests at
// the distance r from the block that is closest: over the top, on the arc about the edge, before the side.
// `right_N` is the force for the way from the tip to there.
std::optional<Finding> find_ball_at_edge_beside(const Engine& engine,
                                                const std::function<Vec3(const Vec3& way)>& right_N) {
  const double r = engine.tip_radius_m;
  // Friction may hold it there, and rightly.
  if (r == 0.0 || engine.friction > 0.0) return std::nullopt;
  constexpr double y_m = 0.0013;
  constexpr double step_m = 2e-5;
  // Two samples of a step, and a twentieth of the load of a ball whose centre is in the surface.
  const double allowed_N = engine.stiffness_N_per_m * (2.0 * step_m + 2.0 * engine.epsilon_m + 0.05 * r);
  // A tip within its epsilon of another place is there to the engine.
  const int most_samples = 4 + static_cast<int>(std::ceil(2.0 * engine.epsilon_m / step_m));
  for (const double share : {0.2, 1.4e-4, -0.5}) {
    const double z = share * r;
    const auto rest = [&](double x) -> Vec3 {
      if (x <= 0.0) return {x, y_m, std::max(r, z)};
      if (z <= 0.0) return {std::max(x, r), y_m, z};
      const double away = std::hypot(x, z);
      return away >= r ? Vec3(x, y_m, z) : Vec3(r / away * x, y_m, r / away * z);
    };
    Probe probe(engine,
                surface::box_mesh({-2.0 * half_side_m, -half_side_m, -2.0 * half_side_m}, {0.0, half_side_m, 0.0}));
    const double from_m = -3.0 * r;
    probe.to({from_m, y_m, 2.0 * r});
    for (int i = 1; i <= 20; ++i) probe.to({from_m, y_m, 2.0 * r + (z - 2.0 * r) * i / 20.0});
    int longest = 0;
    int now = 0;
    double worst_N = 0.0;
    for (int i = 0; i < static_cast<int>(4.5 * r / step_m); ++i) {
      const double x = from_m + step_m * (i + 0.37);
      const Vec3 tip(x, y_m, z);
      const double off_N = (probe.to(tip).f_W_N - right_N(rest(x) - tip)).norm();
      now = off_N <= allowed_N ? 0 : now + 1;
      longest = std::max(longest, now);
      if (now > 0) worst_N = std::max(worst_N, off_N);
    }
    if (longest <= most_samples) continue;
    return Finding{
        "ball-at-edge",
        fmt::format("over a sharp edge a ball of {:g} mm is up to {:.2g} N off, for {} samples", 1e3 * r, worst_N,
                    longest),
        fmt::format("a block with an edge of 90 degrees, the ball's centre {:.3g} mm {} its top, sliding over the "
                    "edge by {:g} um a sample",
                    1e3 * std::abs(z), z > 0.0 ? "above" : "below", 1e6 * step_m),
        worst_N, "N"};
  }
  return std::nullopt;
}

}  // namespace

std::optional<Finding> find_sticks_at_flat_edges(const Engine& engine) {
  Slide slide;
  // Beyond a degree or so force shading rightly changes the force near an edge.
  for (const double bend : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10}) {
    for (const double sign : {1.0, -1.0}) {
      slide.angle_rad = sign * bend;
      const SlideResult result = slide_over(engine, roof(half_side_m, slide.angle_rad), slide);
      if (result.worst_N <= allowed_N(engine, slide)) continue;
      return Finding{"sticks-at-flat-edges",
                     fmt::format("behind a {} edge of {:g} rad the force is {:.3g} N off, {:.3g} mm past it",
                                 sign > 0.0 ? "convex" : "concave", bend, result.worst_N, 1e3 * result.at_x_m),
                     fmt::format("two planes 20 mm wide that meet at {:g} rad, the tip sliding over the edge {:g} mm "
                                 "deep",
                                 bend, 1e3 * slide.depth_m),
                     bend, "rad"};
    }
  }
  return std::nullopt;
}

std::optional<Finding> find_sticks_at_joints(const Engine& engine) {
  const Slide slide;
  const double h = half_side_m;
  for (const double overlap_m : {0.0, 1e-3}) {
    // Each order of the two bodies, and the joint off the origin's own coordinates.
    for (const bool left_first : {true, false}) {
      const TriangleMesh left = surface::box_mesh({-h, -h, -h}, {0.5 * overlap_m, h, 0.0});
      const TriangleMesh right = surface::box_mesh({-0.5 * overlap_m, -h, -h}, {h, h, 0.0});
      const TriangleMesh both = left_first ? together(left, right) : together(right, left);
      const SlideResult result = slide_over(engine, both, slide);
      if (result.worst_N <= allowed_N(engine, slide)) continue;
      return Finding{"sticks-at-joints",
                     fmt::format("past the joint of two blocks with level tops the force is {:.3g} N off, {:.3g} mm "
                                 "from it",
                                 result.worst_N, 1e3 * result.at_x_m),
                     fmt::format("two blocks that {}, tops at one height, the tip sliding across {:g} mm deep",
                                 overlap_m > 0.0 ? fmt::format("overlap by {:g} mm", 1e3 * overlap_m) : "touch",
                                 1e3 * slide.depth_m),
                     result.worst_N, "N"};
    }
  }
  return std::nullopt;
}

std::optional<Finding> find_jump_between_triangles(const Engine& engine) {
  constexpr double step_m = 2e-7;
  constexpr double depth_m = 1e-4;
  struct Case {
    TriangleMesh mesh;
    const char* name;
  };
  std::vector<Case> cases{{nested_sheet(half_side_m, 1e-3), "a plane sheet 40 mm wide"}};
  // Where the surface bends, a renderer may declare that it jumps. Between triangles of one plane there is nothing that
  // could.
  if (find_limitation(engine.cannot, rendering::Ability::continuous_force) == nullptr)
    cases.insert(cases.begin(), {surface::sphere_mesh(half_side_m, 4), "a ball of 2048 triangles, 20 mm in radius"});
  for (const Case& one : cases) {
    Probe probe(engine, one.mesh);
    const auto edges = crossings(one.mesh);
    // A probe that rests at every place takes long: some edges are enough to see whether rest makes them right.
    constexpr std::size_t rests = 16;
    const std::size_t stride = 1 + static_cast<std::size_t>(engine.settle_samples) / rests;
    for (std::size_t at = 0; at < edges.size(); at += stride) {
      const Crossing& edge = edges[at];
      // A proxy keeps its face until its own foot passes the edge.
      const int reach = 5 + static_cast<int>(depth_m * edge.bend_rad / step_m);
      probe.reset();
      const double load_N = probe.approach(edge.middle - reach * step_m * edge.across, edge.n, depth_m, 4).f_W_N.norm();
      double last_N = 0.0;
      double jump_N = 0.0;
      for (int i = -reach; i <= reach; ++i) {
        const double now_N = probe.press(edge.middle + (i + 0.5) * step_m * edge.across, edge.n, depth_m).f_W_N.norm();
        // The first ones may turn from pressing to sliding, which friction feels.
        if (i > 2 - reach) jump_N = std::max(jump_N, std::abs(now_N - last_N));
        last_N = now_N;
      }
      // A ridge: from face to face the depth changes by its cosine; the rest is the tip's own way.
      const double right_N = load_N * (1.0 - std::cos(edge.bend_rad)) +
                             engine.stiffness_N_per_m * ((2.0 + engine.friction) * step_m + engine.epsilon_m);
      if (jump_N <= right_N) continue;
      return Finding{
          "jump-between-triangles",
          fmt::format("from one triangle to its neighbour, {:.2g} rad apart, the force of {:.3g} N jumps by {:.3g} N "
                      "({:.2g} N are right)",
                      edge.bend_rad, load_N, jump_N, right_N),
          fmt::format("{}, the tip {:g} mm deep moving {:g} um across the edge at ({:.4g}, {:.4g}, {:.4g}) m", one.name,
                      1e3 * depth_m, 1e6 * step_m, edge.middle.x(), edge.middle.y(), edge.middle.z()),
          jump_N, "N"};
    }
  }
  return std::nullopt;
}

std::optional<Finding> find_ball_at_edge(const Engine& engine) {
  // A contact that is softer or stiffer than its author says, by more than its epsilon, is so at the edge, too: by the
  // power law through two depths on a plane.
  const double half_m = 0.5 * engine.tip_radius_m;
  const double half_N = half_m > 0.0 ? rested_force_N(engine, half_m).norm() : 0.0;
  const double quarter_N = half_m > 0.0 ? rested_force_N(engine, 0.5 * half_m).norm() : 0.0;
  const double linear_N = engine.stiffness_N_per_m * half_m;
  const double allowed_N = 0.01 * linear_N + 2.0 * engine.stiffness_N_per_m * engine.epsilon_m;
  const bool known = quarter_N > 0.0 && half_N > quarter_N && std::abs(half_N - linear_N) > allowed_N;
  const double power = known ? std::log2(half_N / quarter_N) : 1.0;
  return find_ball_at_edge_beside(engine, [&](const Vec3& way) -> Vec3 {
    if (!known || way.norm() == 0.0) return engine.stiffness_N_per_m * way;
    return half_N * std::pow(way.norm() / half_m, power) * way.normalized();
  });
}

std::optional<Finding> find_ball_at_edge_under(const Engine& engine, const ForceMap& map) {
  return find_ball_at_edge_beside(engine, [&](const Vec3& way) { return map(engine.stiffness_N_per_m * way); });
}

std::optional<Finding> find_friction_lost(const Engine& engine) {
  if (engine.friction == 0.0) return std::nullopt;
  for (const double unit : {1.0, 1e-3, 1e3}) {
    // Pressed by less than some epsilons an engine need not feel the body.
    if (probe_depth_m * unit < 4.0 * engine.epsilon_m) continue;
    const double felt = friction_felt(engine, unit);
    if (felt >= 0.5 * engine.friction) continue;
    return Finding{"friction-lost",
                   fmt::format("dragged over a plane, the tangential force reaches {:.3g} of the normal force; {:.3g} "
                               "is declared; lengths in units of {:g} m",
                               felt, engine.friction, 1.0 / unit),
                   fmt::format("a block 40 mm wide, lengths times {:g}, the tip {:g} mm deep, dragged 10 mm at 10 mm/s",
                               unit, 1e3 * probe_depth_m),
                   felt, "1"};
  }
  return std::nullopt;
}

}  // namespace touchstone::renderer_faults
