// Every fault that a device, its bus or its network can have, injected into an emulator, and what the driver makes of
// it. The table is docs/explanation/driver-faults.md: this test makes it and holds the file against it.
// TOUCHSTONE_HIL_FAULT_TABLE names a file to write it to.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <thread>
#include <utility>

#include "drivers/comedi_daq.h"
#include "drivers/falcon.h"
#include "drivers/netft.h"
#include "drivers/usb.h"
#include "emulators/netft_emulator.h"
#include "emulators/permission_denied.h"
#include "emulators/usb_emulator.h"
#include "harness/base/atomic_file.h"

namespace touchstone::hil {
namespace {

struct Row {
  std::string fault, emulator, answer;
};

std::string answer_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const DeviceError& error) {
    return fmt::format("error: {}", to_string(error.device_status()));
  } catch (const std::exception& error) {
    return fmt::format("error: bad data ({})", error.what());
  }
  return "none";
}

class FaultTable : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!UsbEmulator::preloaded()) GTEST_SKIP() << "needs LD_PRELOAD=libumockdev-preload.so.0 (ctest sets it)";
  }
  static double soon() { return MonotonicClock().now_s() + 1.0; }
  static std::unique_ptr<HapticDevice> open() {
    FalconOptions options;
    options.emulated = true;
    options.timeout_s = 1.0;
    return open_falcon(options);
  }
  // On a running Falcon; the driver must also bring it, or what is left of it, to rest.
  static std::string running(const std::function<void(UsbEmulator&, FalconModel&)>& spoil, double deadline_s) {
    FalconModel model(true);
    UsbEmulator usb(UsbEmulator::Identity{}, model);
    const auto device = open();
    spoil(usb, model);
    MonotonicClock clock;
    const double before = clock.now_s();
    auto answer = answer_of([&] { device->exchange(Vec3::Zero(), before + deadline_s); });
    EXPECT_LT(clock.now_s() - before, deadline_s + 5.0) << "a wait without an end";
    return answer;
  }
  static std::string unplugged_in_mid_transfer() {
    FalconModel model(true);
    UsbEmulator usb(UsbEmulator::Identity{}, model);
    const auto device = open();
    usb.faults.silent = true;  // the host waits in its transfer
    std::thread hand([&usb] {
      MonotonicClock clock;
      clock.sleep_until(clock.now_s() + 0.1);
      usb.unplug();
    });
    auto answer = answer_of([&] { device->exchange(Vec3::Zero(), MonotonicClock().now_s() + 10.0); });
    hand.join();
    return answer;
  }
  static std::string opening(const std::function<void(UsbEmulator&)>& spoil) {
    FalconModel model(true);
    UsbEmulator usb(UsbEmulator::Identity{}, model);
    spoil(usb);
    return answer_of([] { open(); });
  }
  // What the stream's counters and flags say after `n` records.
  static std::string stream(const NetFtFaults& faults, std::size_t n = 400) {
    NetFtEmulator emulator(2000, faults, [](double) { return Wrench{}; });
    const auto source = open_netft(emulator.address(), 5.0, true);
    source->start();
    std::vector<WrenchSample> some(64);
    std::size_t got = 0;
    std::uint64_t last = 0;
    std::uint32_t flags = 0;
    bool back = false;
    while (got < n) {
      const auto now = source->read(some, soon() + 4.0);
      if (now == 0) break;
      for (std::size_t i = 0; i < now; ++i) {
        back = back || (got + i > 0 && some[i].sequence <= last);
        last = some[i].sequence;
        flags |= some[i].flags;
      }
      got += now;
    }
    const auto c = source->counters();
    std::string said;
    const auto add = [&](const char* what, std::uint64_t count) {
      if (count > 0) said += (said.empty() ? "counted: " : ", ") + std::string(what);
    };
    add("lost", c.lost);
    add("repeated", c.repeated);
    add("reordered", c.reordered);
    add("malformed", c.malformed);
    add("device errors", c.device_errors);
    if ((flags & recording::sample_after_gap) != 0) said += "; flagged: after a gap";
    if ((flags & recording::sample_device_error) != 0) said += "; flagged: device error";
    if (got < n) said += said.empty() ? "silence until the deadline" : "; silence until the deadline";
    if (back) said += "; TIME RAN BACK";
    return said.empty() ? "none" : said;
  }
  static NetFtFaults faulty(std::uint32_t NetFtFaults::*which, std::uint32_t value) {
    NetFtFaults faults;
    faults.*which = value;
    return faults;
  }
};

TEST_F(FaultTable, IsTheOneInTheDocumentation) {
  std::vector<Row> rows;
  const auto usb = [&](const char* fault, const std::string& answer) { rows.push_back({fault, "USB", answer}); };
  usb("none", running([](UsbEmulator&, FalconModel&) {}, 2.0));
  usb("stall while opening", opening([](UsbEmulator& u) { u.faults.stall = true; }));
  usb("stall while running", running([](UsbEmulator& u, FalconModel&) { u.faults.stall = true; }, 2.0));
  usb("timeout", running([](UsbEmulator& u, FalconModel&) { u.faults.silent = true; }, 0.2));
  usb("busy", opening([](UsbEmulator& u) { u.faults.busy = true; }));
  usb("no permission", fmt::format("error: {}", permission_denied().status));
  usb("short packet", running([](UsbEmulator& u, FalconModel&) { u.faults.short_packets = true; }, 0.2));
  usb("bad frame", running([](UsbEmulator&, FalconModel& m) { m.damage_next_frames(1); }, 2.0));
  usb("unplugged while running", running([](UsbEmulator& u, FalconModel&) { u.unplug(); }, 2.0));
  usb("unplugged in mid-transfer", unplugged_in_mid_transfer());
  usb("not there", opening([](UsbEmulator& u) { u.unplug(); }));
  usb("plugged in again after the program began", opening([](UsbEmulator& u) { u.unplug(), u.plug(); }));

  const auto net = [&](const char* fault, const std::string& answer) { rows.push_back({fault, "Net F/T", answer}); };
  net("none", stream({}));
  net("lost packets", stream(faulty(&NetFtFaults::drop_every, 50)));
  net("repeated packets", stream(faulty(&NetFtFaults::repeat_every, 50)));
  net("reordered packets", stream(faulty(&NetFtFaults::swap_every, 50)));
  net("short packets", stream(faulty(&NetFtFaults::short_every, 50)));
  net("sequence number rolls over", stream(faulty(&NetFtFaults::first_sequence, 0xffffffffU - 100)));
  net("error bits", stream(faulty(&NetFtFaults::error_bit_every, 50)));
  net("falls silent", stream(faulty(&NetFtFaults::silent_after, 100), 200));
  {
    NetFtFaults faults;
    faults.newest_client_wins = true;
    NetFtEmulator emulator(1000, faults, [](double) { return Wrench{}; });
    const auto first = open_netft(emulator.address(), 5.0, true), second = open_netft(emulator.address(), 5.0, true);
    std::vector<WrenchSample> some(64);
    first->start();
    first->read(some, soon() + 4.0);
    second->start();
    EXPECT_GT(second->read(some, soon() + 4.0), 0U);
    while (first->read(some, MonotonicClock().now_s() + 0.1) > 0) {
    }
    net("a second client takes the stream",
        first->read(some, MonotonicClock().now_s() + 0.2) == 0 ? "silence until the deadline" : "samples");
  }
  {
    NetFtFaults silent, garbage;
    silent.http_silent = true;
    garbage.http_garbage = true;
    NetFtEmulator mute(100, silent, [](double) { return Wrench{}; }),
        liar(100, garbage, [](double) { return Wrench{}; });
    net("configuration is not answered", answer_of([&] { open_netft(mute.address(), 0.3, true); }));
    const auto answer = answer_of([&] { open_netft(liar.address(), 5.0, true); });
    net("configuration is something else", answer.substr(0, answer.find(" (")));
  }
  {
    NetFtEmulator emulator(1000, {}, [](double) { return Wrench{}; });
    const auto source = open_netft(emulator.address(), 5.0, true);
    const auto address = emulator.address();
    source->start();
    std::vector<WrenchSample> some(64);
    source->read(some, soon() + 4.0);
    emulator.unplug();
    source->stop();
    net("unplugged while running", answer_of([&] {
          for (double until = soon(); MonotonicClock().now_s() < until;) source->read(some, until);
        }));
    net("not there", answer_of([&] { open_netft(address, 2.0, true); }));
  }

  for (const auto& [fault, name] :
       {std::pair{"", "none"}, {"absent", "not there"}, {"forbidden", "no permission"}, {"busy", "busy"}}) {
    ::setenv("TOUCHSTONE_STUB_COMEDI_FAULT", fault, 1);
    rows.push_back({name, "comedi", answer_of([] { comedi_board("/dev/comedi0", TOUCHSTONE_STUB_COMEDI); })});
  }
  ::unsetenv("TOUCHSTONE_STUB_COMEDI_FAULT");
  rows.push_back(
      {"no comedilib", "comedi", answer_of([] { comedi_board("/dev/comedi0", "/nowhere/libcomedi.so.0"); })});

  std::string table =
      "# Faults and what the drivers make of them\n\nMade by the test `FaultTable.IsTheOneInTheDocumentation` with "
      "emulators: it shows that the drivers answer our\nreading of a fault, not that a device fails in this way. Every "
      "wait had an end.\n\n| fault | emulator | what the driver says |\n|---|---|---|\n";
  for (const auto& row : rows) table += fmt::format("| {} | {} | {} |\n", row.fault, row.emulator, row.answer);
  if (const char* const file = std::getenv("TOUCHSTONE_HIL_FAULT_TABLE")) write_file(file, table);
  std::ifstream in(std::filesystem::path(std::getenv("TOUCHSTONE_SOURCE_DIR")) / "docs" / "explanation" /
                   "driver-faults.md");
  std::stringstream documented;
  documented << in.rdbuf();
  EXPECT_EQ(documented.str(), table);
}

// One libusb context, as a program that runs all day has: devices come and go under it.
TEST_F(FaultTable, DevicesComeAndGoUnderOneContext) {
  FalconModel model(true);
  UsbEmulator usb(UsbEmulator::Identity{}, model);
  const UsbContext context;
  const std::uint16_t vendors[] = {0x0403};
  // The kernel's message reaches libusb's own thread: wait for it, with an end.
  const auto count_becomes = [&](std::size_t wanted) {
    MonotonicClock clock;
    for (const double until = clock.now_s() + 10.0; clock.now_s() < until; clock.sleep_until(clock.now_s() + 0.01)) {
      if (context.devices(vendors).size() == wanted) return true;
    }
    return false;
  };
  EXPECT_TRUE(count_becomes(1));
  for (int i = 0; i < 3; ++i) {
    usb.unplug();
    EXPECT_TRUE(count_becomes(0));
    usb.plug();
    EXPECT_TRUE(count_becomes(1));
    const UsbHandle handle(context, 0x0403, 0xcb48, "EMUF0001");
    EXPECT_EQ(handle.serial(), "EMUF0001");
  }
}

}  // namespace
}  // namespace touchstone::hil
