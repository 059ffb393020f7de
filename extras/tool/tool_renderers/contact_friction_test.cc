// Friction at the points of a tool: closed forms of one point, the equation itself with many, and a cube and a ball
// that stick, slide, roll and spin.
#include "tool_renderers/contact_friction.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "contacts/known_contacts.h"
#include "harness/base/random.h"
#include "harness/surface/box_mesh.h"
#include "harness/surface/sphere_mesh.h"
#include "harness/tool/faulty_tool.h"
#include "harness/tool/tool_checks.h"
#include "harness/tool/tool_path.h"
#include "tool_errors.h"
#include "tool_renderers/tool_catalogue.h"

namespace touchstone::tool_renderers {
using surface::TriangleMesh;
using tool::ToolSettings;

namespace {

constexpr double mu = 0.3;
constexpr double contact_N_per_m = 20000.0;

TEST(ContactFriction, OnePointInClosedForm) {
  constexpr double spring = 1000.0;  // N/m, what holds the tool
  constexpr double press_depth = 1e-4;
  const Mat6 a = spring * Mat6::Identity();
  // Held at r = 0 it does not turn: (k0 + k) y_z = k d - N, and along x either (k0 + k) y_x = F or k0 y_x = F - mu f_n.
  for (const double pull : {0.1, 0.5, 0.7, 4.0}) {
    ContactFriction friction(1, mu, contact_N_per_m);
    friction.begin_step();
    const Vec3 first = friction.touch(0, Vec3::Zero(), Vec3::Zero(), Vec3::UnitZ(), press_depth);
    EXPECT_EQ(first, Vec3(0, 0, contact_N_per_m * press_depth)) << "it begins without friction";
    Vec6 b = Vec6::Zero();
    b[0] = pull;
    b[2] = -2.0;
    const Vec6 y = friction.displacement(a, b);
    const double y_z = (contact_N_per_m * press_depth - 2.0) / (spring + contact_N_per_m);
    const double f_n = contact_N_per_m * (press_depth - y_z);
    const double stuck = pull / (spring + contact_N_per_m);
    const double y_x = contact_N_per_m * stuck <= mu * f_n ? stuck : (pull - mu * f_n) / spring;
    EXPECT_NEAR(y[0], y_x, 1e-15) << pull;
    EXPECT_NEAR(y[2], y_z, 1e-15);
  }
}

TEST(ContactFriction, ManyPointsBalance) {
  Random random(91);
  for (int trial = 0; trial < 300; ++trial) {
    const std::size_t count = 1 + random.below(40);
    ContactFriction friction(count, mu, contact_N_per_m);
    friction.begin_step();
    const Mat3 frame = random.rotation().toRotationMatrix();
    struct Point {
      Vec3 r, n;
      double depth;
    };
    std::vector<Point> points;
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 r = frame * Vec3(random.uniform(-0.01, 0.01), random.uniform(-0.01, 0.01), -0.01);
      const Vec3 n = (frame.col(2) + 0.2 * random.direction()).normalized();
      points.push_back({r, n, random.uniform(1e-6, 1e-4)});
      friction.touch(static_cast<std::int32_t>(i), r, r, n, points.back().depth);
    }
    Mat6 a = Mat6::Identity();
    a.topLeftCorner<3, 3>() *= 5000.0;
    a.bottomRightCorner<3, 3>() *= 2.0;
    Vec6 b;
    b << 3.0 * random.direction() - 2.0 * frame.col(2), 0.02 * random.direction();
    const Vec6 y = friction.displacement(a, b);
    Vec6 sum = b;
    for (const Point& point : points) {
      const Vec3 way = y.head<3>() + Vec3(y.tail<3>()).cross(point.r);
      const double f_n = contact_N_per_m * (point.depth - way.dot(point.n));
      if (f_n <= 0.0) continue;
      Vec3 f_t = -contact_N_per_m * (way - way.dot(point.n) * point.n);
      if (f_t.norm() > mu * f_n) f_t *= mu * f_n / f_t.norm();
      const Vec3 f = f_n * point.n + f_t;
      sum.head<3>() += f;
      sum.tail<3>() += point.r.cross(f);
    }
    EXPECT_LE((a * y - sum).head<3>().norm(), 1e-7) << trial << ", " << count << " points";
    EXPECT_LE((a * y - sum).tail<3>().norm(), 1e-9) << trial;
  }
}

std::unique_ptr<tool::ToolRenderer> with_friction(const TriangleMesh& tool, const TriangleMesh& object) {
  ToolSettings settings;
  settings.parameters["mu"] = mu;
  return make_tool_renderer("penalty-coupling", tool::solid_tool(tool), object, settings);
}
TriangleMesh plate() { return surface::box_mesh(Vec3(-0.05, -0.05, -0.02), Vec3(0.05, 0.05, 0.0)); }
tool::Pose at_height(double z) { return {Vec3(0, 0, z), Quat::Identity()}; }

// Pressed evenly, a face that spins about its middle has the torque mu N times the mean way of its points from there.
TEST(PenaltyCouplingFriction, ASpinningFaceHasTheTorqueOfItsPoints) {
  constexpr double half = 0.01;
  const auto renderer = with_friction(surface::box_mesh(Vec3::Constant(-half), Vec3::Constant(half)), plate());
  settle(*renderer, at_height(0.014), at_height(0.008));
  tool::ToolResult result;
  for (int i = 1; i <= 400; ++i)
    result = renderer->step({1.0 + 1e-3 * i, {Vec3(0, 0, 0.008), tool::rotation_by(Vec3(0, 0, 1e-3 * i))}});
  double mean = 0.0;
  for (const tool::ToolContact& contact : result.contacts)
    mean += (contact.p_W_m - result.proxy.p_W_m).head<2>().norm();
  mean /= double(result.contacts.size());
  EXPECT_GT(result.contacts.size(), 400U);
  // The direction of friction is that of the way of a step, which turns by a thousandth.
  EXPECT_NEAR(result.torque_W_Nm.z(), -mu * result.f_W_N.z() * mean, 1e-3 * mu * 2.0 * mean);
  // Of an even pressure on a square: a (sqrt 2 + log(1 + sqrt 2)) / 3; points a millimetre apart.
  EXPECT_NEAR(mean, half * (std::numbers::sqrt2 + std::log(1.0 + std::numbers::sqrt2)) / 3.0, 0.05 * half);
  EXPECT_LE(result.f_W_N.head<2>().norm(), 0.01 * mu * 2.0) << "it turns in place, but for points that lie unevenly";
}

// A ball held at its centre: what it rubs with depends on how it turns while it goes on.
TEST(PenaltyCouplingFriction, ABallSlidesWithMuAndRollsWithout) {
  constexpr double radius = 0.01;
  const TriangleMesh ball = surface::sphere_mesh(radius, 5);
  const auto friction_over_load = [&](double rolls) {
    const auto renderer = with_friction(ball, plate());
    settle(*renderer, at_height(0.014), at_height(0.008));
    tool::ToolResult result;
    double sum = 0.0;
    for (int i = 1; i <= 600; ++i) {
      const double way = 2e-5 * i;
      result =
          renderer->step({1.0 + 1e-3 * i, {Vec3(way, 0, 0.008), tool::rotation_by(Vec3(0, rolls * way / radius, 0))}});
      for (const tool::ToolContact& contact : result.contacts) {
        const double f_n = contact.f_W_N.dot(contact.n_W);
        EXPECT_LE((contact.f_W_N - f_n * contact.n_W).norm(), mu * f_n + 1e-12);
      }
      if (i > 300) sum += -result.f_W_N.x() / result.f_W_N.z();
    }
    return sum / 300.0;
  };
  EXPECT_NEAR(friction_over_load(0.0), mu, 1e-6);
  EXPECT_LE(std::abs(friction_over_load(1.0)), 0.1 * mu);
}

// Over what a spring gives way: the springs of the contacts, in the direction of the load.
TEST(PenaltyCouplingFriction, SlidesAsTheEquilibriumSays) {
  const tool::Coupling coupling;
  for (const std::string& name : contacts::sliding_case_names()) {
    const tool::KnownContacts slides = contacts::known_slides(name, coupling, mu);
    ToolSettings settings;
    settings.parameters["mu"] = mu;
    const auto renderer = make_tool_renderer("penalty-coupling", slides.tool, slides.object_W, settings);
    const tool::ToolErrors errors = tool::errors_of(*renderer, "penalty-coupling", slides);
    // One point that carries all gives way by f / k: at most 3 N, and with mu beside it.
    const double gives_m = 3.0 * std::hypot(1.0, mu) / contact_N_per_m;
    EXPECT_LE(errors.max_force_N, coupling.stiffness_N_per_m * gives_m) << name;
    EXPECT_LE(errors.mean_torque_Nm, 0.005) << name;
  }
}

tool::ToolSubject rubbing() {
  ToolSettings settings;
  settings.parameters["mu"] = mu;
  return subject_of(find_tool_renderer(tool_renderer_catalogue(), "penalty-coupling"), settings);
}

TEST(PenaltyCouplingFriction, PassesTheChecks) {
  for (const tool::ToolFinding& finding : check_tool_renderer(rubbing())) {
    EXPECT_TRUE(finding.passed && finding.applies)
        << finding.check << ": " << finding.measured << " of " << finding.limit;
  }
}

TEST(PenaltyCouplingFriction, FaultsAreCaughtByName) {
  for (const std::string_view fault : tool::tool_fault_names) {
    std::vector<std::string> named;
    for (const tool::ToolFinding& finding : check_tool_renderer(with_fault(rubbing(), fault))) {
      if (!finding.fault.empty()) named.push_back(finding.fault);
    }
    EXPECT_THAT(named, ::testing::ElementsAre(std::string(fault)));
  }
}

}  // namespace
}  // namespace touchstone::tool_renderers
