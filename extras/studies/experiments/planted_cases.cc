#include "experiments/planted_cases.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "harness/base/random.h"
#include "harness/perception/filters/weber_law.h"
#include "harness/perception/judge/slow_channels.h"
#include "harness/perception/judge/vibration_scale.h"
#include "synthetic/trajectories/tremor.h"

namespace touchstone::experiments {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;
constexpr double air_share = 0.15;      // of the stroke that passes in the air
constexpr double stroke_spread = 0.03;  // between presses
constexpr double rise = 0.3;            // of the stroke that a constant force takes to rise
constexpr double tremor_m = 2e-5;
constexpr double tap_decay_s = 0.015;
constexpr double tap_frequency_Hz = 300.0;
constexpr double tap_speed_m_per_s = 0.05;

// The motion of one hand: depth below the surface and place along x, functions of time.
class Hand {
 public:
  Hand(const PlantedCase& planted, const PlantedSetup& setup, std::uint64_t seed)
      // Who meets the object late presses on until the force is there.
      : stroke_m_(planted.deeper * setup.peak_N / setup.stiffness_N_per_m + planted.late_m),
        beat_Hz_(planted.faster * setup.beat_Hz),
        slide_m_per_s_(setup.sliding_m_per_s),
        tremor_(seed, tremor_m * std::min(1.0, stroke_m_ / 0.005)) {
    Random random(seed);
    for (int i = 0; i < 1000; ++i) scale_.push_back(1.0 + stroke_spread * random.normal());
  }

  [[nodiscard]] double duration_s(double presses) const { return presses / beat_Hz_; }
  [[nodiscard]] double depth_m(double t_s) const {
    const double beats = std::max(0.0, t_s * beat_Hz_);
    const auto press = static_cast<std::size_t>(beats);
    // From air_share of the stroke above the surface to the full stroke below it, a cosine each press.
    const double share = 0.5 * (1.0 - std::cos(two_pi * beats));
    const double stroke = stroke_m_ * scale_[press % scale_.size()];
    const double free = air_share * stroke_m_;
    return -free + (stroke + free) * share + tremor_.first_at(t_s) * share;
  }
  // To and fro along x at an even speed, a turn every two presses, in the air: friction turns round unfelt.
  [[nodiscard]] double x_m(double t_s) const {
    const double period_s = 4.0 / beat_Hz_;
    const double at = t_s / period_s;
    const double share = at - std::floor(at);
    return slide_m_per_s_ * period_s * (share < 0.5 ? share : 1.0 - share);
  }

 private:
  double stroke_m_;
  double beat_Hz_;
  double slide_m_per_s_;
  synthetic::Tremor tremor_;
  std::vector<double> scale_;
};

PlantedCase named(std::string family, std::string name) {
  PlantedCase planted;
  planted.family = std::move(family);
  planted.name = std::move(name);
  return planted;
}

}  // namespace

std::vector<PlantedCase> planted_cases() {
  std::vector<PlantedCase> cases{named("repeat", "repeat")};
  const auto add = [&cases](std::string family, std::string name) -> PlantedCase& {
    cases.push_back(named(std::move(family), std::move(name)));
    return cases.back();
  };
  for (const double share : {0.01, 0.02, 0.05, 0.10, 0.20, 0.60})
    add("softer", fmt::format("softer by {:.0f} %", 100.0 * share)).softer = share;
  for (const double f : {50.0, 100.0, 200.0, 400.0, 800.0}) {
    for (const double times : {0.3, 1.0, 3.0, 30.0}) {
      auto& own = add("buzz", fmt::format("buzz at {:.0f} Hz, {:.2g} of the threshold", f, times));
      own.buzz_Hz = f;
      own.buzz_N = times * perception::Thresholds{}.vibration_force_N(f);
    }
  }
  for (const double force : {0.2, 1.0, 3.0, 5.0})
    add("sideways", fmt::format("{:.1f} N sideways", force)).sideways_N = force;
  for (const double degrees : {5.0, 25.6, 75.0})
    add("direction", fmt::format("force turned by {:.3g} degrees", degrees)).tilt_rad =
        degrees / 180.0 * std::numbers::pi;
  for (const double mm : {1.0, 3.0, 12.0})
    add("late onset", fmt::format("contact {:.1f} mm late", mm)).late_m = 1e-3 * mm;
  for (const double ms : {1.0, 10.0, 30.0, 60.0})
    add("delay", fmt::format("force {:.0f} ms behind motion", ms)).delay_s = 1e-3 * ms;
  add("other hand", "recorded 100 ms later").recording_delay_s = 0.1;
  add("other hand", "pressed 1.5 times as deep").deeper = 1.5;
  add("other hand", "pressed 0.7 times as deep").deeper = 0.7;
  add("other hand", "pressed twice as fast").faster = 2.0;
  add("other hand", "1.5 times as long").longer = 1.5;
  add("noise", "sensor noise three times as large").noisier = 3.0;
  for (const double times : {0.3, 5.0, 30.0})
    add("texture", fmt::format("texture of 0.5 mm, {:.2g} of the threshold", times)).texture_N = times;
  for (const double quantum : {0.001, 0.2, 0.5})
    add("quantised", fmt::format("force in steps of {:.3g} N", quantum)).quantum_N = quantum;
  for (const double mu : {0.02, 0.2, 0.6}) add("sticking", fmt::format("friction of {:.2g}", mu)).friction = mu;
  for (const double force : {0.0005, 0.05, 0.5})
    add("tap", fmt::format("300 Hz burst of {:.2g} N at contact", force)).tap_N = force;
  // A texture's strength is in thresholds at the frequency that the sliding makes of its wavelength.
  for (auto& own : cases) {
    if (own.family != "texture") continue;
    const double f = PlantedSetup{}.sliding_m_per_s / own.texture_wavelength_m;
    own.texture_N *= perception::Thresholds{}.vibration_force_N(f);
  }
  return cases;
}

double planted_d_prime(const PlantedCase& planted, const PlantedSetup& setup,
                       const perception::Thresholds& thresholds) {
  const perception::NoticeableSteps steps(thresholds.force);
  const auto apart = [&](double a_N, double b_N) { return std::abs(steps(a_N) - steps(b_N)); };
  const double deepest_m = setup.peak_N / setup.stiffness_N_per_m;
  double force = 0.0;
  const double rate = planted.delay_s / thresholds.delay_s;
  double direction = 0.0;
  double friction = 0.0;
  // Over the depths that a press spends time at.
  for (int tenth = 2; tenth <= 10; ++tenth) {
    const double f = setup.peak_N * tenth / 10.0;
    const double rendered = f * (1.0 - planted.softer);
    const double magnitude = std::hypot(rendered, planted.sideways_N * tenth / 10.0);
    force = std::max(force, perception::force_at_depth_jnd(apart(magnitude, f), f, magnitude, 1.0, thresholds));
    friction =
        std::max(friction, perception::friction_jnd(0.0, planted.friction * f, planted.friction * f, f, thresholds));
  }
  direction = (planted.tilt_rad + (planted.sideways_N > 0.0 ? std::atan2(planted.sideways_N, setup.peak_N) : 0.0)) /
              thresholds.direction_rad;
  const double slope = std::hypot(1.0 - planted.softer, planted.sideways_N / setup.peak_N);  // of the magnitude
  const double stiffness = std::abs(std::log(slope)) / std::log1p(thresholds.stiffness_fraction);
  const auto vibration = [&](double amplitude_N, double f_Hz) {
    return std::pow(amplitude_N / thresholds.vibration_force_N(f_Hz), 2);
  };
  const perception::VibrationScale scale(thresholds);
  double power = 0.0;  // over that of the threshold
  if (planted.buzz_N > 0.0) power = vibration(planted.buzz_N, planted.buzz_Hz);
  if (planted.texture_N > 0.0) {
    power = vibration(planted.texture_N, setup.sliding_m_per_s / planted.texture_wavelength_m);
  }
  if (planted.quantum_N > 0.0) {
    // A saw tooth of the step's height: harmonics h of amplitude q / (pi h), at h times the rate of steps, which goes
    // with the speed over the stroke; what lies between 20 Hz and half the rate is felt.
    constexpr int moments = 200;
    for (int m = 0; m < moments; ++m) {
      const double angle = std::numbers::pi * (m + 0.5) / moments;
      const double steps_Hz = setup.peak_N * std::numbers::pi * setup.beat_Hz * std::sin(angle) / planted.quantum_N;
      for (int h = 1; h * steps_Hz < 0.5 * setup.rate_Hz && h < 1000; ++h) {
        if (h * steps_Hz < 20.0) continue;
        power += vibration(planted.quantum_N / (std::numbers::pi * h), h * steps_Hz) / moments;
      }
    }
  }
  double burst = 0.0;
  if (planted.tap_N > 0.0) {
    // Power of a decaying sine over the 64 ms that follow.
    const double speed = deepest_m * (1.0 + air_share) * std::numbers::pi * setup.beat_Hz *
                         std::sqrt(4.0 * air_share / (1.0 + air_share) * (1.0 - air_share / (1.0 + air_share)));
    const double amplitude = planted.tap_N * speed / tap_speed_m_per_s;
    const double rms = amplitude * std::sqrt(0.5 * 0.5 * tap_decay_s / 0.064);
    burst = scale.from_nothing(vibration(rms * std::numbers::sqrt2, tap_frequency_Hz) /
                               (thresholds.vibration_integration_s / 0.064));
  }
  const double position = planted.late_m / thresholds.position_m;
  const double fast = scale.from_nothing(power);
  const double curve = std::max(force, stiffness);
  return std::sqrt(curve * curve + rate * rate + direction * direction + fast * fast + burst * burst +
                   friction * friction + position * position);
}

recording::Recording record_planted(const PlantedCase& planted, const PlantedSetup& setup, std::uint64_t seed) {
  Random random(seed);
  Random noise = random.stream(1);
  const Hand hand(planted, setup, seed);
  const double duration_s = hand.duration_s(planted.longer * setup.presses);
  const auto count = static_cast<std::size_t>(duration_s * setup.rate_Hz);
  const double k = setup.stiffness_N_per_m * (1.0 - planted.softer);
  recording::Recording recording;
  recording.source = planted.name;
  double contact_s = -1.0;  // when contact began
  double contact_speed = 0.0;
  double depth_before = -1.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double clock_s = static_cast<double>(i) / setup.rate_Hz;
    const double t = clock_s - planted.recording_delay_s;
    // The force answers the motion of `delay_s` ago.
    const double felt_depth = hand.depth_m(t - planted.delay_s) - planted.late_m;
    if (felt_depth > 0.0 && depth_before <= 0.0) {
      contact_s = t;
      contact_speed = (felt_depth - depth_before) * setup.rate_Hz;
    }
    depth_before = felt_depth;
    Vec3 force = Vec3::Zero();
    if (felt_depth > 0.0) {
      double normal = k * felt_depth;
      if (planted.plateau_N > 0.0) {
        // Without a kink, which would be felt as a click.
        const double part = std::min(1.0, felt_depth * setup.stiffness_N_per_m / (rise * setup.peak_N));
        normal = planted.plateau_N * (1.0 - planted.softer) * part * part * (3.0 - 2.0 * part);
      }
      if (planted.buzz_N > 0.0) normal += planted.buzz_N * std::sin(two_pi * planted.buzz_Hz * t);
      if (planted.texture_N > 0.0)
        normal += planted.texture_N * std::sin(two_pi * hand.x_m(t) / planted.texture_wavelength_m);
      if (planted.tap_N > 0.0 && contact_s >= 0.0) {
        const double since = t - contact_s;
        normal += planted.tap_N * contact_speed / tap_speed_m_per_s * std::exp(-since / tap_decay_s) *
                  std::sin(two_pi * tap_frequency_Hz * since);
      }
      if (planted.quantum_N > 0.0) normal = planted.quantum_N * std::round(normal / planted.quantum_N);
      const double v = (hand.x_m(t + 1e-4) - hand.x_m(t - 1e-4)) / 2e-4;
      // Sideways force grows with depth, as the normal force does: without a blow.
      const double grown = felt_depth * setup.stiffness_N_per_m / setup.peak_N;
      force = Vec3(-planted.friction * normal * (v > 0.0 ? 1.0 : -1.0), grown * planted.sideways_N, normal);
      if (planted.tilt_rad > 0.0) force = Eigen::AngleAxisd(planted.tilt_rad, Vec3::UnitX()) * force;
    }
    const auto jitter = [&noise](double sigma) -> Vec3 {
      const double x = noise.normal();
      const double y = noise.normal();
      return {sigma * x, sigma * y, sigma * noise.normal()};
    };
    recording.motion.t_s.push_back(clock_s);
    recording.motion.p_W_m.push_back(Vec3(hand.x_m(t), 0.0, -hand.depth_m(t)) + jitter(setup.position_noise_m));
    recording.f_W_N.push_back(force + jitter(setup.force_noise_N * planted.noisier));
  }
  return recording;
}

}  // namespace touchstone::experiments
