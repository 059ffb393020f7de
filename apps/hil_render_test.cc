// `touchstone hil render` as a user runs it: three renderers live on two emulated devices behind the guard, each
// compared with the replay of its own path; and what it says when the guard lets go.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "harness/testing/built_program.h"

namespace touchstone::apps {
namespace {

using ::testing::HasSubstr;

class HilRender : public testing::BuiltProgram {
 protected:
  void SetUp() override {
    BuiltProgram::SetUp();
    if (IsSkipped()) return;
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
  testing::Outcome render(const std::string& renderer, const std::string& device, const std::string& more) {
    return run(
        fmt::format("hil render --device-plugin {} --settings {} --model {}.json --mesh plate.obj --seconds 1.5 "
                    "--command-age 2000 --out live {}",
                    TOUCHSTONE_EXAMPLE_DEVICE, device, renderer, more));
  }
  nlohmann::json result() { return nlohmann::json::parse(read_file(folder_ / "live" / "result.json")); }
};

TEST_F(HilRender, ThreeRenderersOnTwoDevicesDoWhatTheirReplaysSay) {
  for (const char* const renderer : {"god-object", "friction-cone", "penalty"}) {
    for (const char* const device : {"press", "slide"}) {
      SCOPED_TRACE(std::string(renderer) + " on " + device);
      const auto outcome = render(renderer, device, "--force-limit 10");
      ASSERT_EQ(outcome.status, 0) << outcome.out << outcome.err;
      EXPECT_THAT(outcome.out, HasSubstr("emulated: emulated-handle"));
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

TEST_F(HilRender, TheLimitIsTheGuards) {
  const auto outcome = render("god-object", "press", "--force-limit 0.3");
  const auto live = result();
  EXPECT_GT(live["cut_by_guard"], 0);
  EXPECT_THAT(render("god-object", "press", "--force-limit 0").err, HasSubstr("--force-limit"));
  EXPECT_THAT(render("god-object", "jump", "--force-limit 1").err, HasSubstr("\"press\" or \"slide\""));
}

}  // namespace
}  // namespace touchstone::apps
