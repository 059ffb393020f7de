// A haptic device, a force sensor and a person's hand in simulation, on a clock of their own: the lab's experiments run
// against it in no time, whatever else the machine does, and with faults whose effect is known. All results are
// emulated. An unplugged device throws DeviceError, as a driver does.
//   The device: m x'' = F_motor + F_hand - b x' - f_c sign(x') along x; the motor follows its command through a delay
// and a first-order lag, the encoder counts. Stiff contact with a sampled wall then behaves as Colgate and Schenkel
// (1997) say: passive for K T / 2 + |B| < b.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "devices/interfaces.h"
#include "harness/base/random.h"
#include "safety/dead_man.h"

namespace touchstone::hil {

struct SimulatedHandle {
  std::string id = "novint-falcon";  // of the device table
  double mass_kg = 0.1;
  double damping_N_s_per_m = 0.8;
  double friction_N = 0.05;
  double motor_lag_s = 1e-3;  // first order: 159 Hz
  double delay_s = 0.5e-3;    // from command to motor
  double encoder_m = 20e-6;
  double sensor_rate_Hz = 5000.0;
  double sensor_noise_N = 0.003;
};

// What is wrong with the device, on top.
struct SimulatedFaults {
  double force_gain = 1.0;
  double added_latency_s = 0.0;
  double added_friction_N = 0.0;
  double added_lag_s = 0.0;
  double jitter_s = 0.0;        // now and then the servo loop wakes up that much late
  double release_at_s = 1e300;  // the dead-man is let go
  double unplug_at_s = 1e300;   // the device goes away
  double sensor_silent_at_s = 1e300;
};

// What the hand does with the handle.
enum class Hand {
  clamped,  // fixed to the force sensor
  moves,    // leads it along a given path, with the sensor between hand and handle
  presses,  // a light passive grip that presses it along -x with 0.5 N
};

class SimulatedBench {
 public:
  explicit SimulatedBench(const SimulatedFaults& faults = {}, const SimulatedHandle& handle = {});
  ~SimulatedBench();
  SimulatedBench(const SimulatedBench&) = delete;
  SimulatedBench& operator=(const SimulatedBench&) = delete;

  [[nodiscard]] Clock& clock();
  [[nodiscard]] HapticDevice& device();
  [[nodiscard]] WrenchSource& sensor();
  [[nodiscard]] DeadMan& dead_man();

  void clamp();
  // x of time since now, in m; twice differentiable.
  void move_along(std::function<double(double)> x_m);
  // From `x_m` above a wall at x = 0.
  void press_from(double x_m);
  // What the motors apply now.
  [[nodiscard]] Vec3 motor_N() const;

  struct World;

 private:
  std::unique_ptr<World> world_;
};

}  // namespace touchstone::hil
