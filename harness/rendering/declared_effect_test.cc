#include "harness/rendering/declared_effect.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>

#include "harness/base/error.h"
#include "harness/rendering/formula.h"
#include "harness/rendering/model.h"
#include "harness/rendering/unit_dimension.h"
#include "harness/testing/error_message.h"

namespace touchstone::rendering {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using touchstone::testing::message_of;

constexpr const char* drag_effect = R"({"schema": "touchstone-effect/1", "name": "quadratic-drag",
 "summary": "drag that grows with the square of the speed", "source": "Newton 1687", "acts_on": "friction",
 "contains": ["viscous-friction"],
 "parameters": {"c": {"unit": "N s^2/m^2", "minimum": 0, "maximum": 1e4, "start": [0.5, 5], "meaning": "drag"}},
 "formula": {"along_N": "-c * speed_m_per_s^2"}})";

constexpr const char* hysteresis = R"({"schema": "touchstone-effect/1", "name": "dahl",
 "summary": "a bristle", "source": "Dahl 1968", "acts_on": "friction",
 "parameters": {"mu": {"unit": "1", "minimum": 0, "maximum": 5, "start": 0.2},
                "s": {"unit": "m", "minimum": 1e-6, "maximum": 1, "start": 1e-3}},
 "states": {"z": {"unit": "m", "start": 0, "rate": "vx_m_per_s - abs(vx_m_per_s) * z / s"}},
 "formula": {"x_N": "-mu * normal_N * z / s"}})";

// The drag's file with one piece of text in the place of another one.
std::string with(const std::string& old_text, const std::string& new_text) {
  std::string text = drag_effect;
  const std::size_t at = text.find(old_text);
  EXPECT_NE(at, std::string::npos) << old_text;
  return text.replace(at, old_text.size(), new_text);
}

std::string refusal(const std::string& old_text, const std::string& new_text) {
  return message_of([&] { (void)parse_effect(with(old_text, new_text), "drag.json"); });
}

TEST(Formula, IsEvaluatedAtTheVariablesOfNow) {
  double a = 2.0;
  double b = 0.0;
  const Formula formula("a^2 + sin(pi * b)", {{"a", &a}, {"b", &b}, {"c", &b}}, "f");
  EXPECT_DOUBLE_EQ(formula.value(), 4.0);
  a = 3.0;
  b = 0.5;
  EXPECT_DOUBLE_EQ(formula.value(), 10.0);
  EXPECT_THAT(formula.used(), ElementsAre("a", "b"));
}

TEST(Formula, ErrorsNameThePosition) {
  double depth = 1.0;
  const auto refused = [&](const std::string& text) {
    return message_of([&] { (void)Formula(text, {{"depth_m", &depth}}, "f.json: /formula/x"); });
  };
  EXPECT_THAT(refused("2 * dept_m"),
              AllOf(HasSubstr("f.json: /formula/x"), HasSubstr("position 5"), HasSubstr("did you mean \"depth_m\"")));
  EXPECT_THAT(refused("2 + * depth_m"), HasSubstr("position 5: Unexpected operator \"*\""));
  EXPECT_THAT(refused("(depth_m"), HasSubstr("position 9"));
  EXPECT_THAT(refused("depth_m = 3"), HasSubstr("position 9: a formula assigns nothing"));
  EXPECT_THAT(refused("1, depth_m"), HasSubstr("one value was expected, got 2"));
  EXPECT_THAT(refused("  "), HasSubstr("empty"));
  EXPECT_EQ(refused("depth_m >= 1 ? 1 : 0"), "no error");
}

TEST(UnitDimension, CountsPowers) {
  EXPECT_EQ(dimension_of("N s^2/m^2"), (UnitDimension{{-2, 2, 1}}));
  EXPECT_EQ(dimension_of("N/m/s"), (UnitDimension{{-1, -1, 1}}));
  EXPECT_EQ(dimension_of("kg m/s^2"), dimension_of("N"));
  EXPECT_EQ(dimension_of("1/m"), (UnitDimension{{-1, 0, 0}}));
  EXPECT_EQ(dimension_of("Pa*m^2"), dimension_of("N"));
  for (const char* const unknown : {"", "mm", "N^", "m^x", "/", "newton"})
    EXPECT_FALSE(dimension_of(unknown)) << unknown;
}

TEST(DeclaredEffect, ReadsWhatTheFileSays) {
  const DeclaredEffect effect = parse_effect(drag_effect, "drag.json");
  EXPECT_EQ(effect.name, "quadratic-drag");
  EXPECT_EQ(effect.acts_on, ActsOn::friction);
  ASSERT_EQ(effect.parameters.size(), 1U);
  EXPECT_EQ(effect.parameters[0].unit, "N s^2/m^2");
  EXPECT_EQ(effect.parameters[0].initial, 0.5);
  EXPECT_THAT(effect.starts[0], ElementsAre(0.5, 5.0));
  EXPECT_THAT(effect.traits.contains, ElementsAre("viscous-friction"));
  EXPECT_TRUE(effect.traits.follows_speed);
  EXPECT_FALSE(effect.traits.along_surface);
  EXPECT_FALSE(effect.is_instrument());
}

TEST(DeclaredEffect, WritesWhatItReadsBack) {
  for (const char* const text : {drag_effect, hysteresis}) {
    const DeclaredEffect effect = parse_effect(text, "a.json");
    const DeclaredEffect again = parse_effect(effect_to_json(effect), "b.json");
    EXPECT_EQ(effect_to_json(again), effect_to_json(effect));
  }
}

TEST(DeclaredEffect, RefusesWithFileKeyAndPosition) {
  EXPECT_THAT(refusal("speed_m_per_s^2", "sped_m_per_s^2"),
              AllOf(HasSubstr("drag.json: /formula/along_N"), HasSubstr("position 6"), HasSubstr("speed_m_per_s")));
  EXPECT_THAT(refusal("\"friction\"", "\"sliding\""), AllOf(HasSubstr("/acts_on"), HasSubstr("normal-force")));
  EXPECT_THAT(refusal("along_N", "normal_N"), AllOf(HasSubstr("/formula/normal_N"), HasSubstr("along_N, x_N")));
  EXPECT_THAT(refusal("N s^2/m^2", "mm"), AllOf(HasSubstr("/parameters/c/unit"), HasSubstr("SI")));
  EXPECT_THAT(refusal("\"maximum\": 1e4", "\"maximum\": -1"), HasSubstr("/parameters/c/maximum"));
  EXPECT_THAT(refusal("[0.5, 5]", "[0.5, 5e5]"), AllOf(HasSubstr("/parameters/c/start"), HasSubstr("500000")));
  EXPECT_THAT(refusal("[0.5, 5]", "[]"), HasSubstr("/parameters/c/start"));
  EXPECT_THAT(refusal("\"c\": {", "\"depth_m\": {"), AllOf(HasSubstr("/parameters/depth_m"), HasSubstr("already")));
  EXPECT_THAT(refusal("\"quadratic-drag\"", "\"Quadratic drag\""), HasSubstr("/name"));
  EXPECT_THAT(refusal("-c *", "-"), HasSubstr("/formula/along_N"));
  EXPECT_THAT(refusal("\"meaning\"", "\"meening\""), AllOf(HasSubstr("/parameters/c"), HasSubstr("meening")));
  EXPECT_THAT(refusal("[\"viscous-friction\"]", "\"viscous-friction\""), HasSubstr("/contains"));
}

TEST(DeclaredEffect, RefusesFormulasThatHideAUnit) {
  EXPECT_THAT(refusal("-c * speed_m_per_s^2", "-c * speed_m_per_s"),
              AllOf(HasSubstr("/formula/along_N"), HasSubstr("not a quantity in N"), HasSubstr("unit of length")));
  // 0.01 is a length that only a parameter can declare.
  EXPECT_THAT(refusal("-c * speed_m_per_s^2", "-c * speed_m_per_s^2 * exp(-depth_m / 0.01)"),
              HasSubstr("unit of length"));
  EXPECT_THAT(refusal("-c * speed_m_per_s^2", "-c * speed_m_per_s^2 * sin(t_s)"), HasSubstr("unit of time"));
  EXPECT_THAT(refusal("-c * speed_m_per_s^2", "-c * speed_m_per_s^2 - 1"), HasSubstr("unit of"));
  // Nowhere a number: what its unit is cannot be seen.
  EXPECT_THAT(refusal("-c * speed_m_per_s^2", "-c * speed_m_per_s^2 + sqrt(-1 - depth_m^2)"),
              HasSubstr("is a number nowhere"));
  EXPECT_EQ(refusal("-c * speed_m_per_s^2", "-c * speed_m_per_s * abs(speed_m_per_s) * (depth_m > 0 ? 1 : 0)"),
            "no error");
}

TEST(DeclaredEffect, HoldsTheRatesOfStatesAgainstTheirUnits) {
  std::string text = hysteresis;
  text.replace(text.find("vx_m_per_s - abs"), 10, "x_m       ");
  EXPECT_THAT(message_of([&] { (void)parse_effect(text, "dahl.json"); }),
              AllOf(HasSubstr("dahl.json: /states/z/rate"), HasSubstr("m per second")));
}

TEST(DeclaredEffect, AModelNamesItsFileOrHoldsItsText) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "declared_effect";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "drag.json") << drag_effect;
  std::ofstream(folder / "model.json") << R"({"schema": "touchstone-model/1", "renderer": "god-object",
    "parameters": {"stiffness_N_per_m": 500},
    "effects": [{"name": "quadratic-drag", "law": "drag.json", "parameters": {"c": 3}}]})";
  const Model model = load_model(folder / "model.json");
  ASSERT_NE(model.effects[0].law, nullptr);
  const Model again = parse_model(model_to_json(model), "elsewhere/model.json");
  ASSERT_NE(again.effects[0].law, nullptr);
  EXPECT_EQ(effect_to_json(*again.effects[0].law), effect_to_json(*model.effects[0].law));
  EXPECT_EQ(model_to_json(again), model_to_json(model));
}

TEST(DeclaredEffect, AModelRefusesALawOfAnotherNameOrSide) {
  const auto refused = [](const std::string& list, const std::string& name) {
    return message_of([&] {
      (void)parse_model(R"({"schema": "touchstone-model/1", "renderer": "god-object", ")" + list + R"(": [{"name": ")" +
                            name + R"(", "law": )" + drag_effect + "}]}",
                        "m.json");
    });
  };
  EXPECT_EQ(refused("effects", "quadratic-drag"), "no error");
  EXPECT_THAT(refused("effects", "drag"), AllOf(HasSubstr("m.json: /effects/0/law"), HasSubstr("quadratic-drag")));
  EXPECT_THAT(refused("instrument", "quadratic-drag"), AllOf(HasSubstr("/instrument/0/law"), HasSubstr("effects")));
}

}  // namespace
}  // namespace touchstone::rendering
