#include "contacts/exact_cases.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <utility>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/base/rotations.h"

namespace touchstone::contacts {
namespace {

// A body of about 20 mm that the hand holds 15 mm above and 5 mm beside its centre: every contact has a lever.
const Vec3 center_T_m(0.005, -0.002, -0.015);
constexpr std::size_t fine_triangles = 10000;
constexpr std::size_t poses = 8;
constexpr double slab_half_m = 0.04;
constexpr double sideways_m = 0.004;

// Each case is made `s` times as large as its description says.
surface::TriangleMesh slab(double s) {
  return box_mesh(s * Vec3(-slab_half_m, -slab_half_m, -0.02), s * Vec3(slab_half_m, slab_half_m, 0.0), 8);
}

// Poses about `touching`, pressed in by 0.5 to 3 mm along -z, whatever the size, and turned by up to `tilt`. A fixed
// seed: the cases are part of the definition of the table.
void add_presses(ExactCase& c, const tool::Pose& touching, double tilt_rad, double aside_m) {
  Random random(2007);
  c.free = {touching.p_W_m + Vec3(0, 0, 0.006), touching.q_WT};
  for (std::size_t i = 0; i < poses; ++i) {
    const Vec3 aside(random.uniform(-aside_m, aside_m), random.uniform(-aside_m, aside_m),
                     -random.uniform(0.0005, 0.003));
    c.handles.push_back(moved(touching, {aside, random.uniform(0.2, 1.0) * tilt_rad * random.direction()}));
  }
}

ExactCase sphere_on_plane(double s) {
  ExactCase c;
  c.what = "a ball of 20 mm on a plane";
  c.tool_T = ellipsoid_mesh(s * center_T_m, Vec3::Constant(s * 0.01), fine_triangles);
  c.object_W = slab(s);
  c.gaps = {ball_on_plane(s * center_T_m, s * 0.01, Vec3::UnitZ(), 0.0)};
  c.goes_on_along_x = true;
  add_presses(c, {Vec3(0, 0, s * 0.025), Quat::Identity()}, 0.2, s * sideways_m);
  return c;
}

ExactCase sphere_on_sphere(double s) {
  ExactCase c;
  c.what = "a ball of 20 mm on a ball of 60 mm";
  c.tool_T = ellipsoid_mesh(s * center_T_m, Vec3::Constant(s * 0.01), fine_triangles);
  c.object_W = ellipsoid_mesh(Vec3(0, 0, s * -0.03), Vec3::Constant(s * 0.03), fine_triangles);
  c.gaps = {ball_on_ball(s * center_T_m, s * 0.01, Vec3(0, 0, s * -0.03), s * 0.03)};
  add_presses(c, {Vec3(0, 0, s * 0.025), Quat::Identity()}, 0.2, s * sideways_m);
  return c;
}

const Vec3 semi_axes_m(0.012, 0.008, 0.006);

ExactCase ellipsoid_on_plane_case(double s) {
  ExactCase c;
  c.what = "an ellipsoid of 24 x 16 x 12 mm on a plane";
  c.tool_T = ellipsoid_mesh(s * center_T_m, s * semi_axes_m, fine_triangles);
  c.object_W = slab(s);
  c.gaps = {ellipsoid_on_plane(s * center_T_m, s * semi_axes_m, Vec3::UnitZ(), 0.0)};
  c.goes_on_along_x = true;
  add_presses(c, {Vec3(0, 0, s * 0.021), Quat::Identity()}, 0.3, s * sideways_m);
  return c;
}

ExactCase ellipsoid_on_sphere_case(double s) {
  ExactCase c;
  c.what = "an ellipsoid of 24 x 16 x 12 mm on a ball of 60 mm";
  c.tool_T = ellipsoid_mesh(s * center_T_m, s * semi_axes_m, fine_triangles);
  c.object_W = ellipsoid_mesh(Vec3(0, 0, s * -0.03), Vec3::Constant(s * 0.03), fine_triangles);
  c.gaps = {ellipsoid_on_ball(s * center_T_m, s * semi_axes_m, Vec3(0, 0, s * -0.03), s * 0.03)};
  add_presses(c, {Vec3(0, 0, s * 0.021), Quat::Identity()}, 0.2, s * sideways_m);
  return c;
}

// A cube of 20 mm about center_T_m, turned so that a face, an edge or a corner is lowest.
ExactCase cube_on_plane(const std::string& what, const Quat& turned, double lowest_m, double tilt_rad, double s) {
  ExactCase c;
  c.what = what;
  const Vec3 center = s * center_T_m;
  const Vec3 half = Vec3::Constant(s * 0.01);
  c.tool_T = box_mesh(center - half, center + half);
  c.object_W = slab(s);
  for (const Vec3& corner : c.tool_T.vertices_W_m) c.gaps.push_back(ball_on_plane(corner, 0.0, Vec3::UnitZ(), 0.0));
  c.goes_on_along_x = true;
  const Vec3 center_W = turned * center;
  add_presses(c, {Vec3(0, 0, s * lowest_m - center_W.z()), turned}, tilt_rad, s * sideways_m);
  return c;
}

ExactCase two_spheres_on_a_bar(double s) {
  ExactCase c;
  c.what = "two balls of 10 mm, 40 mm apart on a bar, on a plane: the torque balances between them";
  const Vec3 first(s * -0.02, 0, s * -0.02);
  const Vec3 second(s * 0.02, 0, s * -0.02);
  const Vec3 bar_half(s * 0.02, s * 0.001, s * 0.001);
  const Vec3 middle(0, 0, s * -0.02);
  c.tool_T = joined(joined(ellipsoid_mesh(first, Vec3::Constant(s * 0.005), 4000),
                           ellipsoid_mesh(second, Vec3::Constant(s * 0.005), 4000)),
                    box_mesh(middle - bar_half, middle + bar_half));
  c.object_W = slab(s);
  c.gaps = {ball_on_plane(first, s * 0.005, Vec3::UnitZ(), 0.0), ball_on_plane(second, s * 0.005, Vec3::UnitZ(), 0.0)};
  c.goes_on_along_x = true;
  add_presses(c, {Vec3(0, 0, s * 0.025), Quat::Identity()}, 0.05, s * sideways_m);
  return c;
}

ExactCase cylinder_in_groove(double s) {
  ExactCase c;
  c.what = "a cylinder of 16 mm, 30 mm long, in a V-groove of 90 degrees";
  const double radius = s * 0.008;
  const double length = s * 0.03;
  const double depth = s * 0.012;
  const Vec3 center(0, 0, s * -0.015);
  c.goes_on_along_x = true;
  c.tool_T = cylinder_mesh(center, radius, length, 360);
  c.object_W = groove_mesh(depth, 0.25 * std::numbers::pi, s * slab_half_m);
  for (const double side : {-1.0, 1.0}) {
    // The wall that rises to +y looks to -y.
    const Vec3 n = Vec3(0, -side, 1).normalized();
    for (const double end : {-0.5, 0.5}) {
      c.gaps.push_back(disc_on_plane(center + Vec3(end * length, 0, 0), Vec3::UnitX(), radius, n, n.z() * -depth));
    }
  }
  const double axis_z = -depth + radius * std::numbers::sqrt2;
  add_presses(c, {Vec3(0, 0, axis_z - center.z()), Quat::Identity()}, 0.05, s * 0.0015);
  return c;
}

ExactCase peg_in_hole(double clearance_m, double s) {
  ExactCase c;
  c.what = fmt::format("a square peg of 20 mm in a hole with {} mm of clearance on each side, 15 mm deep",
                       clearance_m * 1e3);
  const double half = s * 0.01;
  const double end_T = s * -0.035;
  const double inserted = s * 0.015;
  c.tool_T = box_mesh(Vec3(-half, -half, end_T), Vec3(half, half, end_T + s * 0.04));
  c.object_W = hole_mesh(half + clearance_m, s * slab_half_m, s * 0.03);
  for (const GapOfPose& gap : square_peg_in_hole(half, end_T, half + clearance_m)) c.gaps.push_back(gap);
  c.free = {Vec3(0, 0, -end_T - inserted), Quat::Identity()};
  Random random(1982);
  for (std::size_t i = 0; i < poses; ++i) {
    const Vec3 aside(random.uniform(-0.002, 0.002), 0.0, 0.0);
    c.handles.push_back(moved(c.free, {aside, Vec3(0, random.uniform(-0.08, 0.08), 0)}));
  }
  return c;
}

Quat edge_down() { return Quat(Eigen::AngleAxisd(0.25 * std::numbers::pi, Vec3::UnitX())); }
Quat corner_down() { return shortest_rotation(Vec3(1, 1, -1), -Vec3::UnitZ()); }

struct Known {
  std::string name;
  std::optional<double> clearance_m;  // of a peg
  std::function<ExactCase(double scale)> make;
};

const std::vector<Known>& catalogue() {
  const auto cube = [](const char* what, const Quat& turned, double lowest_m, double tilt_rad) {
    return [=](double s) { return cube_on_plane(what, turned, lowest_m, tilt_rad, s); };
  };
  static const std::vector<Known> all{
      {"sphere-plane", {}, sphere_on_plane},
      {"sphere-sphere", {}, sphere_on_sphere},
      {"ellipsoid-plane", {}, ellipsoid_on_plane_case},
      {"ellipsoid-sphere", {}, ellipsoid_on_sphere_case},
      {"box-face", {}, cube("a face of a cube of 20 mm on a plane", Quat::Identity(), 0.01, 0.02)},
      {"box-edge", {}, cube("an edge of a cube of 20 mm on a plane", edge_down(), 0.01 * std::numbers::sqrt2, 0.02)},
      {"box-corner",
       {},
       cube("a corner of a cube of 20 mm on a plane", corner_down(), 0.01 * std::numbers::sqrt3, 0.1)},
      {"two-spheres", {}, two_spheres_on_a_bar},
      {"cylinder-groove", {}, cylinder_in_groove},
      {"peg-0.5mm", 0.5e-3, {}},
      {"peg-0.2mm", 0.2e-3, {}},
      {"peg-0.1mm", 0.1e-3, {}},
      {"peg-0.05mm", 0.05e-3, {}},
  };
  return all;
}

void check_shape(std::string_view name, const tool::ContactShape& shape) {
  if (!(shape.scale > 0.0) || !std::isfinite(shape.scale))
    throw UsageError(fmt::format("case '{}': scale {}; more than 0 was expected", name, shape.scale));
  if (name == peg && !shape.clearance_m)
    throw UsageError("case 'peg': give clearance_m, or take a case with one, such as peg-0.2mm");
  if (name != peg && shape.clearance_m)
    throw UsageError(fmt::format("case '{}' takes no clearance_m; 'peg' does", name));
  if (shape.clearance_m && (!(*shape.clearance_m > 0.0) || !std::isfinite(*shape.clearance_m)))
    throw UsageError(fmt::format("case 'peg': clearance_m {}; more than 0 was expected", *shape.clearance_m));
}

}  // namespace

std::vector<std::string> exact_case_names() {
  std::vector<std::string> names;
  for (const Known& one : catalogue()) names.push_back(one.name);
  return names;
}

ExactCase make_exact_case(std::string_view name, const tool::ContactShape& shape) {
  check_shape(name, shape);
  std::string known;
  const auto named = [&](ExactCase made) {
    made.name = name;
    return made;
  };
  if (name == peg) return named(peg_in_hole(*shape.clearance_m, shape.scale));
  for (const Known& one : catalogue()) {
    if (one.name == name)
      return named(one.clearance_m ? peg_in_hole(*one.clearance_m, shape.scale) : one.make(shape.scale));
    known += (known.empty() ? "" : ", ") + one.name;
  }
  throw UsageError(fmt::format("case '{}' is not known; known: {}", name, known));
}

}  // namespace touchstone::contacts
