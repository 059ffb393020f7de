// A small session through the gate: a tip on a level plate, its force as it is and reversed.
#include "acquired_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/recording/recording_file.h"
#include "harness/testing/steps.h"
#include "harness/testing/temporary_folder.h"

namespace touchstone::acquisition {
namespace {

using ::testing::HasSubstr;

// 8 s in the plate's frame: down to the plate within the first second, pressed and slid in circles over it, up in the
// last.
class AcquiredFile : public ::testing::Test {
 protected:
  // `sign` of the force: 1 is the plate's push on the tip.
  AcquisitionDescription session(double sign, const std::string& bias = "") {
    std::string force = "t_s,fx_N,fy_N,fz_N,tx_Nm,ty_Nm,tz_Nm\n";
    for (const double t : testing::steps(0.0, 8.0, 1e-3)) {
      const bool touches = t > 1.0 && t < 7.0;
      const double push = touches ? 1.5 + 0.5 * std::sin(5.0 * t) : 0.0;
      const double drag = 0.2 * push;
      force += fmt::format("{:.4f},{:.6f},{:.6f},{:.6f},0,0,0\n", t, sign * drag * std::sin(2.0 * t),
                           -sign * drag * std::cos(2.0 * t), sign * push);
    }
    std::string motion = "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n";
    for (const double t : testing::steps(0.0, 8.0, 0.01)) {
      const double height = 0.01 * std::max(0.0, std::max(1.0 - t, t - 7.0));
      motion += fmt::format("{:.4f},{:.7f},{:.7f},{:.7f},1,0,0,0\n", t, 0.03 * std::cos(2.0 * t),
                            0.03 * std::sin(2.0 * t), height);
    }
    file("force.csv", force);
    file("motion.csv", motion);
    file("markers.csv",
         "x_m,y_m,z_m,mx_m,my_m,mz_m\n0.1,0,0,0.1,0,0\n-0.1,0.1,0,-0.1,0.1,0\n0,-0.1,0.05,0,-0.1,0.05\n");
    file("plate.obj", "v -0.2 -0.2 0\nv 0.2 -0.2 0\nv 0.2 0.2 0\nv -0.2 0.2 0\nf 1 2 3\nf 1 3 4\n");
    return acquisition::read_description(file("session.json", R"({"schema": "touchstone-acquisition/1",
      "force": {"file": "force.csv")" + bias + R"(},
      "motion": {"file": "motion.csv"}, "probe": {"tip_P_m": [0, 0, 0], "tip_S_m": [0, 0, 0]}, "clocks": {"offset_s": 0},
      "registration": {"markers": "markers.csv", "mesh": "plate.obj"}})"));
  }
  std::string file(const std::string& name, const std::string& text) {
    write_file(folder_.path() / name, text);
    return (folder_.path() / name).string();
  }
  testing::TemporaryFolder folder_;
};

TEST_F(AcquiredFile, ASoundSessionPassesAndIsWritten) {
  const CheckedAcquisition result =
      acquire_into(session(1.0), folder_.path() / "out.csv", folder_.path() / "report.json");
  EXPECT_TRUE(result.passed()) << result.text();
  EXPECT_THAT(result.text(), HasSubstr("samples -> " + (folder_.path() / "out.csv").string()));
  EXPECT_EQ(recording::load_recording(folder_.path() / "out.csv").size(), result.acquired.recording.size());
  EXPECT_EQ(read_file(folder_.path() / "report.json"), report_json(result.acquired.report));
}

TEST_F(AcquiredFile, AReversedForceIsNotedAndDoesNotPassButIsWritten) {
  const CheckedAcquisition result = acquire_into(session(-1.0), folder_.path() / "out.csv", "");
  EXPECT_TRUE(result.faulty);
  EXPECT_FALSE(result.passed());
  EXPECT_THAT(result.acquired.report.notes, ::testing::Contains(HasSubstr("reversed")));
  EXPECT_GT(recording::load_recording(folder_.path() / "out.csv").size(), 500U);
}

TEST_F(AcquiredFile, ContactInTheBiasIntervalIsRefused) {
  EXPECT_THAT([&] { acquire_and_check(session(1.0, R"(, "bias_from_s": 0.5, "bias_to_s": 2.5)")); },
              ::testing::ThrowsMessage<BadData>(HasSubstr("something is touched in the bias interval")));
}

}  // namespace
}  // namespace touchstone::acquisition
