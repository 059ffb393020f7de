#include "servo/setup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/testing/temporary_folder.h"

namespace touchstone::servo {
namespace {

using ::testing::HasSubstr;

TEST(DataSheet, EveryFigureOfEveryDeviceHasASourceOrAReasonWhyThereIsNone) {
  ASSERT_GE(device_names().size(), 10u);
  for (const std::string& name : device_names()) {
    const DataSheet sheet = find_device(name);
    for (const FigureEntry& entry : device_entries()) {
      EXPECT_NE(sheet.figures.contains(entry.name), sheet.not_published.contains(entry.name)) << name << entry.name;
    }
  }
  for (const std::string& name : grip_names()) {
    const DataSheet sheet = find_grip(name);
    for (const FigureEntry& entry : grip_entries()) {
      EXPECT_NE(sheet.figures.contains(entry.name), sheet.not_published.contains(entry.name)) << name << entry.name;
    }
  }
}

std::string refusal(const std::string& text) {
  const testing::TemporaryFolder folder;
  const auto file = folder.path() / "own.json";
  write_file(file, text);
  try {
    find_device(file.string());
  } catch (const BadData& error) {
    return error.what();
  }
  return "";
}

TEST(DataSheet, SaysWhatIsWrongAndWhere) {
  const std::string head = R"({"schema": "touchstone-device/1", "name": "mine", "figures": {)";
  EXPECT_THAT(refusal(head + R"("mass_kg": {"value": 0, "source": "weighed"}}})"), HasSubstr("/figures/mass_kg/value"));
  EXPECT_THAT(refusal(head + R"("mass_kg": {"value": 0.1}}})"), HasSubstr("source"));
  EXPECT_THAT(refusal(head + R"("mass_g": {"value": 100, "source": "weighed"}}})"), HasSubstr("mass_kg"));
  EXPECT_THAT(refusal(head + R"("latency_s": {"value": -1, "source": "x"}}})"), HasSubstr("0 or more"));
  EXPECT_THAT(refusal(R"({"schema": "touchstone-grip/1"})"), HasSubstr("touchstone-device/1"));
}

TEST(Setup, WhatIsSetComesBeforeWhatIsPublished) {
  const LoopSetup plain = make_setup("touch", "light", {}, 1);
  EXPECT_EQ(plain.parameters.resolution_m, 5.5e-5);
  EXPECT_EQ(plain.device_masses_kg, std::vector<double>{0.045});
  EXPECT_DOUBLE_EQ(plain.parameters.axis.mass_kg, 0.051);
  const LoopSetup own = make_setup("touch", "light", {{"resolution_m", 1e-6}, {"hand_mass_kg", 0.2}}, 1);
  EXPECT_EQ(own.parameters.resolution_m, 1e-6);
  EXPECT_DOUBLE_EQ(own.with_mass(0.1).axis.mass_kg, 0.3);
}

TEST(Setup, WithoutAMassSeveralAreTriedAndItIsSaid) {
  const LoopSetup setup = make_setup("omega.3", "light", {}, 1);
  EXPECT_GT(setup.device_masses_kg.size(), 3u);
  EXPECT_THAT(setup.assumed.front(), HasSubstr("mass_kg"));
  EXPECT_EQ(agreed({Verdict::stable, Verdict::stable}), Verdict::stable);
  EXPECT_EQ(agreed({Verdict::stable, Verdict::buzzes}), Verdict::cannot_tell);
}

TEST(Setup, NamesThatAreNotKnownAreSaidAndSoIsAGripWithoutFigures) {
  EXPECT_THROW(make_setup("omega.9", "light", {}, 1), UsageError);
  EXPECT_THROW(make_setup("touch", "light", {{"mas_kg", 1.0}}, 1), UsageError);
  EXPECT_THROW(make_setup("touch", "light", {{"mass_kg", std::nan("")}}, 1), UsageError);
  try {
    make_setup("touch", "normal", {}, 1);
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("--set hand_mass_kg="));
  }
}

}  // namespace
}  // namespace touchstone::servo
