#include "harness/discrepancy/model_edit.h"

#include <gtest/gtest.h>

#include "harness/discrepancy/catalogue_for_test.h"

namespace touchstone::discrepancy {
using rendering::Model;

namespace {

TEST(ShorterPaths, AreOfEveryFrictionAndLeaveTheRest) {
  Model model;
  model.parameters["stiffness_N_per_m"] = 700.0;
  EXPECT_FALSE(has_path(model));
  EXPECT_TRUE(with_shorter_paths(model).empty());
  model.effects.push_back({"normal-damping", {{"coefficient_N_s_per_m", 2.0}}, ""});
  EXPECT_FALSE(has_path(model));
  model.effects.push_back({"coulomb-friction", {{"mu_static", 0.4}, {"mu_dynamic", 0.4}, {"presliding_m", 2e-4}}, ""});
  ASSERT_TRUE(has_path(model));
  const auto shorter = with_shorter_paths(model);
  ASSERT_EQ(shorter.size(), 2u);
  double before_m = 2e-4;
  for (const Model& one : shorter) {
    const double path_m = one.effects[1].parameters.at("presliding_m");
    EXPECT_LT(path_m, 0.5 * before_m);
    EXPECT_GT(path_m, 0.0);
    before_m = path_m;
    EXPECT_EQ(one.effects[1].parameters.at("mu_dynamic"), 0.4);
    EXPECT_EQ(one.effects[0].parameters, model.effects[0].parameters);
    EXPECT_EQ(one.parameters, model.parameters);
  }
}

TEST(ShorterPaths, SoAreWindowsOfAccelerations) {
  Model model;
  model.instrument.push_back({"tool-inertia", {{"mass_kg", 0.2}, {"window_s", 0.2}}, ""});
  const auto shorter = with_shorter_paths(model);
  ASSERT_EQ(shorter.size(), 2u);
  EXPECT_DOUBLE_EQ(shorter[0].instrument[0].parameters.at("window_s"), 0.12);
  EXPECT_DOUBLE_EQ(shorter[1].instrument[0].parameters.at("window_s"), 0.08);
  EXPECT_EQ(shorter[0].instrument[0].parameters.at("mass_kg"), 0.2);
  EXPECT_FALSE(has_path(model));  // of dry friction, whose bars are others
}

TEST(Kinds, DampingIsALimitOfRelaxationAndNotTheOtherWay) {
  const auto catalogue = whole_catalogue();
  const EffectLibrary library(catalogue);
  EXPECT_TRUE(library.contains("stress-relaxation", "normal-damping"));
  EXPECT_FALSE(library.contains("normal-damping", "stress-relaxation"));
}

}  // namespace
}  // namespace touchstone::discrepancy
