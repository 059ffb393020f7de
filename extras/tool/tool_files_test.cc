#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "harness/base/error.h"
#include "harness/recording/recording_file.h"
#include "harness/recording/recording_writer.h"
#include "harness/recording/table_source.h"
#include "tool_metrics.h"
#include "tool_points.h"
#include "tool_replay.h"

namespace touchstone::tool {
using recording::InTrajectory;
using recording::Recording;

namespace {

using ::testing::HasSubstr;

class Folder {
 public:
  Folder() : path_(std::filesystem::path(::testing::TempDir()) / ("tool-files-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

// A wrench that a reader can work out: the force is the position in kN/m, the torque twice the rotation vector.
class Known : public ToolRenderer {
 protected:
  void do_reset() override {}
  ToolResult do_step(const ToolState& state, double) noexcept override {
    ToolResult result;
    result.f_W_N = 1000.0 * state.handle.p_W_m;
    result.torque_W_Nm = 2.0 * rotation_vector(state.handle.q_WT);
    result.proxy = {2.0 * state.handle.p_W_m, state.handle.q_WT};
    result.contact = state.handle.p_W_m.z() < 0.0;
    return result;
  }
};

void write_path(const std::filesystem::path& file, int samples) {
  recording::TrajectoryWriter writer(file, true);
  for (int i = 0; i < samples; ++i)
    writer.append(1e-3 * i, Vec3(0.001, 0.002, i < 4 ? 0.003 : -0.003), rotation_by(Vec3(0.1, 0.0, 0.01 * i)));
  writer.commit();
}

TEST(ToolReplay, WrenchAndProxyGoThroughFiles) {
  for (const char* extension : {".csv", ".h5"}) {
    const Folder folder;
    const auto path = folder / (std::string("path") + extension);
    write_path(path, 10);
    Known renderer;
    const ToolReplaySummary summary = replay_tool(
        renderer, {path, folder / (std::string("out") + extension), folder / (std::string("proxy") + extension), 1});
    EXPECT_EQ(summary.samples, 10U);
    EXPECT_EQ(summary.in_contact, 6U);
    const Recording out = recording::load_recording(folder / (std::string("out") + extension));
    ASSERT_EQ(out.size(), 10U);
    ASSERT_EQ(out.torque_W_Nm.size(), 10U);
    for (std::size_t i = 0; i < 10; ++i) {
      EXPECT_EQ(out.f_W_N[i], 1000.0 * out.motion.p_W_m[i]);
      EXPECT_LE((out.torque_W_Nm[i] - 2.0 * rotation_vector(out.motion.q_WS[i])).norm(), 1e-15);
    }
    const InTrajectory proxy = recording::load_trajectory(folder / (std::string("proxy") + extension));
    EXPECT_EQ(proxy.motion.p_W_m[5], 2.0 * out.motion.p_W_m[5]);
    replay_tool(renderer, {path, folder / "some.csv", {}, 4});
    EXPECT_EQ(recording::load_recording(folder / "some.csv").size(), 3U) << "samples 0, 4 and 8";
    EXPECT_EQ(measure_tool_steps(renderer, path).size(), 10U);
  }
}

// Two contacts where it touches, that a reader can work out from the time.
class WithContacts : public Known {
 protected:
  ToolResult do_step(const ToolState& state, double dt_s) noexcept override {
    ToolResult result = Known::do_step(state, dt_s);
    contacts_[0] = {state.handle.p_W_m, Vec3::UnitZ(), Vec3(0, 0, state.t_s)};
    contacts_[1] = {-state.handle.p_W_m, Vec3::UnitX(), Vec3(state.t_s, 0, 0)};
    if (result.contact) result.contacts = contacts_;
    return result;
  }

 private:
  std::array<ToolContact, 2> contacts_;
};

TEST(ToolReplay, ContactsGoIntoATable) {
  const Folder folder;
  write_path(folder / "path.csv", 10);
  WithContacts renderer;
  const ToolReplaySummary summary =
      replay_tool(renderer, {folder / "path.csv", folder / "out.csv", {}, 2, folder / "contacts.csv"});
  EXPECT_EQ(summary.contacts, 6U) << "two at each of samples 4, 6 and 8";
  const auto table = recording::open_table(folder / "contacts.csv");
  EXPECT_THAT(table->names(),
              ::testing::ElementsAre("t_s", "px_m", "py_m", "pz_m", "nx", "ny", "nz", "fx_N", "fy_N", "fz_N"));
  std::vector<std::vector<double>> values(10);
  EXPECT_EQ(table->read(100, values), 6U);
  EXPECT_THAT(values[0], ::testing::ElementsAre(0.004, 0.004, 0.006, 0.006, 0.008, 0.008));
  EXPECT_THAT(values[3], ::testing::ElementsAre(-0.003, 0.003, -0.003, 0.003, -0.003, 0.003));
  EXPECT_THAT(values[4], ::testing::ElementsAre(0, 1, 0, 1, 0, 1));
  EXPECT_THAT(values[9], ::testing::ElementsAre(0.004, 0, 0.006, 0, 0.008, 0));
}

TEST(PointTool, ThroughAFile) {
  const Folder folder;
  PointShell shell;
  shell.p_T_m = {Vec3(0.1, 0.2, 0.3), Vec3(-0.1, 1.0 / 3.0, 0.0)};
  shell.inward_T = {Vec3(0, 0, -1), Vec3(0.6, 0.8, 0.0)};
  save_point_shell(shell, folder / "points.csv");
  const PointShell back = load_point_shell(folder / "points.csv");
  EXPECT_EQ(back.p_T_m, shell.p_T_m);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_LE((back.inward_T[i] - shell.inward_T[i]).norm(), 1e-15);
  std::ofstream(folder / "mm.csv") << "nz,x_mm,y_mm,z_mm,ny,nx\n2,100,200,300,0,0\n";
  const PointShell mm = load_point_shell(folder / "mm.csv");
  EXPECT_LE((mm.p_T_m[0] - shell.p_T_m[0]).norm(), 1e-15);
  EXPECT_EQ(mm.inward_T[0], Vec3(0, 0, -1));
}

TEST(PointTool, SaysWhatIsWrongWithAFile) {
  const Folder folder;
  const auto message = [&](const std::string& text) {
    std::ofstream(folder / "bad.csv") << text;
    try {
      static_cast<void>(load_point_shell(folder / "bad.csv"));
    } catch (const BadData& wrong) {
      return std::string(wrong.what());
    }
    return std::string("taken");
  };
  EXPECT_THAT(message("x_m,y_m,z_m,nx,ny\n0,0,0,0,1\n"), HasSubstr("no column nz"));
  EXPECT_THAT(message("x_m,y_m,z_m,nx,ny,w\n0,0,0,0,1,0\n"), HasSubstr("column w is not known"));
  EXPECT_THAT(message("x_m,y_m,z_ft,nx,ny,nz\n0,0,0,0,1,0\n"), HasSubstr("unit 'ft'"));
  EXPECT_THAT(message("x_m,y_m,z,nx,ny,nz\n0,0,0,0,1,0\n"), HasSubstr("column z is not known"));
  EXPECT_THAT(message("x_m,y_m,z_m,nx,ny,nz\n0,0,0,0,0,1\n0,0,0,0,0,0\n"),
              ::testing::AllOf(HasSubstr("line 3"), HasSubstr("has no direction")));
  EXPECT_THAT(message("x_m,y_m,z_m,nx,ny,nz\n0,nan,0,0,0,1\n"), HasSubstr("line 2"));
}

TEST(ToolReplay, PathWithoutOrientationSaysWhatIsMissing) {
  const Folder folder;
  recording::TrajectoryWriter writer(folder / "points.csv", false);
  writer.append(0.0, Vec3::Zero());
  writer.append(0.1, Vec3::Zero());
  writer.commit();
  Known renderer;
  try {
    replay_tool(renderer, {folder / "points.csv", folder / "out.csv", {}, 1});
    FAIL();
  } catch (const BadData& error) {
    EXPECT_THAT(error.what(), HasSubstr("points.csv"));
    EXPECT_THAT(error.what(), HasSubstr("qw, qx, qy and qz"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "out.csv"));
}

Recording recording_of(const std::vector<Vec3>& forces, const std::vector<Vec3>& torques) {
  Recording recording;
  recording.source = "made.csv";
  for (std::size_t i = 0; i < forces.size(); ++i) {
    recording.motion.t_s.push_back(1e-3 * double(i));
    recording.motion.p_W_m.push_back(Vec3::Zero());
  }
  recording.f_W_N = forces;
  recording.torque_W_Nm = torques;
  return recording;
}

TEST(ToolMetrics, ErrorsPerAxisAndInJustNoticeableDifferences) {
  const Recording expected = recording_of({Vec3(1, 0, 0), Vec3(0, 2, 0)}, {Vec3(0.1, 0, 0), Vec3(0, 0.01, 0)});
  const Recording obtained =
      recording_of({Vec3(1.3, 0, 0), Vec3(0, 2, -0.4)}, {Vec3(0.1, 0, 0), Vec3(0, 0.01, 0.00762)});
  const ToolComparison c = compare_tools(expected, obtained);
  EXPECT_LE((c.max_force_error_N - Vec3(0.3, 0, 0.4)).norm(), 1e-15);
  EXPECT_NEAR(c.rms_force_error_N, std::sqrt((0.09 + 0.16) / 2.0), 1e-15);
  EXPECT_LE((c.max_torque_error_Nm - Vec3(0, 0, 0.00762)).norm(), 1e-15);
  EXPECT_EQ(c.worst_torque_row, 1U);
  EXPECT_NEAR(c.max_torque_error_jnd, 1.0, 1e-12) << "12.7 % of 60 mNm";
  EXPECT_NEAR(torque_error_in_jnd(Vec3(0.1, 0, 0), Vec3(0.1127, 0, 0)), 1.0, 1e-12) << "12.7 % of what was expected";
}

TEST(ToolMetrics, RefusesOtherTimesAndMissingTorque) {
  const Recording a = recording_of({Vec3::Zero(), Vec3::Zero()}, {Vec3::Zero(), Vec3::Zero()});
  Recording b = a;
  b.motion.t_s[1] = 0.5;
  EXPECT_THROW(static_cast<void>(compare_tools(a, b)), BadData);
  EXPECT_THROW(static_cast<void>(compare_tools(a, recording_of({Vec3::Zero()}, {Vec3::Zero()}))), BadData);
  EXPECT_THROW(static_cast<void>(compare_tools(a, recording_of({Vec3::Zero(), Vec3::Zero()}, {}))), BadData);
}

TEST(ToolMetrics, PoseOfTheProxy) {
  InTrajectory a;
  InTrajectory b;
  for (int i = 0; i < 3; ++i) {
    a.motion.t_s.push_back(i);
    b.motion.t_s.push_back(i);
    a.motion.p_W_m.emplace_back(i, 0, 0);
    b.motion.p_W_m.emplace_back(i, 1e-3 * i, 0);
    a.motion.q_WS.push_back(rotation_by(Vec3(0.2 * i, 0.1, 0)));
    b.motion.q_WS.push_back(rotation_by(Vec3(0, 0, 0.05 * i)) * a.motion.q_WS.back());
  }
  ToolComparison c;
  const Coupling coupling{1000.0, 0.25};
  Recording wrenches =
      recording_of({Vec3::Zero(), Vec3(0, 0, 1), Vec3(0, 0, 4)}, {Vec3::Zero(), Vec3(0.1, 0, 0), Vec3(0.1, 0, 0)});
  wrenches.motion.t_s = a.motion.t_s;
  compare_proxies(a, b, wrenches, coupling, c);
  EXPECT_NEAR(c.max_proxy_translation_m.value(), 2e-3, 1e-15);
  EXPECT_NEAR(c.max_proxy_rotation_rad.value(), 0.1, 1e-12);
  // Of 2 N against 7 % of 4 N (1 N against 20 % of 1 N is less); of 25 mNm against 12.7 % of 100 mNm.
  EXPECT_NEAR(c.max_proxy_translation_jnd.value(), 2.0 / (0.07 * 4.0), 1e-9);
  EXPECT_NEAR(c.max_proxy_rotation_jnd.value(), 0.025 / 0.0127, 1e-9);
}

}  // namespace
}  // namespace touchstone::tool
