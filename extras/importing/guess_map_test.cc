// What a proposal makes of files as programs write them: read as an expert reads them, or asked about. Layouts are
// those of the programs named; the numbers are made here.
#include "guess_map.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "import_file.h"

namespace touchstone::importing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

std::filesystem::path guess_file(const std::string& text, const std::string& name) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / fmt::format("touchstone-guess-{}", ::getpid());
  ensure_writable_folder(folder);
  write_file(folder / name, text);
  return folder / name;
}

GuessedMap guess_of(const std::string& text, const std::string& name = "log.csv") {
  return guess_map(guess_file(text, name));
}

nlohmann::json columns_of_guess(const GuessedMap& guess) { return nlohmann::json::parse(guess.json)["columns"]; }

// Imports by the proposal as it is, which is refused while a question is open.
Imported imported_as_guessed(const std::string& text, const std::string& name = "log.csv") {
  const auto path = guess_file(text, name);
  return import_file(path, parse_import_map(nlohmann::json::parse(guess_map(path).json), "guessed"));
}

// The same with its questions taken out, as by somebody who agrees with what is assumed.
Imported imported_when_agreed(const std::string& text, const std::string& name = "log.csv") {
  const auto path = guess_file(text, name);
  auto map = nlohmann::json::parse(guess_map(path).json);
  map.erase("decide");
  return import_file(path, parse_import_map(map, "agreed"));
}

// Forty rows of `columns` values each at 250 Hz; `row` gives those behind the time.
std::string rows_of(const std::function<std::string(int)>& row, double step = 0.004) {
  std::string text;
  for (int i = 0; i < 40; ++i) text += fmt::format("{},{}\n", step * i, row(i));
  return text;
}

std::string six(int i) {
  return fmt::format("{},{},{},{},{},{}", 0.01 + 0.001 * i, 0.02 - 0.001 * i, 0.3, 0.5 * i, -0.25 * i, 2 + i);
}

TEST(GuessMap, TheSameQuantitiesUnderManyNames) {
  for (const char* const names :
       {"t,pos_x,pos_y,pos_z,force_x,force_y,force_z", "Time(s),P_x(m),P_y(m),P_z(m),F_x(N),F_y(N),F_z(N)",
        "Time,PosX,PosY,PosZ,ForceX,ForceY,ForceZ",
        "stamp,tcp.x,tcp.y,tcp.z,wrench.force.x,wrench.force.y,wrench.force.z",
        "__time,/p/pose/position/x,/p/pose/position/y,/p/pose/position/z,/ft/wrench/force/x,/ft/wrench/force/y,/ft/"
        "wrench/force/z",
        "timestamp,actual_TCP_pose_0,actual_TCP_pose_1,actual_TCP_pose_2,actual_TCP_force_0,actual_TCP_force_1,actual_"
        "TCP_force_2",
        "\"T_S\",\"X_M\",\"Y_M\",\"Z_M\",\"FX_N\",\"FY_N\",\"FZ_N\""}) {
    const GuessedMap guess = guess_of(std::string(names) + "\n" + rows_of(six));
    if (std::string_view(names).find("pose_0") != std::string_view::npos) {
      // Three of a pose's six: which they are is not certain, and is not said.
      EXPECT_FALSE(columns_of_guess(guess).contains("x_m"));
      EXPECT_EQ(columns_of_guess(guess)["fz_N"]["from"], "actual_TCP_force_2");
      continue;
    }
    EXPECT_THAT(guess.decide, ElementsAre()) << names;
    const Imported got = imported_as_guessed(std::string(names) + "\n" + rows_of(six));
    EXPECT_THAT(got.names, ElementsAre("t_s", "x_m", "y_m", "z_m", "fx_N", "fy_N", "fz_N")) << names;
    EXPECT_NEAR(got.columns[0][39], 0.156, 1e-12) << names;
    EXPECT_NEAR(got.columns[2][3], 0.017, 1e-12) << names;
    EXPECT_NEAR(got.columns[5][4], -1.0, 1e-12) << names;
  }
}

TEST(GuessMap, ThreeAnglesAreNoOrientationUntilTheirOrderIsStated) {
  const GuessedMap guess = guess_of("t,x_m,y_m,z_m,roll,pitch,yaw\n" + rows_of(six));
  EXPECT_FALSE(nlohmann::json::parse(guess.json).contains("euler"));
  EXPECT_THAT(guess.unused,
              testing::Contains(testing::AllOf(testing::HasSubstr("roll"), testing::HasSubstr("\"euler\""))));
  // What is assumed of the clock is said with the rate that follows.
  EXPECT_THAT(guess.reasons,
              testing::Contains(testing::HasSubstr("s is assumed, for it steps as a clock in s does: 250 Hz")));
}

TEST(GuessMap, UnitsOfTheTradeAreConvertedAndOthersAskedFor) {
  const Imported got =
      imported_as_guessed("time (ms),x (in),y (in),z (in),Fx (lbf),Fy (lbf),Fz (lbf)\n" + rows_of(six, 2.5));
  EXPECT_NEAR(got.columns[0][2], 0.005, 1e-15);
  EXPECT_NEAR(got.columns[1][1], 0.011 * 0.0254, 1e-15);
  EXPECT_NEAR(got.columns[6][1], 3 * 4.4482216152605, 1e-8);
  for (const char* const unit : {"lbz", "V", "kg", "counts"}) {
    const GuessedMap guess =
        guess_of(fmt::format("time (s),x (mm),y (mm),z (mm),Fx ({0}),Fy ({0}),Fz ({0})\n", unit) + rows_of(six));
    EXPECT_FALSE(columns_of_guess(guess).contains("fx_N")) << unit;
    EXPECT_THAT(guess.decide, ::testing::Contains(HasSubstr(unit))) << unit;
    EXPECT_THROW(parse_import_map(nlohmann::json::parse(guess.json), "guessed"), BadData);
  }
}

TEST(GuessMap, APoseFilesTranslationIsNoTorque) {
  std::string text = "# timestamp tx ty tz qx qy qz qw\n";
  for (int i = 0; i < 30; ++i) {
    const double h = 0.02 * i;
    text += fmt::format("{:.3f} {} 0.4 0.7 0 {} 0 {}\n", 1.7e9 + 0.02 * i, 0.001 * i, std::sin(h), std::cos(h));
  }
  const Imported got = imported_as_guessed(text, "pose.txt");
  EXPECT_THAT(got.names, ElementsAre("t_s", "x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"));
  EXPECT_NEAR(got.columns[1][10], 0.01, 1e-12);
  EXPECT_NEAR(got.columns[4][10], std::cos(0.2), 1e-9);
  // Beside forces and an orientation it may be either.
  EXPECT_THAT(guess_of("t,fx,fy,fz,tx,ty,tz,qx,qy,qz,qw\n" + rows_of([](int i) { return six(i) + ",0,0,0,1"; })).decide,
              ::testing::Contains(HasSubstr("a torque or a translation")));
}

TEST(GuessMap, AQuaternionGoesByItsNames) {
  const auto row = [](int i) { return six(i) + fmt::format(",{},0,{},0", std::cos(0.01 * i), std::sin(0.01 * i)); };
  const Imported got = imported_when_agreed("t,x,y,z,fx,fy,fz,quat_w,quat_x,quat_y,quat_z\n" + rows_of(row));
  EXPECT_NEAR(got.columns[7][20], std::cos(0.2), 1e-9);
  EXPECT_NEAR(got.columns[9][20], std::sin(0.2), 1e-9);
}

TEST(GuessMap, ClocksByTheirNumbersOnlyWhereTheseAreSure) {
  const auto at = [](double start, double step, const std::string& name) {
    std::string text = name + ",z_mm,fz_N\n";
    for (int i = 0; i < 30; ++i) text += fmt::format("{:.6f},{},{}\n", start + step * i, 0.1 * i, i % 5);
    return guess_of(text);
  };
  EXPECT_NEAR(columns_of_guess(at(1.7e18, 2e6, "timestamp"))["t_s"]["scale"].get<double>(), 1e-9, 1e-21);
  EXPECT_NEAR(columns_of_guess(at(1.7e15, 2000, "stamp"))["t_s"]["scale"].get<double>(), 1e-6, 1e-18);
  EXPECT_NEAR(columns_of_guess(at(1.7e12, 2, "time"))["t_s"]["scale"].get<double>(), 1e-3, 1e-15);
  EXPECT_FALSE(columns_of_guess(at(0, 0.002, "t"))["t_s"].contains("scale"));
  // Whole steps may be of any unit; outside of 1 Hz to 1 MHz it is no clock of a recording, whatever its name says.
  for (const auto& [step, name] : {std::pair{3.0, "Time"}, {1.0, "t"}, {25.0, "Time (s)"}, {1e-4, "Time (us)"}}) {
    const GuessedMap guess = at(0, step, name);
    EXPECT_FALSE(columns_of_guess(guess).contains("t_s")) << name << step;
    EXPECT_THAT(guess.decide, ::testing::Contains(HasSubstr("t_s"))) << name << step;
  }
  EXPECT_THAT(at(0, 0.1, "Segment").decide, ::testing::Contains(HasSubstr("no name says which column is the clock")));
}

TEST(GuessMap, SixForcesAreAWrenchOnlyWhereThatIsSaid) {
  const auto six_of = [](const char* name) {
    std::string text = "t,z_mm";
    for (int k = 0; k < 6; ++k) text += fmt::format(",{}_{}", name, k);
    return guess_of(text + "\n" + rows_of([](int i) { return fmt::format("1,{},2,3,0.01,0.0{},0.03", i % 7, i % 5); }));
  };
  EXPECT_THAT(six_of("forces").decide, ::testing::Contains(HasSubstr("of a second sensor")));
  EXPECT_FALSE(columns_of_guess(six_of("forces")).contains("tx_Nm"));
  for (const char* const name : {"wrench", "ft", "actual_TCP_force"}) {
    EXPECT_THAT(six_of(name).decide, ElementsAre()) << name;
    EXPECT_TRUE(columns_of_guess(six_of(name)).contains("tx_Nm")) << name;
  }
}

TEST(GuessMap, NumbersOfTheHeadAreReadAsTheyAreWritten) {
  const auto rate = [](const std::string& head) {
    const auto columns =
        columns_of_guess(guess_of(head + "\nx_mm,y_mm,z_mm,fx_N,fy_N,fz_N\n" +
                                  rows_of([](int i) { return fmt::format("2,3,{},5,6", i % 7); }, 1.0)));
    return columns.contains("t_s") ? columns["t_s"]["row_rate_Hz"].get<double>() : 0.0;
  };
  EXPECT_EQ(rate("Sample rate: 1,000 Hz"), 1000);
  EXPECT_EQ(rate("Sampling frequency 2,5 kHz"), 2500);
  EXPECT_EQ(rate("Sampling Rate (kHz): 2"), 2000);
  EXPECT_EQ(rate("Capture Frame Rate,120,250,x"), 120);
  EXPECT_EQ(rate("Data rate: 9600 baud"), 0);
  EXPECT_EQ(rate("Sample rate: 10 mm/min"), 0);
  const GuessedMap counts = guess_of("Sample rate: 50 Hz\nForce unit: N\nCounts per force: 1,000,000\nFx,Fy,Fz,a\n" +
                                     rows_of([](int i) { return fmt::format("2,{},5", i % 7); }, 1.0));
  EXPECT_EQ(columns_of_guess(counts)["fx_N"]["scale"], 1e-6);
}

TEST(GuessMap, ACounterIsAClockOnlyByTheRateAboveIt) {
  std::string rows = "Sample,Fx,Fy,Fz\n";
  for (int i = 1; i < 30; ++i) rows += fmt::format("{},{},2,3\n", i, 0.5 * i);
  EXPECT_THAT(guess_of(rows).decide, ElementsAre(HasSubstr("counts rows and no line states their rate")));
  const Imported got = imported_as_guessed("Sample Frequency (Hz): 4000\n" + rows);
  EXPECT_NEAR(got.columns[0].back(), 28.0 / 4000.0, 1e-12);
  EXPECT_THAT(
      guess_of("Sampling rate: 100 Hz\nt,Fx,Fy,Fz\n" + rows_of([](int i) { return fmt::format("{},2,3", i); })).decide,
      ElementsAre(HasSubstr("which is 250 Hz, but 'Sampling rate: 100 Hz' stands above it")));
  EXPECT_THAT(
      guess_of("Force Units: lbf\nt,Fx (N),Fy (N),Fz (N)\n" + rows_of([](int i) { return fmt::format("{},2,3", i); }))
          .decide,
      ::testing::Contains(HasSubstr("the lines above the table say lbf")));
}

// The layout of a Motive export (OptiTrack's manual, "Data Export: CSV").
std::string motive(const std::string& first, const std::string& second) {
  std::string text =
      "Format Version,1.24,Take Name,T,Capture Frame Rate,240,Export Frame Rate,240,Rotation Type,Quaternion,"
      "Length Units,Centimeters,Coordinate Space,Global\n\n"
      ",Type";
  const auto line = [&](const std::string& label, const std::string& a, const std::string& b) {
    text += "," + label;
    for (int k = 0; k < 7; ++k) text += "," + a;
    for (int k = 0; k < 7; ++k) text += "," + b;
    text += "\n";
  };
  text.resize(text.size() - 5);
  line("Type", "Rigid Body", "Rigid Body");
  line("Name", first, second);
  line("ID", "1", "2");
  text += ",";
  for (int body = 0; body < 2; ++body) text += ",Rotation,Rotation,Rotation,Rotation,Position,Position,Position";
  text += "\nFrame,Time (Seconds),X,Y,Z,W,X,Y,Z,X,Y,Z,W,X,Y,Z\n";
  for (int i = 0; i < 30; ++i) {
    text += fmt::format("{},{:.6f},0,0,0,1,{},5,6,0,0,0,1,7,8,9\n", i, i / 240.0, 2 + 0.5 * i);
  }
  return text;
}

TEST(GuessMap, MotiveIsReadByItsHead) {
  const Imported got = imported_as_guessed(motive("Stylus", "Plate"), "take.csv");
  EXPECT_NEAR(got.columns[1][4], 0.04, 1e-12);
  EXPECT_NEAR(got.columns[4][4], 1.0, 1e-12);  // qw
  EXPECT_NEAR(got.columns[0][24], 0.1, 1e-12);
  const GuessedMap guess = guess_of(motive("Body A", "Body B"), "take.csv");
  EXPECT_FALSE(columns_of_guess(guess).contains("x_m"));
  EXPECT_THAT(guess.decide, ::testing::Contains(HasSubstr("are as likely")));
}

TEST(GuessMap, ColumnsOfOneNameGoByTheirNumber) {
  const auto path = guess_file("t,X,Y,Z,X,Y,Z\n" + rows_of(six), "twice.csv");
  EXPECT_THAT(guess_map(path).decide, ::testing::Contains(HasSubstr("stand for the same")));
  const auto map = [](const std::string& from) {
    return parse_import_map(
        nlohmann::json::parse(R"({"schema": "touchstone-import/1", "columns": {"x_m": {"from": )" + from + "}}}"),
        "map.json");
  };
  try {
    import_file(path, map("\"X\""));
    FAIL();
  } catch (const BadData& error) {
    EXPECT_THAT(error.what(), HasSubstr("'X' stands for columns 2, 5"));
  }
  EXPECT_EQ(import_file(path, map("5")).columns[0][2], 1.0);
}

TEST(GuessMap, LabviewMeasurementsBySpecification) {
  const auto head = [](const std::string& x_columns) {
    return "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\nX_Columns\t" + x_columns +
           "\n***End_of_Header***\t\n\t\nChannels\t2\nSamples\t30\t30\nY_Unit_Label\tmm\tNewtons\nX_"
           "Dimension\tTime\tTime\n"
           "X0\t0.5\t0.5\nDelta_X\t0.002\t0.002\n***End_of_Header***\t\t\t\n";
  };
  const auto rows = [](const std::function<std::string(double)>& row) {
    std::string text;
    for (int i = 0; i < 30; ++i) text += row(0.5 + 0.002 * i) + "\n";
    return text;
  };
  const std::string names = "X_Value\tHeight\tFz\tComment\n";
  for (const std::string& text :
       {head("One") + names + rows([](double t) { return fmt::format("{:.6f}\t7.25\t1.5", t); }),
        head("No") + names + rows([](double) { return std::string("\t7.25\t1.5"); }),
        head("Multi") + "X_Value\tHeight\tX_Value\tFz\tComment\n" +
            rows([](double t) { return fmt::format("{0:.6f}\t7.25\t{0:.6f}\t1.5", t); })}) {
    const Imported got = imported_when_agreed(text, "force.lvm");
    ASSERT_THAT(got.names, ElementsAre("t_s", "z_m", "fz_N"));
    EXPECT_NEAR(got.columns[0][29], 0.058, 1e-9);
    EXPECT_NEAR(got.columns[1][0], 0.00725, 1e-15);
    EXPECT_EQ(got.columns[2][0], 1.5);
  }
}

// `rostopic echo -p` and `ros2 topic echo --csv`: the frame is text, the latter has no names.
TEST(GuessMap, EchoedTopics) {
  std::string one =
      "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.wrench.force.x,field.wrench.force.y,"
      "field.wrench.force.z,field.wrench.torque.x,field.wrench.torque.y,field.wrench.torque.z\n";
  std::string two, twist, pose;
  for (int i = 0; i < 30; ++i) {
    one += fmt::format("{0},{1},{0},tool,1,2,{1},4,5,6\n", 1700000000000000000 + 5000000L * i, i);
    two += fmt::format("{},{},ft_link,1,2,{},4,5,6\n", 1700000000 + i / 20, 50000000 * (i % 20), i);
    twist += fmt::format("1700000000,{},base,1,2,{},4,5,6\n", 5000000 * i, i);
    pose += fmt::format("1700000000,{},base,1,2,{},0,0,0.6,0.8\n", 5000000 * i, 0.01 * i);
  }
  for (const std::string* text : {&one, &two}) {
    const Imported got = imported_as_guessed(*text);
    ASSERT_THAT(got.names, ElementsAre("t_s", "fx_N", "fy_N", "fz_N", "tx_Nm", "ty_Nm", "tz_Nm"));
    EXPECT_NEAR(got.columns[0][29], text == &one ? 0.145 : 1.45, 1e-6);
    EXPECT_EQ(got.columns[3][7], 7.0);
  }
  EXPECT_FALSE(columns_of_guess(guess_of(twist)).contains("fx_N"));
  const Imported got = imported_as_guessed(pose);
  EXPECT_NEAR(got.columns[3][5], 0.05, 1e-12);
  EXPECT_NEAR(got.columns[4][5], 0.8, 1e-12);
}

// A tracker's millimetres without a unit: in m they would be farther than a hand reaches.
TEST(GuessMap, PositionsBeyondAHandAreAskedFor) {
  const auto row = [](int i) {
    return fmt::format("{},{},0,0,{},20,-180", std::cos(0.01 * i), std::sin(0.01 * i), 10 + 0.1 * i);
  };
  const GuessedMap guess = guess_of("t,Q0,Qx,Qy,Qz,Tx,Ty,Tz\n" + rows_of(row));
  EXPECT_THAT(guess.decide,
              ElementsAre(::testing::AllOf(HasSubstr("x_m, y_m, z_m ('Tx', 'Ty', 'Tz'): no unit is named"),
                                           HasSubstr("0.001 for mm"))));
  EXPECT_FALSE(columns_of_guess(guess).contains("x_m"));
  EXPECT_EQ(nlohmann::json::parse(guess.json)["quaternion"]["from"][0], "Q0");
  EXPECT_THAT(guess_of("t,x_mm,y,z\n" + rows_of([](int i) { return fmt::format("{},2,3", i); })).decide,
              ElementsAre(HasSubstr("'x_mm' (column 2) names a unit and 'z' (column 4) none")));
}

// Four of a rotation's nine numbers may have the norm one too.
TEST(GuessMap, ARotationByItsNamesIsNoQuaternion) {
  const auto row = [](int i) {
    const double c = std::cos(0.1 * i), s = std::sin(0.1 * i);
    return fmt::format("1,2,3,0,{0},{1},0,{2},{0},1,0,0", c, -s, s);
  };
  const auto json =
      nlohmann::json::parse(guess_of("t,fx,fy,fz,r11,r12,r13,r21,r22,r23,r31,r32,r33\n" + rows_of(row)).json);
  EXPECT_TRUE(json.contains("rotation_rows"));
  EXPECT_FALSE(json.contains("quaternion"));
}

TEST(GuessMap, JointsAreNoAxes) {
  const GuessedMap guess = guess_of(
      "t,field.position0,field.position1,field.position2,field.effort0,field.effort1,field.effort2\n" + rows_of(six));
  EXPECT_FALSE(columns_of_guess(guess).contains("x_m"));
  EXPECT_FALSE(columns_of_guess(guess).contains("tx_Nm"));
}

TEST(GuessMap, TheSameInVoltsIsNoRival) {
  const Imported got = imported_when_agreed("Time (s),Depth (nm),Load (uN),Depth (V),Load (V)\n" +
                                            rows_of([](int i) { return fmt::format("{},2,3,4", i); }));
  EXPECT_THAT(got.names, ElementsAre("t_s", "z_m", "fz_N"));
  EXPECT_NEAR(got.columns[1][7], 7e-9, 1e-20);
}

TEST(GuessMap, AMachineThatNamesNeitherUnitNorAxisIsAskedFor) {
  const GuessedMap guess = guess_of("Time (s),Extension,Load\n" +
                                    rows_of([](int i) { return fmt::format("{},{}", 0.01 * i, 2 * (i % 7)); }));
  EXPECT_THAT(guess.decide, ElementsAre(HasSubstr("'Extension' (column 2) names neither unit nor axis"),
                                        HasSubstr("'Load' (column 3) names neither unit nor axis")));
}

// A press there and back twice with the load of a depth: as heights are, the object would pull the probe in.
TEST(GuessMap, ADepthIsNoHeight) {
  const auto press = [](const char* names, double sign) {
    std::string text = names;
    for (int i = 0; i < 200; ++i) {
      const double depth = 3 * std::pow(std::sin(0.05 * i), 2);
      text += fmt::format("{:.3f},{:.6f},{:.6f}\n", 0.01 * i, sign * depth, 1.7 * depth + 0.02 * std::sin(1.3 * i));
    }
    return guess_of(text);
  };
  EXPECT_THAT(press("Time (s),Depth (mm),Load (N)\n", 1).decide, ElementsAre(HasSubstr("if it is a depth")));
  const GuessedMap right = press("Time (s),Height (mm),Load (N)\n", -1);
  EXPECT_THAT(right.decide, ElementsAre());
  EXPECT_THAT(nlohmann::json::parse(right.json)["reasons"].dump(), HasSubstr("as that ON a probe does"));
}

// What grows in both columns without end says nothing of their signs: a press, a tension test, a drift.
TEST(GuessMap, SignsOfColumnsWithoutAnAxisAreAskedFor) {
  const auto ramp = rows_of([](int i) { return fmt::format("{},{}", 0.05 * i, 3.0 * i); });
  for (const char* const names : {"Time (s),Extension (mm),Load (N)\n", "Time (s),Pd (um),Fn (mN)\n"}) {
    EXPECT_THAT(guess_of(names + ramp).decide, ElementsAre(HasSubstr("the numbers do not tell the signs"))) << names;
  }
  EXPECT_THAT(guess_of("Time (s),Force (N)\n" + rows_of([](int i) { return std::to_string(i % 7); })).decide,
              ElementsAre(HasSubstr("fz_N ('Force (N)')")));
  // Names of axes say it.
  EXPECT_THAT(guess_of("Time (s),z (mm),Fz (N)\n" + ramp).decide, ElementsAre());
}

TEST(GuessMap, AMotionWithoutAClockIsNoSetOfStaticPoses) {
  const auto poses = [](double step) {
    std::string text = "fx_N,fy_N,fz_N,qw,qx,qy,qz\n";
    for (int i = 0; i < 60; ++i) {
      const double a = std::sin(step * i);
      text += fmt::format("{},1,{},{},{},0,0\n", i % 5, i % 3, std::cos(a), std::sin(a));
    }
    return guess_of(text);
  };
  EXPECT_THAT(poses(0.05).decide, ElementsAre(HasSubstr("as a motion does"), HasSubstr("force_frame")));
  EXPECT_THAT(poses(2.4).decide, ElementsAre());
}

// PlotJuggler's CSV has a row for each time stamp of any topic, and blanks for the other topics.
TEST(GuessMap, SeveralTopicsInOneTable) {
  std::string text =
      "__time,/ft/wrench/force/x,/ft/wrench/force/y,/ft/wrench/force/z,/p/pose/position/x,/p/pose/position/y,/p/pose/"
      "position/z\n";
  for (int i = 0; i < 60; ++i) {
    const double t = 1.7e9 + 0.004 * i;
    text += fmt::format("{:.4f},,,,{},0.2,0.3\n{:.4f},1,2,{},,,\n", t, 0.001 * i, t + 0.001, i % 7);
  }
  const Imported got = imported_as_guessed(text);
  ASSERT_EQ(got.columns[0].size(), 59U) << "the last force lies behind the last position";
  EXPECT_NEAR(got.columns[0][1], 0.004, 1e-6);
  // A clock since 1970 has steps of 2.4e-7 s in double: 6e-8 of the way.
  EXPECT_NEAR(got.columns[1][10], 0.01025, 6e-8) << "a quarter of the way from one position to the next";
  EXPECT_EQ(got.columns[6][10], 3.0);
  // The same by numbers from the map of a user, who wants the rows of the position.
  const auto map = parse_import_map(nlohmann::json::parse(R"({"schema": "touchstone-import/1", "rows": {"at": 5},
                                "columns": {"t_s": {"from": 1}, "x_m": {"from": 5}, "fz_N": {"from": 4}}})"),
                                    "map.json");
  const Imported own = import_file(guess_file(text, "log.csv"), map);
  ASSERT_EQ(own.columns[0].size(), 59U);
  EXPECT_NEAR(own.columns[2][0], 0.75, 1e-4);
}

TEST(GuessMap, AClockAloneIsNoRecording) {
  EXPECT_THROW(imported_as_guessed("t,foo\n" + rows_of([](int i) { return std::to_string(i % 3); })), BadData);
}

}  // namespace
}  // namespace touchstone::importing
