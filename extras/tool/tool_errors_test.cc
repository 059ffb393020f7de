// Renderers against known wrenches: the right one has no error, one that is off by a known wrench has that one.
#include "tool_errors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "harness/base/error.h"
#include "harness/tool/faulty_tool.h"
#include "harness/tool/tool_checks.h"
#include "tool_metrics.h"
#include "tool_replay.h"

namespace touchstone::tool {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// Pushes up in proportion to the depth of the handle below z = 0, and turns about x; `off` is added to the force.
class Pusher : public ToolRenderer {
 public:
  explicit Pusher(Vec3 off = Vec3::Zero()) : off_(std::move(off)) {}

 protected:
  void do_reset() override {}
  ToolResult do_step(const ToolState& state, double) noexcept override {
    ToolResult result;
    const double depth_m = std::max(0.0, -state.handle.p_W_m.z());
    result.f_W_N = Vec3(0, 0, 1000.0 * depth_m) + off_;
    result.torque_W_Nm = Vec3(10.0 * depth_m, 0, 0);
    result.proxy = state.handle;
    return result;
  }

 private:
  Vec3 off_;
};

KnownContacts two_depths() {
  KnownContacts known;
  known.name = "pushes";
  known.free.p_W_m = Vec3(0, 0, 0.01);
  for (const double depth_m : {0.001, 0.003}) {
    Pose handle;
    handle.p_W_m = Vec3(0, 0, -depth_m);
    known.handles.push_back(handle);
    known.wrenches_W.push_back({Vec3(0, 0, 1000.0 * depth_m), Vec3(10.0 * depth_m, 0, 0)});
  }
  return known;
}

// What is no number has no error of 0.
TEST(ToolErrors, AnAnswerThatIsNoNumberIsNotTheBest) {
  Pusher none(Vec3(std::numeric_limits<double>::quiet_NaN(), 0, 0));
  const ToolErrors errors = errors_of(none, "none", two_depths());
  EXPECT_TRUE(std::isnan(errors.max_force_N));
  EXPECT_TRUE(std::isnan(errors.mean_force_N));
  EXPECT_LE(errors.max_torque_Nm, 1e-12);
}

TEST(ToolErrors, TheRightAnswerHasNone) {
  Pusher right;
  const ToolErrors errors = errors_of(right, "right", two_depths());
  EXPECT_LE(errors.max_force_N, 1e-12);
  EXPECT_LE(errors.max_torque_Nm, 1e-12);
  EXPECT_EQ(errors.largest_right_force_N, 3.0);
  EXPECT_EQ(errors.largest_right_torque_Nm, 0.03);
}

TEST(ToolErrors, AKnownErrorIsFoundAndStandsInTheTable) {
  Pusher off(Vec3(0.3, 0.4, 0.0));
  const ToolErrors errors = errors_of(off, "off", two_depths());
  EXPECT_NEAR(errors.mean_force_N, 0.5, 1e-12);
  EXPECT_NEAR(errors.max_force_N, 0.5, 1e-12);
  EXPECT_LE(errors.max_torque_jnd, 1e-12);
  EXPECT_THAT(tool_error_table({{errors}}), HasSubstr("| pushes | off | 0.5 | 0.5 | "));
}

TEST(ToolErrors, ATorqueOfTheWrongSignIsCountedInJustNoticeableDifferences) {
  FaultyTool turned(std::make_unique<Pusher>(), ToolFault::torque_sign, Vec3::Zero());
  const ToolErrors errors = errors_of(turned, "turned", two_depths());
  EXPECT_NEAR(errors.max_torque_Nm, 0.06, 1e-12);
  // 60 mNm against a difference of 7.6 mNm, which holds below the reference.
  EXPECT_NEAR(errors.max_torque_jnd, 0.06 / (torque_weber_fraction * torque_reference_Nm), 1e-9);
}

TEST(ToolErrors, WithinLetsNoComponentPassThatIsNoNumber) {
  ToolComparison comparison;
  comparison.max_force_error_N = Vec3(0.1, 0.2, 0.3);
  EXPECT_TRUE(within(comparison, Vec3(0.1, 0.2, 0.3), Vec3::Zero()));
  EXPECT_FALSE(within(comparison, Vec3(0.1, 0.1, 0.3), Vec3::Zero()));
  comparison.max_torque_error_Nm.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(within(comparison, Vec3::Ones(), Vec3::Ones()));
  EXPECT_THAT(comparison_to_text(comparison), HasSubstr("largest (0.1, 0.2, 0.3) N"));
}

TEST(ToolErrors, StepTimesAreQuantilesOfTheSteps) {
  std::vector<double> ascending;
  for (int i = 1; i <= 1000; ++i) ascending.push_back(i);
  const auto json = nlohmann::json::parse(step_times_to_json(ascending, 64));
  EXPECT_EQ(json["median_us"], 501.0);
  EXPECT_EQ(json["p999_us"], 1000.0);
  EXPECT_EQ(json["memory_bytes"], 64);
  EXPECT_TRUE(nlohmann::json::parse(step_times_to_json(ascending, std::nullopt))["memory_bytes"].is_null());
  EXPECT_THAT(step_times_to_text(ascending), HasSubstr("max 1000.000 us"));
}

TEST(ToolErrors, FindingsCountThoseThatApply) {
  std::vector<ToolFinding> findings{{"a", true, true, 0.5, 1.0, "N", "", ""},
                                    {"b", false, false, 9.0, 1.0, "N", "", "its normals are the tool's own"}};
  EXPECT_TRUE(passed(findings));
  findings.push_back({"c", false, true, 2.0, 1.0, "N", "torque-sign", ""});
  EXPECT_FALSE(passed(findings));
  const std::string text = findings_to_text("mine", findings);
  EXPECT_THAT(text, HasSubstr("its normals are the tool's own"));
  EXPECT_THAT(text, HasSubstr("2 of at most 1 N: torque-sign"));
  EXPECT_THAT(text, HasSubstr("mine: 1 of 2 checks passed"));
}

TEST(ToolErrors, AFaultIsPlantedByName) {
  ToolSubject subject;
  subject.make = [](const Tool&, const surface::TriangleMesh&, const Coupling&) { return std::make_unique<Pusher>(); };
  const auto planted = with_fault(subject, "torque-sign").make({}, {}, {});
  planted->reset();
  ToolState state;
  state.handle.p_W_m = Vec3(0, 0, -0.001);
  EXPECT_EQ(planted->step(state).torque_W_Nm.x(), -0.01);
  EXPECT_THAT([&] { static_cast<void>(with_fault(subject, "gremlins")); },
              ThrowsMessage<UsageError>(HasSubstr("--fault gremlins")));
}

}  // namespace
}  // namespace touchstone::tool
