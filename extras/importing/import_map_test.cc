// What a map says is done, number by number; a map that makes no sense is refused with its place.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "guess_map.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/recording/recording_file.h"
#include "import_file.h"

namespace touchstone::importing {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::filesystem::path map_folder() {
  auto path = std::filesystem::path(::testing::TempDir()) / fmt::format("touchstone-import-map-{}", ::getpid());
  ensure_writable_folder(path);
  return path;
}

ImportMap map_of(const std::string& rest) {
  return parse_import_map(nlohmann::json::parse(R"({"schema": "touchstone-import/1", )" + rest + "}"), "map.json");
}

Imported imported_by(const std::string& text, const std::string& rest, const std::string& name = "main.txt") {
  write_file(map_folder() / name, text);
  return import_file(map_folder() / name, map_of(rest));
}

std::string map_refusal(const std::string& text, const std::string& rest) {
  try {
    imported_by(text, rest);
  } catch (const BadData& e) {
    return e.what();
  }
  return "no error";
}

const std::vector<double>& column(const Imported& imported, const std::string& name) {
  return imported.columns.at(
      static_cast<std::size_t>(std::ranges::find(imported.names, name) - imported.names.begin()));
}

TEST(ImportMap, SumsConstantsIntegralsAndRowClocks) {
  const auto got = imported_by("a,b\n1,10\n2,20\n3,40\n",
                               R"("columns": {"t_s": {"row_rate_Hz": 2},
                                  "x_mm": {"sum": [{"from": "a", "scale": 2}, {"from": 2}], "offset": 0.5},
                                  "y_mm": {"constant": 7}, "z_mm": {"integrate": "b", "start": 1}})");
  EXPECT_THAT(got.names, ElementsAre("t_s", "x_mm", "y_mm", "z_mm"));
  EXPECT_THAT(got.columns[0], ElementsAre(0, 0.5, 1));
  EXPECT_THAT(got.columns[1], ElementsAre(12.5, 24.5, 46.5));
  EXPECT_THAT(got.columns[2], ElementsAre(7, 7, 7));
  EXPECT_THAT(got.columns[3], ElementsAre(1, 8.5, 23.5));  // trapezoids
}

// Words as ATI's demo logs them: healthy, a threshold crossed (no fault), saturated.
const std::string status_log =
    "Status (hex), RDT Sequence, Fx, Fy, Fz\n0x0, 1, 1, 2, 3\n0x80010000, 2, 1, 2, 4\n0x80020000, 3, 1, 2, 9\n"
    "0x80020000, 4, 1, 2, 9\n0x0, 5, 1, 2, 4\n";

std::string status_map(const std::string& bad_samples, const std::string& more = "") {
  return R"x("columns": {"t_s": {"from": "RDT Sequence", "scale": 0.5}, "fx_N": {"from": "Fx"}, "fy_N": {"from": "Fy"},
            "fz_N": {"from": "Fz"})x" +
         more + R"x(}, "status": {"from": "Status (hex)", "device": "net-ft")x" + bad_samples + "}";
}

TEST(ImportMap, ASensorThatSaysItIsSaturatedIsRefusedWithItsPlace) {
  const std::string refused = map_refusal(status_log, status_map(""));
  EXPECT_THAT(refused, HasSubstr("the sensor says 'transducer saturation or A/D error' of 2 of 5 samples, the first in "
                                 "row 3 (1.5 s), the last in row 4 (2 s)"));
  EXPECT_THAT(refused, HasSubstr("\"leave out\""));
  EXPECT_THAT(refused, ::testing::Not(HasSubstr("monitor condition")));
}

TEST(ImportMap, SamplesThatTheSensorCallsBadAreLeftOutOrKeptWithFlags) {
  const auto left = imported_by(status_log, status_map(R"(, "bad_samples": "leave out")"));
  EXPECT_THAT(column(left, "fz_N"), ElementsAre(3, 4, 4));
  EXPECT_THAT(left.notes, ::testing::Contains(HasSubstr("2 rows left out: the sensor was saturated")));
  EXPECT_THAT(left.notes, ::testing::Contains(HasSubstr("'monitor condition latched' of 1 of 5 samples")));
  const auto kept = imported_by(status_log, status_map(R"(, "bad_samples": "keep")"));
  EXPECT_THAT(column(kept, "flags"), ElementsAre(0, 0, 1, 1, 0));
  const auto recording = imported_by(
      status_log, status_map(R"(, "bad_samples": "keep")",
                             R"(, "x_m": {"constant": 0}, "y_m": {"constant": 0}, "z_m": {"constant": 0})"));
  EXPECT_THAT(recording.names, ::testing::Not(::testing::Contains("flags")));
  EXPECT_THAT(recording.notes, ::testing::Contains(HasSubstr("transducer saturation")));
}

// The status goes with its force: shifted by a row, the saturated forces of rows 3 and 4 stand in rows 4 and 5.
TEST(ImportMap, AShiftTakesTheSensorsWordWithTheForce) {
  const std::string shift = R"(, "shift_force_s": 0.5)";
  const auto left = imported_by(status_log, status_map(R"(, "bad_samples": "leave out")") + shift);
  EXPECT_THAT(column(left, "fz_N"), ElementsAre(3, 4));
  const auto kept = imported_by(status_log, status_map(R"(, "bad_samples": "keep")") + shift);
  EXPECT_THAT(column(kept, "fz_N"), ElementsAre(3, 4, 9, 9));
  EXPECT_THAT(column(kept, "flags"), ElementsAre(0, 0, 1, 1));
}

TEST(ImportMap, AStatusThatIsNoneIsRefused) {
  EXPECT_THAT(
      map_refusal(status_log, R"("columns": {"fx_N": {"from": "Fx"}}, "status": {"from": "Fx", "device": "gamma"})"),
      HasSubstr("net-ft or ethernet-axia"));
  EXPECT_THAT(map_refusal("a,b\n1.5,2\n2,3\n", R"("columns": {"fx_N": {"from": "b"}},
                          "status": {"from": "a", "device": "net-ft"})"),
              HasSubstr("row 1: the status 'a' is 1.5: a whole number of 32 bits"));
}

TEST(ImportMap, PartsBesideOneAnotherAreStackedAndRowsChosen) {
  const std::string text = "1\t2\t3\t4\n5\t6\t7\t8\n";
  const std::string stack = R"("stack": [{"z": 1, "f": 2}, {"z": 3, "f": 4, "reverse": true}], )";
  const auto all = imported_by(text, stack + R"("columns": {"z_m": {"from": "z"}, "fz_N": {"from": "f"}})");
  EXPECT_THAT(column(all, "z_m"), ElementsAre(1, 5, 7, 3));
  EXPECT_THAT(column(all, "fz_N"), ElementsAre(2, 6, 8, 4));
  const auto first =
      imported_by(text, stack + R"("rows": {"where": {"segment": 0}}, "columns": {"z_m": {"from": "z"}})");
  EXPECT_THAT(column(first, "z_m"), ElementsAre(1, 5));
}

TEST(ImportMap, APaddedPartIsReadFromWhereItsColumnChanges) {
  const std::string text = "9\t4\t7\n8\t4\t7\n7\t4\t5\n6\t3\t5\n5\t3\t1\n";
  const std::string columns = R"("columns": {"z_m": {"from": "z"}, "fz_N": {"from": "f"}})";
  const auto got = imported_by(
      text,
      R"("stack": [{"z": 1, "f": 2, "reverse": true, "padded": "f"}, {"z": 1, "f": 3, "padded": "f"}], )" + columns);
  EXPECT_THAT(column(got, "z_m"), ElementsAre(5, 6, 7, 8, 7, 6, 5));
  EXPECT_THAT(column(got, "fz_N"), ElementsAre(3, 3, 4, 7, 5, 5, 1));
  EXPECT_THAT(map_refusal(text, R"("stack": [{"z": 1, "f": 2, "padded": "load"}], )" + columns),
              HasSubstr("padded: a column that the part names was expected"));
}

TEST(ImportMap, FilesAreJoinedByTimeOnTheMainClock) {
  write_file(map_folder() / "pose.txt", "0.5 0 0\n1.5 10 20\n2.5 30 20\n");
  const auto got = imported_by("t,f\n0,1\n1,2\n2,3\n3,4\n",
                               R"("files": {"pose": {"file": "pose.txt", "time": {"from": 1}}},
                                  "columns": {"t_s": {"from": "t"}, "fz_N": {"from": "f"}, "x_m": {"from": "pose:2"},
                                              "y_m": {"from": "pose:3"}})");
  // At 0 and at 3 s the pose's clock has not begun or has ended.
  EXPECT_THAT(column(got, "fz_N"), ElementsAre(2, 3));
  EXPECT_THAT(column(got, "x_m"), ElementsAre(5, 20));
  EXPECT_THAT(column(got, "y_m"), ElementsAre(10, 20));
  EXPECT_THAT(column(got, "t_s"), ElementsAre(0, 1));
  EXPECT_THAT(got.notes, ::testing::Contains(HasSubstr("2 rows left out")));
  write_file(map_folder() / "rows.txt", "1 2\n3 4\n");
  EXPECT_THAT(
      map_refusal(
          "t,f\n0,1\n1,2\n2,3\n",
          R"("files": {"pose": {"file": "rows.txt"}}, "columns": {"x_m": {"from": "pose:2"}, "t_s": {"from": "t"}})"),
      HasSubstr("has 2 rows where"));
}

TEST(ImportMap, OrientationsInEveryWriting) {
  const double s = std::sqrt(0.5);
  const std::string columns = R"("columns": {"fx_N": {"from": 1}, "fy_N": {"from": 2}, "fz_N": {"from": 3}}, )";
  // A quarter turn about z takes the sensor's x to the object's y.
  const std::string xyzw = fmt::format("1,0,0, 0,0,{0},{0}\n1,0,0, 0,0,0,1\n", s);
  const auto q =
      imported_by(xyzw, columns + R"("quaternion": {"from": [4,5,6,7], "order": "xyzw"}, "force_frame": "sensor")");
  EXPECT_NEAR(column(q, "fy_N")[0], 1.0, 1e-12);
  EXPECT_NEAR(column(q, "fx_N")[1], 1.0, 1e-12);
  EXPECT_NEAR(column(q, "qw")[0], s, 1e-12);
  const auto inverse =
      imported_by(xyzw, columns + R"("quaternion": {"from": [4,5,6,7], "order": "xyzw"}, "force_frame": "inverse")");
  EXPECT_NEAR(column(inverse, "fy_N")[0], -1.0, 1e-12);
  const auto rows =
      imported_by("1,0,0,0,-1,0,1,0,0,0,0,1\n1,0,0,1,0,0,0,1,0,0,0,1\n",
                  columns + R"("rotation_rows": [4,5,6,7,8,9,10,11,12], "force_frame": "sensor", "force_sign": -1)");
  EXPECT_NEAR(column(rows, "fy_N")[0], -1.0, 1e-12);
  const auto euler =
      imported_by("1,0,0,0,0,90\n1,0,0,0,0,0\n",
                  columns + R"("euler": {"from": [4,5,6], "order": "xyz", "unit": "deg"}, "force_frame": "sensor")");
  EXPECT_NEAR(column(euler, "fy_N")[0], 1.0, 1e-12);
  EXPECT_THAT(map_refusal("1,0,0,0.5,0,0,0\n1,0,0,0,0,0,1\n",
                          columns + R"("quaternion": {"from": [4,5,6,7], "order": "xyzw"})"),
              HasSubstr("row 1: the orientation is off a rotation by 0.5"));
}

TEST(ImportMap, ShiftedForces) {
  const auto got =
      imported_by("0,0,1\n1,0,2\n2,0,4\n3,0,8\n",
                  R"("columns": {"t_s": {"from": 1}, "fx_N": {"from": 2}, "fy_N": {"from": 2}, "fz_N": {"from": 3}},
                                  "shift_force_s": -0.5)");
  EXPECT_THAT(column(got, "fz_N"), ElementsAre(1.5, 3, 6));  // what the file has half a second later
}

TEST(ImportMap, WhatMakesNoSenseIsRefusedWithItsPlace) {
  const std::string text = "1,2\n3,4\n";
  EXPECT_THAT(map_refusal(text, R"("columns": {"x_m": {"from": 3}})"), HasSubstr("has no column '3'"));
  EXPECT_THAT(map_refusal(text, R"("columns": {"x_m": {"from": 1, "constant": 2}})"),
              HasSubstr("/columns/x_m: one of from"));
  EXPECT_THAT(map_refusal(text, R"("columns": {"x_m": {"frm": 1}})"),
              HasSubstr("map.json: /columns/x_m: nothing reads the key \"frm\"; did you mean \"from\"?"));
  EXPECT_THAT(map_refusal(text, R"("columns": {})"), HasSubstr("at least one column"));
  EXPECT_THAT(map_refusal(text, R"("columns": {"x_m": {"from": 1}}, "force_frame": "moon")"),
              HasSubstr("/force_frame"));
  EXPECT_THAT(map_refusal(text, R"("columns": {"x_m": {"integrate": 1}})"), HasSubstr("an integral needs t_s"));
  EXPECT_THAT(map_refusal(text, R"("columns": {"x_m": {"from": 1}}, "rows": {"where": {"1": 9}})"),
              HasSubstr("no row is left of 2"));
  EXPECT_THAT(map_refusal(text, R"("table": {"separator": "dot"}, "columns": {"x_m": {"from": 1}})"),
              HasSubstr("'dot' is not known"));
  // Beyond the numbers of an int; 2^32 + 1 was once read as column 1.
  EXPECT_THAT(map_refusal(text, R"("columns": {"x_m": {"from": 4294967297}})"), HasSubstr("no column '4294967297'"));
  EXPECT_THAT(map_refusal(text, R"("table": {"names": "a"}, "columns": {"x_m": {"from": 1}})"),
              HasSubstr("/table/names: a list of texts was expected"));
}

// The operator chose another unit for the next file; a head that is wrong is overruled by names of one's own.
TEST(ImportMap, AScaleThatIsNotOfTheFilesUnitIsRefused) {
  const std::string in_mm = "Time,Travel,Load\n(s),(mm),(N)\n1,2,3\n2,3,4\n",
                    in_kN = "Time,Travel,Load\n(s),(mm),(kN)\n1,2,3\n2,3,4\n";
  const std::string columns =
      R"("columns": {"t_s": {"from": 1}, "z_mm": {"from": "Travel", "scale": -1}, "fz_N": {"from": 3}})";
  EXPECT_EQ(imported_by(in_mm, columns).columns[1][0], -2);
  EXPECT_THAT(map_refusal(in_kN, columns),
              AllOf(HasSubstr("column 3 is 'Load (kN)'"), HasSubstr("the scale to fz_N is 1000, and not 1")));
  const std::string renamed = R"("table": {"names": ["t", "travel", "load"]},
      "columns": {"t_s": {"from": 1}, "z_mm": {"from": "travel"}, "fz_N": {"from": "load"}})";
  EXPECT_EQ(imported_by(in_kN, renamed).columns[2][1], 4);
  // Volts are of another quantity: their scale is a sensor's.
  EXPECT_EQ(imported_by("t,F (V)\n1,2\n2,3\n", R"("columns": {"t_s": {"from": 1}, "fz_N": {"from": 2, "scale": 50}})")
                .columns[1][1],
            150);
}

TEST(ImportMap, ARecordingIsReadBackAndAWrongOneIsNotWritten) {
  const std::string rest =
      R"("columns": {"t_s": {"from": 1}, "x_m": {"from": 2}, "y_m": {"constant": 0}, "z_m": {"constant": 0},
      "fx_N": {"constant": 0}, "fy_N": {"constant": 0}, "fz_N": {"from": 2}})";
  const auto out = map_folder() / "out.csv";
  std::filesystem::remove(out);
  save_imported(out, imported_by("5,0.25\n6,0.5\n7,1\n", rest));
  const recording::Recording r = recording::load_recording(out);
  EXPECT_THAT(r.motion.t_s, ElementsAre(0, 1, 2));
  EXPECT_EQ(r.f_W_N[1].z(), 0.5);
  EXPECT_THAT(imported_text(imported_by("5,0.25\n6,0.5\n7,1\n", rest)), HasSubstr("3 samples\n2 s at 1 Hz"));
  EXPECT_THAT(imported_picture(imported_by("5,0.25\n6,0.5\n7,1\n", rest), "a<b"), HasSubstr("</svg>"));
  const auto bad = map_folder() / "bad.csv";
  EXPECT_THROW(save_imported(bad, imported_by("5,0.25\n5,0.5\n7,1\n", rest)), BadData);
  EXPECT_FALSE(std::filesystem::exists(bad));
}

TEST(GuessMap, NamesUnitsClocksAndQuaternionsAreSeen) {
  std::string text = "Time [ms],Fx (mN),Fy (mN),Fz (mN),x_mm,y_mm,z_mm,a,b,c,d\n";
  for (int i = 0; i < 50; ++i) {
    const double h = 0.01 * i;
    text += fmt::format("{},1,2,3,4,5,6,0,0,{},{}\n", 2 * i, std::sin(h), std::cos(h));
  }
  write_file(map_folder() / "log.csv", text);
  const GuessedMap guess = guess_map(map_folder() / "log.csv");
  EXPECT_TRUE(guess.missing.empty());
  auto json = nlohmann::json::parse(guess.json);
  EXPECT_EQ(json["quaternion"]["order"], "xyzw");
  // Its order is assumed: nothing is imported until somebody says so.
  EXPECT_THAT(guess.decide, ElementsAre(HasSubstr("the order of a and the three after it")));
  EXPECT_THROW(parse_import_map(json, "guessed"), BadData);
  json.erase("decide");
  const Imported got = import_file(map_folder() / "log.csv", parse_import_map(json, "guessed"));
  EXPECT_NEAR(column(got, "t_s")[10], 0.02, 1e-12);
  EXPECT_NEAR(column(got, "fz_N")[0], 0.003, 1e-12);
  EXPECT_NEAR(column(got, "y_m")[0], 0.005, 1e-12);
  EXPECT_NEAR(column(got, "qw")[0], 1.0, 1e-12);
}

TEST(GuessMap, AJointWithoutHeaderAndClock) {
  std::string text;
  for (int i = 0; i < 400; ++i) {
    const double t = i / 200.0;
    text += fmt::format("{},{},{}\n", std::sin(t), std::cos(t), 0.1 * (i % 7));
  }
  write_file(map_folder() / "joint.csv", text);
  const auto json = nlohmann::json::parse(guess_map(map_folder() / "joint.csv").json);
  EXPECT_EQ(json["columns"]["t_s"]["row_rate_Hz"], 200);
  EXPECT_EQ(json["columns"]["q_rad"]["from"], "c1");
  EXPECT_EQ(json["columns"]["torque_Nm"]["from"], "c3");
}

// Loggers of Windows write "µ" and "°" in Latin-1, which JSON cannot hold.
TEST(GuessMap, NamesThatAreNoUtf8GoByTheirNumber) {
  write_file(map_folder() / "latin.csv", "t,fx,angle (\xb0)\n0,1,2\n0.1,1,3\n0.2,1,4\n");
  const GuessedMap guess = guess_map(map_folder() / "latin.csv");
  const Imported got =
      import_file(map_folder() / "latin.csv", parse_import_map(nlohmann::json::parse(guess.json), "guessed"));
  EXPECT_EQ(got.columns.front().size(), 3U);
}

}  // namespace
}  // namespace touchstone::importing
