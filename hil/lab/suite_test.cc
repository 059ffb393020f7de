// The lab's tests. On hardware: label `hil`; without it each is skipped with its reason, or fails where the device was
// promised. With TOUCHSTONE_HIL_EMULATED=1 the same program runs against emulators and says so in every result.
// Procedures and pictures: docs/hil.md. Tests that need a person at the bench run with TOUCHSTONE_HIL_OPERATOR=1 only.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string_view>
#include <vector>

#include "harness/base/random.h"
#include "hil/devices/device_lock.h"
#include "hil/drivers/comedi_daq.h"
#include "hil/drivers/falcon.h"
#include "hil/drivers/netft.h"
#include "hil/drivers/vendor_devices.h"
#include "hil/emulators/haptic_emulator.h"
#include "hil/emulators/netft_emulator.h"
#include "hil/lab/analysis.h"
#include "hil/lab/availability.h"
#include "hil/lab/evidence.h"
#include "hil/safety/force_supervisor.h"
#include "hil/safety/guardian.h"

namespace touchstone::hil {
namespace {

bool operator_present() {
  const char* const value = std::getenv("TOUCHSTONE_HIL_OPERATOR");
  return value != nullptr && std::string_view(value) == "1";
}

// Runs, skips or fails by the rules; leaves `found` filled where the test runs.
#define TOUCHSTONE_REQUIRE_DEVICE(found, id)                          \
  const Availability found = availability(id);                        \
  if (found.decision == Decision::skip) GTEST_SKIP() << found.reason; \
  ASSERT_NE(found.decision, Decision::fail) << found.reason

class WrenchSensor : public ::testing::TestWithParam<const char*> {
 protected:
  void open(const Availability& found) {
    const auto map = hardware_map_from_environment();
    const MappedDevice* const mapped = map.find(GetParam());
    fixture_ = mapped != nullptr ? mapped->fixture : "";
    if (found.emulated) {
      emulator_ = std::make_unique<NetFtEmulator>(1000, NetFtFaults{}, [this](double t) {
        return Wrench{
            Vec3(0.003 * random_.normal() + 1e-5 * t, 0.003 * random_.normal(), 0.003 * random_.normal() + load_N_),
            Vec3::Zero()};
      });
      source_ = open_netft(emulator_->address(), 2.0, true);
    } else {
      lock_ = std::make_unique<DeviceLock>(GetParam(), mapped != nullptr ? mapped->serial : "");
      if (std::string_view(GetParam()) == "ati-netft") {
        source_ = open_netft({mapped->address, mapped->http_port, mapped->udp_port}, 2.0, false);
      } else {
        source_ = open_comedi_ati({mapped->address.empty() ? "/dev/comedi0" : mapped->address, mapped->library,
                                   *mapped->calibration_file, mapped->serial, 5000.0, false});
      }
    }
    source_->start();
  }
  std::vector<WrenchSample> measure(double seconds) {
    MonotonicClock clock;
    const double until = clock.now_s() + seconds;
    std::vector<WrenchSample> all, some(1024);
    while (clock.now_s() < until) {
      const auto n = source_->read(some, std::min(until, clock.now_s() + 0.5));
      all.insert(all.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(n));
    }
    return all;
  }
  Evidence evidence(const std::string& test) const {
    Evidence e;
    e.test = test + "-" + GetParam();
    e.device = source_->identity();
    e.fixture = fixture_;
    e.counters = source_->counters();
    return e;
  }
  Random random_{1};
  std::atomic<double> load_N_{0.0};
  std::unique_ptr<NetFtEmulator> emulator_;
  std::unique_ptr<DeviceLock> lock_;
  std::unique_ptr<WrenchSource> source_;
  std::string fixture_;
};

TEST_P(WrenchSensor, NoiseFloorAndBiasDrift) {
  TOUCHSTONE_REQUIRE_DEVICE(found, GetParam());
  open(found);
  const auto samples = measure(found.emulated ? 1.0 : 60.0);
  ASSERT_GT(samples.size(), 100U);
  const double rate = static_cast<double>(samples.back().sequence - samples.front().sequence) /
                      (samples.back().t_s - samples.front().t_s);
  const auto noise = noise_floor(samples, rate);
  auto e = evidence("noise-floor");
  e.measurements = {{"rate_Hz", rate},
                    {"noise_fx_N", noise.sigma_N.x()},
                    {"noise_fy_N", noise.sigma_N.y()},
                    {"noise_fz_N", noise.sigma_N.z()},
                    {"drift_N_per_s", noise.drift_N_per_s.norm()},
                    {"lost", static_cast<double>(e.counters.lost)}};
  publish(e, samples);
  // A dead channel is quieter than any real one; a loose cable is louder.
  EXPECT_GT(noise.sigma_N.minCoeff(), 0.0);
  EXPECT_LT(noise.sigma_N.maxCoeff(), 0.1);
  EXPECT_EQ(e.counters.lost + e.counters.malformed, 0U);
}

TEST_P(WrenchSensor, KnownWeight) {
  TOUCHSTONE_REQUIRE_DEVICE(found, GetParam());
  if (!found.emulated && !operator_present())
    GTEST_SKIP() << GetParam() << ": needs a person who hangs the weight on (TOUCHSTONE_HIL_OPERATOR=1)";
  const char* const text = std::getenv("TOUCHSTONE_HIL_WEIGHT_KG");
  const double mass = text != nullptr ? std::atof(text) : 0.1;
  open(found);
  const auto mean = [&] {
    const auto samples = measure(found.emulated ? 0.3 : 5.0);
    Vec3 f = Vec3::Zero();
    for (const auto& s : samples) f += s.wrench.f_N / static_cast<double>(samples.size());
    return f;
  };
  const Vec3 before = mean();
  if (found.emulated) {
    load_N_ = mass * 9.80665;
    measure(0.05);
  } else {
    fmt::print(stderr, "Hang {} kg on the tip without touching it; 20 s ...\n", mass);
    ::sleep(20);
  }
  const double weight = (mean() - before).norm();
  auto e = evidence("known-weight");
  e.measurements = {{"weight_applied_N", mass * 9.80665}, {"weight_measured_N", weight}};
  publish(e);
  EXPECT_NEAR(weight, mass * 9.80665, 0.01 * mass * 9.80665 + 0.01);  // ATI: 1 % of the load, and the noise
}

INSTANTIATE_TEST_SUITE_P(Lab, WrenchSensor, ::testing::Values("ati-netft", "ati-nano17-daq"), [](const auto& tested) {
  std::string name = tested.param;
  std::erase(name, '-');
  return name;
});

class Haptic : public ::testing::TestWithParam<const char*> {
 protected:
  void open(const Availability& found) {
    const auto map = hardware_map_from_environment();
    const MappedDevice* const mapped = map.find(GetParam());
    if (found.emulated) {
      file_ = std::filesystem::temp_directory_path() / fmt::format("touchstone-lab-{}-{}", ::getpid(), GetParam());
      plant_ = std::make_unique<EmulatedHapticPlant>(file_, 0.0);
      device_ = open_guarded([this] { return open_emulated_haptic(file_); }, {});
      limit_N_ = 1.0;
      return;
    }
    lock_ = std::make_unique<DeviceLock>(GetParam(), mapped != nullptr ? mapped->serial : "");
    limit_N_ = mapped != nullptr ? mapped->force_limit_N : 0.0;
    const MappedDevice settings = mapped != nullptr ? *mapped : MappedDevice{};
    device_ = open_guarded(
        [settings, id = std::string_view(GetParam())]() -> std::unique_ptr<HapticDevice> {
          VendorDeviceOptions vendor;
          vendor.library = settings.library;
          vendor.serial = settings.serial;
          if (id == "novint-falcon") {
            FalconOptions options;
            options.serial = settings.serial;
            options.firmware = settings.firmware;
            return open_falcon(options);
          }
          if (id == "3ds-touch") return open_openhaptics(vendor);
          return open_force_dimension(vendor);
        },
        {});
  }
  // Servo loop at 1 kHz for `seconds`; what(state, t) is the wanted force. Returns the times of the exchanges.
  template <class Wanted>
  std::vector<double> servo(double seconds, ForceSupervisor& supervisor, const Wanted& wanted,
                            std::vector<double>* along = nullptr) {
    const ForceGuard guard(*device_);
    MonotonicClock clock;
    ForceSupervisor::Input in;
    in.dead_man_held = true;
    in.state.t_s = clock.now_s();
    const double start = clock.now_s();
    std::vector<double> times;
    for (std::size_t i = 0; i < static_cast<std::size_t>(seconds * 1000); ++i) {
      clock.sleep_until(start + 1e-3 * static_cast<double>(i));
      in.now_s = clock.now_s();
      in.calibrated = device_->calibrated();
      in.wanted_W_N = wanted(in.state, in.now_s - start);
      in.state = device_->exchange(supervisor.allow(in), in.now_s + patience_s());
      times.push_back(in.state.t_s);
      if (along != nullptr) along->push_back(in.state.p_W_m.x());
    }
    return times;
  }
  // An emulator on a busy machine may be late without any harm; a device may not.
  double patience_s() const { return device_->identity().emulated ? 5.0 : 0.1; }
  SafetyLimits limits() const {
    SafetyLimits l;
    l.force_N = limit_N_;
    l.workspace_W_m = Box3(Vec3::Constant(-0.2), Vec3::Constant(0.2));
    l.stale_s = patience_s();
    return l;
  }
  Evidence evidence(const std::string& test) const {
    Evidence e;
    e.test = test + "-" + GetParam();
    e.device = device_->identity();
    return e;
  }
  std::filesystem::path file_;
  std::unique_ptr<EmulatedHapticPlant> plant_;
  std::unique_ptr<DeviceLock> lock_;
  std::unique_ptr<HapticDevice> device_;
  double limit_N_ = 0.0;
};

TEST_P(Haptic, ServoJitter) {
  TOUCHSTONE_REQUIRE_DEVICE(found, GetParam());
  open(found);
  ForceSupervisor supervisor(limits());
  const auto times =
      servo(found.emulated ? 0.5 : 60.0, supervisor, [](const DeviceState&, double) { return Vec3(0, 0, 0); });
  const auto jitter = servo_jitter(times, 1e-3, 50e-6, 40);
  auto e = evidence("servo-jitter");
  e.measurements = {{"period_mean_s", jitter.mean_s},
                    {"late_p99_s", jitter.p99_late_s},
                    {"late_worst_s", jitter.worst_late_s},
                    {"missed", static_cast<double>(jitter.missed)}};
  publish(e);
  std::uint64_t counted = 0;
  for (const auto n : jitter.histogram) counted += n;
  EXPECT_EQ(counted, times.size() - 1);
  // Limits are held only where the run was scheduled for it.
  if (scheduling() != "SCHED_OTHER" && !found.emulated) {
    EXPECT_LT(jitter.p99_late_s, 0.5e-3);
  }
}

TEST_P(Haptic, StiffnessSweep) {
  TOUCHSTONE_REQUIRE_DEVICE(found, GetParam());
  if (!found.emulated && !operator_present())
    GTEST_SKIP() << GetParam() << ": needs a person who holds the handle against the wall (TOUCHSTONE_HIL_OPERATOR=1)";
  open(found);
  std::vector<double> stiffness;
  std::vector<bool> stable;
  for (double k = 100; k <= (found.emulated ? 400 : 3200); k *= std::numbers::sqrt2) {
    ForceSupervisor supervisor(limits());
    std::vector<double> along;
    servo(
        found.emulated ? 0.1 : 3.0, supervisor,
        [k](const DeviceState& s, double) { return Vec3(s.p_W_m.x() < 0 ? -k * s.p_W_m.x() : 0.0, 0, 0); }, &along);
    stiffness.push_back(k);
    stable.push_back(!oscillates(along, 5e-4));
    if (!stable.back() || supervisor.tripped() != Trip::none) break;
  }
  auto e = evidence("stiffness-sweep");
  e.measurements = {{"z_width_N_per_m", z_width_N_per_m(stiffness, stable)}};
  publish(e);
  EXPECT_GE(z_width_N_per_m(stiffness, stable), 100.0);
}

TEST_P(Haptic, LetsGoWhenTheProgramStops) {
  TOUCHSTONE_REQUIRE_DEVICE(found, GetParam());
  open(found);
  ForceSupervisor supervisor(limits());
  servo(0.1, supervisor, [this](const DeviceState&, double) { return Vec3(0.5 * limit_N_, 0, 0); });
  EXPECT_TRUE(device_->zero_force());
  if (plant_) {
    EXPECT_EQ(plant_->applied_N(), Vec3(0, 0, 0));
  }
}

INSTANTIATE_TEST_SUITE_P(Lab, Haptic, ::testing::Values("novint-falcon", "force-dimension-omega", "3ds-touch"),
                         [](const auto& tested) {
                           std::string name = tested.param;
                           for (char& c : name) c = c == '-' ? '_' : c;
                           return name;
                         });

}  // namespace
}  // namespace touchstone::hil
