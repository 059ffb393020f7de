// `touchstone hil render` as a user runs it: three renderers live on two emulated devices behind the guard, each
// compared with the replay of its own path; and what it says when the guard lets go.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "emulators/haply_emulator.h"
#include "harness/testing/built_program.h"

namespace touchstone::hil {
namespace {

using ::testing::HasSubstr;

class HilRender : public testing::BuiltProgram {
 protected:
  void SetUp() override {
    testing::BuiltProgram::SetUp();
    if (IsSkipped()) return;
    ::setenv("TOUCHSTONE_LOCK_DIR", folder_.c_str(), 1);  // devices of its own
    write_file(folder_ / "plate.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3\nf 1 3 4\n");
    for (const char* const name : {"god-object", "friction-cone", "penalty"}) {
      write_file(
          folder_ / (std::string(name) + ".json"),
          fmt::format(
              R"({{"schema": "touchstone-model/1", "renderer": "{}", "parameters": {{"stiffness_N_per_m": 300}}}})",
              name));
    }
  }
  // Long patience: a busy machine is not what is tried here.
  testing::Outcome render_on(const std::string& device, const std::string& renderer, const std::string& more) {
    return run(
        fmt::format("hil render {} --model {}.json --mesh plate.obj --seconds 1.5 --command-age 2000 --out live {}",
                    device, renderer, more));
  }
  testing::Outcome render(const std::string& renderer, const std::string& settings, const std::string& more) {
    return render_on(handle(settings), renderer, more);
  }
  static std::string handle(const std::string& settings) {
    return fmt::format("--device-plugin {} --settings {}", TOUCHSTONE_EXAMPLE_DEVICE, settings);
  }
  nlohmann::json result() { return nlohmann::json::parse(read_file(folder_ / "live" / "result.json")); }
};

TEST_F(HilRender, ThreeRenderersOnTwoDevicesDoWhatTheirReplaysSay) {
  // A handle by a plug-in, which the force moves, and Haply's service, whose cursor is moved through the plate.
  const HaplyEmulator service(
      {}, [](double t) { return Vec3(0.003 * std::sin(2.0 * t), 0.0, 0.002 * std::cos(2.0 * std::numbers::pi * t)); });
  write_file(folder_ / "map.json", fmt::format(R"({{"schema": "touchstone-hardware/1", "devices": [
 {{"id": "haply-inverse3", "connected": true, "address": "127.0.0.1", "port": {}, "force_limit_N": 10}}]}})",
                                               service.port()));
  for (const char* const renderer : {"god-object", "friction-cone", "penalty"}) {
    for (const auto& [device, name] : {std::pair(handle("press"), "emulated-handle"),
                                       {handle("slide"), "emulated-handle"},
                                       {std::string("--device haply-inverse3 --map map.json"), "haply-inverse3"}}) {
      SCOPED_TRACE(std::string(renderer) + " on " + device);
      const auto outcome = render_on(device, renderer, "--force-limit 10");
      ASSERT_EQ(outcome.status, 0) << outcome.out << outcome.err;
      EXPECT_THAT(outcome.out, HasSubstr(std::string("emulated: ") + name));
      const auto live = result();
      EXPECT_EQ(live["difference_from_replay_N"], 0.0);
      EXPECT_GT(live["largest_force_N"], 0.2) << "it never touched, and this test shows nothing";
      EXPECT_GT(live["ticks"], 100);
      EXPECT_EQ(live["trip"], "none");
      // Once more, from the files: what was recorded is what was rendered.
      const auto again = run(
          fmt::format("replay --model {}.json --mesh plate.obj --trajectory live/live.csv --out again.csv", renderer));
      ASSERT_EQ(again.status, 0) << again.err;
      const auto compared = run("compare live/replayed.csv again.csv");
      EXPECT_EQ(compared.status, 0) << compared.out << compared.err;
    }
  }
}

TEST_F(HilRender, LettingGoIsNoSuccess) {
  // The handle is 2 mm aside: outside of this workspace when the first force is due.
  const auto outcome = render("god-object", "press", "--force-limit 10 --workspace 0.0015");
  EXPECT_EQ(outcome.status, 1) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("[workspace]"));
  EXPECT_EQ(result()["trip"], "workspace");
}

TEST_F(HilRender, ARecordingOutlivesItsReplay) {
  write_file(folder_ / "plane.json",
             R"({"schema": "touchstone-model/1", "renderer": "plane", "parameters": {"stiffness_N_per_m": 300}})");
  const auto outcome = render("plane", "press",
                              fmt::format("--force-limit 10 --plugin {}/CRASHES_WHEN_RUN_AGAIN.so",
                                          testing::environment("TOUCHSTONE_TEST_PLUGINS")));
  EXPECT_EQ(outcome.status, 1) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("crashed"));
  EXPECT_GT(std::ranges::count(read_file(folder_ / "live" / "live.csv"), '\n'), 100);
}

TEST_F(HilRender, TheLimitIsTheGuards) {
  render("god-object", "press", "--force-limit 0.3");
  const auto live = result();
  EXPECT_GT(live["cut_by_guard"], 0);
  EXPECT_THAT(render("god-object", "press", "--force-limit 0").err, HasSubstr("--force-limit"));
  for (const char* const wrong :
       {"--tolerance inf", "--tolerance nan", "--tolerance=-1", "--rate 1e300", "--rate 2e7"}) {
    const auto outcome = render("god-object", "press", std::string("--force-limit 1 ") + wrong);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(std::string(wrong).substr(0, 6)));
  }
  EXPECT_THAT(render("god-object", "jump", "--force-limit 1").err, HasSubstr("\"press\" or \"slide\""));
}

}  // namespace
}  // namespace touchstone::hil
