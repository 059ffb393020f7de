// A run in free air that touches something after all: planted presses are found with their time, untouched runs (made
// ones and a real one) are not blamed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "free_air_files.h"
#include "harness/base/random.h"
#include "harness/recording/raw_table.h"
#include "harness/testing/shared_data.h"

namespace touchstone::acquisition {
using recording::RawTable;
namespace {

using ::testing::HasSubstr;
const Vec3 down(0, 0, -9.80665);

struct MadeRun {
  FreeAirRun run;
  ToolLoad load;
};

// A tool that turns slowly about two axes and moves with up to 2 m/s^2; 500 Hz, sensor noise 0.2 % of the weight.
MadeRun made_run(double mass_kg, double press_N, double from_s, double to_s, Random& random) {
  MadeRun made;
  made.load.mass_kg = mass_kg;
  made.load.bias.f_N = mass_kg * Vec3(0.5, -0.2, 1.0);
  for (int i = 0; i < 5000; ++i) {
    const double t = 0.002 * i;
    const Quat q(Eigen::AngleAxisd(0.7 * std::sin(0.8 * t), Vec3::UnitX()) *
                 Eigen::AngleAxisd(0.4 * std::sin(0.5 * t), Vec3::UnitY()));
    const Vec3 a(2.0 * std::sin(2 * std::numbers::pi * 0.7 * t), std::cos(3.0 * t), 0.0);
    Wrench w = tool_wrench(made.load, q, down);
    w.f_N -= mass_kg * (q.conjugate() * a);
    if (t >= from_s && t < to_s) w.f_N += q.conjugate() * Vec3(0, 0, press_N);
    for (int k = 0; k < 3; ++k) w.f_N[k] += 0.02 * mass_kg * random.normal();
    made.run.t_wrench_s.push_back(t);
    made.run.wrench.push_back(w);
    made.run.t_orientation_s.push_back(t);
    made.run.q_WS.push_back(q);
  }
  return made;
}

FreeAirReport report_of(const MadeRun& made) {
  return analyse_free_air(made.run, made.load, {}, down, {2, 5, 20, 100}, 0.02, "run.csv");
}

TEST(FreeAirContact, APressIsFoundWithItsTime) {
  Random random(11);
  for (const double mass_kg : {0.01, 1.0, 30.0}) {
    const double weight_N = mass_kg * 9.80665;
    const auto report = report_of(made_run(mass_kg, weight_N, 4.0, 5.0, random));
    ASSERT_EQ(report.contacts.size(), 1U);
    EXPECT_NEAR(report.contacts[0].from_s, 4.0, 0.1);
    EXPECT_NEAR(report.contacts[0].to_s, 5.0, 0.1);
    EXPECT_NEAR(report.contacts[0].force_N, weight_N, 0.3 * weight_N);
    EXPECT_THAT(contact_message(report, "run.csv"), HasSubstr("run.csv: contact: this run touches something, 1 time"));
  }
}

TEST(FreeAirContact, ARunThatLeansOnSomethingAllAlongIsFound) {
  Random random(12);
  const auto report = report_of(made_run(1.0, 9.0, 0.0, 10.0, random));
  ASSERT_FALSE(report.contacts.empty());
  EXPECT_GT(report.contacts.back().to_s - report.contacts.front().from_s, 8.0);
}

TEST(FreeAirContact, MotionAloneIsNotBlamed) {
  Random random(13);
  for (int world = 0; world < 20; ++world) {
    const auto report = report_of(made_run(1.0, 0.0, 0.0, 0.0, random));
    EXPECT_TRUE(report.contacts.empty()) << contact_message(report, "run.csv");
    EXPECT_EQ(contact_message(report, "run.csv"), "");
  }
}

TEST(FreeAirContact, ARealRunIsFreeUntilAPressIsPlanted) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(calibration, "tool-gravity/0-calibration_fts-accel.csv");
  TOUCHSTONE_SHARED_DATA_OR_SKIP(wrench_path, "tool-gravity/1-baseline_wrench.csv");
  TOUCHSTONE_SHARED_DATA_OR_SKIP(orientation_path, "tool-gravity/1-baseline_orientations.csv");
  TOUCHSTONE_SHARED_DATA_OR_SKIP(acceleration_path, "tool-gravity/1-baseline_accel.csv");
  FreeAirFiles files{calibration, wrench_path, orientation_path, acceleration_path, "us", true, 9.82085};
  EXPECT_THAT(free_air_text(read_and_analyse_free_air(files)), ::testing::Not(HasSubstr("contact")));
  files.acceleration.reset();
  const auto bare = read_and_analyse_free_air(files);
  EXPECT_THAT(free_air_text(bare), ::testing::Not(HasSubstr("contact")));

  const RawTable wrench(wrench_path), orientation(orientation_path);
  FreeAirRun run;
  run.t_wrench_s = wrench.times_s("us");
  run.t_orientation_s = orientation.times_s("us");
  run.q_WS = orientation.rotations();
  const auto f = wrench.vectors("f", {}, true), torque = wrench.vectors("t", {}, true);
  const double start = run.t_wrench_s.front();
  for (auto* clock : {&run.t_wrench_s, &run.t_orientation_s}) {
    for (double& t : *clock) t -= start;
  }
  const double middle = 0.5 * run.t_wrench_s.back();
  for (std::size_t i = 0; i < f.size(); ++i) {
    const bool pressed = std::abs(run.t_wrench_s[i] - middle) < 0.25;
    run.wrench.push_back({f[i] + (pressed ? Vec3(0, 0, 9) : Vec3(0, 0, 0)), torque[i]});
  }
  const auto report = analyse_free_air(run, bare.tool.load, {}, Vec3(0, 0, -9.82085), {5}, 0.02, "pressed");
  ASSERT_EQ(report.contacts.size(), 1U);
  EXPECT_NEAR(report.contacts[0].from_s, middle - 0.25, 0.1);
  EXPECT_NEAR(report.contacts[0].to_s, middle + 0.25, 0.1);
}

}  // namespace
}  // namespace touchstone::acquisition
