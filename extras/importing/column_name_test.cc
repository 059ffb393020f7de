// The grammar's table: names as programs write them, and what they mean.
#include "column_name.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "foreign_unit.h"

namespace touchstone::importing {
namespace {

using enum Quantity;
using ::testing::HasSubstr;

struct Row {
  const char* name;
  std::vector<Quantity> quantities;
  char axis = 0;
  std::optional<double> factor;
};

void expect_rows(const std::vector<Row>& rows) {
  for (const Row& row : rows) {
    const ColumnName got = parse_column_name(row.name);
    EXPECT_EQ(got.quantities, row.quantities) << row.name;
    EXPECT_EQ(got.axis, row.axis) << row.name;
    ASSERT_EQ(got.factor.has_value(), row.factor.has_value()) << row.name << " " << got.doubt;
    EXPECT_NEAR(got.factor.value_or(0.0), row.factor.value_or(0.0), 1e-12) << row.name;
    EXPECT_EQ(got.doubt, "") << row.name;
  }
}

TEST(ColumnName, WhateverTheOrderCaseAndSeparators) {
  expect_rows({{"force_x", {force}, 'x', {}},
               {"F_y(N)", {force}, 'y', 1.0},
               {"Fx [mN]", {force}, 'x', 1e-3},
               {"FX", {force}, 'x', {}},
               {"FZ_N", {force}, 'z', 1.0},
               {"fz_n", {force}, 'z', 1.0},
               {"ForceX", {force}, 'x', {}},
               {"TCPForceY", {force}, 'y', {}},
               {"forcez", {force}, 'z', {}},
               {"force.x", {force}, 'x', {}},
               {"x_force_mN", {force}, 'x', 1e-3},
               {"X Force (kN)", {force}, 'x', 1e3},
               {"x (N)", {force}, 'x', 1.0},
               {"x_N", {force}, 'x', 1.0},
               {"Fz, N", {force}, 'z', 1.0},
               {"Fz in N", {force}, 'z', 1.0},
               {"Fx/N", {force}, 'x', 1.0},
               {"Kraft / N", {force}, 0, 1.0},
               {"Course traverse absolue (mm)", {position}, 0, 1e-3},
               {"Grip to grip separation [mm]", {position}, 0, 1e-3},
               {"F_n [mN]", {force}, 'n', 1e-3},
               {"/ft/wrench/force/x", {force}, 'x', {}},
               {"field.wrench.torque.z", {torque}, 'z', {}},
               {"force_torque_sensor.force.z", {force}, 'z', {}},
               {"pos_x", {position}, 'x', {}},
               {"pos_x_mm", {position}, 'x', 1e-3},
               {"P_z(m)", {position}, 'z', 1.0},
               {"PosY", {position}, 'y', {}},
               {"xpos", {position}, 'x', {}},
               {"x-position / mm", {position}, 'x', 1e-3},
               {"Position X", {position}, 'x', {}},
               {"tip_x", {position}, 'x', {}},
               {"current_pos_x", {position}, 'x', {}},
               {"current_orientation_w", {quaternion}, 'w', {}},
               {"tool0.pose.position.z", {position}, 'z', {}},
               {"X_MM", {position}, 'x', 1e-3},
               {"px", {position}, 'x', {}},
               {"Extension", {position}, 0, {}},
               {"height (measured)", {position}, 0, {}},
               {"torque_x", {torque}, 'x', {}},
               {"torque_x_Nmm", {torque}, 'x', 1e-3},
               {"Ty (N-mm)", {torque}, 'y', 1e-3},
               {"mx [N.m]", {torque}, 'x', 1.0},
               {"quat_w", {quaternion}, 'w', {}},
               {"qx", {quaternion}, 'x', {}},
               {"orientation.y", {quaternion}, 'y', {}},
               {"Time [ms]", {time}, 0, 1e-3},
               {"time_us", {time}, 0, 1e-6},
               {"timestamp_ns", {time}, 0, 1e-9},
               {"Time (Seconds)", {time}, 0, 1.0},
               {"Time_S", {time}, 0, 1.0},
               {"timeMs", {time}, 0, 1e-3},
               {"force_fx", {force}, 'x', {}},
               {"tool_position_px", {position}, 'x', {}},
               {"torque_tz", {torque}, 'z', {}},
               {"posMm", {position}, 0, 1e-3},
               {"posXmm", {position}, 'x', 1e-3},
               {"forceZN", {force}, 'z', 1.0},
               {"FX (KN)", {force}, 'x', 1e3},
               {"FORCE_Y_MN", {force}, 'y', 1e-3},
               {"TX (NM)", {torque}, 'x', 1.0},
               {"tz_nm", {torque}, 'z', 1.0},
               {"X_NM", {position}, 'x', 1e-9},
               {"z_nm", {position}, 'z', 1e-9},
               {"Effort Z (daN)", {force}, 'z', 10.0},
               {"forceN", {force}, 0, 1.0},
               {"t", {time}, 0, {}},
               {"Series Time", {time}, 0, {}},
               {"header.stamp.nanosec", {time}, 0, 1e-9},
               {"RDT Sequence", {count}, 0, {}},
               {"Frame", {count}, 0, {}},
               {"joint_angle", {angle}, 0, {}},
               {"q [deg]", {angle}, 0, std::acos(-1.0) / 180.0}});
}

TEST(ColumnName, NumbersCountTheComponents) {
  for (const auto& [name, quantity, index] : {std::tuple{"actual_TCP_force_0", force, 0U},
                                              {"wrench.3", wrench, 3U},
                                              {"force[2]", force, 2U},
                                              {"position.1", position, 1U},
                                              {"pose_6", pose, 6U},
                                              {"position_mm.2", position, 2U},
                                              {"force_mN_1", force, 1U},
                                              {"obs/ft.2", wrench, 2U}}) {
    const ColumnName got = parse_column_name(name);
    EXPECT_TRUE(got.is(quantity)) << name;
    EXPECT_EQ(got.index, index) << name;
  }
  EXPECT_EQ(parse_column_name("actual_TCP_force_0").frame, "actual tcp");
  EXPECT_EQ(parse_column_name("position_mm.2").factor, 1e-3);
}

TEST(ColumnName, WhatIsOpenStaysOpenUntilAUnitDecides) {
  EXPECT_TRUE(parse_column_name("tx").may_be(torque));
  EXPECT_TRUE(parse_column_name("tx").may_be(position));
  expect_rows(
      {{"tx [mm]", {position}, 'x', 1e-3}, {"tx_Nm", {torque}, 'x', 1.0}, {"Position (mm)", {position}, 0, 1e-3}});
  EXPECT_TRUE(parse_column_name("position").may_be(angle));
  EXPECT_TRUE(parse_column_name("ft_sensor.x").may_be(torque));
  EXPECT_TRUE(parse_column_name("ft_sensor.x").may_be(force));
}

// None of these is a position or a force that was measured.
TEST(ColumnName, OthersAreNotTaken) {
  for (const char* const name : {"velocity_x",
                                 "gyro_x",
                                 "target_TCP_pose_0",
                                 "force_error_x",
                                 "Force magnitude",
                                 "cmd_fx",
                                 "accel.z",
                                 "vx",
                                 "wx",
                                 "eye_x",
                                 "x_y_ratio",
                                 "dx",
                                 "foo",
                                 "temperature (C)",
                                 "FnRef",
                                 "rpy_x",
                                 "Extend T-B(V)",
                                 "tau_J_1",
                                 "joint_torque_2",
                                 "current_x",
                                 "x_des",
                                 "ground_force_px",
                                 "force_q_x",
                                 "fz_des",
                                 "T (degC)",
                                 "P (kPa)",
                                 "Load cell X (V)",
                                 "x (m/s)",
                                 "motor current (A)",
                                 "current"}) {
    const ColumnName got = parse_column_name(name);
    EXPECT_TRUE(got.quantities.empty() || got.is(other)) << name;
  }
}

TEST(ColumnName, AUnitThatIsNotKnownIsADoubt) {
  for (const char* const name :
       {"Fx (lbx)", "Fz [V]", "Fx (kg)", "time (rows)", "force_x_kpd", "pos_x_N", "Fx_mm", "time_mm", "Force (counts)",
        "Fz (N*1000)", "x (1/100 mm)", "x (%)", "X (Mm)", "Load (Mn)", "F (g)"}) {
    const ColumnName got = parse_column_name(name);
    EXPECT_NE(got.doubt, "") << name;
  }
  EXPECT_THAT(parse_column_name("Fx (kg)").doubt, HasSubstr("mass"));
}

// Against the definitions: the pound of 0.45359237 kg under 9.80665 m/s^2, the inch of 25.4 mm (NIST SP 811, appendix
// B).
TEST(ForeignUnit, SpellingsOfTheTrade) {
  constexpr double g = 9.80665, pound = 0.45359237 * g, inch = 0.0254;
  for (const auto& [written, si, factor] : {std::tuple{"lbf", "N", pound},
                                            {"gf", "N", 1e-3 * g},
                                            {"kgf", "N", g},
                                            {"kp", "N", g},
                                            {"cN", "N", 1e-2},
                                            {"\xc2\xb5N", "N", 1e-6},
                                            {"\xce\xbcN", "N", 1e-6},
                                            {"uN", "N", 1e-6},
                                            {"Newtons", "N", 1.0},
                                            {"N-mm", "N.m", 1e-3},
                                            {"N.m", "N.m", 1.0},
                                            {"Nm", "N.m", 1.0},
                                            {"Nmm", "N.m", 1e-3},
                                            {"mNm", "N.m", 1e-3},
                                            {"N\xc2\xb7m", "N.m", 1.0},
                                            {"lbf-in", "N.m", pound * inch},
                                            {"in-lb", "N.m", pound * inch},
                                            {"ft-lbs", "N.m", pound * 12 * inch},
                                            {"oz-in", "N.m", pound / 16 * inch},
                                            {"kg-cm", "N.m", g * 1e-2},
                                            {"in", "m", inch},
                                            {"inches", "m", inch},
                                            {"ft", "m", 12 * inch},
                                            {"mil", "m", inch / 1000},
                                            {"\xc2\xb5m", "m", 1e-6},
                                            {"\xce\xbcm", "m", 1e-6},
                                            {"\xb5m", "m", 1e-6},
                                            {"Millimeters", "m", 1e-3},
                                            {"nm", "m", 1e-9},
                                            {"msec", "s", 1e-3},
                                            {"min", "s", 60.0},
                                            {"deg", "rad", std::acos(-1.0) / 180.0}}) {
    const auto got = foreign_unit_factor(written, si);
    ASSERT_TRUE(got) << written;
    EXPECT_NEAR(*got, factor, 2e-9 * factor) << written;
  }
  for (const auto& [written, si] : {std::pair{"lbz", "N"},
                                    {"Hz", "s"},
                                    {"counts", "rad"},
                                    {"%", "rad"},
                                    {"kg", "N"},
                                    {"mm", "N"},
                                    {"", "m"},
                                    {"2024-03-05", "m"},
                                    {"\xc2\xb0"
                                     "C",
                                     "rad"},
                                    {"J", "N.m"},
                                    {"N/m", "N"}}) {
    EXPECT_EQ(foreign_unit_factor(written, si), std::nullopt) << written;
  }
}

}  // namespace
}  // namespace touchstone::importing
