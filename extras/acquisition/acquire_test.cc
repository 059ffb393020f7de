// The whole way on a session whose truth is known: a probe with a 30 g tool scans a mesh; its gauge voltages, tracker
// poses, markers and static orientations are made from the truth and must lead back to it.
#include "acquire.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/testing/steps.h"

namespace touchstone::acquisition {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

class AcquireTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / fmt::format("touchstone-acquire-{}-{}", ::getpid(),
                                                      ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
    make_session();
  }
  void TearDown() override { fs::remove_all(folder_); }

  // Truth: a plate in the object's z = 0 plane; a probe that taps, then slides with friction, held at changing angles.
  void make_session() {
    Random random(77);
    tool_.mass_kg = 0.03;
    tool_.center_S_m = Vec3(0.0005, -0.0003, 0.024);
    tool_.bias = {Vec3(0.4, -0.2, 1.1), Vec3(2e-3, -1e-3, 5e-4)};
    object_ = {random.rotation(), Vec3(0.3, -0.2, 0.9)};  // tracker to object
    const Vec3 tip_S(0, 0, 0.05), tip_P(0.01, 0.02, 0.12);
    const Quat q_PS(Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()));
    const double offset = 0.7312, skew = 60e-6;
    const std::vector<double> taps{1.0, 1.7, 2.25, 3.05, 26.1, 26.85, 27.4, 28.2};
    const auto height = [taps](double t) {
      double h = 0.012;
      if (t > 5 && t < 24) h = std::max(0.0, h - 0.03 * std::min(t - 5, 24 - t));
      for (const double c : taps) {
        if (t <= c) h = std::min(h, 0.08 * (c - t));
        if (t > c && t < c + 0.09) h = 0;
        if (t >= c + 0.09) h = std::min(h, 0.07 * (t - c - 0.09));
      }
      return h;
    };
    const auto force = [taps](double t) -> Vec3 {
      for (const double c : taps) {
        if (t > c && t < c + 0.09) return Vec3(0, 0, 2.0 * std::sin(std::numbers::pi * (t - c) / 0.09));
      }
      if (t < 5.5 || t > 23.5) return Vec3::Zero();
      const double n = 1.2 + 0.6 * std::sin(2 * t);
      return Vec3(-0.2 * n * std::cos(0.7 * t), 0.2 * n * std::sin(0.7 * t), n);
    };
    const auto tip = [height, this](double t) -> Vec3 {
      return Vec3(0.03 * std::sin(0.7 * t), 0.03 * std::cos(0.7 * t), height(t) + radius_);
    };
    const auto attitude = [&](double t) -> Quat {
      return Quat(Eigen::AngleAxisd(std::numbers::pi + 0.3 * std::sin(0.4 * t), Vec3::UnitX()) *
                  Eigen::AngleAxisd(0.25 * std::cos(0.31 * t), Vec3::UnitY()));
    };
    Eigen::Matrix<double, 6, 6> axes;
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 6; ++j) axes(i, j) = (i == j ? 3.0 : 0.4 * random.normal()) * (i < 3 ? 1.0 : 6.0);
    }
    write_file(folder_ / "sensor.cal", calibration(axes));
    const Quat q_TW = object_.q.conjugate();
    const Vec3 gravity_T(0, 0, -9.81);
    // Voltages at 1 kHz keep the test quick.
    std::string volts = "t_s,v1_V,v2_V,v3_V,v4_V,v5_V,v6_V\n";
    for (const double t : testing::steps(0.0, 29, 1e-3)) {
      const Quat q_TS = q_TW * attitude(t);
      const Vec3 f_S = q_TS.conjugate() * (q_TW * force(t));
      Wrench w = tool_wrench(tool_, q_TS, gravity_T);
      w.f_N += f_S;
      w.torque_Nm += tip_S.cross(f_S);
      Eigen::Matrix<double, 6, 1> load;
      load << w.f_N, 1e3 * w.torque_Nm;
      for (int k = 0; k < 6; ++k) load[k] += (k < 3 ? 0.004 : 0.01) * random.normal();
      const Eigen::Matrix<double, 6, 1> v = axes.inverse() * load;
      volts += fmt::format("{:.9f},{:.7f},{:.7f},{:.7f},{:.7f},{:.7f},{:.7f}\n", t * (1 + skew) + offset, v[0], v[1],
                           v[2], v[3], v[4], v[5]);
    }
    write_file(folder_ / "volts.csv", volts);
    std::string motion = "t_s,x_m,y_m,z_m,qw,qx,qy,qz,tracked\n";
    for (const double t : testing::steps(0.0, 29, 1.0 / 60)) {
      const Quat q_TP = q_TW * attitude(t) * q_PS.conjugate();
      const Vec3 tip_T = q_TW * (tip(t) - object_.t_m);
      const Vec3 p = tip_T - q_TP * tip_P + 5e-5 * Vec3(random.normal(), random.normal(), random.normal());
      motion += fmt::format("{:.9f},{:.7f},{:.7f},{:.7f},{:.9f},{:.9f},{:.9f},{:.9f},1\n", t, p.x(), p.y(), p.z(),
                            q_TP.w(), q_TP.x(), q_TP.y(), q_TP.z());
    }
    write_file(folder_ / "motion.csv", motion);
    std::string markers = "x_m,y_m,z_m,mx_m,my_m,mz_m\n";
    for (const Vec3& m : {Vec3(0.08, 0, 0), Vec3(-0.08, 0.05, 0.01), Vec3(0, -0.08, 0.03), Vec3(0.03, 0.07, -0.02)}) {
      const Vec3 seen = q_TW * (m - object_.t_m) + 1e-4 * Vec3(random.normal(), random.normal(), random.normal());
      markers += fmt::format("{:.7f},{:.7f},{:.7f},{},{},{}\n", seen.x(), seen.y(), seen.z(), m.x(), m.y(), m.z());
    }
    write_file(folder_ / "markers.csv", markers);
    std::string statics = "fx_N,fy_N,fz_N,tx_Nmm,ty_Nmm,tz_Nmm,qw,qx,qy,qz\n";
    for (int i = 0; i < 8; ++i) {
      const Quat q = random.rotation();
      const Wrench w = tool_wrench(tool_, q, gravity_T);
      statics += fmt::format("{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.9f},{:.9f},{:.9f},{:.9f}\n",
                             w.f_N.x() + 0.001 * random.normal(), w.f_N.y(), w.f_N.z(), 1e3 * w.torque_Nm.x(),
                             1e3 * w.torque_Nm.y(), 1e3 * w.torque_Nm.z(), q.w(), q.x(), q.y(), q.z());
    }
    write_file(folder_ / "statics.csv", statics);
    write_file(folder_ / "plate.obj", "v -0.2 -0.2 0\nv 0.2 -0.2 0\nv 0.2 0.2 0\nv -0.2 0.2 0\nf 1 2 3\nf 1 3 4\n");
    write_file(folder_ / "acquisition.json", fmt::format(R"({{"schema": "touchstone-acquisition/1",
      "force": {{"file": "volts.csv", "calibration": "sensor.cal", "serial": "FT0042", "cutoff_Hz": 20}},
      "motion": {{"file": "motion.csv"}},
      "probe": {{"tip_P_m": [0.01, 0.02, 0.12], "tip_S_m": [0, 0, 0.05], "q_PS": [{:.12f}, {:.12f}, {:.12f}, {:.12f}], "tip_radius_m": {}}},
      "tool": {{"file": "statics.csv"}},
      "clocks": {{"tap_normal_W": [0, 0, 1]}},
      "registration": {{"markers": "markers.csv", "mesh": "plate.obj", "contact_force_N": 0.4}}}})",
                                                         q_PS.w(), q_PS.x(), q_PS.y(), q_PS.z(), radius_));
    truth_force_ = force;
    truth_tip_ = tip;
    truth_offset_ = offset;
    truth_skew_ = skew;
  }

  static std::string calibration(const Eigen::Matrix<double, 6, 6>& axes) {
    std::string xml =
        "<FTSensor Serial=\"FT0042\" BodyStyle=\"Nano17\" Family=\"DAQ\" NumGages=\"6\" "
        "CalFileVersion=\"1.0\"><Calibration PartNumber=\"SI-12-0.12\" "
        "CalDate=\"2/3/2020\" ForceUnits=\"N\" TorqueUnits=\"N-mm\" DistUnits=\"mm\" OutputRange=\"20\" "
        "OutputBipolar=\"True\">";
    const char* const names[] = {"Fx", "Fy", "Fz", "Tx", "Ty", "Tz"};
    for (int i = 0; i < 6; ++i) {
      xml += fmt::format("<Axis Name=\"{}\" scale=\"1\" max=\"{}\" values=\"", names[i], i < 3 ? 17 : 120);
      for (int j = 0; j < 6; ++j) xml += fmt::format(" {:.17g}", axes(i, j));
      xml += "\"/>";
    }
    return xml + "<BasicTransform Dx=\"0\" Dy=\"0\" Dz=\"0\" Rx=\"0\" Ry=\"0\" Rz=\"0\"/></Calibration></FTSensor>";
  }

  Acquired run() { return acquire(read_description(folder_ / "acquisition.json")); }
  std::string complaint() {
    try {
      run();
    } catch (const BadData& error) {
      return error.what();
    }
    return "accepted";
  }
  void replace_in(const std::string& file, const std::string& from, const std::string& to) {
    auto text = read_file(folder_ / file);
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    write_file(folder_ / file, text.replace(at, from.size(), to));
  }

  fs::path folder_;
  ToolLoad tool_;
  RigidTransform object_;
  double radius_ = 0.0015;
  std::function<Vec3(double)> truth_force_, truth_tip_;
  double truth_offset_ = 0.0, truth_skew_ = 0.0;
};

TEST_F(AcquireTest, LeadsBackToTheTruth) {
  const auto [recording, report] = run();
  ASSERT_GT(recording.size(), 1600U);
  ASSERT_TRUE(report.clocks && report.tool && report.markers && report.contacts);
  const double at = report.clocks->reference_s;
  EXPECT_NEAR(report.clocks->to_force_clock(at), at * (1 + truth_skew_) + truth_offset_, 1e-3);
  EXPECT_NEAR(report.tool->load.mass_kg, 0.03, 5e-4);
  EXPECT_LT(report.markers->residual_rms_m, 2.5e-4);
  EXPECT_LT(report.contacts->rms_after_m, 1e-4);
  EXPECT_EQ(report.contacts->determined_directions, 3);  // a plate tells height and two tilts
  double force = 0, position = 0;
  std::size_t n = 0;
  for (std::size_t i = 0; i < recording.size(); ++i) {
    const double t = recording.motion.t_s[i];
    if (t < 7 || t > 22) continue;
    force += (recording.f_W_N[i] - truth_force_(t)).squaredNorm();
    position += (recording.motion.p_W_m[i] - truth_tip_(t)).squaredNorm();
    ++n;
  }
  EXPECT_LT(std::sqrt(force / static_cast<double>(n)), 0.01);
  EXPECT_LT(std::sqrt(position / static_cast<double>(n)), 4e-4);  // markers of 0.1 mm leave that much across the plate
  EXPECT_LT(report.free_air.force_component_N, 0.01);
  EXPECT_NEAR(report.force_bandwidth_Hz, 20, 1e-9);
  EXPECT_THAT(report_json(report), HasSubstr("touchstone-acquisition-report/1"));
  EXPECT_THAT(report_text(report), HasSubstr("clocks"));
}

TEST_F(AcquireTest, ContactInTheBiasIntervalIsNamed) {
  const auto with_bias = [&](const std::string& interval) {
    auto text = read_file(folder_ / "acquisition.json");
    const std::string serial = "\"serial\": \"FT0042\"";
    const auto at = text.find(serial);
    return text.replace(at, serial.size(), serial + interval);
  };
  const std::string free = with_bias(R"(, "bias_from_s": 0.8, "bias_to_s": 1.6)"),
                    touching = with_bias(R"(, "bias_from_s": 1.2, "bias_to_s": 2.2)");
  write_file(folder_ / "acquisition.json", free);
  EXPECT_FALSE(run().report.contact_in_free_air);
  EXPECT_THAT(report_text(run().report), ::testing::Not(HasSubstr("contact:")));
  write_file(folder_ / "acquisition.json", touching);
  EXPECT_THAT(complaint(), HasSubstr("contact: something is touched in the bias interval of 1.2 to 2.2 s"));
}

TEST(AcquisitionGuide, ItsExampleIsADescription) {
  const char* const source = std::getenv("TOUCHSTONE_SOURCE_DIR");
  ASSERT_NE(source, nullptr);
  const std::string guide = read_file(fs::path(source) / "docs" / "how-to" / "acquire.md");
  const std::string fence = "```json\n";
  const auto from = guide.find(fence) + fence.size();
  const auto file = fs::path(::testing::TempDir()) / "acquisition-guide.json";
  write_file(file, guide.substr(from, guide.find("```", from) - from));
  const AcquisitionDescription description = read_description(file);
  EXPECT_EQ(description.serial, "FT12345");
  EXPECT_EQ(description.tip_radius_m, 0.0015);
  EXPECT_EQ(description.mesh_unit, "mm");
  fs::remove(file);
}

TEST_F(AcquireTest, SaysWhatIsWrongWithItsInputs) {
  EXPECT_EQ(complaint(), "accepted");
  replace_in("acquisition.json", "FT0042", "FT0043");
  EXPECT_THAT(complaint(), HasSubstr("belongs to sensor FT0042"));
  replace_in("acquisition.json", "FT0043", "FT0042");
  replace_in("acquisition.json", "\"tip_S_m\"", "\"tip_s_m\"");
  EXPECT_THAT(complaint(), HasSubstr("tip_S_m"));
  replace_in("acquisition.json", "\"tip_s_m\"", "\"tip_S_m\"");
  // Time running back.
  auto motion = read_file(folder_ / "motion.csv");
  replace_in("motion.csv", "\n10.000000000", "\n9.000000000");
  EXPECT_THAT(complaint(), HasSubstr("time runs back"));
  // A tracker that loses the probe for half a second.
  std::string lost;
  std::istringstream lines(motion);
  for (std::string line; std::getline(lines, line);) {
    const double t = std::atof(line.c_str());
    if (t > 12.0 && t < 12.5) line.back() = '0';
    lost += line + "\n";
  }
  write_file(folder_ / "motion.csv", lost);
  EXPECT_THAT(complaint(), HasSubstr("lost the probe 1 times"));
  replace_in("acquisition.json", "\"file\": \"motion.csv\"", "\"file\": \"motion.csv\", \"keep_around_gaps\": true");
  EXPECT_EQ(complaint(), "accepted");
  const auto kept = run();
  EXPECT_GT(kept.report.samples_without_tracking, 20U);
  for (const double t : kept.recording.motion.t_s) EXPECT_FALSE(t > 12.01 && t < 12.49);
  write_file(folder_ / "motion.csv", motion);
  // Flags and forces that are none, of a sensor that gives wrenches.
  const std::string voltages = R"("file": "volts.csv", "calibration": "sensor.cal", "serial": "FT0042")";
  replace_in("acquisition.json", voltages, R"("file": "force.csv")");
  for (const auto& [first, said] : {std::pair{"0.0,1,0,0,0,0,0,nan", "is not a whole number"},
                                    {"0.0,1,0,0,0,0,0,-1", "is not a whole number"},
                                    {"0.0,1,0,0,0,0,0,0.5", "is not a whole number"},
                                    {"0.0,nan,0,0,0,0,0,0", "1 of 2 samples are not finite"}}) {
    write_file(folder_ / "force.csv",
               std::string("t_s,fx_N,fy_N,fz_N,tx_Nm,ty_Nm,tz_Nm,flags\n") + first + "\n0.1,1,0,0,0,0,0,0\n");
    EXPECT_THAT(complaint(), HasSubstr(said)) << first;
  }
  replace_in("acquisition.json", R"("file": "force.csv")", voltages);
  // Markers mixed up.
  const auto markers = read_file(folder_ / "markers.csv");
  replace_in("markers.csv", ",0.08,0,0\n", ",0.08,0.01,0\n");
  EXPECT_THAT(complaint(), HasSubstr("is the order the same"));
  write_file(folder_ / "markers.csv", markers);
  // A single static orientation.
  auto statics = read_file(folder_ / "statics.csv");
  write_file(folder_ / "statics.csv", statics.substr(0, statics.find('\n', statics.find('\n') + 1) + 1));
  EXPECT_THAT(complaint(), HasSubstr("determine only 6 of the 10"));
}

}  // namespace
}  // namespace touchstone::acquisition
