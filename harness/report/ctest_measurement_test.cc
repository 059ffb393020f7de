#include "harness/report/ctest_measurement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "harness/base/atomic_file.h"
#include "harness/report/gnuplot.h"
#include "harness/testing/temporary_folder.h"

namespace touchstone::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(CtestMeasurement, NumbersKeepEveryBit) {
  EXPECT_EQ(measurement("force_rms_N", 0.1),
            "<CTestMeasurement type=\"numeric/double\" name=\"force_rms_N\">0.10000000000000001</CTestMeasurement>");
}

TEST(CtestMeasurement, WhatIsNotFiniteIsSaidAndNotSent) {
  for (const double value : std::vector<double>{std::nan(""), INFINITY, -INFINITY}) {
    EXPECT_THAT(measurement("m", value), Not(HasSubstr("CTestMeasurement")));
    EXPECT_THAT(measurement("m", value), HasSubstr("not sent"));
  }
}

TEST(CtestMeasurement, TextIsEscaped) {
  EXPECT_THAT(measurement("a<b", std::string_view("x & \"y\"\x01")),
              HasSubstr("name=\"a&lt;b\">x &amp; &quot;y&quot; </CTestMeasurement>"));
}

// Two levels, of which one is the lowest and the other the highest value: no line may hide under the frame.
TEST(CtestMeasurement, LevelsAtTheEdgesOfAPanelAreDrawn) {
  const touchstone::testing::TemporaryFolder own;
  const auto& folder = own.path();
  const Plot plot{
      "a step", "commit", {{"error", "N", {{"", {{0, 0.04}, {6, 0.04}, {7, 0.044}, {11, 0.044}}, false}}, {0.0, 0.0}}}};
  const auto problem = write_plot(plot, folder / "levels.png");
  if (problem.find("not installed") != std::string::npos) GTEST_SKIP() << problem;
  EXPECT_EQ(problem, "");
}

TEST(CtestMeasurement, PicturesAreReadBeforeTheyAreNamed) {
  const touchstone::testing::TemporaryFolder own;
  const auto& folder = own.path();
  const auto png = folder / "plot.png";
  const Plot plot{"it's a title",
                  "t [s]",
                  {{"force", "N", {{"golden", {{0.0, 0.0}, {1.0, 2.0}, {2.0, std::nan("")}}, false}}, {0.0, 0.0}}}};
  const auto problem = write_plot(plot, png);
  if (problem.find("not installed") != std::string::npos) GTEST_SKIP() << problem;
  ASSERT_EQ(problem, "");
  EXPECT_THAT(picture_measurement("TestImage", png), HasSubstr("image/png"));
  const auto whole = read_file(png);
  write_file(folder / "cut.png", whole.substr(0, whole.size() / 2));
  write_file(folder / "text.png", "not a picture");
  for (const char* const bad : {"cut.png", "text.png", "absent.png"}) {
    EXPECT_THAT(picture_measurement("TestImage", folder / bad), Not(HasSubstr("CTestMeasurementFile")));
  }
}

}  // namespace
}  // namespace touchstone::report
