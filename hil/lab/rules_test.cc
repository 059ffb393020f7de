// The test of the tests: without hardware nothing passes, a promised device that is absent fails, and emulated results
// are called so. And the analyses of the lab tests on signals whose answer is known.
#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <numbers>
#include <string_view>

#include "devices/device_lock.h"
#include "devices/probe.h"
#include "emulators/haply_emulator.h"
#include "emulators/ndi_emulator.h"
#include "emulators/netft_emulator.h"
#include "harness/base/atomic_file.h"
#include "harness/base/hash.h"
#include "harness/base/random.h"
#include "harness/testing/built_program.h"
#include "harness/testing/steps.h"
#include "lab/analysis.h"
#include "lab/availability.h"
#include "lab/evidence.h"
#include "lab/force_experiments.h"

namespace touchstone::hil {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

struct Output {
  std::string text;
  int status = -1;
};

Output run_suite(const std::string& environment) {
  const auto command = "env -u TOUCHSTONE_HARDWARE_MAP -u TOUCHSTONE_HIL_EMULATED -u TOUCHSTONE_REQUIRE_HIL " +
                       environment + " " TOUCHSTONE_HIL_SUITE " 2>&1";
  Output output;
  std::FILE* const pipe = ::popen(command.c_str(), "r");
  char buffer[4096];
  while (const auto n = std::fread(buffer, 1, sizeof buffer, pipe)) output.text.append(buffer, n);
  const int status = ::pclose(pipe);
  output.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  output.text = touchstone::testing::of_another_suite(std::move(output.text));
  return output;
}

bool hardware_here() {
  for (const auto& r : probe({})) {
    if (r.status != DeviceStatus::absent && r.status != DeviceStatus::invisible) return true;
  }
  return false;
}

TEST(SkipRules, WithoutHardwareEveryLabTestIsSkippedWithItsDevicesReason) {
  if (hardware_here()) GTEST_SKIP() << "there is hardware here: this test is for machines without";
  const auto output = run_suite("");
  EXPECT_EQ(output.status, 0);
  EXPECT_THAT(output.text, Not(HasSubstr("[       OK ]")));
  EXPECT_THAT(output.text, HasSubstr("[ SKIPPED ]"));
  EXPECT_THAT(output.text, HasSubstr("Novint Falcon (novint-falcon): absent: no such device on USB"));
  EXPECT_THAT(output.text, HasSubstr("ATI Net F/T (ati-netft): absent: a network device is looked for only where the "
                                     "hardware map gives its address"));
}

TEST(SkipRules, WhatIsRequiredAndAbsentFails) {
  if (hardware_here()) GTEST_SKIP() << "there is hardware here: this test is for machines without";
  const auto output = run_suite("TOUCHSTONE_REQUIRE_HIL=1");
  EXPECT_EQ(output.status, 1);
  EXPECT_THAT(output.text, Not(HasSubstr("[       OK ]")));
  EXPECT_THAT(output.text, Not(HasSubstr("[ SKIPPED ]")));
  EXPECT_THAT(output.text, HasSubstr("TOUCHSTONE_REQUIRE_HIL=1 allows no absence"));
  const auto map = std::filesystem::temp_directory_path() / fmt::format("touchstone-map-{}.json", ::getpid());
  write_file(map, R"({"schema": "touchstone-hardware/1", "devices": [{"id": "novint-falcon", "connected": true}]})");
  const auto promised = run_suite("TOUCHSTONE_HARDWARE_MAP=" + map.string());
  std::filesystem::remove(map);
  EXPECT_EQ(promised.status, 1);
  EXPECT_THAT(promised.text, HasSubstr("the hardware map calls it connected"));
  EXPECT_THAT(promised.text, HasSubstr("[ SKIPPED ]"));  // the devices that nobody promised
}

TEST(SkipRules, EmulatedResultsSaySoAndNeverReachADashboard) {
  // One of each kind; all of them are tests of their own under the label emulated.
  const auto output =
      run_suite("TOUCHSTONE_HIL_EMULATED=1 GTEST_FILTER='*NoiseFloor*/atinetft:*ForceStep*/novint_falcon'");
  EXPECT_EQ(output.status, 0) << output.text;
  EXPECT_THAT(output.text, HasSubstr("emulated noise-floor-ati-netft noise_fx_N"));
  EXPECT_THAT(output.text, HasSubstr("emulated force-step-novint-falcon step_measured_N"));
  EXPECT_THAT(output.text, Not(HasSubstr("CTestMeasurement")));
  EXPECT_EQ(run_suite("TOUCHSTONE_HIL_EMULATED=1 TOUCHSTONE_REQUIRE_HIL=1").status, 1);
}

TEST(SkipRules, EveryStatusButPresentSkipsOrFails) {
  for (const auto status : {DeviceStatus::absent, DeviceStatus::no_permission, DeviceStatus::busy,
                            DeviceStatus::wrong_serial, DeviceStatus::calibration_expired, DeviceStatus::failed}) {
    ProbeResult r{"novint-falcon", "Novint Falcon", status, "", "why", false};
    EXPECT_EQ(judge(r, false).decision, Decision::skip);
    EXPECT_EQ(judge(r, true).decision, Decision::fail);
    r.required = true;
    EXPECT_EQ(judge(r, false).decision, Decision::fail);
    EXPECT_THAT(judge(r, false).reason, HasSubstr(std::string(to_string(status))));
  }
}

TEST(SkipRules, ForcesOnHardwareNeedADeadMan) {
  const Availability here{Decision::run, false, "novint-falcon: present"}, emulated{Decision::run, true, "emulated"},
      absent{Decision::skip, false, "absent"};
  EXPECT_EQ(judge_dead_man(here, "terminal", true).decision, Decision::run);
  EXPECT_EQ(judge_dead_man(here, "", false).decision, Decision::skip);
  EXPECT_EQ(judge_dead_man(here, "", true).decision, Decision::fail);
  EXPECT_THAT(judge_dead_man(here, "", true).reason, HasSubstr("no dead-man input is set"));
  EXPECT_EQ(judge_dead_man(emulated, "", true).decision, Decision::run);
  EXPECT_EQ(judge_dead_man(absent, "", true).decision, Decision::skip);
}

TEST(Probe, SaysForEveryKnownDeviceWhatItFound) {
  const auto results = probe({});
  EXPECT_GE(results.size(), 10U);
  for (const auto& r : results) EXPECT_FALSE(r.reason.empty()) << r.id;
  EXPECT_THAT(probe_one("phantom-omni", {}).reason, HasSubstr("FireWire"));
  EXPECT_EQ(probe_one("phantom-omni", {}).status, DeviceStatus::invisible);
}

TEST(Probe, NetworkSensorPresentWrongSerialAndExpired) {
  NetFtEmulator emulator(100, {}, [](double) { return Wrench{}; });
  const auto file = std::filesystem::temp_directory_path() / fmt::format("touchstone-probe-{}.cal", ::getpid());
  write_file(file, "calibration");
  HardwareMap map;
  MappedDevice d;
  d.id = "ati-netft";
  d.address = "127.0.0.1";
  d.http_port = emulator.address().http_port;
  d.udp_port = emulator.address().udp_port;
  d.calibration_file = file;
  d.calibration_sha256 = sha256_file(file);
  d.calibration_expires = recording::CalendarDay{2999, 1, 1};
  const auto status = [&] {
    map.devices = {d};
    return probe_one("ati-netft", map).status;
  };
  EXPECT_EQ(status(), DeviceStatus::present);
  d.serial = "FT99999";
  EXPECT_EQ(status(), DeviceStatus::wrong_serial);
  d.serial = "FT27462";
  d.calibration_expires = recording::CalendarDay{2020, 1, 1};
  EXPECT_EQ(status(), DeviceStatus::calibration_expired);
  d.calibration_expires.reset();
  d.calibration_sha256 = std::string(64, '0');
  EXPECT_EQ(status(), DeviceStatus::calibration_expired);
  std::filesystem::remove(file);
  EXPECT_EQ(status(), DeviceStatus::calibration_expired);
  d.calibration_file.reset();
  emulator.unplug();
  EXPECT_EQ(status(), DeviceStatus::absent);
}

// Another program may be using what is looked for.
TEST(Probe, ResetsAndCommandsNothing) {
  HardwareMap map;
  map.devices.resize(2);
  MappedDevice &tracker = map.devices[0], &handle = map.devices[1];
  NdiEmulator polaris(60.0, {}, [](double) { return EmulatedPose{}; });
  tracker.id = "ndi-polaris";
  tracker.address = "127.0.0.1";
  tracker.port = polaris.port();
  EXPECT_EQ(probe_one("ndi-polaris", map).status, DeviceStatus::present);
  EXPECT_EQ(polaris.commands(), 0U);
  tracker.address = "/dev/no-such-line";
  EXPECT_EQ(probe_one("ndi-polaris", map).status, DeviceStatus::absent);
  HaplyEmulator service({}, [](double) -> Vec3 { return Vec3::Zero(); });
  handle.id = "haply-inverse3";
  handle.port = service.port();  // no address: on this machine, as it is opened
  EXPECT_EQ(probe_one("haply-inverse3", map).status, DeviceStatus::present);
  EXPECT_EQ(service.messages(), 0U);
}

TEST(HardwareMapFile, SaysWhatIsWrong) {
  const auto path = std::filesystem::temp_directory_path() / fmt::format("touchstone-hw-{}.json", ::getpid());
  const auto complaint = [&](const std::string& device) {
    write_file(path, R"({"schema": "touchstone-hardware/1", "devices": [)" + device + "]}");
    try {
      load_hardware_map(path);
    } catch (const BadData& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(
      complaint(R"({"id": "novint-falcon", "serial": "X", "connected": true, "force_limit_N": 3, "fixture": "bench"})"),
      "accepted");
  EXPECT_EQ(complaint(R"({"id": "novint-falcon", "dead_man": "button:0", "limits": {"friction_N": 0.8}})"), "accepted");
  EXPECT_THAT(complaint(R"({"id": "novint-falcon", "limits": {"frction_N": 0.8}})"), HasSubstr("known: friction_N"));
  EXPECT_THAT(complaint(R"({"id": "novint-falcon", "limits": {"friction_N": 0}})"), HasSubstr("not a positive number"));
  EXPECT_THAT(complaint(R"({"id": "novint-flacon"})"), HasSubstr("known: ati-netft"));
  EXPECT_THAT(complaint(R"({"id": "novint-falcon", "force_limit": 3})"), HasSubstr("force_limit"));
  EXPECT_THAT(complaint(R"({"id": "novint-falcon", "force_limit_N": -1})"), HasSubstr("negative"));
  for (const char* const baud : {"1e300", "57600.7", "-1"})
    EXPECT_THAT(complaint(fmt::format(R"({{"id": "hx711-serial", "baud": {}}})", baud)),
                ::testing::AllOf(HasSubstr("/devices/0/baud"), HasSubstr("whole number")));
  EXPECT_THAT(complaint(R"({"id": "hx711-serial", "value": 1.5})"), HasSubstr("/devices/0/value"));
  EXPECT_THAT(complaint(R"({"id": "ati-netft", "udp_port": 49152.5})"), HasSubstr("a port from 1"));
  EXPECT_THAT(complaint(R"({"id": "ati-netft", "udp_port": 70000})"), HasSubstr("port"));
  std::filesystem::remove(path);
}

DeviceIdentity opened_as(const std::string& id, const std::string& serial) { return {id, serial, "", "", true}; }

TEST(DeviceLock, ASecondRunIsToldWhoHasIt) {
  const auto serial = fmt::format("LOCK{}", ::getpid());
  const DeviceLock first(opened_as("novint-falcon", serial));
  try {
    const DeviceLock second(opened_as("novint-falcon", serial));
    FAIL();
  } catch (const DeviceError& error) {
    EXPECT_EQ(error.device_status(), DeviceStatus::busy);
    EXPECT_THAT(error.what(), HasSubstr(fmt::format("process {}", ::getpid())));
  }
  const DeviceLock other(opened_as("novint-falcon", serial + "-another"));
}

TEST(DeviceLock, OneDeviceHasOneLockByWhicheverIdItIsOpened) {
  const auto serial = fmt::format("FD{}", ::getpid());
  const DeviceLock first(opened_as("force-dimension-omega", serial));
  EXPECT_THROW(DeviceLock{opened_as("force-dimension-delta", serial)}, DeviceError);
}

// A folder that the user names keeps its mode; in the place of the usual one a link, which anybody may lay, is refused.
TEST(DeviceLock, LeavesFoldersAsTheyAre) {
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("touchstone-own-locks-{}", ::getpid());
  std::filesystem::create_directory(folder);
  std::filesystem::permissions(folder, std::filesystem::perms(0700));
  const char* const before = std::getenv("TOUCHSTONE_LOCK_DIR");
  const std::string kept = before != nullptr ? before : "";
  ::setenv("TOUCHSTONE_LOCK_DIR", folder.c_str(), 1);
  { const DeviceLock lock(opened_as("novint-falcon", "MODE")); }
  EXPECT_EQ(std::filesystem::status(folder).permissions(), std::filesystem::perms(0700));
  // Nor is another file overwritten that was given a lock's name.
  write_file(folder / "letter", "its own words");
  std::filesystem::create_hard_link(folder / "letter", folder / "novint-falcon-LETTER.lock");
  EXPECT_THROW(DeviceLock(opened_as("novint-falcon", "LETTER"), 0), DeviceError);
  EXPECT_EQ(read_file(folder / "letter"), "its own words");
  if (before != nullptr) {
    ::setenv("TOUCHSTONE_LOCK_DIR", kept.c_str(), 1);
  } else {
    ::unsetenv("TOUCHSTONE_LOCK_DIR");
  }
  std::filesystem::remove_all(folder);
}

TEST(DeviceLock, TheSameSensorHasOneLockWhateverTheMapSaysOfIt) {
  MappedDevice named, bare;
  named.id = bare.id = "ati-netft";
  named.serial = "FT27462";
  named.address = "localhost";
  bare.address = "127.0.0.1";
  EXPECT_EQ(lock_name(named), lock_name(bare));
  // Two trackers' servers behind one address are two.
  MappedDevice first_server = named, second_server = named;
  first_server.port = 1510;
  second_server.port = 1512;
  EXPECT_NE(lock_name(first_server), lock_name(second_server));
  // A port that is left out is the device's usual one.
  for (const auto& [id, port] :
       {std::pair("ndi-polaris", 8765), {"optitrack", 1510}, {"qualisys", 22223}, {"vrpn", 3883}}) {
    MappedDevice said = bare;
    said.id = id;
    const auto left_out = lock_name(said);
    said.port = port;
    EXPECT_EQ(lock_name(said), left_out) << id;
  }
  named.udp_port = bare.udp_port = 1000 + ::getpid() % 60000;
  const DeviceLock first(named);
  EXPECT_THROW(DeviceLock{bare}, DeviceError);
  bare.udp_port += 1;
  const DeviceLock another(bare);
}

TEST(DeviceLock, ServesEveryUserOfTheMachine) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs to become two users: run as root";
  const auto name = fmt::format("USERS{}", ::getpid());
  // What it does as that user: 0 it had the lock, 1 it was refused.
  const auto as_user = [&](uid_t user, mode_t mask) {
    const pid_t child = ::fork();
    if (child == 0) {
      ::umask(mask);
      if (::setresuid(user, user, user) != 0) ::_exit(9);
      try {
        const DeviceLock lock(opened_as("novint-falcon", name));
        ::_exit(0);
      } catch (const DeviceError&) {
        ::_exit(1);
      }
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return WEXITSTATUS(status);
  };
  EXPECT_EQ(as_user(65533, 022), 0);
  EXPECT_EQ(as_user(65534, 022), 0);
  const auto path = DeviceLock(opened_as("novint-falcon", name)).path();
  std::filesystem::permissions(path, std::filesystem::perms(0644));  // as older versions left them
  EXPECT_EQ(as_user(65534, 022), 0);
  EXPECT_EQ(as_user(65533, 022), 0);
  std::filesystem::remove(path);
}

// In a time namespace CLOCK_BOOTTIME runs 100 s ahead of CLOCK_MONOTONIC, as after a suspend of 100 s.
TEST(MonotonicClock, SeesTheTimeInWhichTheMachineWasSuspended) {
  const pid_t child = ::fork();
  if (child == 0) {
    if (::unshare(CLONE_NEWTIME) != 0) ::_exit(77);
    const int offsets = ::open("/proc/self/timens_offsets", O_WRONLY | O_CLOEXEC);
    constexpr std::string_view ahead = "boottime 100 0";
    if (offsets < 0 || ::write(offsets, ahead.data(), ahead.size()) != static_cast<ssize_t>(ahead.size())) ::_exit(77);
    const pid_t inside = ::fork();  // children live in the new namespace
    if (inside == 0) {
      timespec still{};
      ::clock_gettime(CLOCK_MONOTONIC, &still);
      const double ahead_s = MonotonicClock().now_s() - static_cast<double>(still.tv_sec);
      ::_exit(ahead_s > 99.0 ? 0 : 1);
    }
    int status = 0;
    ::waitpid(inside, &status, 0);
    ::_exit(WEXITSTATUS(status));
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  if (WEXITSTATUS(status) == 77) GTEST_SKIP() << "this machine allows no time namespace";
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST(DeviceLock, IsFreeOnceItsHolderIsKilled) {
  const auto serial = fmt::format("KILL{}", ::getpid());
  const pid_t child = ::fork();
  if (child == 0) {
    const DeviceLock lock(opened_as("novint-falcon", serial));
    ::raise(SIGKILL);
  }
  ::waitpid(child, nullptr, 0);
  EXPECT_NO_THROW(DeviceLock{opened_as("novint-falcon", serial)});
}

TEST(Analysis, NoiseAndDriftAreFoundAtEveryScale) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    Random random(8);
    std::vector<WrenchSample> samples(20000);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      samples[i].wrench.f_N = scale * Vec3(0.01 * random.normal() + 0.002 * static_cast<double>(i) / 1000,
                                           0.02 * random.normal() + 5, 0.03 * random.normal());
    }
    const auto n = noise_floor(samples, 1000);
    EXPECT_NEAR(n.sigma_N.x() / scale, 0.01, 0.0003);
    EXPECT_NEAR(n.sigma_N.z() / scale, 0.03, 0.001);
    EXPECT_NEAR(n.drift_N_per_s.x() / scale, 0.002, 0.0001);
    EXPECT_NEAR(n.allan_N[4] / n.allan_N[0], 0.25, 0.02);  // white noise falls with the root of 16
  }
}

TEST(Analysis, ADriftThatASessionWouldShowFailsTheNoiseFloor) {
  const auto failures = [](double drift_N_per_s) {
    Random random(9);
    std::vector<WrenchSample> samples(5000);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      samples[i].sequence = i;
      samples[i].t_s = 1e-3 * static_cast<double>(i);
      samples[i].wrench.f_N =
          Vec3(0.01 * random.normal(), 0.01 * random.normal(), 0.01 * random.normal() + drift_N_per_s * samples[i].t_s);
    }
    return noise_and_drift(samples, 0.0).failures();
  };
  EXPECT_THAT(failures(0.0), ::testing::IsEmpty());
  EXPECT_THAT(failures(0.001), ::testing::IsEmpty());
  for (const double drift : {1.4, -0.05, 0.006})
    EXPECT_THAT(failures(drift), ::testing::ElementsAre(::testing::HasSubstr("drift_N_per_s"))) << drift;
}

TEST(Analysis, StepOfAFirstOrderSystem) {
  constexpr double tau = 0.01;
  std::vector<double> t, f;
  for (const double x : testing::steps(0, 0.5, 1e-4))
    t.push_back(x), f.push_back(1.0 + (x < 0.1 ? 0.0 : 2.0 * (1 - std::exp(-(x - 0.1) / tau))));
  const auto r = step_response(t, f, 0.1);
  EXPECT_NEAR(r.rise_s, tau * std::log(9.0), 1e-4);
  EXPECT_NEAR(r.delay_s, tau * std::numbers::ln2, 2e-4);
  EXPECT_NEAR(r.bandwidth_Hz, 1 / (2 * std::numbers::pi * tau), 0.2);
  EXPECT_LT(r.overshoot, 1e-6);
}

TEST(Analysis, JitterOscillationAndZWidth) {
  std::vector<double> t;
  for (int i = 0; i < 1000; ++i) t.push_back(1e-3 * i + (i == 500 ? 0.4e-3 : 0.0) + (i >= 800 ? 2.5e-3 : 0.0));
  const auto j = servo_jitter(t, 1e-3, 1e-4, 10);
  EXPECT_EQ(j.missed, 1U);
  EXPECT_NEAR(j.worst_late_s, 2.5e-3, 1e-9);
  EXPECT_EQ(j.histogram.back(), 1U);
  std::vector<double> ringing, calm;
  for (int i = 0; i < 1000; ++i)
    ringing.push_back(1e-3 * std::sin(0.3 * i)), calm.push_back(1e-3 * std::exp(-0.02 * i) * std::sin(0.3 * i));
  EXPECT_TRUE(oscillates(ringing, 1e-4));
  EXPECT_FALSE(oscillates(calm, 1e-4));
  EXPECT_EQ(z_width_N_per_m({100, 200, 400, 800}, {true, true, false, true}), 200.0);
  EXPECT_EQ(z_width_N_per_m({100}, {false}), 0.0);
  EXPECT_DOUBLE_EQ(passive_stiffness_N_per_m(0.5, 1e-3), 1000.0);
}

TEST(Evidence, RefusesNumbersThatAreNone) {
  Evidence e;
  e.device.emulated = true;
  e.measurements = {{"x", std::nan("")}};
  EXPECT_THROW(publish(e), BadData);
}

// Whatever cannot be used, its message ends with what to do about it.
TEST(DeviceErrors, SayWhatToDoNext) {
  for (int status = static_cast<int>(DeviceStatus::absent); status < static_cast<int>(DeviceStatus::invisible);
       ++status) {
    const auto kind = static_cast<DeviceStatus>(status);
    const std::string bare = DeviceError(kind, "/dev/ttyUSB0: Input/output error").what();
    EXPECT_THAT(bare, ::testing::StartsWith("/dev/ttyUSB0: Input/output error; ")) << to_string(kind);
    EXPECT_GT(bare.size(), 50U) << to_string(kind);
  }
  // What says so itself is not told twice.
  EXPECT_STREQ(DeviceError(DeviceStatus::failed, "it hums", "let it cool").what(), "it hums; let it cool");
  EXPECT_STREQ(DeviceError::passed_on(DeviceStatus::failed, "it hums; let it cool").what(), "it hums; let it cool");
}

// A semicolon or a question mark in what a device or the system says is no advice.
TEST(DeviceErrors, AProblemWithASemicolonIsNoAdvice) {
  for (const char* const problem : {"status 3; code 7", "/dev/input/who?: Input/output error"}) {
    const std::string said = DeviceError(DeviceStatus::gone, problem).what();
    EXPECT_THAT(said, ::testing::StartsWith(problem));
    EXPECT_THAT(said, ::testing::EndsWith(std::string(usual_advice(DeviceStatus::gone))));
  }
}

}  // namespace
}  // namespace touchstone::hil
