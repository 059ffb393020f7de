// What the numbers say, held against presses and strokes of an exact law: a plane z = 0 with stiffness and dry
// friction, whose force, energy and lever are known.
#include "number_evidence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "harness/base/vec.h"

namespace touchstone::importing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::set<std::string> all_assumed{"x_m", "y_m", "z_m", "fx_N", "fy_N", "fz_N", "tx_Nm", "ty_Nm", "tz_Nm"};

// Down to 3 mm and up while x and y wander: 700 N/m, friction 0.3, at 500 Hz for 4 s.
struct Stroke {
  double length = 1.0, force = 1.0, torque = 1.0;  // of one SI unit
  Vec3 mirror_p = Vec3::Ones(), mirror_f = Vec3::Ones();
  double lever_m = 0.04;

  [[nodiscard]] Imported read(bool torques = false) const {
    Imported out;
    out.names = {"t_s", "x_m", "y_m", "z_m", "fx_N", "fy_N", "fz_N"};
    if (torques) out.names.insert(out.names.end(), {"tx_Nm", "ty_Nm", "tz_Nm"});
    out.columns.resize(out.names.size());
    const auto place = [](double t) {
      return Vec3(0.03 * std::sin(2 * std::numbers::pi * t / 4), 0.02 * std::cos(3 * std::numbers::pi * t / 4),
                  0.002 - 0.005 * std::pow(std::sin(std::numbers::pi * t / 4), 2));
    };
    for (int i = 0; i < 2000; ++i) {
      const double t = 0.002 * i;
      const Vec3 p = place(t), v = (place(t + 1e-6) - place(t - 1e-6)) / 2e-6;
      Vec3 f(0, 0, p.z() < 0 ? -700 * p.z() : 0);
      const Vec3 slide(v.x(), v.y(), 0);
      f -= 0.3 * f.z() * slide / slide.norm();
      const Vec3 moment = Vec3(0, 0, lever_m).cross(f);
      const Vec3 ps = p.cwiseProduct(mirror_p) / length, fs = f.cwiseProduct(mirror_f) / force;
      std::vector<double> row{t, ps.x(), ps.y(), ps.z(), fs.x(), fs.y(), fs.z()};
      if (torques) row.insert(row.end(), {moment.x() / torque, moment.y() / torque, moment.z() / torque});
      for (std::size_t c = 0; c < row.size(); ++c) out.columns[c].push_back(row[c]);
    }
    return out;
  }
};

std::vector<std::string> contradictions(const Imported& read, const std::set<std::string>& assumed = all_assumed) {
  std::vector<std::string> out;
  for (const NumberFinding& f : number_evidence(read, assumed)) {
    if (f.contradicts) out.push_back(f.about + ": " + f.what);
  }
  return out;
}

TEST(NumberEvidence, ARightRecordingIsConfirmed) {
  EXPECT_THAT(contradictions(Stroke{}.read(true)), IsEmpty());
  std::string confirmed;
  for (const NumberFinding& f : number_evidence(Stroke{}.read(true), all_assumed)) confirmed += f.what + "\n";
  EXPECT_THAT(confirmed, AllOf(HasSubstr("m is assumed"), HasSubstr("N is assumed"), HasSubstr("N m is assumed"),
                               HasSubstr("ON a probe")));
}

TEST(NumberEvidence, UnitsThatCannotBeAreAskedForWithTheScaleThatFits) {
  EXPECT_THAT(contradictions(Stroke{.length = 1e-3}.read()),
              ::testing::ElementsAre(AllOf(HasSubstr("x_m, y_m, z_m: "), HasSubstr("0.001 for mm"))));
  EXPECT_THAT(
      contradictions(Stroke{.force = 1e-3}.read()),
      ::testing::ElementsAre(AllOf(HasSubstr("fx_N, fy_N, fz_N: "), HasSubstr("0.001 for mN"), HasSubstr("1 for N"))));
  EXPECT_THAT(contradictions(Stroke{.torque = 1e-3}.read(true)),
              ::testing::ElementsAre(AllOf(HasSubstr("tx_Nm, ty_Nm, tz_Nm: "), HasSubstr("0.001 for N.mm"))));
  // A bias that no tool weighs.
  Imported biased = Stroke{}.read();
  for (double& f : biased.columns[5]) f += 334;
  EXPECT_THAT(contradictions(biased), ::testing::ElementsAre(HasSubstr("reach 334 N")));
  EXPECT_THAT(contradictions(biased, {}), IsEmpty());
  // What is named is not asked for, however large.
  EXPECT_THAT(contradictions(Stroke{.length = 1e-3}.read(), {}), IsEmpty());
  for (const NumberFinding& f : number_evidence(Stroke{.length = 1e-3}.read(), all_assumed)) {
    if (!f.contradicts) continue;
    EXPECT_THAT(f.withdrawn, ::testing::ElementsAre("x_m", "y_m", "z_m"));
  }
}

TEST(NumberEvidence, AJointInDegreesTurnsMoreThanOnceRound) {
  Imported read;
  read.names = {"q_rad", "torque_Nm"};
  read.columns = {{-20, 0, 35}, {1, 2, 3}};
  EXPECT_THAT(contradictions(read, {"q_rad"}), ::testing::ElementsAre(HasSubstr("0.0174532925 for deg")));
  for (double& q : read.columns[0]) q *= std::numbers::pi / 180.0;
  EXPECT_THAT(contradictions(read, {"q_rad"}), IsEmpty());
}

TEST(NumberEvidence, ForcesByTheProbeAndMirroredAxesGiveEnergy) {
  EXPECT_THAT(contradictions(Stroke{.mirror_f = -Vec3::Ones()}.read(), {}),
              ::testing::ElementsAre(HasSubstr("\"force_sign\": -1")));
  EXPECT_THAT(contradictions(Stroke{.mirror_p = Vec3(1, 1, -1)}.read(), {}),
              ::testing::ElementsAre(HasSubstr("\"scale\": -1")));
}

// Sliding at a constant depth with one horizontal axis mirrored: friction along it would drive the probe.
TEST(NumberEvidence, AMirroredAxisIsNamed) {
  const auto slide = [](double mirrored) {
    Imported read;
    read.names = {"t_s", "x_m", "y_m", "fx_N", "fy_N"};
    read.columns.resize(5);
    for (int i = 0; i < 1000; ++i) {
      const double t = 0.004 * i, load = std::min({1.0, t, 3.996 - t}), v = std::cos(7 * t);
      const double row[] = {t, 0.01 * std::sin(7 * t) * mirrored, 0.001 * t, -load * (v > 0 ? 1 : -1), -0.1 * load};
      for (std::size_t c = 0; c < 5; ++c) read.columns[c].push_back(row[c]);
    }
    return read;
  };
  EXPECT_THAT(contradictions(slide(1.0), {}), IsEmpty());
  EXPECT_THAT(contradictions(slide(-1.0), {}), ::testing::ElementsAre(HasSubstr("the x axis may be mirrored")));
}

TEST(NumberEvidence, AClockThatGoesBackOrRepeatsIsNamed) {
  Imported read = Stroke{}.read();
  read.columns[0][700] = read.columns[0][699];
  EXPECT_THAT(contradictions(read), ::testing::ElementsAre(HasSubstr("samples 700 and 701 have one time, 1.398 s")));
  read.columns[0][700] = 0.25;
  EXPECT_THAT(contradictions(read),
              ::testing::ElementsAre(HasSubstr("goes back from 1.398 s to 0.25 s at sample 701")));
}

// Two things that only drift, or a recording that begins under load, say nothing of each other.
TEST(NumberEvidence, DriftsAndLoadsFromTheBeginningDecideNothing) {
  Imported read = Stroke{.mirror_f = -Vec3::Ones()}.read();
  for (int i = 0; i < 2000; ++i) {
    const auto at = static_cast<std::size_t>(i);
    for (std::size_t c = 1; c < 7; ++c) read.columns[c][at] = (c < 4 ? 1e-5 : 1e-3) * i * static_cast<double>(c);
  }
  EXPECT_THAT(contradictions(read, {}), IsEmpty());
}

// A tool of 2 N, turned in the air: in its sensor's frame the weight turns.
TEST(NumberEvidence, AWeightThatTurnsIsInTheSensorsFrame) {
  const auto turned = [](bool by_sensor) {
    Imported read;
    read.names = {"t_s", "fx_N", "fy_N", "fz_N", "qw", "qx", "qy", "qz"};
    read.columns.resize(8);
    for (int i = 0; i < 300; ++i) {
      const Quat q(Eigen::AngleAxisd(0.01 * i, Vec3(1, 0.3, 0.1).normalized()));
      const Vec3 weight(0.01 * std::sin(i), 0, -2), f = by_sensor ? Vec3(q.conjugate() * weight) : weight;
      const double row[] = {0.01 * i, f.x(), f.y(), f.z(), q.w(), q.x(), q.y(), q.z()};
      for (std::size_t c = 0; c < 8; ++c) read.columns[c].push_back(row[c]);
    }
    return read;
  };
  EXPECT_THAT(contradictions(turned(true), {}), ::testing::ElementsAre(HasSubstr("\"force_frame\": \"sensor\"")));
  EXPECT_THAT(contradictions(turned(false), {}), IsEmpty());
  // In contact neither is steady: the numbers cannot tell.
  Imported pressed = turned(false);
  for (std::size_t i = 0; i < 300; ++i)
    pressed.columns[1][i] += 5 * std::sin(0.11 * i), pressed.columns[3][i] += 4 * std::cos(0.07 * i);
  EXPECT_THAT(contradictions(pressed, {}), ::testing::ElementsAre(HasSubstr("the numbers do not tell")));
  // Where the probe hardly turns either frame will do.
  for (std::size_t i = 0; i < 300; ++i)
    pressed.columns[4][i] = 1, pressed.columns[5][i] = pressed.columns[6][i] = pressed.columns[7][i] = 0.001;
  EXPECT_THAT(contradictions(pressed, {}), IsEmpty());
}

}  // namespace
}  // namespace touchstone::importing
