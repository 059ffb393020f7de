// Sweeps of renderers of tools: what a specification says is what runs, rows hold the errors, and do not depend on how
// the cases were shared.
#include "tool_sweep.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"

namespace touchstone::tool {
using runs::CaseRow;
using runs::SweepDesign;

namespace {

using nlohmann::json;

class SweepOfTools : public ::testing::Test {
 protected:
  SweepOfTools() { std::filesystem::create_directories(folder_); }
  ~SweepOfTools() override { std::filesystem::remove_all(folder_); }

  static json grid() {
    return json::parse(R"({"schema": "touchstone-tool-sweep/1", "design": "grid",
      "contacts": {"corner": {"case": "box-corner"}, "edge": {"case": "box-edge"}},
      "renderers": {"god": {"renderer": "god-object-tool"},
                    "springs": {"renderer": "penalty-coupling", "parameters": {"contact_stiffness_N_per_m": 20000}}},
      "vary": [{"set": "/renderer/stiffness_N_per_m", "values": [500, 1000]}]})");
  }
  std::filesystem::path write(const json& spec) const {
    write_file(folder_ / "spec.json", spec.dump());
    return folder_ / "spec.json";
  }
  static std::vector<CaseRow> rows(const SweepDesign& design, unsigned threads) {
    runs::CaseStore store(runs::CaseStore::in_memory, tool_sweep_table(design));
    const std::atomic<bool> never = false;
    run_cases(tool_sweep_job(design), store, {}, threads, never);
    return store.rows(0, design.size());
  }

 private:
  std::filesystem::path folder_ = std::filesystem::path(::testing::TempDir()) / "tool-sweep";
};

TEST_F(SweepOfTools, RowsHoldTheErrorsOfEachCase) {
  const SweepDesign design(write(grid()), tool_sweep_parts());
  ASSERT_EQ(design.size(), 8U);
  const std::vector<CaseRow> all = rows(design, 1);
  ASSERT_EQ(all.size(), 8U);
  std::size_t exact = 0;
  for (const CaseRow& row : all) {
    EXPECT_EQ(row.error, "");
    // contacts, renderer, document, stiffness, then the errors of force (mean, largest) and torque, and JND.
    if (runs::as_text(row.values.at(1)) == "god") {
      EXPECT_LE(runs::as_number(row.values.at(5)), 1e-9);
      EXPECT_LE(runs::as_number(row.values.at(7)), 1e-9);
      ++exact;
    } else {
      EXPECT_GT(runs::as_number(row.values.at(5)), 1e-6) << "springs give way";
      EXPECT_LT(runs::as_number(row.values.at(5)), 0.3);
    }
    // The largest right force follows the coupling: the hand presses by up to 3 mm.
    EXPECT_LE(runs::as_number(row.values.at(10)), 3.01e-3 * runs::as_number(row.values.at(3)));
  }
  EXPECT_EQ(exact, 4U);
  const std::vector<CaseRow> again = rows(design, 2);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(again[i].values, all[i].values);
}

TEST_F(SweepOfTools, SizeAndClearanceOfAContactCanVary) {
  json spec = grid();
  spec["contacts"] = json::parse(R"({"peg": {"case": "peg", "clearance_m": 1e-4}})");
  spec["renderers"].erase("springs");
  spec["vary"] = json::parse(R"([{"set": "/contacts/scale", "values": [1, 2]},
                                 {"set": "/contacts/clearance_m", "values": [1e-4, 5e-4]}])");
  const std::vector<CaseRow> all = rows(SweepDesign(write(spec), tool_sweep_parts()), 2);
  ASSERT_EQ(all.size(), 4U);
  std::set<double> forces;
  for (const CaseRow& row : all) {
    EXPECT_EQ(row.error, "");
    EXPECT_LE(runs::as_number(row.values.at(6)), 1e-9);
    forces.insert(runs::as_number(row.values.at(11)));
  }
  EXPECT_EQ(forces.size(), 4U) << "each is another contact";
}

TEST_F(SweepOfTools, ACaseThatCannotBeRunIsARowWithItsError) {
  json spec = grid();
  spec["contacts"]["edge"]["case"] = "teapot";
  spec["vary"] = json::array();
  spec["renderers"].erase("god");
  const std::vector<CaseRow> all = rows(SweepDesign(write(spec), tool_sweep_parts()), 1);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].error, "");
  EXPECT_THAT(all[1].error, ::testing::HasSubstr("teapot"));
}

TEST_F(SweepOfTools, WhatIsNoPartOfACaseIsRefused) {
  const auto message = [&](const json& spec) -> std::string {
    try {
      const SweepDesign design(write(spec), tool_sweep_parts());
    } catch (const BadData& error) {
      return error.what();
    }
    return "";
  };
  json spec = grid();
  spec["vary"][0]["set"] = "/scale";
  EXPECT_THAT(message(spec), ::testing::HasSubstr("/renderer/..."));
  spec = grid();
  spec["seeds"] = {1, 2};
  EXPECT_THAT(message(spec), ::testing::HasSubstr("seeds"));
  spec = grid();
  spec["surfaces"] = json::object();
  EXPECT_THAT(message(spec), ::testing::HasSubstr("surfaces"));
}

}  // namespace
}  // namespace touchstone::tool
