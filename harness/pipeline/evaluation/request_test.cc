#include "harness/pipeline/evaluation/request.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "harness/base/error.h"
#include "harness/pipeline/evaluation/campaign.h"

namespace touchstone::pipeline {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(Thresholds, TheUnitSaysOfWhat) {
  EvaluationRequest request;
  apply_threshold("0.2 N", request);
  apply_threshold("0.25mm", request);
  EXPECT_EQ(request.force_threshold_N, 0.2);
  EXPECT_DOUBLE_EQ(request.position_threshold_m, 0.25e-3);
  EXPECT_DOUBLE_EQ(parse_force_N("50mN", "--contact-threshold"), 0.05);
}

TEST(Thresholds, WhatIsNoForceIsRefusedByName) {
  for (const char* const text : {"0.2", "N", "-1N", "nan N", "inf N"}) {
    EXPECT_THAT([&] { parse_force_N(text, "--threshold"); }, ThrowsMessage<UsageError>(HasSubstr("--threshold")))
        << text;
  }
  EXPECT_THAT([] { parse_force_N("1 mm", "--threshold"); }, ThrowsMessage<UsageError>(HasSubstr("unit of force")));
}

TEST(Planning, EachModelOnOneRecordingHasAFolderOfItsOwn) {
  EvaluationRequest base;
  base.recording = "press.csv";
  rendering::Model model;
  const auto both = plan_recording(base, {{model, "a/soft.json"}, {model, "hard.json"}});
  ASSERT_EQ(both.size(), 2U);
  EXPECT_EQ(both[0].folder, "soft");
  EXPECT_EQ(both[1].column, "hard");
  EXPECT_EQ(plan_recording(base, {{model, "soft.json"}})[0].folder, "") << "one alone stands in the folder itself";
  EXPECT_THAT(
      [&] {
        plan_recording(base, {{model, "a/soft.json"}, {model, "b/soft.json"}});
      },
      ThrowsMessage<UsageError>(HasSubstr("two models are named soft")));
}

}  // namespace
}  // namespace touchstone::pipeline
