// Files as their instruments wrote them, each by its shipped map, held against figures that other programs read from
// them (lines counted by wc, first and last values as the files have them, tools as the data's authors give them).
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "guess_map.h"
#include "harness/base/atomic_file.h"
#include "harness/recording/tool_load.h"
#include "harness/testing/shared_data.h"
#include "import_file.h"

namespace touchstone::importing {
namespace {

Imported by_map(const std::filesystem::path& file, const std::string& map) {
  const char* const folder = std::getenv("TOUCHSTONE_IMPORT_MAPS");
  EXPECT_NE(folder, nullptr);
  Imported imported = import_file(file, load_import_map(std::filesystem::path(folder) / map));
  fmt::print("{}\n{}", file.filename().string(), imported_text(imported));
  return imported;
}

std::filesystem::path saved(const Imported& imported, const std::string& name) {
  auto path = std::filesystem::path(::testing::TempDir()) / name;
  save_imported(path, imported);
  return path;
}

// Layouts that their makers fix: csv_writer.py of Universal Robots' RTDE client (blanks, names with _0 to _5), "File
// Formats" of the TUM RGB-D benchmark (timestamp tx ty tz qx qy qz qw, comments with #), "Data Explanation" of BGU-SPAD
// (time, three columns each of position, velocity, load force and grip force, two of the tactors).
TEST(RealImport, LayoutsOfMakersByTheirMaps) {
  const auto bluehill = std::filesystem::path(::testing::TempDir()) / fmt::format("bluehill-{}.csv", ::getpid());
  write_file(bluehill, "Crosshead Rate,5.00,mm/min\n\nTime,Extension,Load\n(s),(mm),(N)\n0.1,0.01,2.5\n0.2,0.02,5.5\n");
  const Imported pulled = by_map(bluehill, "bluehill.json");
  EXPECT_NEAR(pulled.columns[1][1], 2e-5, 1e-18);
  EXPECT_EQ(pulled.columns[2][1], -5.5);
  const auto trial = std::filesystem::path(::testing::TempDir()) / fmt::format("trial-{}.csv", ::getpid());
  write_file(trial,
             "0,1,2,3,4,5,6,7,8,9,10,11,12,0,0\n0.0125,1,1.5,3,4,5,6,7,8.5,9,10,11,12,0,0\n"
             "0.025,1,1,3,4,5,6,7,9,9,10,11,12,0,0\n");
  const Imported felt = by_map(trial, "bgu-spad.json");
  EXPECT_THAT(felt.names, ::testing::ElementsAre("t_s", "x_m", "y_m", "z_m", "fx_N", "fy_N", "fz_N"));
  EXPECT_THAT(felt.columns[2], ::testing::ElementsAre(2.0, 1.5, 1.0));
  EXPECT_THAT(felt.columns[5], ::testing::ElementsAre(8.0, 8.5, 9.0));
  const auto path = std::filesystem::path(::testing::TempDir()) / fmt::format("layout-{}.txt", ::getpid());
  std::string log = "timestamp", poses = "# ground truth trajectory\n";
  for (const char* const what : {"pose", "force"}) {
    for (int k = 0; k < 6; ++k) log += fmt::format(" actual_TCP_{}_{}", what, k);
  }
  log += "\n";
  for (int i = 0; i < 9; ++i) {
    log +=
        fmt::format("{:.3f} 0.11 0.22 {} 0 3.14 0 1 2 {} 0.1 0.2 0.3\n", 500.125 + 0.008 * i, 0.3 - 0.001 * i, 7 + i);
    poses += fmt::format("{:.4f} {} 0.2 0.3 0.6 0 0 0.8\n", 1.3e9 + 0.033 * i, 0.01 * i);
  }
  write_file(path, log);
  const Imported robot = by_map(path, "ur-rtde.json");
  EXPECT_EQ(robot.names.size(), 10U);
  EXPECT_NEAR(robot.columns[0][8], 0.064, 1e-9);
  EXPECT_EQ(robot.columns[3][4], 0.3 - 0.004);
  EXPECT_EQ(robot.columns[6][4], 11.0);
  EXPECT_EQ(robot.columns[9][0], 0.3);
  write_file(path, poses);
  const Imported trajectory = by_map(path, "tum-trajectory.json");
  EXPECT_NEAR(trajectory.columns[0][8], 0.264, 1e-6);
  EXPECT_EQ(trajectory.columns[1][5], 0.05);
  EXPECT_EQ(trajectory.columns[4][5], 0.8) << "the real part stands last";
}

// capisample of NDI's Combined API, as two public programs made from it write it: a line for each frame, a tool and its
// markers behind one another, a missing tool's values empty.
TEST(RealImport, TrackerTableOfNdiByItsMap) {
  const auto path = std::filesystem::path(::testing::TempDir()) / fmt::format("capi-{}.csv", ::getpid());
  std::string table =
      "ToolCount,ToolInfo,Frame#,PortHandle,Face#,timespec_s,timespec_ns,TransformStatus,Q0,Qx,Qy,Qz,Tx,Ty,Tz,Error,"
      "#Markers,Marker0.Status,Tx,Ty,Tz\n";
  for (int i = 0; i < 5; ++i) {
    table += fmt::format("1,,{},Port:1,0,1700000000,{},", 300 + i, 25'000'000 * i);
    table += i == 2 ? "Missing,,,,,,,,,1,Missing,,,\n"
                    : fmt::format("Enabled,0.8,0.6,0,0,{},20,-150,0.1,1,OK,1,2,3\n", 10 + 0.5 * i);
  }
  write_file(path, table);
  const Imported got = by_map(path, "ndi-capi.json");
  ASSERT_EQ(got.columns[0].size(), 4U) << "the row without a tool is none";
  EXPECT_NEAR(got.columns[0][3], 0.1, 1e-6);
  EXPECT_NEAR(got.columns[1][1], 0.0105, 1e-15);
  EXPECT_NEAR(got.columns[3][3], -0.15, 1e-15);
  EXPECT_EQ(got.columns[4][0], 0.8) << "the real part stands first";
}

TEST(RealImport, Axia80PosesGiveTheToolInTheWorldsFrame) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(file, "tool-gravity-axia80/recorded_messages_wrench_100.txt");
  const Imported got = by_map(file, "tool-gravity-axia80.json");
  EXPECT_EQ(got.columns.front().size(), 100U);
  auto poses = recording::read_static_poses(saved(got, "axia80.csv"), false);
  const Vec3 gravity(0, 0, -9.80665);
  EXPECT_GT(identify_tool(poses, gravity, "axia80").fit.force_component_N, 4.0) << "not in the sensor's frame";
  for (recording::StaticPose& pose : poses) {
    pose.measured = rotated(pose.q_WS.conjugate(), pose.measured);
  }
  const auto in_world = identify_tool(poses, gravity, "axia80");
  EXPECT_NEAR(in_world.load.mass_kg, 1.24, 0.005);
  EXPECT_NEAR(in_world.fit.force_component_N, 0.29, 0.01);
}

TEST(RealImport, GammaStaticsAndTheRunWithThreeClocks) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(statics, "tool-gravity/0-calibration_fts-accel.csv");
  TOUCHSTONE_SHARED_DATA_OR_SKIP(run, "tool-gravity/1-baseline_wrench.csv");
  const Imported poses = by_map(statics, "tool-gravity-statics.json");
  EXPECT_EQ(poses.columns.front().size(), 24U);
  const auto tool =
      identify_tool(recording::read_static_poses(saved(poses, "gamma.csv"), false), Vec3(0, 0, -9.82085), "gamma");
  EXPECT_NEAR(tool.load.mass_kg, 0.932, 0.01);
  const Imported moving = by_map(run, "tool-gravity-run.json");
  EXPECT_EQ(moving.names.front(), "t_s");
  EXPECT_EQ(moving.names.size(), 14U);
  EXPECT_GT(moving.columns.front().size(), 4000U);
}

TEST(RealImport, JointSweep) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(file, "actuator/mtm_joint4_sweep.csv");
  const Imported got = by_map(file, "actuator-joint.json");
  ASSERT_EQ(got.columns.front().size(), 4885U);
  EXPECT_EQ(got.columns[1].front(), -1.4687252941333431);
  EXPECT_EQ(got.columns[3].back(), -0.15993316732704796);
  EXPECT_NE(guess_map(file).json.find("\"row_rate_Hz\": 200"), std::string::npos);
}

TEST(RealImport, Spindle) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(file, "spindle-friction/Tool_4_Maryland_L_2_00.txt");
  const Imported got = by_map(file, "spindle.json");
  EXPECT_NEAR(static_cast<double>(got.columns.front().size()), 18000.0, 20.0);
}

TEST(RealImport, AfmCurves) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(jpk, "afm-indentation/fmt-tab-fd_version_0.13.3.tab");
  TOUCHSTONE_SHARED_DATA_OR_SKIP(workshop, "raw-formats/fmt-afm-workshop-fd_single_2020-02-14_13.41.25.csv");
  TOUCHSTONE_SHARED_DATA_OR_SKIP(nt_mdt,
                                 "raw-formats/fmt-ntmdt-txt-fd_2015_01_17_gel4-0,1_mQ_adh_6B_Curve_DFL_Height_51.txt");
  const Imported cell = by_map(jpk, "afm-jpk-tab.json");
  saved(cell, "cell.csv");
  const Imported curve = by_map(workshop, "afm-workshop.json");
  saved(curve, "workshop.csv");
  EXPECT_EQ(curve.columns[3].front(), 15072.4571 * -1e-6);
  const Imported gel = by_map(nt_mdt, "nt-mdt-curve.json");
  saved(gel, "gel.csv");
  // As afmformats reads it: the approach listed backwards, both without the constant they begin with.
  EXPECT_EQ(gel.columns[6].front(), -1.1033);
  EXPECT_EQ(gel.columns[6].back(), -1.0926);
  const auto turn = std::ranges::find(gel.columns[6], 1.4726) - gel.columns[6].begin();
  ASSERT_LT(turn + 1, std::ssize(gel.columns[6]));
  EXPECT_EQ(gel.columns[6][static_cast<std::size_t>(turn) + 1], 1.4711);
  EXPECT_EQ(std::ranges::count(gel.columns[6], 1.4726), 1);
  EXPECT_EQ(std::ranges::count(gel.columns[6], 1.4711), 1);
}

// A map that is proposed reads what the shipped map reads, as far as the file tells.
TEST(RealImport, ProposedMapsReadTheFilesTheyAreProposedFor) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(workshop, "raw-formats/fmt-afm-workshop-fd_single_2020-02-14_13.41.25.csv");
  TOUCHSTONE_SHARED_DATA_OR_SKIP(nt_mdt,
                                 "raw-formats/fmt-ntmdt-txt-fd_2015_01_17_gel4-0,1_mQ_adh_6B_Curve_DFL_Height_51.txt");
  TOUCHSTONE_SHARED_DATA_OR_SKIP(axia80, "tool-gravity-axia80/recorded_messages_wrench_100.txt");
  TOUCHSTONE_SHARED_DATA_OR_SKIP(jpk, "afm-indentation/fmt-tab-fd_version_0.13.3.tab");
  TOUCHSTONE_SHARED_DATA_OR_SKIP(joint, "actuator/mtm_joint4_sweep.csv");
  for (const auto& [file, shipped] : {std::pair{workshop, "afm-workshop.json"},
                                      {nt_mdt, "nt-mdt-curve.json"},
                                      {axia80, "tool-gravity-axia80.json"},
                                      {joint, "actuator-joint.json"}}) {
    const GuessedMap guess = guess_map(file);
    for (const std::string& reason : guess.reasons) fmt::print("  {}\n", reason);
    EXPECT_TRUE(guess.missing.empty()) << file;
    auto json = nlohmann::json::parse(guess.json);
    EXPECT_TRUE(json.contains("decide")) << "these files name no unit, clock or order";
    json.erase("decide");
    const Imported guessed = import_file(file, parse_import_map(json, "guessed"));
    const Imported meant = by_map(file, shipped);
    ASSERT_EQ(guessed.names, meant.names) << file;
    for (std::size_t c = 0; c < meant.names.size(); ++c) {
      ASSERT_EQ(guessed.columns[c].size(), meant.columns[c].size()) << file;
      for (std::size_t i = 0; i < meant.columns[c].size(); i += 37) {
        EXPECT_NEAR(guessed.columns[c][i], meant.columns[c][i], 1e-9 * std::abs(meant.columns[c][i]))
            << file << meant.names[c] << i;
      }
    }
  }
  // Its height is the piezo's, not the tip's: the deflection has to be added by hand.
  const std::string cell = guess_map(jpk).json;
  EXPECT_NE(cell.find("height (measured)"), std::string::npos);
  EXPECT_NE(cell.find("\"t_s\""), std::string::npos);
}

}  // namespace
}  // namespace touchstone::importing
