#include "harness/recording/convert.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/recording/recording_file.h"

namespace touchstone::recording {
namespace {

std::filesystem::path temporary(const std::string& name) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "touchstone-convert";
  ensure_writable_folder(folder);
  return folder / name;
}

constexpr const char* rendered =
    "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N,px_m,py_m,pz_m,contact\n"
    "0,0.1,-2e-07,0,0,0,0.3333333333333333,0,0,0,1\n"
    "0.001,0.2,1e+30,0,0,0,1,0,0,0.1,0\n";

TEST(Convert, ThereAndBackGivesTheSameText) {
  write_file(temporary("a.csv"), rendered);
  const Conversion there = convert_recording(temporary("a.csv"), temporary("b.h5"));
  EXPECT_EQ(there.samples, 2U);
  EXPECT_TRUE(there.notes.empty());
  convert_recording(temporary("b.h5"), temporary("c.csv.gz"));
  convert_recording(temporary("c.csv.gz"), temporary("d.csv"));
  EXPECT_EQ(read_file(temporary("d.csv")), rendered);
  convert_recording(temporary("d.csv"), temporary("d.csv"), {.length = "mm"});
  EXPECT_THAT(read_file(temporary("d.csv")), ::testing::StartsWith("t_s,x_mm,y_mm,z_mm,fx_N,fy_N,fz_N,px_mm,py_mm,"
                                                                   "pz_mm,contact\n0,100,"));
}

TEST(Convert, WhatIsWrongLeavesTheTargetAsItWas) {
  write_file(temporary("bad.csv"), std::string(rendered) + "0,0,0,0,0,0,0,0,0,0,0\n");
  write_file(temporary("kept.csv"), "as it was");
  EXPECT_THROW(convert_recording(temporary("bad.csv"), temporary("kept.csv")), BadData);
  EXPECT_THROW(convert_recording(temporary("bad.csv"), temporary("kept.csv"), {.force = "lbf"}), UsageError);
  EXPECT_EQ(read_file(temporary("kept.csv")), "as it was");
}

}  // namespace
}  // namespace touchstone::recording
