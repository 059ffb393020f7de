// One axis from a file to a report: columns, signs, a repeat, and files that are none.
#include "axis_run.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/testing/temporary_folder.h"

namespace touchstone::axis {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double dry = 0.07;

// 30 s of a joint with dry friction and a cable, under `seed`'s noise; `sign` of the load.
std::string joint(std::uint64_t seed, const std::string& header, double sign = 1.0) {
  Random random(seed);
  std::string text = header + "\n";
  for (int i = 0; i < 6000; ++i) {
    const double t = i / 200.0;
    const double q = std::sin(0.6 * t) + 0.3 * std::sin(2.3 * t);
    const double rate = 0.6 * std::cos(0.6 * t) + 0.69 * std::cos(2.3 * t);
    const double load = std::copysign(dry, rate) + 0.2 * std::sin(1.5 * q) + 0.005 * random.normal();
    text += fmt::format("{:.3f},{:.6f},{:.5f}\n", t, q, sign * load);
  }
  return text;
}

class AxisFiles : public ::testing::Test {
 protected:
  std::string file(const std::string& name, const std::string& text) {
    write_file(folder_.path() / name, text);
    return (folder_.path() / name).string();
  }
  static AxisResult run(const AxisRequest& request) {
    return run_axis(request, load_axis(request.recording, request.flip_force));
  }
  testing::TemporaryFolder folder_;
};

TEST_F(AxisFiles, AJointIsFittedAndReported) {
  const std::string recording = file("joint.csv", joint(1, "t_s,q_rad,torque_Nm"));
  const AxisRequest request{recording, file("again.csv", joint(2, "t_s,q_rad,torque_Nm"))};
  EXPECT_THAT(check_axis(load_axis(recording, false)), ::testing::IsEmpty());
  const AxisResult result = run(request);
  EXPECT_NEAR(result.fit.dry, dry, 0.004);
  // What two runs differ by is the noise of both: sqrt(2) times 0.005 N m.
  ASSERT_TRUE(result.floor.has_value());
  EXPECT_NEAR(result.floor->value, 0.005, 0.0004);
  EXPECT_THAT(result.text(), HasSubstr("torque over angle"));
  EXPECT_EQ(nlohmann::json::parse(result.json())["schema"], "touchstone-axis/1");
  const auto page = write_axis(request, result, {"touchstone", "axis"}, folder_.path() / "out");
  EXPECT_EQ(read_file(folder_.path() / "out" / "axis.json"), result.json());
  EXPECT_THAT(read_file(page), HasSubstr("joint.csv"));
}

TEST_F(AxisFiles, TheColumnsNameTheWords) {
  const AxisInput actuator = load_axis(file("actuator.csv", joint(3, "t_s,q_m,force_N")), false);
  EXPECT_EQ(actuator.words.load, "force");
  EXPECT_EQ(actuator.words.place_unit, "m");
  const std::string pressed =
      file("pressed.csv", "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N\n0,0,0,-0.001,0,0,2\n0.1,0,0,0,0,0,0\n");
  const AxisInput indentation = load_axis(pressed, false);
  EXPECT_EQ(indentation.words.place, "indentation");
  EXPECT_EQ(indentation.run.place[0], 0.001) << "it grows downwards";
  EXPECT_EQ(indentation.run.load[0], 2.0) << "and is pushed up against";
}

TEST_F(AxisFiles, AReversedLoadIsRefusedUnlessItIsFlipped) {
  const std::string reversed = file("reversed.csv", joint(4, "t_s,q_rad,torque_Nm", -1.0));
  EXPECT_THAT([&] { run({reversed, ""}); }, ThrowsMessage<BadData>(HasSubstr("reversed torque")));
  EXPECT_NEAR(run({reversed, "", true}).fit.dry, dry, 0.004);
}

TEST_F(AxisFiles, WhatIsNoAxisIsRefusedWithTheColumnsThatWereExpected) {
  const std::string other = file("other.csv", "t_s,a,b\n0,1,2\n1,2,3\n");
  EXPECT_THAT([&] { load_axis(other, false); }, ThrowsMessage<BadData>(HasSubstr("q_rad and torque_Nm")));
}

}  // namespace
}  // namespace touchstone::axis
