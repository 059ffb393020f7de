#include "harness/pipeline/discrepancy/earlier_run.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/input_files.h"
#include "harness/testing/temporary_folder.h"

namespace touchstone::pipeline {
namespace {

constexpr const char* two_pieces = R"({"schema": "touchstone-findings/1",
  "empirical_law": {"pieces": [{"file": "law-1.json"}, {"file": "law-2.json"}, {"file": "../apart.json"}, {}]},
  "next_experiment": {"trajectory": "next.csv"}, "suggested_instrument": "suggested-instrument.json"})";

TEST(EarlierRun, WhatItsFindingsNameGoesAndNothingElse) {
  const testing::TemporaryFolder folder;
  const auto found = folder.path() / "found";
  ensure_writable_folder(found);
  for (const char* name : {"law-1.json", "law-2.json", "law-3.json", "empirical.json", "next.csv",
                           "suggested-instrument.json", "notes.txt"})
    write_file(found / name, "{}");
  write_file(folder.path() / "apart.json", "{}");
  EarlierRun(found).remove();
  EXPECT_TRUE(std::filesystem::exists(found / "law-1.json"));  // no findings: nobody's
  write_file(found / "findings.json", two_pieces);
  EarlierRun(found).remove();
  for (const char* name : {"law-1.json", "law-2.json", "empirical.json", "next.csv", "suggested-instrument.json"})
    EXPECT_FALSE(std::filesystem::exists(found / name)) << name;
  for (const char* name : {"law-3.json", "notes.txt", "findings.json"})
    EXPECT_TRUE(std::filesystem::exists(found / name)) << name;
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "apart.json"));
  EarlierRun(found).remove();  // once more: gone is gone
}

TEST(EarlierRun, FindingsThatCannotBeReadNameNothing) {
  const testing::TemporaryFolder folder;
  write_file(folder.path() / "law-1.json", "{}");
  for (const char* text : {"", "{", "[]", "{\"schema\": 1}", "{\"schema\": \"touchstone-findings/1\"}",
                           "{\"schema\": \"touchstone-findings/1\", \"empirical_law\": 3}"}) {
    write_file(folder.path() / "findings.json", text);
    EarlierRun(folder.path()).remove();
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "law-1.json")) << text;
  }
}

TEST(EarlierRun, AnInputOfThisRunIsRefusedBeforeTheLongWork) {
  const testing::TemporaryFolder folder;
  write_file(folder.path() / "findings.json", two_pieces);
  write_file(folder.path() / "law-2.json", "{}");
  forget_input_files();
  protect_input_files();
  note_input_file(folder.path() / "law-2.json");
  EXPECT_THROW(EarlierRun{folder.path()}, UsageError);
  forget_input_files();
}

}  // namespace
}  // namespace touchstone::pipeline
