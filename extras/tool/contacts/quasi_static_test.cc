// The truth against answers found another way: closed forms, statics in one variable in long double, and the definition
// of an equilibrium (no feasible pose near has less energy; forces found from dense samples of the shapes).
#include "contacts/quasi_static.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "contacts/exact_cases.h"
#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/surface/mesh_topology.h"
#include "harness/tool/tool.h"

namespace touchstone::contacts {
using tool::Pose;

namespace {

constexpr tool::Coupling coupling{};
constexpr double exact = 1e-9;  // N and Nm

using Real = long double;
// The root of a function that changes its sign once between low and high.
Real root(const std::function<Real(Real)>& f, Real low, Real high) {
  const bool rising = f(low) < 0;
  for (int i = 0; i < 200; ++i) {
    const Real middle = (low + high) / 2;
    ((f(middle) < 0) == rising ? low : high) = middle;
  }
  return (low + high) / 2;
}

Pose handle_at(double x, double z, double turn_y) { return {Vec3(x, 0, z), tool::rotation_by(Vec3(0, turn_y, 0))}; }

TEST(QuasiStatic, FreeToolFeelsNothing) {
  const Equilibrium e = quasi_static_equilibrium({ball_on_plane(Vec3::Zero(), 0.01, Vec3::UnitZ(), 0.0)},
                                                 handle_at(0, 0.02, 0.1), coupling);
  ASSERT_TRUE(e.found);
  EXPECT_EQ(e.wrench_W.f_N.norm(), 0.0);
  EXPECT_EQ(e.wrench_W.torque_Nm.norm(), 0.0);
}

// A ball held at its centre, pressed in by D: N = k_t D, mu N against the way, and the torque R mu N of the contact.
TEST(SlidingEquilibrium, OfABallInClosedForm) {
  constexpr double radius = 0.01, deep = 0.002, mu = 0.4;
  const Vec3 along = Vec3(3, 4, 0).normalized();
  const Equilibrium e = sliding_equilibrium({ball_on_plane(Vec3::Zero(), radius, Vec3::UnitZ(), 0.0)},
                                            handle_at(0, radius - deep, 0.2), coupling, mu, 0.05 * along);
  ASSERT_TRUE(e.found);
  const double f_n = coupling.stiffness_N_per_m * deep;
  const Vec3 f = f_n * Vec3::UnitZ() - mu * f_n * along;
  EXPECT_LE((e.wrench_W.f_N - f).norm(), exact);
  EXPECT_LE((e.wrench_W.torque_Nm - Vec3(0, 0, -radius).cross(f)).norm(), exact);
}

// A corner that is dragged and turns the tool about y: one unknown, the angle, in long double.
TEST(SlidingEquilibrium, OfACornerInOneUnknown) {
  constexpr double mu = 0.3, deep = 0.0015;
  const Vec3 corner(0.008, 0.0, -0.02);
  const Pose handle = handle_at(0, 0.02 - deep, 0.0);
  const auto arm_x = [&](Real a) { return std::cos(a) * Real(corner.x()) + std::sin(a) * Real(corner.z()); };
  const auto arm_z = [&](Real a) { return -std::sin(a) * Real(corner.x()) + std::cos(a) * Real(corner.z()); };
  const auto load = [&](Real a) { return Real(coupling.stiffness_N_per_m) * (-arm_z(a) - Real(handle.p_W_m.z())); };
  const Real angle = root(
      [&](Real a) {
        const Real torque = arm_z(a) * (-Real(mu) * load(a)) - arm_x(a) * load(a);
        return Real(coupling.rotational_stiffness_Nm_per_rad) * a - torque;
      },
      -0.05L, 0.05L);
  const Equilibrium e =
      sliding_equilibrium({ball_on_plane(corner, 0.0, Vec3::UnitZ(), 0.0)}, handle, coupling, mu, Vec3::UnitX());
  ASSERT_TRUE(e.found);
  EXPECT_NEAR(e.wrench_W.f_N.z(), double(load(angle)), exact);
  EXPECT_NEAR(e.wrench_W.f_N.x(), -mu * double(load(angle)), exact);
  EXPECT_NEAR(e.wrench_W.torque_Nm.y(), coupling.rotational_stiffness_Nm_per_rad * double(angle), exact);
}

// A flat face: many sets of corners hold it, all at one place.
TEST(SlidingEquilibrium, OfAFaceLiesFlat) {
  std::vector<GapOfPose> gaps;
  for (const double x : {-0.01, 0.01})
    for (const double y : {-0.01, 0.01}) gaps.push_back(ball_on_plane(Vec3(x, y, -0.01), 0.0, Vec3::UnitZ(), 0.0));
  const Equilibrium e = sliding_equilibrium(gaps, handle_at(0, 0.008, 0.0), coupling, 0.3, Vec3::UnitX());
  ASSERT_TRUE(e.found);
  EXPECT_LE((e.wrench_W.f_N - Vec3(-0.6, 0, 2.0)).norm(), exact);
  EXPECT_LE(e.wrench_W.torque_Nm.norm(), exact);
}

TEST(QuasiStatic, BallHeldAtItsCentreHasNoTorque) {
  const Equilibrium e = quasi_static_equilibrium({ball_on_plane(Vec3::Zero(), 0.01, Vec3::UnitZ(), 0.0)},
                                                 handle_at(0.1, 0.007, 0.3), coupling);
  ASSERT_TRUE(e.found);
  EXPECT_LE((e.wrench_W.f_N - Vec3(0, 0, 3.0)).norm(), exact);
  EXPECT_LE(e.wrench_W.torque_Nm.norm(), exact);
}

// A ball at (cx, cz) in T on z = 0, the handle turned by a about y: in the plane y = 0, with the proxy at angle b,
//   force k_t (z - z_H) = l with z = r - c_z(b), torque about y: k_r (b - a) = -(c_x(b)) l.
TEST(QuasiStatic, BallWithALeverOnAPlane) {
  for (const double turn : {-0.3, 0.0, 0.2}) {
    const double cx = 0.012, cz = -0.015, r = 0.01, z_H = 0.02;
    const auto c_x = [&](Real b) { return cx * std::cos(b) + cz * std::sin(b); };
    const auto c_z = [&](Real b) { return -cx * std::sin(b) + cz * std::cos(b); };
    const auto force = [&](Real b) { return coupling.stiffness_N_per_m * (r - c_z(b) - z_H); };
    // The torque of a force l along z at c_x about y is (x - p) x f = -c_x l.
    const Real b = root(
        [&](Real angle) {
          return coupling.rotational_stiffness_Nm_per_rad * (angle - turn) + c_x(angle) * force(angle);
        },
        turn - 0.5, turn + 0.5);
    const Equilibrium e = quasi_static_equilibrium({ball_on_plane(Vec3(cx, 0, cz), r, Vec3::UnitZ(), 0.0)},
                                                   handle_at(0, z_H, turn), coupling);
    ASSERT_TRUE(e.found);
    EXPECT_NEAR(e.wrench_W.f_N.z(), double(force(b)), exact);
    EXPECT_NEAR(e.wrench_W.torque_Nm.y(), double(-c_x(b) * force(b)), exact);
    EXPECT_GT(std::abs(e.wrench_W.torque_Nm.y()), 1e-3);
  }
}

TEST(QuasiStatic, BallOnABallBesideItsTop) {
  // Held at its centre: the force is along the line between the centres, of length k_t times the overlap.
  const Vec3 o(0.01, -0.02, -0.03);
  const Pose handle{Vec3(0.012, -0.013, 0.003), Quat::Identity()};
  const Equilibrium e = quasi_static_equilibrium({ball_on_ball(Vec3::Zero(), 0.01, o, 0.03)}, handle, coupling);
  ASSERT_TRUE(e.found);
  const Vec3 between = handle.p_W_m - o;
  EXPECT_LE((e.wrench_W.f_N - 1000.0 * (0.04 - between.norm()) * between.normalized()).norm(), exact);
  EXPECT_LE(e.wrench_W.torque_Nm.norm(), exact);
}

TEST(QuasiStatic, EllipsoidOnAPlaneRollsToItsBalance) {
  // In the plane y = 0: height h(b) = sqrt(a^2 sin^2 b + c^2 cos^2 b), energy k_t (h - z_H)^2 / 2 + k_r (b - b_H)^2
  // / 2.
  const double a = 0.012, c = 0.006, z_H = 0.0055;
  for (const double turn : {0.1, 0.4, -0.7}) {
    const auto h = [&](Real b) {
      return std::sqrt(a * a * std::sin(b) * std::sin(b) + c * c * std::cos(b) * std::cos(b));
    };
    const auto h_slope = [&](Real b) { return (a * a - c * c) * std::sin(b) * std::cos(b) / h(b); };
    const auto force = [&](Real b) { return coupling.stiffness_N_per_m * (h(b) - z_H); };
    const Real b = root(
        [&](Real angle) {
          return coupling.rotational_stiffness_Nm_per_rad * (angle - turn) + force(angle) * h_slope(angle);
        },
        turn - 0.3, turn + 0.3);
    const Equilibrium e = quasi_static_equilibrium(
        {ellipsoid_on_plane(Vec3::Zero(), Vec3(a, 0.008, c), Vec3::UnitZ(), 0.0)}, handle_at(0, z_H, turn), coupling);
    ASSERT_TRUE(e.found);
    EXPECT_NEAR(e.wrench_W.f_N.z(), double(force(b)), exact);
    EXPECT_NEAR(e.wrench_W.torque_Nm.y(), double(-force(b) * h_slope(b)), exact);
  }
}

TEST(QuasiStatic, EllipsoidWithEqualAxesIsABall) {
  Random random(21);
  for (int i = 0; i < 20; ++i) {
    const Vec3 center = 0.01 * random.direction();
    const Pose handle{Vec3(0.003, 0.002, 0.008) - center, tool::rotation_by(0.2 * random.direction())};
    for (const auto& [round, ball] :
         {std::pair{ellipsoid_on_plane(center, Vec3::Constant(0.01), Vec3::UnitZ(), 0.0),
                    ball_on_plane(center, 0.01, Vec3::UnitZ(), 0.0)},
          std::pair{ellipsoid_on_ball(center, Vec3::Constant(0.01), Vec3(0, 0, -0.03), 0.03),
                    ball_on_ball(center, 0.01, Vec3(0, 0, -0.03), 0.03)}}) {
      const Equilibrium a = quasi_static_equilibrium({round}, handle, coupling);
      const Equilibrium b = quasi_static_equilibrium({ball}, handle, coupling);
      ASSERT_TRUE(a.found && b.found);
      EXPECT_LE((a.wrench_W.f_N - b.wrench_W.f_N).norm() + (a.wrench_W.torque_Nm - b.wrench_W.torque_Nm).norm(), exact);
    }
  }
}

TEST(QuasiStatic, TwoBallsOnABarShareTheForce) {
  // Straight down: half on each. Turned: one leaves when the torsional spring cannot hold it down.
  const ExactCase c = make_exact_case("two-spheres");
  const Equilibrium even = quasi_static_equilibrium(c.gaps, handle_at(0, 0.023, 0.0), coupling);
  ASSERT_TRUE(even.found);
  EXPECT_NEAR(even.wrench_W.f_N.z(), 2.0, exact);
  EXPECT_NEAR(even.contact_forces_N[0], 1.0, exact);
  EXPECT_NEAR(even.contact_forces_N[1], 1.0, exact);
  EXPECT_LE(even.wrench_W.torque_Nm.norm(), exact);
  // The bar stays level, so that the contacts take the torque of the whole turn: (l_1 - l_2) 0.02 m = -k_r a.
  const double a = 0.01;
  const Equilibrium turned = quasi_static_equilibrium(c.gaps, handle_at(0, 0.023, a), coupling);
  ASSERT_TRUE(turned.found);
  EXPECT_NEAR(turned.wrench_W.torque_Nm.y(), -2.0 * a, exact);
  EXPECT_NEAR(turned.contact_forces_N[0], 1.0 - 0.5, exact);
  EXPECT_NEAR(turned.contact_forces_N[1], 1.0 + 0.5, exact);
}

TEST(QuasiStatic, FlatFaceTakesTheTorqueOfTheHandle) {
  const ExactCase c = make_exact_case("box-face");
  const Pose handle = tool::moved({Vec3(0, 0, 0.023), Quat::Identity()}, {Vec3::Zero(), Vec3(0.003, -0.004, 0.0)});
  const Equilibrium e = quasi_static_equilibrium(c.gaps, handle, coupling);
  ASSERT_TRUE(e.found);
  EXPECT_LE((e.wrench_W.f_N - Vec3(0, 0, 2.0)).norm(), exact);
  EXPECT_LE((e.wrench_W.torque_Nm - Vec3(-0.006, 0.008, 0.0)).norm(), exact);
}

// In the plane y = 0, R of the angle b takes (x, z) to (cos b x + sin b z, -sin b x + cos b z), and a force has the
// torque r_z f_x - r_x f_z about y.
TEST(QuasiStatic, PegHeldBesideTheHoleLeansOnOneRim) {
  const double w = 0.01, end = -0.035, clearance = 0.2e-3, z_H = 0.02, x_H = 0.0004;
  const double W = w + clearance;
  const auto gaps = square_peg_in_hole(w, end, W);
  const std::vector<GapOfPose> all(gaps.begin(), gaps.end());
  // The rim at +W touches the side +w: a force l along (-cos b, sin b) at the rim. The end swings away from the wall.
  const auto force = [&](Real b) {
    return coupling.stiffness_N_per_m * (w - std::cos(b) * (W - x_H) - std::sin(b) * z_H);
  };
  const auto torque = [&](Real b) {
    const Real l = force(b);
    const Real p_x = x_H - l * std::cos(b) / coupling.stiffness_N_per_m;
    const Real p_z = z_H + l * std::sin(b) / coupling.stiffness_N_per_m;
    return -p_z * -l * std::cos(b) - (W - p_x) * l * std::sin(b);
  };
  const Real b =
      root([&](Real angle) { return coupling.rotational_stiffness_Nm_per_rad * angle - torque(angle); }, 0.0L, 0.1L);
  const Equilibrium e = quasi_static_equilibrium(all, {Vec3(x_H, 0, z_H), Quat::Identity()}, coupling);
  ASSERT_TRUE(e.found);
  EXPECT_GT(double(force(b)), 0.1);
  EXPECT_NEAR(e.contact_forces_N[2], double(force(b)), exact);
  EXPECT_NEAR(e.wrench_W.f_N.x(), double(-force(b) * std::cos(b)), exact);
  EXPECT_NEAR(e.wrench_W.torque_Nm.y(), double(torque(b)), exact);
}

TEST(QuasiStatic, PegJamsBetweenEndAndRim) {
  const double w = 0.01, end = -0.035, clearance = 0.2e-3, z_H = 0.02, turn = 0.08;
  const double W = w + clearance;
  const auto gaps = square_peg_in_hole(w, end, W);
  const std::vector<GapOfPose> all(gaps.begin(), gaps.end());
  // The end edge at -w touches the wall at -W (force l_1 along x), the rim at +W the side +w (l_2 along (-cos b, sin
  // b)).
  const auto statics = [&](Real b, Real& l_1, Real& l_2, Real& p_z) {
    const Real p_x = -W + w * std::cos(b) - end * std::sin(b);
    // The rim in the peg's frame: cos b (W - p_x) - sin b (0 - p_z) = w.
    p_z = (w - std::cos(b) * (W - p_x)) / std::sin(b);
    l_2 = coupling.stiffness_N_per_m * (p_z - z_H) / std::sin(b);
    l_1 = coupling.stiffness_N_per_m * p_x + l_2 * std::cos(b);
    const Real end_z = w * std::sin(b) + end * std::cos(b);
    const Real torque = end_z * l_1 + (-p_z) * (-l_2 * std::cos(b)) - (W - p_x) * (l_2 * std::sin(b));
    return coupling.rotational_stiffness_Nm_per_rad * (b - turn) - torque;
  };
  Real l_1 = 0, l_2 = 0, p_z = 0;
  const Real straight = root(
      [&](Real b) {
        statics(b, l_1, l_2, p_z);
        return p_z - z_H;
      },
      0.005L, 0.05L);
  const Real b = root([&](Real angle) { return statics(angle, l_1, l_2, p_z); }, 0.95L * straight, 1.05L * straight);
  statics(b, l_1, l_2, p_z);
  const Equilibrium e = quasi_static_equilibrium(all, {Vec3(0, 0, z_H), tool::rotation_by(Vec3(0, turn, 0))}, coupling);
  ASSERT_TRUE(e.found);
  EXPECT_GT(double(l_1), 0.1);
  EXPECT_GT(double(l_2), 0.1);
  EXPECT_NEAR(e.contact_forces_N[1], double(l_1), exact);
  EXPECT_NEAR(e.contact_forces_N[2], double(l_2), exact);
  EXPECT_NEAR(e.wrench_W.torque_Nm.y(), double(coupling.rotational_stiffness_Nm_per_rad * (b - turn)), exact);
}

class EveryCase : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryCase, IsInBalanceAndHasTheLeastEnergyAround) {
  const ExactCase c = make_exact_case(GetParam());
  Random random(22);
  int touching = 0;
  for (const Pose& handle : c.handles) {
    const Equilibrium e = quasi_static_equilibrium(c.gaps, handle, coupling);
    ASSERT_TRUE(e.found);
    touching += e.wrench_W.f_N.norm() > 0.0 ? 1 : 0;
    // The balance, summed up anew from the contacts.
    Vec3 f = Vec3::Zero();
    Vec3 torque = Vec3::Zero();
    for (std::size_t j = 0; j < c.gaps.size(); ++j) {
      const Gap gap = c.gaps[j](e.proxy);
      EXPECT_GE(gap.gap_m, -1e-12);
      EXPECT_GE(e.contact_forces_N[j], -1e-12);
      f += e.contact_forces_N[j] * gap.n_W;
      torque += (gap.contact_W_m - e.proxy.p_W_m).cross(e.contact_forces_N[j] * gap.n_W);
    }
    EXPECT_LE((f - coupling.stiffness_N_per_m * (e.proxy.p_W_m - handle.p_W_m)).norm(), exact);
    EXPECT_LE((torque - coupling.rotational_stiffness_Nm_per_rad *
                            Vec3(Eigen::AngleAxisd(e.proxy.q_WT * handle.q_WT.conjugate()).angle() *
                                 Eigen::AngleAxisd(e.proxy.q_WT * handle.q_WT.conjugate()).axis()))
                  .norm(),
              exact);
    const double least = coupling_energy_J(coupling, handle, e.proxy);
    for (int i = 0; i < 300; ++i) {
      // The peg's gaps know motions in the plane y = 0 alone.
      const bool planar = GetParam().starts_with("peg");
      const double size = random.log_uniform(1e-7, 1e-3);
      tool::Displacement d{size * random.direction(), 50.0 * size * random.direction()};
      if (planar) d = {Vec3(d.translation_m.x(), 0, d.translation_m.z()), Vec3(0, d.rotation_rad.y(), 0)};
      const Pose near = moved(e.proxy, d);
      bool feasible = true;
      for (const GapOfPose& gap : c.gaps) feasible = feasible && gap(near).gap_m >= 0.0;
      if (feasible) {
        EXPECT_GE(coupling_energy_J(coupling, handle, near), least - 1e-14);
      }
    }
  }
  EXPECT_GE(touching, 6) << "of eight poses";
}

TEST_P(EveryCase, GapsChangeAsTheirNormalsSay) {
  // The rate of a gap is n . (v + w x r): a normal or a place of contact that is wrong shows here.
  const ExactCase c = make_exact_case(GetParam());
  Random random(23);
  constexpr double step = 1e-6;
  for (const Pose& handle : c.handles) {
    for (const GapOfPose& gap : c.gaps) {
      const tool::Displacement d{step * random.direction(),
                                 step * 30.0 * (GetParam().starts_with("peg") ? Vec3::UnitY() : random.direction())};
      const Gap g = gap(handle);
      const double slope =
          (gap(moved(handle, d)).gap_m - gap(moved(handle, {-d.translation_m, -d.rotation_rad})).gap_m) / 2.0;
      const double expected = g.n_W.dot(d.translation_m + d.rotation_rad.cross(g.contact_W_m - handle.p_W_m));
      EXPECT_NEAR(slope / step, expected / step, 1e-6);
    }
  }
}

TEST_P(EveryCase, MeshesAreClosedAndLieOnTheExactShapes) {
  const ExactCase c = make_exact_case(GetParam());
  EXPECT_TRUE(make_topology(c.tool_T).closed());
  EXPECT_TRUE(make_topology(c.object_W).closed());
  EXPECT_GT(tool::solid_mass_frame(c.tool_T, 1000.0).mass_kg, 0.0);
  EXPECT_GT(tool::solid_mass_frame(c.object_W, 1000.0).mass_kg, 0.0);
  for (const GapOfPose& gap : c.gaps) EXPECT_GT(gap(c.free).gap_m, 0.0) << "the start is free";
}

INSTANTIATE_TEST_SUITE_P(Tools, EveryCase, ::testing::ValuesIn(exact_case_names()), [](const auto& tested) {
  std::string name = tested.param;
  for (char& ch : name) ch = std::isalnum(static_cast<unsigned char>(ch)) != 0 ? ch : '_';
  return name;
});

TEST(ExactCases, UnknownNameIsAnError) { EXPECT_THROW(static_cast<void>(make_exact_case("teapot")), UsageError); }

}  // namespace
}  // namespace touchstone::contacts
