#include "lab/suite.h"

#include <fmt/format.h>

#include <cstdlib>
#include <string_view>

#include "drivers/device_table.h"
#include "drivers/open_mapped.h"
#include "safety/guardian.h"

namespace touchstone::hil {
namespace {

std::string environment(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr ? value : "";
}

MappedDevice mapped_device(const std::string& id) {
  const auto map = hardware_map_from_environment();
  const auto* const mapped = map.find(id);
  MappedDevice device = mapped != nullptr ? *mapped : MappedDevice{};
  device.id = id;
  if (const auto chosen = environment("TOUCHSTONE_HIL_DEAD_MAN"); !chosen.empty()) device.dead_man = chosen;
  return device;
}

}  // namespace

bool operator_present() { return environment("TOUCHSTONE_HIL_OPERATOR") == "1"; }

Availability availability_for(const std::string& device_id, Needs needs) {
  auto found = availability(device_id);
  if (found.decision != Decision::run || found.emulated || needs == Needs::nothing) return found;
  if (!operator_present()) {
    return {Decision::skip, false,
            device_id + ": needs a person at the bench (TOUCHSTONE_HIL_OPERATOR=1); see docs/how-to/lab.md"};
  }
  return needs == Needs::forces ? judge_dead_man(found, mapped_device(device_id).dead_man, true) : found;
}

GuardOptions guard_options(const MappedDevice& mapped) {
  GuardOptions options;
  options.limits.force_N = mapped.force_limit_N;
  // The force step and the pseudo-random sequence jump from end to end of the range within a tick.
  constexpr double ticks_per_s = 1000.0;
  options.limits.slew_N_per_s = 2.0 * mapped.force_limit_N * ticks_per_s;
  options.limits.workspace_W_m = Box3(Vec3::Constant(-0.2), Vec3::Constant(0.2));
  return options;
}

LabStation::LabStation(const std::string& device_id, const Availability& found, bool commands_forces, bool with_sensor)
    : id_(device_id) {
  if (found.emulated) {
    SimulatedHandle handle;
    handle.id = device_id;
    simulated_ = std::make_unique<SimulatedBench>(SimulatedFaults{}, handle);
    bench_ = std::make_unique<Bench>(Bench{simulated_->clock(), simulated_->device()});
    bench_->dead_man = commands_forces ? &simulated_->dead_man() : nullptr;
    bench_->sensor = with_sensor ? &simulated_->sensor() : nullptr;
    bench_->limits.force_N = 3.0;
    bench_->limits.workspace_W_m = Box3(Vec3::Constant(-0.2), Vec3::Constant(0.2));
    return;
  }
  mapped_ = mapped_device(device_id);
  limits_ = lab_limits(mapped_.limits);
  device_ = open_guarded([mapped = mapped_] { return open_handle(mapped); }, guard_options(mapped_));
  bench_ = std::make_unique<Bench>(Bench{clock_, *device_});
  bench_->limits.force_N = mapped_.force_limit_N;
  bench_->limits.workspace_W_m = Box3(Vec3::Constant(-0.2), Vec3::Constant(0.2));
  bench_->tell = [](const std::string& text) { fmt::print(stderr, "--> {}\n", text); };
  if (with_sensor) {
    for (const KnownDevice* const known : known_devices()) {
      const std::string id(known->id);
      if (sensor_ || known->open_force == nullptr || known->one_axis || availability(id).decision != Decision::run)
        continue;
      const auto sensor = mapped_device(id);
      sensor_lock_ = std::make_unique<DeviceLock>(sensor);
      sensor_ = open_force(sensor);
    }
    if (!sensor_)
      throw DeviceError(
          DeviceStatus::absent,
          device_id + ": this test needs a force sensor beside the device: connect one in the hardware map");
    sensor_->start();
    bench_->sensor = sensor_.get();
  }
  if (commands_forces) {
    if (!(mapped_.force_limit_N > 0.0))
      throw UsageError(device_id +
                       ": the hardware map gives no force_limit_N: nothing may be commanded; state the largest force "
                       "that a test may command");
    dead_man_ = open_dead_man(mapped_.dead_man);
    bench_->dead_man = dead_man_.get();
  }
  stop_ = std::make_unique<StopSignal>();
  bench_->stop = [this] { return stop_->asked(); };
}

void LabStation::conclude(const Finding& finding) {
  Evidence e;
  e.test = id_;
  e.take(finding);
  e.device = bench_->device.identity();
  e.fixture = mapped_.fixture;
  if (bench_->sensor != nullptr) {
    const auto& s = bench_->sensor->identity();
    e.sensor = fmt::format("{} serial {}{}", s.id, s.serial, s.calibration.empty() ? "" : ", " + s.calibration);
    e.counters = bench_->sensor->counters();
  }
  if (bench_->dead_man != nullptr) e.dead_man = bench_->dead_man->instruction();
  for (const auto& failure : finding.failures()) ADD_FAILURE() << failure;
  publish(e);
}

}  // namespace touchstone::hil
