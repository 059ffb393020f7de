// `touchstone hil record` with several devices, `recover` and `--acquire`, as a user runs them, against emulated
// devices.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "emulators/haply_emulator.h"
#include "emulators/natnet_emulator.h"
#include "emulators/netft_emulator.h"
#include "emulators/qualisys_emulator.h"
#include "emulators/serial_emulator.h"
#include "emulators/vrpn_emulator.h"
#include "harness/testing/built_program.h"

namespace touchstone::hil {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// A ball of 1 mm pressed twice a second into a plate at z = 0, 500 N/m, while it moves along x.
Vec3 tip(double t) { return {0.01 * t, 0.0, 0.001 + 0.004 * std::cos(4 * M_PI * t)}; }
double push_N(double t) { return 500.0 * std::max(0.0, 0.001 - tip(t).z()); }

class HilRecord : public testing::BuiltProgram {
 protected:
  void map(const std::string& devices) {
    write_file(folder_ / "map.json", R"({"schema": "touchstone-hardware/1", "devices": [)" + devices + "]}");
  }
  static std::string netft(const NetFtEmulator& sensor) {
    return fmt::format(R"({{"id": "ati-netft", "address": "127.0.0.1", "http_port": {}, "udp_port": {}}})",
                       sensor.address().http_port, sensor.address().udp_port);
  }
  static std::string optitrack(const NatNetEmulator& motive) {
    return fmt::format(R"({{"id": "optitrack", "address": "127.0.0.1", "port": {}, "body": "probe", "rate_Hz": 120}})",
                       motive.command_port());
  }
  const double began_s_ = MonotonicClock().now_s();
  MonotonicClock clock_;
  [[nodiscard]] double now() const { return clock_.now_s() - began_s_; }
};

TEST_F(HilRecord, ForceAndTrackerBecomeARecording) {
  NetFtEmulator sensor(2000, {}, [this](double) { return Wrench{Vec3(0, 0, push_N(now())), Vec3::Zero()}; });
  NatNetEmulator motive(120, {}, [this, &motive](double t) {
    return EmulatedPose{tip(t + motive.began_s() - began_s_), Quat::Identity(), true};
  });
  map(netft(sensor) + ", " + optitrack(motive));
  write_file(folder_ / "acquisition.json",
             R"({"schema": "touchstone-acquisition/1", "force": {}, "motion": {},
                 "probe": {"tip_P_m": [0, 0, 0], "tip_S_m": [0, 0, 0], "tip_radius_m": 0.001},
                 "clocks": {"offset_s": 0}})");
  const auto outcome =
      run("hil record ati-netft optitrack --map map.json --seconds 4 --out session --acquire acquisition.json");
  ASSERT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("ati-netft"), HasSubstr("(emulated)"), HasSubstr("axis good to"),
                                 HasSubstr("recording.csv")));
  EXPECT_THAT(read_file(folder_ / "session" / "recording.csv"), HasSubstr("t_s,x_m,y_m,z_m"));
  const auto session = nlohmann::json::parse(read_file(folder_ / "session" / "session.json"));
  EXPECT_EQ(session["streams"].size(), 2U);
  // Once more, from the files.
  const auto again = run("hil recover session");
  EXPECT_EQ(again.status, 0) << again.err;
  // And nothing is overwritten.
  const auto twice = run("hil record ati-netft --map map.json --seconds 1 --out session");
  EXPECT_NE(twice.status, 0);
  EXPECT_THAT(twice.err, HasSubstr("is there already"));
}

TEST_F(HilRecord, AStreamThatStopsIsNoSuccess) {
  NetFtEmulator sensor(1000, {}, [](double) { return Wrench{}; });
  // It falls silent once some of what it sent, more than a header, stands in its file.
  constexpr std::uintmax_t some = 8192;
  NatNetEmulator motive(120, {}, [this, &motive](double) {
    std::error_code not_there_yet;
    const auto size = std::filesystem::file_size(folder_ / "session" / "optitrack.tsraw", not_there_yet);
    if (!not_there_yet && size > some) motive.fall_silent();
    return EmulatedPose{};
  });
  map(netft(sensor) + ", " + optitrack(motive));
  const auto outcome = run("hil record ati-netft optitrack --map map.json --seconds 60 --out session");
  EXPECT_EQ(outcome.status, 1) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("optitrack: its stream stopped"));
}

TEST_F(HilRecord, FramesFromAnotherAddressAreSaid) {
  NatNetFaults faults;
  faults.second_card = true;
  NatNetEmulator motive(120, faults, [](double) { return EmulatedPose{}; });
  map(optitrack(motive));
  const auto outcome = run("hil record optitrack --map map.json --silence 0.7 --seconds 60 --out session");
  EXPECT_EQ(outcome.status, 3) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("packets came from another one"));
  EXPECT_THAT(outcome.err, HasSubstr("two network cards"));
}

// A list leaves a tracker's server alone; by its name it is asked.
TEST_F(HilRecord, ProbeConnectsToATrackerOnlyIfItIsNamed) {
  NatNetEmulator motive(120, {}, [](double) { return EmulatedPose{}; });
  map(optitrack(motive));
  const auto list = run("hil probe --map map.json --json list.json");
  EXPECT_THAT(list.out, HasSubstr("touchstone hil probe optitrack"));
  EXPECT_EQ(motive.sent(), 0U) << "a client was there";
  const auto listed = nlohmann::json::parse(read_file(folder_ / "list.json"));
  for (const auto& device : listed["devices"]) {
    if (device["id"] == "optitrack") {
      EXPECT_EQ(device["status"], "not asked");
    }
  }
  const auto named = run("hil probe optitrack --map map.json --json named.json");
  EXPECT_EQ(named.status, 0) << named.out << named.err;
  const auto devices = nlohmann::json::parse(read_file(folder_ / "named.json"))["devices"];
  ASSERT_EQ(devices.size(), 1U);
  EXPECT_EQ(devices[0]["status"], "present");
  EXPECT_NE(run("hil probe optitrak --map map.json").status, 0);
}

TEST_F(HilRecord, EachDeviceOfTheTableIsRecordedByItsName) {
  SerialEmulator bota(bota_sensor({}, [](double t) { return Wrench{Vec3(0, 0, t), Vec3::Zero()}; }));
  SerialEmulator cell(load_cell_sketch(true, 80.0, [](double) { return 500.0; }));
  SerialEmulator pfs(leptrino_sensor({}, [](double) { return Wrench{}; }));
  QualisysEmulator qtm(100.0, {}, [](double) { return EmulatedPose{}; });
  VrpnEmulator vicon(100.0, [](double t) { return EmulatedPose{Vec3(t, 0, 0), Quat::Identity(), true}; });
  HaplyEmulator inverse({}, [](double t) { return Vec3(0.01 * t, 0, 0); });
  map(fmt::format(R"({{"id": "bota-serial", "address": "{}"}},
                     {{"id": "hx711-serial", "address": "{}", "newtons_per_unit": 0.00980665, "rate_Hz": 80}},
                     {{"id": "leptrino-serial", "address": "{}"}},
                     {{"id": "qualisys", "address": "127.0.0.1", "port": {}, "body": "Stylus"}},
                     {{"id": "vrpn", "address": "127.0.0.1", "port": {}, "body": "Tracker0"}},
                     {{"id": "haply-inverse3", "address": "127.0.0.1", "port": {}}})",
                  bota.node(), cell.node(), pfs.node(), qtm.port(), vicon.port(), inverse.port()));
  const auto found = run("hil probe --map map.json --json probe.json");
  EXPECT_EQ(found.status, 0) << found.out << found.err;
  const auto outcome =
      run("hil record bota-serial hx711-serial leptrino-serial qualisys vrpn haply-inverse3 --handle-rate 200 --map "
          "map.json --seconds 2 --out session");
  // On a busy machine ticks of the handle are missed and counted; no stream may be missing.
  EXPECT_LE(outcome.status, 1) << outcome.out << outcome.err;
  const auto session = nlohmann::json::parse(read_file(folder_ / "session" / "session.json"));
  ASSERT_EQ(session["streams"].size(), 6U);
  for (const auto& stream : session["streams"]) {
    EXPECT_GT(stream["samples"], 50) << stream["name"];
    EXPECT_TRUE(stream["emulated"]) << stream["name"];
  }
}

TEST_F(HilRecord, MistakesAreSaid) {
  map(R"({"id": "optitrack", "address": ""}, {"id": "hx711-serial", "address": "/dev/null"})");
  EXPECT_THAT(run("hil record optitrack --map map.json --out a").err,
              HasSubstr("\"address\" must be in the hardware map"));
  EXPECT_THAT(run("hil record hx711-serial --map map.json --out b").err, HasSubstr("newtons_per_unit"));
  EXPECT_THAT(run("hil record vrpn --map map.json --out c").err, HasSubstr("is not in the hardware map"));
  EXPECT_THAT(run("hil record optitrack hx711-serial --map map.json --out d.tsraw").err, HasSubstr("need a folder"));
  map(R"({"id": "optitrack", "address": "x", "axis": "w"})");
  EXPECT_THAT(run("hil record optitrack --map map.json --out e").err, HasSubstr("x, y or z"));
  // A sensor in the place of another of its kind.
  SerialEmulator pfs(leptrino_sensor({}, [](double) { return Wrench{}; }));
  map(fmt::format(R"({{"id": "leptrino-serial", "address": "{}", "serial": "1906001"}})", pfs.node()));
  EXPECT_THAT(run("hil record leptrino-serial --map map.json --out f").err,
              HasSubstr("serial 2606008, the hardware map wants 1906001"));
  EXPECT_THAT(run("hil record leptrino-serial leptrino-serial --map map.json --out g").err,
              HasSubstr("leptrino-serial: is named more than once"));
}

}  // namespace
}  // namespace touchstone::hil
