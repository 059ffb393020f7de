// The page holds what the comparison found: errors per axis against their tolerances, and what a person could feel.
#include "tool_reports/tool_comparison_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <variant>

namespace touchstone::tool_reports {
namespace {

ComparedTools made(double torque_error_Nm) {
  ComparedTools compared;
  for (int i = 0; i < 10000; ++i) {
    for (recording::Recording* r : {&compared.expected, &compared.obtained}) {
      r->motion.t_s.push_back(1e-3 * i);
      r->motion.p_W_m.emplace_back(0, 0, 0);
      r->motion.q_WS.push_back(Quat::Identity());
      r->f_W_N.emplace_back(0, 0, 2.0);
      r->torque_W_Nm.emplace_back(0.1, 0, 0);
    }
  }
  compared.obtained.torque_W_Nm[7777].y() = torque_error_Nm;
  compared.expected.source = "right.csv";
  compared.obtained.source = "mine.csv";
  compared.force_tolerance_N = Vec3::Constant(0.01);
  compared.torque_tolerance_Nm = Vec3(0.001, 0.002, 0.001);
  return compared;
}

const report::Table& axes(const report::Page& page) {
  return std::get<report::Table>(page.sections.front().blocks.front());
}

TEST(ToolComparisonPage, EachAxisStandsBesideItsTolerance) {
  const ComparedTools compared = made(0.0127);
  const report::Page page = tool_comparison_page(compared, compared_errors(compared), {});
  EXPECT_THAT(page.subtitle, ::testing::HasSubstr("failed"));
  ASSERT_EQ(axes(page).rows.size(), 6U);
  for (std::size_t row = 0; row < 6; ++row) EXPECT_EQ(axes(page).rows[row].cells.back().text, row == 4 ? "NO" : "yes");
  EXPECT_EQ(axes(page).rows[4].cells[1].text, "12.7") << "mNm about y";
  EXPECT_THAT(page.headlines[1].note, ::testing::HasSubstr("1 JND as a vector, at row 7778"));
}

// One sample of ten thousand is off, and a screen has no room for all of them.
TEST(ToolComparisonPage, NoPeakIsLeftOutOfAPlot) {
  const ComparedTools compared = made(0.0127);
  const report::Page page = tool_comparison_page(compared, compared_errors(compared), {});
  const auto& torque = std::get<report::LinePlot>(page.sections[1].blocks[1]);
  ASSERT_LT(torque.lines[0].y.size(), 5001U);
  EXPECT_NEAR(*std::ranges::max_element(torque.lines[0].y), 1.0, 1e-9);
}

TEST(ToolComparisonPage, WhatIsNotANumberDoesNotPass) {
  const ComparedTools compared = made(std::numeric_limits<double>::quiet_NaN());
  const tool::ToolComparison errors = compared_errors(compared);
  EXPECT_TRUE(std::isnan(errors.max_torque_error_jnd));
  EXPECT_FALSE(tool::within(errors, Vec3::Constant(1e9), Vec3::Constant(1e9)));
  EXPECT_EQ(axes(tool_comparison_page(compared, errors, {})).rows[4].cells.back().text, "NO");
}

TEST(ToolComparisonPage, PoseOfTheProxyIsSaidAsItIsFelt) {
  ComparedTools compared = made(0.0);
  recording::InTrajectory proxy;
  proxy.motion = compared.expected.motion;
  compared.expected_proxy = compared.obtained_proxy = proxy;
  compared.obtained_proxy->motion.p_W_m[5] = Vec3(0.4e-3, 0, 0);
  compared.coupling = {1000.0, 2.0};
  const report::Page page = tool_comparison_page(compared, compared_errors(compared), {});
  ASSERT_EQ(page.headlines.size(), 4U);
  EXPECT_EQ(page.headlines[2].value, "0.4");
  // 0.4 N of 20 % of 2 N.
  EXPECT_THAT(page.headlines[2].note, ::testing::HasSubstr("1 JND of force"));
}

}  // namespace
}  // namespace touchstone::tool_reports
