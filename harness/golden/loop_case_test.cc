// Which figures of a loop are as good as the golden's, and that a golden keeps them to the bit.
#include "harness/golden/loop_case.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "harness/base/error.h"

namespace touchstone::golden {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const LoopFigures buzzing{"buzzes", 0.62, 100.0, 0.05, 3.0, 1e-3};
const LoopFigures stable{"stable", 2.8, 40.0, 1e-5, 0.1, 1e-5};

LoopFigures with(LoopFigures figures, double LoopFigures::*which, double value) {
  figures.*which = value;
  return figures;
}

TEST(LoopCase, ABuzzIsHeldByMarginBandAndStrength) {
  EXPECT_THAT(loop_differences(buzzing, buzzing), IsEmpty());
  for (const double better : {1.059, 1.0 / 1.059})
    EXPECT_THAT(loop_differences(buzzing, with(buzzing, &LoopFigures::stable_margin, 0.62 * better)), IsEmpty());
  for (const double wrong : {1.061 * 0.62, 0.62 / 1.061, 0.0, std::nan("")}) {
    EXPECT_THAT(loop_differences(buzzing, with(buzzing, &LoopFigures::stable_margin, wrong)),
                ElementsAre(HasSubstr("the stable margin is")));
  }
  EXPECT_THAT(loop_differences(buzzing, with(buzzing, &LoopFigures::buzz_Hz, 112.0)), IsEmpty());
  for (const double wrong_Hz : {113.0, 89.0, 0.0, std::nan("")}) {
    EXPECT_THAT(loop_differences(buzzing, with(buzzing, &LoopFigures::buzz_Hz, wrong_Hz)),
                ElementsAre(HasSubstr("another third of an octave")));
  }
  EXPECT_THAT(loop_differences(buzzing, with(buzzing, &LoopFigures::buzz_jnd, 3.9)), IsEmpty());
  for (const double wrong_jnd : {4.1, 1.9, std::nan("")}) {
    EXPECT_THAT(loop_differences(buzzing, with(buzzing, &LoopFigures::buzz_jnd, wrong_jnd)),
                ElementsAre(HasSubstr("a difference that is noticed")));
  }
}

TEST(LoopCase, WhatIsNotFeltOfAStableLoopIsNotCompared) {
  EXPECT_THAT(loop_differences(stable, with(stable, &LoopFigures::buzz_Hz, 500.0)), IsEmpty());
  LoopFigures other = stable;
  other.verdict = "unstable";
  EXPECT_THAT(loop_differences(stable, other), ElementsAre(HasSubstr("verdict is unstable, the golden's stable")));
  EXPECT_THAT(
      loop_differences(with(stable, &LoopFigures::stable_margin, 0.0), with(stable, &LoopFigures::stable_margin, 0.0)),
      IsEmpty());
}

TEST(LoopCase, AGoldenKeepsTheFiguresToTheBit) {
  Provenance kept;
  add_to(kept, with(buzzing, &LoopFigures::energy_J, 1.0 / 3.0));
  EXPECT_EQ(loop_figures_of(kept, "here").energy_J, 1.0 / 3.0);
  EXPECT_EQ(loop_figures_of(kept, "here").verdict, "buzzes");
  kept["loop_buzz_N"] = "much";
  EXPECT_THROW(loop_figures_of(kept, "here"), BadData);
  EXPECT_THROW(loop_figures_of({}, "here"), BadData);
}

}  // namespace
}  // namespace touchstone::golden
