// The lab's tests of force sensors. Procedures and pictures: docs/how-to/lab.md.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <string_view>

#include "drivers/open_mapped.h"
#include "emulators/netft_emulator.h"
#include "harness/base/random.h"
#include "harness/base/rotations.h"
#include "harness/recording/tool_load.h"
#include "lab/analysis.h"
#include "lab/force_experiments.h"
#include "lab/suite.h"

namespace touchstone::hil {
namespace {

constexpr double gravity_m_per_s2 = 9.80665;

class WrenchSensor : public ::testing::TestWithParam<const char*> {
 protected:
  void open(const Availability& found) {
    const auto map = hardware_map_from_environment();
    const MappedDevice* const mapped = map.find(GetParam());
    fixture_ = mapped != nullptr ? mapped->fixture : "";
    emulated_ = found.emulated;
    if (found.emulated) {
      emulator_ = std::make_unique<NetFtEmulator>(1000, NetFtFaults{}, [this](double t) {
        const Vec3 noise(random_.normal() + 3e-3 * t, random_.normal(), random_.normal());
        return Wrench{0.003 * noise + Vec3(load_x_N_, load_y_N_, load_z_N_), Vec3::Zero()};
      });
      source_ = open_netft(emulator_->address(), 2.0, true);
    } else {
      MappedDevice device = mapped != nullptr ? *mapped : MappedDevice{};
      device.id = GetParam();
      lock_ = std::make_unique<DeviceLock>(device);
      source_ = open_force(device);
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
  Wrench mean(double seconds) {
    measure(emulated_ ? 0.05 : 1.0);  // what was on its way, also where this process was not scheduled for a while
    for (std::vector<WrenchSample> old(1024); source_->read(old, MonotonicClock().now_s()) > 0;) {
    }
    const auto samples = measure(seconds);
    Wrench w;
    for (const auto& s : samples) {
      w.f_N += s.wrench.f_N / static_cast<double>(samples.size());
      w.torque_Nm += s.wrench.torque_Nm / static_cast<double>(samples.size());
    }
    if (samples.empty()) throw DeviceError(DeviceStatus::timed_out, "the sensor sent nothing");
    return w;
  }
  void conclude(const Finding& finding, const std::vector<WrenchSample>& samples = {}) {
    Evidence e;
    e.test = GetParam();
    e.take(finding);
    e.device = source_->identity();
    e.fixture = fixture_;
    e.counters = source_->counters();
    for (const auto& failure : finding.failures()) ADD_FAILURE() << failure;
    publish(e, samples);
  }
  void put_on(const Vec3& load_N) { load_x_N_ = load_N.x(), load_y_N_ = load_N.y(), load_z_N_ = load_N.z(); }

  Random random_{1};
  std::atomic<double> load_x_N_{0.0}, load_y_N_{0.0}, load_z_N_{0.0};  // on the emulated sensor
  bool emulated_ = false;
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
  const auto counters = source_->counters();
  const Finding finding = noise_and_drift(samples, static_cast<double>(counters.lost + counters.malformed));
  conclude(finding, samples);
}

TEST_P(WrenchSensor, KnownWeight) {
  const auto found = availability_for(GetParam(), Needs::person);
  TOUCHSTONE_JUDGE(found);
  const char* const text = std::getenv("TOUCHSTONE_HIL_WEIGHT_KG");
  const double mass = text != nullptr ? std::atof(text) : 0.1;
  ASSERT_GT(mass, 0.0) << "TOUCHSTONE_HIL_WEIGHT_KG is not a mass: " << text;
  open(found);
  const Vec3 before = mean(found.emulated ? 0.3 : 5.0).f_N;
  if (found.emulated) {
    put_on(mass * gravity_m_per_s2 * Vec3::UnitZ());
  } else {
    fmt::print(stderr, "--> hang {} kg on the tip without touching it; 20 s\n", mass);
    ::sleep(20);
  }
  const double weight = (mean(found.emulated ? 0.3 : 5.0).f_N - before).norm(), expected = mass * gravity_m_per_s2;
  Finding finding;
  finding.test = "known-weight";
  finding.measurements = {{"weight_applied_N", expected}, {"weight_measured_N", weight}};
  finding.limits = {{"weight_measured_N", 0.99 * expected - 0.01, 1.01 * expected + 0.01}};  // 1 %, and the noise
  conclude(finding);
}

TEST_P(WrenchSensor, GravityOverOrientations) {
  const auto found = availability_for(GetParam(), Needs::person);
  TOUCHSTONE_JUDGE(found);
  open(found);
  constexpr double emulated_mass_kg = 0.05;
  std::vector<recording::StaticPose> poses;
  std::vector<std::string> names;
  for (const int sign : {1, -1}) {
    for (int axis = 2; axis >= 0; --axis) {
      const Vec3 up = sign * Vec3::Unit(axis);
      names.push_back(fmt::format("{}{}", sign > 0 ? '+' : '-', "xyz"[axis]));
      if (found.emulated) {
        put_on(-emulated_mass_kg * gravity_m_per_s2 * up);
      } else {
        fmt::print(stderr, "--> lay the block so that the sensor's {} points up, hands off; 15 s\n", names.back());
        ::sleep(15);
      }
      poses.push_back({shortest_rotation(up, Vec3::UnitZ()), mean(found.emulated ? 0.2 : 3.0)});
    }
  }
  const Vec3 gravity(0, 0, -gravity_m_per_s2);
  const auto tool = identify_tool(poses, gravity, "gravity over orientations");
  Finding finding;
  finding.test = "gravity";
  finding.measurements = {{"tool_mass_kg", tool.load.mass_kg},
                          {"tool_mass_sigma_kg", tool.mass_sigma_kg},
                          {"force_residual_N", tool.fit.force_component_N},
                          {"force_held_out_N", tool.held_out.force_component_N},
                          {"torque_residual_Nm", tool.fit.torque_component_Nm}};
  const double weight = tool.load.mass_kg * gravity_m_per_s2;
  finding.limits = {{"force_held_out_N", 0.0, 0.02 + 0.05 * weight}, {"tool_mass_kg", 3.0 * tool.mass_sigma_kg}};
  if (found.emulated) finding.limits.push_back({"tool_mass_kg", 0.99 * emulated_mass_kg, 1.01 * emulated_mass_kg});
  Curve residual{"length of the force residual", {}, {}, true};
  for (std::size_t i = 0; i < poses.size(); ++i) {
    residual.x.push_back(static_cast<double>(i + 1));
    residual.y.push_back((poses[i].measured.f_N - tool_wrench(tool.load, poses[i].q_WS, gravity).f_N).norm());
  }
  finding.pictures = {{"Gravity over orientations", "orientation [1]", "residual [N]", {residual}}};
  conclude(finding);
}

INSTANTIATE_TEST_SUITE_P(Lab, WrenchSensor, ::testing::Values("ati-netft", "ati-nano17-daq"), [](const auto& tested) {
  std::string name = tested.param;
  std::erase(name, '-');
  return name;
});

}  // namespace
}  // namespace touchstone::hil
