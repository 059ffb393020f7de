// The constraint-based god-object at rest against a slow exact twin: random convex bodies on a plane and in a groove,
// every vertex against every wall, the step towards the handle by CGAL's quadratic programming in exact arithmetic,
// repeated until it is nought. There the forces balance: nothing of the renderer's search for contacts, margins or
// solver is in it.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/MP_Float.h>
#include <CGAL/QP_functions.h>
#include <CGAL/QP_models.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "contacts/tool_meshes.h"
#include "harness/base/random.h"
#include "harness/tool/tool_path.h"
#include "tool_renderers/tool_catalogue.h"

namespace touchstone::tool_renderers {
using surface::TriangleMesh;
using tool::Coupling;
using tool::Displacement;
using tool::Pose;

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

TriangleMesh random_hull(Random& random, const Vec3& center_m, double radius_m) {
  std::vector<Kernel::Point_3> points;
  for (int i = 0; i < 10; ++i) {
    const Vec3 p = center_m + radius_m * random.direction();
    points.emplace_back(p.x(), p.y(), p.z());
  }
  CGAL::Surface_mesh<Kernel::Point_3> hull;
  CGAL::convex_hull_3(points.begin(), points.end(), hull);
  TriangleMesh mesh;
  mesh.source = "hull";
  for (const auto v : hull.vertices())
    mesh.vertices_W_m.emplace_back(hull.point(v).x(), hull.point(v).y(), hull.point(v).z());
  for (const auto f : hull.faces()) {
    std::array<std::int32_t, 3> corners{};
    std::size_t k = 0;
    for (const auto v : hull.vertices_around_face(hull.halfedge(f))) corners.at(k++) = static_cast<std::int32_t>(v);
    mesh.triangles.push_back(corners);
  }
  return mesh;
}

struct Wall {
  Vec3 n_W;
  double d_m;  // n . x >= d outside
};

// min k_t |dp - free|^2 / 2 + k_r |dw - free|^2 / 2, no vertex behind a wall to first order.
std::optional<Displacement> exact_step(const TriangleMesh& mesh_T, const std::vector<Wall>& walls, const Pose& pose,
                                       const Pose& handle, const Coupling& coupling) {
  const Displacement free = displacement(pose, handle);
  CGAL::Quadratic_program<double> program(CGAL::LARGER, false, 0, false, 0);  // no bounds
  for (int k = 0; k < 3; ++k) {
    program.set_d(k, k, coupling.stiffness_N_per_m);
    program.set_c(k, -coupling.stiffness_N_per_m * free.translation_m[k]);
    program.set_d(k + 3, k + 3, coupling.rotational_stiffness_Nm_per_rad);
    program.set_c(k + 3, -coupling.rotational_stiffness_Nm_per_rad * free.rotation_rad[k]);
  }
  int row = 0;
  for (const Wall& wall : walls) {
    for (const Vec3& v : mesh_T.vertices_W_m) {
      const Vec3 r = pose.q_WT * v;
      const Vec3 lever = r.cross(wall.n_W);
      for (int k = 0; k < 3; ++k) {
        program.set_a(k, row, wall.n_W[k]);
        program.set_a(k + 3, row, lever[k]);
      }
      program.set_b(row, wall.d_m - wall.n_W.dot(pose.p_W_m + r));
      ++row;
    }
  }
  const auto solution = CGAL::solve_quadratic_program(program, CGAL::MP_Float());
  if (!solution.is_optimal()) return {};
  Displacement by;
  int k = 0;
  for (auto value = solution.variable_values_begin(); value != solution.variable_values_end(); ++value, ++k)
    (k < 3 ? by.translation_m[k] : by.rotation_rad[k - 3]) = CGAL::to_double(*value);
  return by;
}

std::optional<Pose> exact_rest(const TriangleMesh& mesh_T, const std::vector<Wall>& walls, const Pose& handle,
                               const Coupling& coupling) {
  Pose pose = handle;
  for (int round = 0; round < 60; ++round) {
    const auto by = exact_step(mesh_T, walls, pose, handle, coupling);
    if (!by) return {};
    pose = moved(pose, *by);
    if (by->translation_m.norm() + by->rotation_rad.norm() < 1e-14) return pose;
  }
  return {};
}

void expect_same(const TriangleMesh& object_W, const std::vector<Wall>& walls, std::uint64_t seed) {
  Random random(seed);
  const Coupling coupling;
  int touching = 0;
  for (int trial = 0; trial < 12; ++trial) {
    const TriangleMesh hull = random_hull(random, Vec3(0.004, -0.002, -0.010), 0.004);
    const auto renderer =
        make_tool_renderer("god-object-tool", {hull, tool::solid_mass_frame(hull, 1000.0)}, object_W, {coupling, {}});
    const Quat q = tool::rotation_by(0.4 * random.direction());
    // Where it just touches, straight down, and pressed in and turned from there.
    double lift = -1.0;
    for (const Wall& wall : walls) {
      for (const Vec3& v : hull.vertices_W_m) lift = std::max(lift, (wall.d_m - wall.n_W.dot(q * v)) / wall.n_W.z());
    }
    const Pose free{Vec3(0, 0, lift + 0.004), q};
    const Pose handle =
        tool::moved({Vec3(0, 0, lift), q},
                    {Vec3(random.uniform(-1e-3, 1e-3), random.uniform(-1e-3, 1e-3), -random.uniform(0.5e-3, 2.5e-3)),
                     0.15 * random.uniform() * random.direction()});
    const tool::ToolResult obtained = settle(*renderer, free, handle);
    const auto rest = exact_rest(hull, walls, handle, coupling);
    ASSERT_TRUE(rest.has_value()) << trial;
    const Wrench expected = coupling_wrench(coupling, handle, *rest);
    EXPECT_LE((obtained.f_W_N - expected.f_N).norm(), 1e-8) << trial;
    EXPECT_LE((obtained.torque_W_Nm - expected.torque_Nm).norm(), 1e-9) << trial;
    touching += expected.f_N.norm() > 0.1 ? 1 : 0;
  }
  EXPECT_GE(touching, 8) << "of twelve";
}

TEST(GodObjectToolTwin, RestsWhereTheExactTwinDoesOnAPlane) {
  expect_same(contacts::box_mesh(Vec3(-0.04, -0.04, -0.02), Vec3(0.04, 0.04, 0.0), 4), {{Vec3::UnitZ(), 0.0}}, 26001);
}

TEST(GodObjectToolTwin, RestsWhereTheExactTwinDoesInAGroove) {
  constexpr double press_depth = 0.02;
  const Vec3 right = Vec3(0, -1, 1).normalized();
  const Vec3 left = Vec3(0, 1, 1).normalized();
  expect_same(contacts::groove_mesh(press_depth, 0.25 * std::numbers::pi, 0.04),
              {{right, -press_depth * right.z()}, {left, -press_depth * left.z()}}, 26002);
}

}  // namespace
}  // namespace touchstone::tool_renderers
