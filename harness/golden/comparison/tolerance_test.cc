#include "harness/golden/comparison/tolerance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "harness/base/error.h"

namespace touchstone::golden {
namespace {

Tolerance parse(const char* text) {
  const auto document = parse_json(text, "t.json");
  return read_tolerance(JsonObject(document, "t.json", ""), default_tolerance());
}

std::string message(const char* text) {
  try {
    parse(text);
  } catch (const BadData& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Tolerance, DefaultsAreThoseThatOutsideProgramsRelyOn) {
  const auto tolerance = default_tolerance();
  EXPECT_EQ(tolerance.of("force").atol, 1e-6);
  EXPECT_EQ(tolerance.of("force").rtol, 1e-6);
  EXPECT_EQ(tolerance.of("position").atol, 1e-7);
  EXPECT_EQ(tolerance.of("contact_position").atol, 1e-7);
}

TEST(Tolerance, WhatIsNotGivenKeepsItsDefault) {
  const auto tolerance =
      parse(R"({"reason": "r", "force": {"atol_N": 0.5, "beyond": 2}, "contact": {"tube_s": 0.002}})");
  EXPECT_EQ(tolerance.of("force").atol, 0.5);
  EXPECT_EQ(tolerance.of("force").rtol, 1e-6);
  EXPECT_EQ(tolerance.of("force").beyond, 2U);
  EXPECT_EQ(tolerance.of("position").atol, 1e-7);
  EXPECT_EQ(tolerance.tube_s, 0.002);
}

TEST(Tolerance, WrittenAndReadBackIsTheSame) {
  const auto tolerance =
      parse(R"({"reason": "why", "force": {"atol_N": 0.5, "rpeak": 0.01, "rms_N": 1, "direction_rad": 0.1,
                                   "direction_floor_N": 0.2}, "contact": {"tube_s": 0.002, "beyond": 3}})");
  const auto document = to_json(tolerance);
  auto object = JsonObject(document, "t.json", "");
  object.schema("touchstone-tolerance/1");
  EXPECT_EQ(to_json(read_tolerance(object, default_tolerance())), document);
}

TEST(Tolerance, BadValuesAreRefusedWithTheirPlace) {
  using testing::HasSubstr;
  EXPECT_THAT(message(R"({"force": {"atol_N": -1}})"), HasSubstr("/force/atol_N"));
  EXPECT_THAT(message(R"({"force": {"atol_mN": 1}})"), HasSubstr("atol_mN"));
  EXPECT_THAT(message(R"({"force": {"beyond": 1.5}})"), HasSubstr("whole number"));
  EXPECT_THAT(message(R"({"force": {"rms_N": "big"}})"), HasSubstr("/force/rms_N"));
  EXPECT_THAT(message(R"({"forces": {}})"), HasSubstr("forces"));
  EXPECT_THAT(message(R"({"force": {"direction_rad": 0.1}})"), HasSubstr("direction_floor_N"));
  EXPECT_THAT(message(R"({"force": {"atol_N": 1e999}})"), HasSubstr("1e999"));
}

}  // namespace
}  // namespace touchstone::golden
