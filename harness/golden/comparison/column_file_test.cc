#include "harness/golden/comparison/column_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/golden/comparison/comparison_report.h"

namespace touchstone::golden {
namespace {

namespace fs = std::filesystem;

class ColumnFile : public testing::Test {
 protected:
  fs::path folder = fs::path(testing::TempDir()) /
                    (std::string("columns_") + testing::UnitTest::GetInstance()->current_test_info()->name());
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }
  // The verdict of comparing two CSV texts; "bad data" where one cannot be read.
  std::string verdict(const std::string& expected, const std::string& obtained) {
    write_file(folder / "e.csv", expected);
    write_file(folder / "o.csv", obtained);
    try {
      const auto [e, o] = load_columns(folder / "e.csv", folder / "o.csv");
      return std::string(to_string(compare(e, o, default_tolerance()).verdict));
    } catch (const BadData& error) {
      last_error = error.what();
      return "bad data";
    }
  }
  std::string last_error;
};

constexpr const char* golden =
    "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N\n0,0,0,0,0,0,0\n0.001,0.002,0,0,0,0,1.5\n0.002,0.004,0,0,0,0,1.25\n";

TEST_F(ColumnFile, OtherUnitsAreConverted) {
  EXPECT_EQ(
      verdict(golden, "t_ms,x_mm,y_mm,z_mm,fx_mN,fy_mN,fz_mN\n0,0,0,0,0,0,0\n1,2,0,0,0,0,1500\n2,4,0,0,0,0,1250\n"),
      "equal");
}

TEST_F(ColumnFile, OrderOfColumnsDoesNotMatter) {
  EXPECT_EQ(
      verdict(golden,
              "fz_N,t_s,x_m,y_m,z_m,fx_N,fy_N\n0,0,0,0,0,0,0\n1.5,0.001,0.002,0,0,0,0\n1.25,0.002,0.004,0,0,0,0\n"),
      "equal");
}

TEST_F(ColumnFile, AUnitThatOnlyTheHeaderChangesFails) {
  std::string obtained = golden;
  obtained.replace(obtained.find("fz_N"), 4, "fz_mN");
  EXPECT_EQ(verdict(golden, obtained), "worse");
}

TEST_F(ColumnFile, WhatIsNotKnownIsNamed) {
  std::string obtained = golden;
  obtained.replace(obtained.find("fz_N"), 4, "fz_lb");
  EXPECT_EQ(verdict(golden, obtained), "bad data");
  EXPECT_THAT(last_error, testing::HasSubstr("fz_lb"));
  obtained = golden;
  obtained.replace(obtained.find("fz_N"), 4, "force_N");
  EXPECT_EQ(verdict(golden, obtained), "bad data");
  EXPECT_THAT(last_error, testing::HasSubstr("force_N"));
}

TEST_F(ColumnFile, ALackingColumnIsMissingWhicheverSideLacksIt) {
  const std::string without = "t_s,x_m,y_m,z_m,fx_N,fy_N\n0,0,0,0,0,0\n0.001,0.002,0,0,0,0\n0.002,0.004,0,0,0,0\n";
  EXPECT_EQ(verdict(golden, without), "missing");
  EXPECT_EQ(verdict(without, golden), "missing");
}

TEST_F(ColumnFile, NotANumberNeverPasses) {
  for (const char* const text : {"nan", "NaN", "-nan", "inf", "1e999", "", "#"}) {
    std::string bad = golden;
    bad.replace(bad.find("1.25"), 4, text);
    EXPECT_THAT(verdict(golden, bad), testing::AnyOf("invalid", "bad data")) << text;
    EXPECT_THAT(verdict(bad, golden), testing::AnyOf("invalid", "bad data")) << text;
    EXPECT_THAT(verdict(bad, bad), testing::AnyOf("invalid", "bad data")) << text;
  }
}

TEST_F(ColumnFile, AHeaderAloneNorNothingPasses) {
  const std::string header = "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N\n";
  EXPECT_NE(verdict(header, header), "equal");
  EXPECT_NE(verdict("", ""), "equal");
  EXPECT_THROW(load_columns(folder / "absent.csv", folder / "absent.csv"), BadData);
}

TEST_F(ColumnFile, ARepeatedColumnIsInvalid) {
  const std::string twice = "t_s,fx_N,fx_mN\n0,1,1000\n1,1,1000\n";
  EXPECT_THAT(verdict(twice, twice), testing::AnyOf("invalid", "bad data"));
}

}  // namespace
}  // namespace touchstone::golden
