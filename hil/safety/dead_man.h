// The dead-man input: a person at the device allows forces by holding something down. Whatever goes wrong with it, and
// whatever is not known about it, counts as released: no news for longer than its repeat, an unplugged pedal, a closed
// pipe, a clock that runs back, a switch that was already down when the run began.
//   Sources: the space bar at the terminal, a pedal or any USB HID key through the kernel's input events, a button of
// the device itself, a pipe. held() is asked once per servo tick: it never waits and never throws.
#pragma once

#include <memory>
#include <string>

#include "devices/interfaces.h"

namespace touchstone::hil {

class DeadMan {
 public:
  virtual ~DeadMan() = default;
  virtual bool held(double now_s, const DeviceState& state) noexcept = 0;
  // What the person is to do: "hold the space bar".
  [[nodiscard]] virtual std::string instruction() const = 0;
};

// Held while beats keep coming: after `beats_before` of them, no two further apart than `stale_s`, until the last is
// older than that. Times are the reader's.
class Heartbeat {
 public:
  Heartbeat(double stale_s, int beats_before) : stale_s_(stale_s), beats_before_(beats_before) {}
  void beat(double now_s) noexcept;
  void release() noexcept { beats_ = 0; }
  bool held(double now_s) noexcept;

 private:
  double stale_s_;
  int beats_before_;
  int beats_ = 0;
  double last_s_ = 0.0;
};

// The repeats of a held space bar. A terminal says nothing of a release, and waits up to 0.7 s before it repeats: the
// bar counts as held from the third repeat on, and as released 0.15 s after the last, or at any other key. Puts the
// terminal `fd` into a mode without echo for as long as it lives. Throws UsageError where `fd` is no terminal or this
// program is not in its foreground.
std::unique_ptr<DeadMan> dead_man_from_terminal(int fd);

// struct input_event of the kernel (a pedal, a keyboard). The key must go down while we look, must repeat, and counts
// as released at its up event, 0.15 s after the last repeat, after lost events (SYN_DROPPED) and when the device goes.
// `key`: 0 takes the first that goes down. Takes `fd` over.
std::unique_ptr<DeadMan> dead_man_from_input_events(int fd, unsigned key);

// A pipe, FIFO or file: each '1' is a beat, anything but white space else releases, and so does the end. At least one
// every 0.1 s. For tests, and for switches with a program of their own. Takes `fd` over.
std::unique_ptr<DeadMan> dead_man_from_pipe(int fd);

// Buttons of the haptic device, all of `mask`; released where the state is older than 50 ms. Must have been seen up.
std::unique_ptr<DeadMan> dead_man_from_button(std::uint32_t mask);

// "terminal", "input:/dev/input/event5" (or with ":KEYCODE"), "button:0", "pipe:/path/of/fifo". Throws UsageError with
// these forms, DeviceError where the device cannot be had or does not repeat its key.
std::unique_ptr<DeadMan> open_dead_man(const std::string& specification);

}  // namespace touchstone::hil
