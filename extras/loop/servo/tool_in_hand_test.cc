// Tools with a shape in the loop, beside points and walls whose loop is known.
#include "servo/tool_in_hand.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "harness/surface/embree_surface.h"
#include "harness/testing/tiny_meshes.h"
#include "renderers/catalogue.h"
#include "servo/evaluation.h"
#include "servo/flat_wall.h"
#include "servo/limits.h"
#include "tool_renderers/tool_catalogue.h"

namespace touchstone::servo {
namespace {

constexpr double half_m = 5e-3;  // of the tool
constexpr double side_m = 0.05;  // of the object, whose top is z = 0

surface::TriangleMesh block() { return surface::box_mesh(Vec3(-side_m, -side_m, -side_m), Vec3(side_m, side_m, 0.0)); }

// A wall of its own on the block.
surface::TriangleMesh room(double wall_m) {
  surface::TriangleMesh mesh = block();
  const surface::TriangleMesh wall = surface::box_mesh(Vec3(wall_m, -side_m, 1e-3), Vec3(side_m, side_m, side_m));
  const int first = static_cast<int>(mesh.vertices_W_m.size());
  mesh.vertices_W_m.insert(mesh.vertices_W_m.end(), wall.vertices_W_m.begin(), wall.vertices_W_m.end());
  for (const auto& [a, b, c] : wall.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
  return mesh;
}

tool::ToolSettings settings(double stiffness_N_per_m) {
  tool::ToolSettings out;
  out.coupling.stiffness_N_per_m = stiffness_N_per_m;
  return out;
}

ToolInHand held(const surface::TriangleMesh& mesh_T, const std::string& renderer, double stiffness_N_per_m) {
  return ToolInHand(
      tool_renderers::make_tool_renderer(renderer, tool::solid_tool(mesh_T), block(), settings(stiffness_N_per_m)));
}

LoopParameters light(double stiffness_N_per_m = 300.0) {
  LoopParameters own;
  own.axis = {0.12, 0.5, 0.0, 4.0, stiffness_N_per_m, 0.0};
  own.hand_mass_kg = 0.02;
  return own;
}

LoopParameters with_every_effect() {
  LoopParameters own = light();
  own.axis.friction_N = 0.05;
  own.axis.actuator_time_constant_s = 2e-4;
  own.latency_s = 7e-4;
  own.jitter_s = 2e-4;
  own.resolution_m = 2e-5;
  own.virtual_damping_N_s_per_m = 1.0;
  own.velocity_cutoff_Hz = 150.0;
  own.seed = 11;
  return own;
}

// The handle from 2 mm above contact to where it presses with 1 N, and along x, over the block's edge if `far_m` is.
MotionColumns press(const LoopParameters& own, double reach_m, double from_m, double far_m) {
  MotionColumns path;
  const double deep_m = 1.0 / own.axis.hand_stiffness_N_per_m;
  for (int k = 0; k <= 200; ++k) {
    const double t = 0.01 * k;
    path.t_s.push_back(t);
    path.p_W_m.emplace_back(from_m + (far_m - from_m) * std::clamp((t - 0.8) / 1.0, 0.0, 1.0), 1e-3,
                            reach_m + 2e-3 - (2e-3 + deep_m) * std::min(1.0, t / 0.3));
  }
  return path;
}

struct Difference {
  double tip_m = 0.0, force_N = 0.0, largest_N = 0.0;
};
Difference difference(const LoopTrace& a, const LoopTrace& b) {
  Difference out;
  EXPECT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    out.tip_m = std::max(out.tip_m, (a.tip_W_m[i] - b.tip_W_m[i]).norm());
    out.force_N = std::max(out.force_N, (a.commanded_W_N[i] - b.commanded_W_N[i]).norm());
    out.largest_N = std::max(out.largest_N, b.commanded_W_N[i].norm());
  }
  return out;
}

TEST(ToolInHand, ABoxOnAPlaneIsTheFlatWallOfItsCoupling) {
  for (const double stiffness : {300.0, 1500.0}) {
    ToolInHand box = held(testing::cube(half_m), "god-object-tool", stiffness);
    FlatWall wall(stiffness, half_m);
    const LoopParameters own = with_every_effect();
    const MotionColumns path = press(own, half_m, -0.01, 0.01);
    const Difference found = difference(run_loop(box, path, own), run_loop(wall, path, own));
    fmt::print("box on a plane, {} N/m: tip within {:.1e} m, force within {:.1e} of {:.2f} N\n", stiffness, found.tip_m,
               found.force_N, found.largest_N);
    EXPECT_GT(found.largest_N, 0.5);
    EXPECT_LT(found.tip_m, 1e-9);
    EXPECT_LT(found.force_N, 1e-6);
  }
}

TEST(ToolInHand, ABoxIsStableUpToTheLimitOfItsCoupling) {
  for (const LoopParameters& own : {light(), light(800.0)}) {
    for (const double latency_s : {0.0, 2e-3}) {
      LoopParameters late = own;
      late.latency_s = latency_s;
      const double critical = critical_gain(late)->stiffness_N_per_m;
      for (const auto& [share, verdict] : {std::pair{0.5, Verdict::stable}, {1.3, Verdict::unstable}}) {
        ToolInHand box = held(testing::cube(half_m), "god-object-tool", share * critical);
        const Judgement found = judge_loop(box, press(late, half_m, 0.0, 0.0), late, {});
        EXPECT_EQ(found.verdict, verdict) << share << " of " << critical << " N/m: " << sentence(found);
      }
    }
  }
}

// A ball of triangles touches a plane with the corner that lies at its radius: so here, the floor and the wall.
TEST(ToolInHand, ABallIsTheCoresBallTip) {
  constexpr double wall_stiffness = 500.0, wall_at_m = 0.02;
  const surface::TriangleMesh object = room(wall_at_m);
  rendering::Model model;
  model.renderer = "god-object";
  model.parameters = {{"stiffness_N_per_m", wall_stiffness}, {"tip_radius_m", half_m}};
  const auto tip = renderers::make_renderer(model, surface::make_embree_surface(object));
  ToolInHand tool(tool_renderers::make_tool_renderer("god-object-tool", tool::solid_tool(testing::ball(half_m, 4)),
                                                     object, settings(wall_stiffness)));
  const LoopParameters own = with_every_effect();
  const MotionColumns path = press(own, half_m, 0.0, wall_at_m);
  const LoopTrace of_tool = run_loop(tool, path, own), of_tip = run_loop(*tip, path, own);
  const Difference found = difference(of_tool, of_tip);
  fmt::print("ball along the floor to the wall: within {:.1e} m and {:.1e} of {:.2f} N\n", found.tip_m, found.force_N,
             found.largest_N);
  EXPECT_LT(of_tip.commanded_W_N.back().x(), -0.3);
  EXPECT_GT(of_tip.commanded_W_N.back().z(), 0.3);
  EXPECT_LT(found.tip_m, 1e-9);
  EXPECT_LT(found.force_N, 1e-6);
}

TEST(ToolInHand, EnergyBalancesAndARunRepeatsToTheBitWithEveryRendererAndEffect) {
  const LoopParameters own = with_every_effect();
  const MotionColumns path = press(own, half_m, side_m - 8e-3, side_m);
  for (const auto& entry : tool_renderers::tool_renderer_catalogue()) {
    ToolInHand box = held(testing::cube(half_m), entry.name, 800.0);
    const LoopTrace trace = run_loop(box, path, own), again = run_loop(box, path, own);
    double worst_J = 0.0, lost_J = 0.0;
    for (std::size_t i = 0; i < trace.size(); ++i) {
      ASSERT_EQ(trace.tip_W_m[i], again.tip_W_m[i]) << entry.name;
      const auto since = [i](const std::vector<double>& energy_J) { return energy_J[i] - energy_J[0]; };
      lost_J = std::max(lost_J, since(trace.lost_J));
      worst_J = std::max(worst_J, std::abs(since(trace.kinetic_J) - since(trace.by_actuator_J) -
                                           since(trace.by_hand_J) + since(trace.lost_J)));
    }
    EXPECT_GT(box.torque().largest_Nm, 0.0) << entry.name;
    EXPECT_GT(lost_J, 1e-4) << entry.name;
    EXPECT_LT(worst_J, 1e-12 * lost_J) << entry.name;
  }
}

// A ball at the end of a lever: the torque about the handle is the lever's.
TEST(ToolInHand, TheTorqueIsSaidAndTurnsNothing) {
  constexpr double lever_m = 0.03;
  surface::TriangleMesh ball = testing::ball(half_m, 3);
  for (Vec3& corner : ball.vertices_W_m) corner.x() += lever_m;
  ToolInHand lever = held(ball, "god-object-tool", 500.0);
  const LoopParameters own = light();
  const LoopTrace trace = run_loop(lever, press(own, half_m, 0.0, 0.0), own);
  double largest_N = 0.0;
  for (const Vec3& f : trace.commanded_W_N) largest_N = std::max(largest_N, f.norm());
  EXPECT_GT(largest_N, 0.3);
  EXPECT_NEAR(lever.torque().largest_Nm, lever_m * largest_N, 0.02 * lever_m * largest_N);
  EXPECT_GT(lever.torque().at_s, 0.1);
  lever.reset();
  EXPECT_EQ(lever.torque().largest_Nm, 0.0);
}

}  // namespace
}  // namespace touchstone::servo
