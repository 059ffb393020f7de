// A renderer on a handle that moves by itself, against its replay: right, stiffer than its twin, broken, without a
// number, and cut by the guard.
#include "lab/live_rendering.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace touchstone::hil {
namespace {

using ::testing::HasSubstr;

// Up and down through the plane z = 0, 2 mm at 20 Hz; the guard lets `limit_N` pass.
class MovingHandle final : public GuardedDevice {
 public:
  explicit MovingHandle(double limit_N = 100.0, Trip trip = Trip::none) : limit_N_(limit_N), trip_(trip) {}
  [[nodiscard]] const DeviceIdentity& identity() const override { return identity_; }
  DeviceState exchange(const Vec3& f_W_N, double) override {
    allowed_N_ = f_W_N.norm() > limit_N_ ? Vec3(limit_N_ * f_W_N.normalized()) : f_W_N;
    DeviceState state;
    state.t_s = clock_.now_s();
    state.p_W_m = Vec3(0.0, 0.0, 0.002 * std::sin(125.0 * state.t_s));
    return state;
  }
  bool zero_force() noexcept override { return true; }
  [[nodiscard]] double watchdog_s() const override { return 0.0; }
  [[nodiscard]] bool calibrated() const override { return identity_.id == "moving-handle"; }
  void becomes(const std::string& id) { identity_.id = id; }
  [[nodiscard]] Trip tripped() const noexcept override { return trip_; }
  [[nodiscard]] GuardPhase phase() const noexcept override { return GuardPhase::at_zero; }
  [[nodiscard]] bool at_zero() const noexcept override { return true; }
  [[nodiscard]] double open_took_s() const noexcept override { return 0.0; }
  [[nodiscard]] Vec3 last_allowed_N() const noexcept override { return allowed_N_; }
  [[nodiscard]] std::vector<GuardEvent> events() const override { return {{5.0, GuardPhase::off, trip_, "let go"}}; }

 private:
  MonotonicClock clock_;
  DeviceIdentity identity_{"moving-handle", "1", "", "", true};
  double limit_N_;
  Trip trip_;
  Vec3 allowed_N_ = Vec3::Zero();
};

// A spring above the plane z = 0, that breaks after so many steps.
class Spring final : public rendering::Renderer {
 public:
  explicit Spring(double stiffness_N_per_m, int steps = 1 << 30) : k_(stiffness_N_per_m), steps_(steps) {}

 private:
  void do_reset() override { done_ = 0; }
  rendering::StepResult do_step(const rendering::TipState& tip) noexcept override {
    rendering::StepResult result;
    if (++done_ > steps_) result.status = rendering::StepStatus::failed;
    result.f_W_N = Vec3(0.0, 0.0, k_ * std::max(0.0, -tip.p_W_m.z()));
    return result;
  }
  [[nodiscard]] std::string do_failure() const override { return "the spring broke"; }
  double k_;
  int steps_, done_ = 0;
};

LiveRendering render(MovingHandle& handle, Spring renderer, Spring twin) {
  LiveOptions options;
  options.seconds = 0.1;
  LiveRun run = run_renderer(
      handle, options, nullptr, [] { return false; }, renderer);
  return compare_with_replay(std::move(run), twin, handle.tripped());
}

TEST(LiveRendering, DoesWhatItsReplaySays) {
  MovingHandle handle;
  const LiveRendering live = render(handle, Spring(500.0), Spring(500.0));
  EXPECT_TRUE(live.run.whole) << live.run.ended;
  EXPECT_EQ(live.figures.difference_N, 0.0);
  EXPECT_GT(live.figures.largest_N, 0.3) << "it never touched, and this test shows nothing";
  EXPECT_TRUE(live.agrees(0.0));
  ASSERT_EQ(live.recording.size(), live.run.ticks.size());
  EXPECT_EQ(live.recording.f_W_N[3], live.run.ticks[3].allowed_W_N);
}

TEST(LiveRendering, ARendererThatIsNotItsTwinIsFound) {
  MovingHandle handle;
  const LiveRendering live = render(handle, Spring(505.0), Spring(500.0));
  // 5 N/m over what it went deep.
  EXPECT_NEAR(live.figures.difference_N, live.figures.largest_N * 5.0 / 505.0, 1e-12);
  EXPECT_FALSE(live.agrees(1e-9));
  EXPECT_TRUE(live.agrees(0.02));
}

TEST(LiveRendering, ABrokenRendererEndsTheRunAtZeroForce) {
  MovingHandle handle;
  Spring breaks(500.0, 20);
  LiveOptions options;
  options.seconds = 0.2;
  const LiveRun run = run_renderer(
      handle, options, nullptr, [] { return false; }, breaks);
  EXPECT_EQ(run.ended, "the renderer failed: the spring broke");
  EXPECT_FALSE(run.whole);
  ASSERT_EQ(run.ticks.size(), 21U);
  EXPECT_EQ(run.ticks.back().wanted_W_N, Vec3(0, 0, 0));
}

// A device that waits for a person says at once what for, and again when the time is up.
TEST(LiveRendering, AHandleThatIsNotCalibratedSaysWhatToDo) {
  MovingHandle handle;
  handle.becomes("3ds-touch");
  Spring spring(500.0);
  LiveOptions options;
  options.ready_within_s = 0.01;
  std::vector<std::string> told;
  options.tell = [&](const std::string& text) { told.push_back(text); };
  const LiveRun run = run_renderer(
      handle, options, nullptr, [] { return false; }, spring);
  EXPECT_THAT(told, ::testing::ElementsAre(HasSubstr("not calibrated: put its stylus into the inkwell")));
  EXPECT_THAT(run.ended, HasSubstr("was not calibrated (homed) in time: put its stylus into the inkwell"));
  EXPECT_TRUE(run.ticks.empty());
}

TEST(LiveRendering, NoNumberIsNoAgreement) {
  MovingHandle handle;
  LiveRun run;
  run.whole = true;
  for (int i = 0; i < 3; ++i) {
    LiveTick tick;
    tick.t_s = 1e-3 * i;
    tick.wanted_W_N.setConstant(i == 1 ? std::numeric_limits<double>::quiet_NaN() : 0.0);
    run.ticks.push_back(tick);
  }
  Spring twin(500.0);
  const LiveRendering live = compare_with_replay(run, twin, Trip::none);
  EXPECT_FALSE(live.agrees(1e300));
  const auto json = nlohmann::json::parse(live_to_json(live, handle, {"model", "mesh", 1000.0, 3.0}));
  EXPECT_TRUE(json["largest_force_N"].is_null());
  EXPECT_EQ(json["not_finite"], nlohmann::json({"difference_from_replay_N", "largest_force_N"})) << "in file's order";
}

TEST(LiveRendering, TheGuardIsToldInTheResult) {
  MovingHandle handle(0.2, Trip::workspace);
  const LiveRendering live = render(handle, Spring(500.0), Spring(500.0));
  EXPECT_GT(live.run.cut, 0U);
  EXPECT_FALSE(live.agrees(1.0)) << "the guard let go";
  const auto json = nlohmann::json::parse(live_to_json(live, handle, {"model", "mesh", 1000.0, 3.0}));
  EXPECT_EQ(json["schema"], "touchstone-live/1");
  EXPECT_EQ(json["trip"], "workspace");
  EXPECT_EQ(json["guard"][0]["t_s"], 2.0);
  EXPECT_EQ(json["largest_force_N"], live.figures.largest_N);
  EXPECT_TRUE(json["not_finite"].empty());
}

TEST(LiveRendering, PatienceWithTheLoopIsPatienceWithDriverAndGuard) {
  const GuardOptions usual = live_guard({3.0}, 1000.0);
  EXPECT_EQ(usual.limits.slew_N_per_s, 300.0);
  EXPECT_EQ(usual.limits.stale_s, 0.01);
  EXPECT_EQ(usual.watchdog_s, GuardOptions().watchdog_s);
  EXPECT_EQ(usual.limits.energy_J, usual_energy_J);
  EXPECT_EQ(live_guard({3.0, 0.2, 2.0}, 1000.0).watchdog_s, 1.6);
}

}  // namespace
}  // namespace touchstone::hil
