#include "harness/perception/judge/thresholds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"

namespace touchstone::perception {
namespace {

using ::testing::HasSubstr;

class ThresholdFile : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] Thresholds read(const std::string& text) const {
    write_file(folder_ / "thresholds.json", text);
    return read_thresholds(folder_ / "thresholds.json");
  }
  [[nodiscard]] std::string refusal(const std::string& text) const {
    try {
      static_cast<void>(read(text));
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
  std::filesystem::path folder_ =
      std::filesystem::path(::testing::TempDir()) / ::testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(ThresholdFile, ReplacesAnyConstantAndGivesBackWhatItWrites) {
  auto changed = read(R"({"schema": "touchstone-thresholds/1", "stiffness_fraction": 0.15})");
  EXPECT_EQ(changed.stiffness_fraction, 0.15);
  EXPECT_EQ(changed.direction_rad, Thresholds{}.direction_rad);
  double value = 0.011;
  for (const auto& entry : threshold_entries()) {
    EXPECT_FALSE(entry.source.empty()) << entry.name;
    entry.place(changed) = value;
    value *= 1.1;
  }
  auto again = read(thresholds_to_json(changed));
  for (const auto& entry : threshold_entries()) EXPECT_EQ(entry.place(again), entry.place(changed)) << entry.name;
  for (const double f : {20.0, 100.0, 1000.0})
    EXPECT_NEAR(again.vibration_force_N(f) / changed.vibration_force_N(f), 1.0, 1e-12) << f;
}

// The numbers that were read in a text are held against that text, typed here once more; all others must say that they
// were not checked.
TEST(Thresholds, EachSaysWhetherItsSourceWasReadAndThoseReadAgree) {
  const std::map<std::string, double> read{
      {"force_absolute_N", 0.06},
      {"force_breakpoint_N", 2.5},
      {"force_fraction_below", 0.20},
      {"force_fraction_above", 0.07},
      {"stiffness_fraction", 0.22},
      {"delay_s", 0.036},
      {"direction_rad", 25.6 / 180.0 * std::numbers::pi},
      {"friction_fraction", 0.2},
      {"position_m", 0.6 / 180.0 * std::numbers::pi * 0.3},
      {"vibration_fraction", 0.20},
      {"frequency_fraction", std::sqrt(0.25 * 0.18)},
      {"depth_fraction", std::sqrt(std::pow(std::log(1.22), 2) - std::pow(std::log(1.07), 2))},
  };
  Thresholds thresholds;
  for (const auto& entry : threshold_entries()) {
    const auto found = read.find(std::string(entry.name));
    EXPECT_EQ(entry.read_in.empty(), found == read.end()) << entry.name;
    EXPECT_THAT(source_of(entry), HasSubstr(entry.read_in.empty() ? "not checked" : "read in: ")) << entry.name;
    if (found != read.end()) {
      EXPECT_NEAR(entry.place(thresholds), found->second, 2e-4) << entry.name;
    }
    EXPECT_THAT(source_of(entry), HasSubstr("procedure: ")) << entry.name;
    EXPECT_THAT(thresholds_to_json(thresholds), HasSubstr(source_of(entry)));
  }
}

TEST_F(ThresholdFile, RefusesWhatItDoesNotUnderstandWithItsPlace) {
  EXPECT_THAT(refusal(R"({"schema": "touchstone-thresholds/1", "stifness_fraction": 0.15})"),
              HasSubstr("stifness_fraction"));
  EXPECT_THAT(refusal(R"({"schema": "touchstone-thresholds/1", "position_m": 0})"),
              HasSubstr("a value above 0 was expected"));
  EXPECT_EQ(read(R"({"schema": "touchstone-thresholds/1", "depth_fraction": 0})").depth_fraction, 0.0);
  EXPECT_THAT(refusal(R"({"schema": "touchstone-thresholds/1", "depth_fraction": -0.1})"),
              HasSubstr("a value above 0 was expected"));
  EXPECT_THAT(refusal(R"({"schema": "touchstone-thresholds/1",
                          "vibration_threshold": {"frequency_Hz": [100, 20], "amplitude_N": [1, 1]}})"),
              HasSubstr("ascending"));
  EXPECT_THAT(refusal(R"({"schema": "touchstone-thresholds/1",
                          "vibration_threshold": {"frequency_Hz": [100], "amplitude_N": [1, 1]}})"),
              HasSubstr("at least two frequencies"));
}

TEST(Thresholds, VibrationIsFeltBestNear250HzAsInTheSourceOfTheCurve) {
  // 0.1 um at 250 Hz, 12 dB per octave on both sides of the best range (Bolanowski et al. 1988), flat below 40 Hz
  // (Verrillo 1963).
  EXPECT_DOUBLE_EQ(Thresholds::vibration_displacement_m(250.0), 1e-7);
  EXPECT_NEAR(Thresholds::vibration_displacement_m(125.0) / 1e-7, std::pow(10.0, 12.0412 / 20.0), 1e-4);
  EXPECT_NEAR(Thresholds::vibration_displacement_m(600.0) / 1e-7, std::pow(10.0, 12.0412 / 20.0), 1e-4);
  EXPECT_EQ(Thresholds::vibration_displacement_m(20.0), Thresholds::vibration_displacement_m(40.0));
  EXPECT_NEAR(Thresholds::vibration_displacement_m(40.0) / 1e-7, std::pow(250.0 / 40.0, 2), 1e-9);
  for (double f = 20.0; f <= 1000.0; f *= 1.1) EXPECT_GE(Thresholds::vibration_displacement_m(f), 1e-7) << f;
  // With a hand that is a damper alone, force is damping times speed.
  Thresholds damper;
  damper.hand_mass_kg = 1e-12;
  damper.hand_stiffness_N_per_m = 1e-9;
  damper.hand_damping_N_s_per_m = 2.0;
  EXPECT_NEAR(damper.vibration_force_N(250.0), 2.0 * 2.0 * std::numbers::pi * 250.0 * 1e-7, 1e-12);
}

TEST(Thresholds, OneJndIs76PercentOfRightAnswersAndNoneIsChance) {
  EXPECT_DOUBLE_EQ(forced_choice_probability(0.0), 0.5);
  EXPECT_NEAR(forced_choice_probability(1.0), 0.7602, 1e-4);  // Macmillan and Creelman 2005, table A5.2
  EXPECT_NEAR(forced_choice_probability(std::numbers::sqrt2 * 0.6744897501960817), 0.75, 1e-12);
}

}  // namespace
}  // namespace touchstone::perception
