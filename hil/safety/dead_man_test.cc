// Every source of the dead-man input: held while it is held, and released by all that can go wrong. Times are given, so
// nothing here depends on how busy the machine is.
#include "safety/dead_man.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/input.h>
#include <pty.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string_view>

#include "harness/testing/steps.h"
#include "safety/force_supervisor.h"

namespace touchstone::hil {
namespace {

using ::testing::HasSubstr;

struct Pipe {
  Pipe() { EXPECT_EQ(::pipe2(ends, O_CLOEXEC), 0); }
  ~Pipe() { close_writer(); }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void write(std::string_view text) const {
    EXPECT_EQ(::write(ends[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  void close_writer() {
    if (ends[1] >= 0) ::close(ends[1]);
    ends[1] = -1;
  }
  int ends[2];
};

TEST(Heartbeat, IsHeldWhileBeatsKeepComing) {
  Heartbeat h(0.1, 3);
  EXPECT_FALSE(h.held(0.0));
  h.beat(1.00);
  h.beat(1.05);
  EXPECT_FALSE(h.held(1.05));
  h.beat(1.10);
  EXPECT_TRUE(h.held(1.10));
  EXPECT_TRUE(h.held(1.19));
  EXPECT_FALSE(h.held(1.21));
  h.beat(1.22);  // one alone does not bring it back
  EXPECT_FALSE(h.held(1.22));
}

TEST(Heartbeat, ATimeThatIsNoneOrRunsBackReleases) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 0.5}) {
    Heartbeat h(0.1, 1);
    h.beat(1.0);
    ASSERT_TRUE(h.held(1.0));
    EXPECT_FALSE(h.held(bad));
    EXPECT_FALSE(h.held(1.0)) << "latched";
    h.beat(std::nan(""));
    EXPECT_FALSE(h.held(1.0));
  }
}

TEST(DeadManPipe, BeatsHoldAndAllElseReleases) {
  Pipe pipe;
  const auto dead_man = dead_man_from_pipe(pipe.ends[0]);
  EXPECT_FALSE(dead_man->held(0.0, {}));
  pipe.write("1\n");
  EXPECT_TRUE(dead_man->held(0.01, {}));
  EXPECT_TRUE(dead_man->held(0.10, {}));
  EXPECT_FALSE(dead_man->held(0.12, {})) << "stale";
  pipe.write("1");
  EXPECT_TRUE(dead_man->held(0.2, {}));
  pipe.write("10");
  EXPECT_FALSE(dead_man->held(0.21, {}));
  pipe.write("1x1");
  EXPECT_TRUE(dead_man->held(0.22, {}));
  pipe.close_writer();
  EXPECT_FALSE(dead_man->held(0.23, {})) << "nobody holds the other end";
}

TEST(DeadManPipe, AFileThatEndsIsReleasedAndAFifoIsOpenedWithoutWaiting) {
  const auto path = std::filesystem::temp_directory_path() / fmt::format("touchstone-deadman-{}", ::getpid());
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  const auto dead_man = open_dead_man("pipe:" + path.string());
  EXPECT_FALSE(dead_man->held(0.0, {})) << "nobody writes";
  const int writer = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  EXPECT_EQ(::write(writer, "1", 1), 1);
  EXPECT_TRUE(dead_man->held(0.1, {}));
  ::close(writer);
  EXPECT_FALSE(dead_man->held(0.11, {}));
  std::filesystem::remove(path);
}

class DeadManTerminal : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(::openpty(&keyboard_, &terminal_, nullptr, nullptr, nullptr), 0); }
  void TearDown() override {
    ::close(keyboard_);
    ::close(terminal_);
  }
  void type(std::string_view keys) const {
    EXPECT_EQ(::write(keyboard_, keys.data(), keys.size()), static_cast<ssize_t>(keys.size()));
  }
  int keyboard_ = -1, terminal_ = -1;
};

TEST_F(DeadManTerminal, TheSpaceBarIsHeldFromItsThirdRepeatUntilTheyStop) {
  const auto dead_man = dead_man_from_terminal(terminal_);
  EXPECT_THAT(dead_man->instruction(), HasSubstr("space bar"));
  double t = 10.0;
  type(" ");
  EXPECT_FALSE(dead_man->held(t, {}));
  t += 0.5;  // the keyboard waits before it repeats
  for (int i = 0; i < 30; ++i, t += 0.033) {
    type(" ");
    EXPECT_EQ(dead_man->held(t, {}), i >= 2) << i;
  }
  EXPECT_TRUE(dead_man->held(t + 0.1, {}));
  EXPECT_FALSE(dead_man->held(t + 0.2, {}));
}

TEST_F(DeadManTerminal, AnotherKeyReleasesAndWhatPiledUpIsOneBeat) {
  const auto dead_man = dead_man_from_terminal(terminal_);
  const auto hold = [&](double t) {
    for (int i = 0; i < 3; ++i, t += 0.03) type(" "), dead_man->held(t, {});
    return dead_man->held(t, {});
  };
  ASSERT_TRUE(hold(0.0));
  type(" q");
  EXPECT_FALSE(dead_man->held(0.1, {}));
  type("          ");  // typed while nobody looked
  EXPECT_FALSE(dead_man->held(1.0, {}));
  EXPECT_TRUE(hold(2.0));
}

TEST_F(DeadManTerminal, GivesTheTerminalBackAsItWas) {
  termios before{}, during{}, after{};
  ::tcgetattr(terminal_, &before);
  auto dead_man = dead_man_from_terminal(terminal_);
  ::tcgetattr(terminal_, &during);
  EXPECT_EQ(during.c_lflag & static_cast<tcflag_t>(ECHO | ICANON), 0U);
  dead_man.reset();
  ::tcgetattr(terminal_, &after);
  EXPECT_EQ(after.c_lflag, before.c_lflag);
}

void send(const Pipe& pipe, unsigned type, unsigned code, int value) {
  input_event event{};
  event.type = static_cast<decltype(event.type)>(type);
  event.code = static_cast<decltype(event.code)>(code);
  event.value = value;
  pipe.write({reinterpret_cast<const char*>(&event), sizeof event});
}

TEST(DeadManPedal, IsHeldByPressAndRepeatsAndReleasedByAllElse) {
  Pipe pipe;
  const auto dead_man = dead_man_from_input_events(pipe.ends[0], 0);
  send(pipe, EV_KEY, KEY_B, 2);
  EXPECT_FALSE(dead_man->held(0.0, {})) << "was down before the run";
  send(pipe, EV_KEY, KEY_B, 0);
  send(pipe, EV_KEY, KEY_B, 1);
  send(pipe, EV_SYN, SYN_REPORT, 0);
  EXPECT_TRUE(dead_man->held(0.1, {}));
  for (const double t : testing::steps(0.2, 1.0, 0.03)) {
    send(pipe, EV_KEY, KEY_B, 2);
    EXPECT_TRUE(dead_man->held(t, {}));
  }
  send(pipe, EV_KEY, KEY_A, 1);  // another key matters not
  EXPECT_TRUE(dead_man->held(1.0, {}));
  send(pipe, EV_KEY, KEY_B, 0);
  EXPECT_FALSE(dead_man->held(1.01, {}));
  send(pipe, EV_KEY, KEY_B, 1);
  EXPECT_TRUE(dead_man->held(1.1, {}));
  EXPECT_FALSE(dead_man->held(1.3, {})) << "its repeats stopped";
  send(pipe, EV_KEY, KEY_B, 2);
  EXPECT_FALSE(dead_man->held(1.31, {})) << "must be pressed anew";
  send(pipe, EV_KEY, KEY_B, 1);
  EXPECT_TRUE(dead_man->held(1.4, {}));
  send(pipe, EV_SYN, SYN_DROPPED, 0);
  EXPECT_FALSE(dead_man->held(1.41, {})) << "events were lost";
}

TEST(DeadManPedal, UnpluggedIsReleasedForGood) {
  Pipe pipe;
  const auto dead_man = dead_man_from_input_events(pipe.ends[0], KEY_B);
  send(pipe, EV_KEY, KEY_A, 1);
  EXPECT_FALSE(dead_man->held(0.0, {})) << "not the key that was chosen";
  send(pipe, EV_KEY, KEY_B, 1);
  EXPECT_TRUE(dead_man->held(0.01, {}));
  pipe.close_writer();
  EXPECT_FALSE(dead_man->held(0.02, {}));
  EXPECT_FALSE(dead_man->held(0.03, {}));
}

TEST(DeadManButton, MustBeSeenUpBeSeenDownAndBeFresh) {
  const auto dead_man = dead_man_from_button(2);
  DeviceState state;
  state.buttons = 2;
  EXPECT_FALSE(dead_man->held(0.0, state)) << "stuck since before the run";
  state.buttons = 1;
  EXPECT_FALSE(dead_man->held(0.0, state));
  state.buttons = 3;
  EXPECT_TRUE(dead_man->held(0.0, state));
  EXPECT_FALSE(dead_man->held(0.06, state)) << "stale";
  EXPECT_FALSE(dead_man->held(-0.01, state)) << "from the future";
  EXPECT_FALSE(dead_man->held(std::nan(""), state));
}

TEST(DeadMan, SpecificationsThatAreNoneAreSaid) {
  for (const auto* bad : {"", "pedal", "terminal:1", "button:", "button:32", "button:x",
                          "pipe:", "input:", "input:/dev/input/event0:0", "input:/dev/input/event0:k"}) {
    try {
      open_dead_man(bad);
      ADD_FAILURE() << bad;
    } catch (const UsageError& error) {
      EXPECT_THAT(error.what(), HasSubstr("use terminal, input:/dev/input/eventN")) << bad;
    }
  }
  try {
    open_dead_man("pipe:/nowhere/at/all");
    ADD_FAILURE();
  } catch (const DeviceError& error) {
    EXPECT_EQ(error.device_status(), DeviceStatus::absent);
  }
  try {
    open_dead_man("input:/dev/null");
    ADD_FAILURE();
  } catch (const DeviceError& error) {
    EXPECT_THAT(error.what(), HasSubstr("do not repeat"));
  }
}

// The whole way: what the dead-man says reaches the supervisor, and letting go in mid-run brings the force down for
// good.
TEST(DeadMan, ReleasedInMidRunTheForceRampsDownAndStaysDown) {
  Pipe pipe;
  const auto dead_man = dead_man_from_pipe(pipe.ends[0]);
  SafetyLimits limits;
  limits.force_N = 2.0;
  limits.workspace_W_m = Box3(Vec3::Constant(-0.1), Vec3::Constant(0.1));
  ForceSupervisor supervisor(limits);
  double at_release = 0.0, last = 0.0, zero_at_s = -1.0, released_at_s = -1.0;
  for (int i = 0; i < 2000; ++i) {
    const double t = 1e-3 * i;
    if (i % 20 == 0 && (i < 1000 || i >= 1500)) pipe.write("1");  // let go at 1 s, held again from 1.5 s on
    ForceSupervisor::Input in;
    in.now_s = in.state.t_s = t;
    in.wanted_W_N = Vec3(0, 0, 1);
    in.calibrated = true;
    in.dead_man_held = dead_man->held(t, in.state);
    const double force = supervisor.allow(in).norm();
    if (supervisor.tripped() == Trip::none) at_release = force;
    if (supervisor.tripped() != Trip::none && released_at_s < 0) released_at_s = t;
    if (released_at_s >= 0) {
      EXPECT_LE(force, last + 1e-15) << t;
      if (force == 0.0 && zero_at_s < 0) zero_at_s = t;
    }
    last = force;
  }
  EXPECT_EQ(at_release, 1.0);
  EXPECT_EQ(supervisor.tripped(), Trip::dead_man);
  EXPECT_NEAR(released_at_s, 0.98 + 0.1, 0.0021);
  EXPECT_NEAR(zero_at_s - released_at_s, limits.ramp_down_s, 0.0021);
  EXPECT_EQ(last, 0.0) << "held again is not reset";
}

}  // namespace
}  // namespace touchstone::hil
