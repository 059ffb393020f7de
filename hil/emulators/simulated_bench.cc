#include "emulators/simulated_bench.h"

#include <algorithm>
#include <cmath>
#include <deque>

namespace touchstone::hil {

struct SimulatedBench::World {
  static constexpr double step_s = 20e-6;
  static constexpr double grip_damping_N_s_per_m = 0.4, grip_press_N = 0.5;

  World(const SimulatedFaults& f, const SimulatedHandle& h) : handle(h), faults(f) {}

  SimulatedHandle handle;
  SimulatedFaults faults;
  Random random{20060919};
  double now_s = 1000.0;  // far from 0, as a monotonic clock is
  double simulated_s = now_s;
  Hand hand = Hand::clamped;
  std::function<double(double)> path;
  double path_start_s = 0.0;
  double x_m = 0.0, v_m_per_s = 0.0, hand_N = 0.0;
  Vec3 motor_N = Vec3::Zero();
  std::deque<std::pair<double, Vec3>> commands;  // when it reaches the motor, and what
  Vec3 at_motor_N = Vec3::Zero();
  std::deque<WrenchSample> samples;
  std::uint64_t sequence = 0;
  double next_sample_s = now_s;
  bool sensor_on = true;
  double start_s = now_s;

  [[nodiscard]] double age_s() const { return now_s - start_s; }

  double path_at(double t) const { return path(t - path_start_s); }

  void step(double dt) {
    while (!commands.empty() && commands.front().first <= simulated_s)
      at_motor_N = commands.front().second, commands.pop_front();
    // Exact over the step for a constant command.
    const double lag = handle.motor_lag_s + faults.added_lag_s;
    motor_N += (1.0 - std::exp(-dt / lag)) * (faults.force_gain * at_motor_N - motor_N);
    const double friction = handle.friction_N + faults.added_friction_N, b = handle.damping_N_s_per_m;
    simulated_s += dt;
    if (hand == Hand::moves) {
      constexpr double h = 1e-4;
      const double before = path_at(simulated_s - h), here = path_at(simulated_s), after = path_at(simulated_s + h);
      x_m = here;
      v_m_per_s = (after - before) / (2 * h);
      const double a = (after - 2 * here + before) / (h * h);
      hand_N = handle.mass_kg * a + b * v_m_per_s +
               (v_m_per_s > 0   ? friction
                : v_m_per_s < 0 ? -friction
                                : 0.0) -
               motor_N.x();
    } else if (hand == Hand::presses) {
      // Semi-implicit; Coulomb friction at most stops the handle within the step.
      double v =
          v_m_per_s + dt / handle.mass_kg * (motor_N.x() - grip_press_N - (b + grip_damping_N_s_per_m) * v_m_per_s);
      const double most = dt * friction / handle.mass_kg;
      v = std::abs(v) <= most ? 0.0 : v - std::copysign(most, v);
      v_m_per_s = v;
      x_m += dt * v;
    } else {
      v_m_per_s = 0.0;
    }
    if (simulated_s >= next_sample_s) {
      next_sample_s += 1.0 / handle.sensor_rate_Hz;
      const Vec3 noise = handle.sensor_noise_N * Vec3(random.normal(), random.normal(), random.normal());
      if (sensor_on && age_s() < faults.sensor_silent_at_s) {
        WrenchSample s;
        s.t_s = simulated_s;
        s.sequence = ++sequence;
        s.wrench.f_N = noise + (hand == Hand::moves     ? Vec3(hand_N, 0, 0)
                                : hand == Hand::clamped ? motor_N
                                                        : Vec3(0, 0, 0));
        samples.push_back(s);
      }
    }
  }

  void advance() {
    while (simulated_s + step_s <= now_s) step(step_s);
  }
  [[nodiscard]] double encoder() const { return std::round(x_m / handle.encoder_m) * handle.encoder_m; }

  struct WorldClock final : Clock {
    explicit WorldClock(World& w) : world(w) {}
    [[nodiscard]] double now_s() const override { return world.now_s; }
    void sleep_until(double t_s) override {
      if (t_s <= world.now_s) {
        world.now_s += 1e-5;  // a loop that is behind takes time too
      } else {
        world.now_s = t_s;
        if (world.faults.jitter_s > 0.0 && world.random.uniform() < 0.05) world.now_s += world.faults.jitter_s;
      }
      world.advance();
    }
    World& world;
  } clock{*this};

  struct Device final : HapticDevice {
    explicit Device(World& w) : world(w), who{w.handle.id, "EMU-SIMULATED", "simulated", "", true} {}
    [[nodiscard]] const DeviceIdentity& identity() const override { return who; }
    DeviceState exchange(const Vec3& f_W_N, double) override {
      if (world.age_s() > world.faults.unplug_at_s)
        throw DeviceError(DeviceStatus::gone, "the simulated device was unplugged");
      world.commands.emplace_back(world.now_s + world.handle.delay_s + world.faults.added_latency_s, f_W_N);
      DeviceState state;
      state.t_s = world.now_s;
      state.p_W_m.x() = world.encoder();
      // From the encoder over a few ticks, as real devices do.
      if (state.t_s > last_s) {
        velocity += 0.2 * ((state.p_W_m.x() - last_m) / (state.t_s - last_s) - velocity);
        last_m = state.p_W_m.x(), last_s = state.t_s;
      }
      state.v_W_m_per_s.x() = velocity;
      return state;
    }
    bool zero_force() noexcept override {
      world.commands.clear();
      world.at_motor_N.setZero();
      return world.age_s() <= world.faults.unplug_at_s;
    }
    [[nodiscard]] double watchdog_s() const override { return 0.02; }
    [[nodiscard]] bool calibrated() const override { return true; }
    World& world;
    DeviceIdentity who;
    double last_m = 0.0, last_s = 0.0, velocity = 0.0;
  } device{*this};

  struct Sensor final : WrenchSource {
    explicit Sensor(World& w) : world(w), who{"ati-netft", "EMU-SIMULATED", "simulated", "", true} {}
    [[nodiscard]] const DeviceIdentity& identity() const override { return who; }
    void start() override { world.sensor_on = true; }
    void stop() noexcept override { world.sensor_on = false; }
    std::size_t read(std::span<WrenchSample> out, double deadline_s) override {
      if (world.samples.empty() && deadline_s > world.now_s) {
        world.now_s = deadline_s;
        world.advance();
      }
      const std::size_t n = std::min(out.size(), world.samples.size());
      std::copy_n(world.samples.begin(), n, out.begin());
      world.samples.erase(world.samples.begin(), world.samples.begin() + static_cast<std::ptrdiff_t>(n));
      received += n;
      return n;
    }
    [[nodiscard]] StreamCounters counters() const override { return {received, 0, 0, 0, 0, 0}; }
    World& world;
    DeviceIdentity who;
    std::uint64_t received = 0;
  } sensor{*this};

  struct Held final : DeadMan {
    explicit Held(World& w) : world(w) {}
    bool held(double, const DeviceState&) noexcept override { return world.age_s() < world.faults.release_at_s; }
    [[nodiscard]] std::string instruction() const override { return "hold the simulated switch"; }
    World& world;
  } dead_man{*this};
};

SimulatedBench::SimulatedBench(const SimulatedFaults& faults, const SimulatedHandle& handle)
    : world_(std::make_unique<World>(faults, handle)) {}
SimulatedBench::~SimulatedBench() = default;

Clock& SimulatedBench::clock() { return world_->clock; }
HapticDevice& SimulatedBench::device() { return world_->device; }
WrenchSource& SimulatedBench::sensor() { return world_->sensor; }
DeadMan& SimulatedBench::dead_man() { return world_->dead_man; }

void SimulatedBench::clamp() { world_->hand = Hand::clamped; }
void SimulatedBench::move_along(std::function<double(double)> x_m) {
  world_->hand = Hand::moves;
  world_->path = std::move(x_m);
  world_->path_start_s = world_->now_s;
}
void SimulatedBench::press_from(double x_m) {
  world_->hand = Hand::presses;
  world_->x_m = world_->device.last_m = x_m;
  world_->v_m_per_s = world_->device.velocity = 0.0;
}
Vec3 SimulatedBench::motor_N() const { return world_->motor_N; }

}  // namespace touchstone::hil
