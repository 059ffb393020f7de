#include "harness/discrepancy/instrument_description.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "harness/base/json_reader.h"
#include "harness/stats/quantile.h"

namespace touchstone::discrepancy {
namespace {

double non_negative(JsonObject& object, std::string_view key) {
  const double value = object.number(key);
  if (value < 0.0) object.fail_at(key, "must not be negative");
  return value;
}

// The standard deviation of white noise in a series, from its differences of an order over a lag of samples by their
// median: differences remove what varies slowly, the median what varies in bursts. The two factors turn the median into
// a standard deviation. An axis that never changes was not measured: force against displacement has two of them.
double noise_of(std::vector<Vec3> series, int order, std::size_t lag) {
  if (series.empty()) return 0.0;
  std::vector<int> moving;
  for (int axis = 0; axis < 3; ++axis) {
    const auto still = [&](const Vec3& value) { return value[axis] == series.front()[axis]; };
    if (!std::all_of(series.begin(), series.end(), still)) moving.push_back(axis);
  }
  double gain = 1.0;  // of the variance of white noise: binomial(2 order, order)
  for (int k = 1; k <= order; ++k) {
    gain *= (4.0 * k - 2.0) / k;
    if (series.size() <= lag) return 0.0;
    for (std::size_t i = 0; i + lag < series.size(); ++i) series[i] = series[i + lag] - series[i];
    series.resize(series.size() - lag);
  }
  std::vector<double> magnitudes;
  for (const int axis : moving) {
    for (const Vec3& difference : series) magnitudes.push_back(std::abs(difference[axis]));
  }
  if (magnitudes.empty()) return 0.0;
  return stats::normal_sigma_per_median * stats::upper_median(std::move(magnitudes)) / std::sqrt(gain);
}

// The impulse response of a two-pole Butterworth filter run forwards and backwards, 1 / (1 + (f / cutoff)^4): the
// inverse Fourier transform of 4 a^4 / (4 a^4 + w^4), with a = 2 pi cutoff / sqrt(2).
double zero_phase_response(double t_s, double cutoff_Hz) {
  const double x = std::numbers::sqrt2 * std::numbers::pi * cutoff_Hz * std::abs(t_s);
  return std::numbers::pi * cutoff_Hz / std::numbers::sqrt2 * std::exp(-x) * (std::cos(x) + std::sin(x));
}

}  // namespace

InstrumentDescription load_instrument(const std::filesystem::path& path) {
  const auto json = load_json(path);
  JsonObject root(json, path.string(), "");
  root.schema("touchstone-instrument/1");
  InstrumentDescription instrument;
  instrument.force_noise_N = non_negative(root, "force_noise_N");
  instrument.force_noise_time_constant_s = root.optional_number("force_noise_time_constant_s").value_or(0.0);
  if (root.has("force_step_N")) {
    const auto steps = root.numbers("force_step_N");
    if (steps.size() != 3) root.fail_at("force_step_N", "three numbers were expected: the steps along x, y and z");
    instrument.force_step_N = Vec3(steps[0], steps[1], steps[2]);
  }
  instrument.position_noise_m = non_negative(root, "position_noise_m");
  if (root.has("position_wander_m")) instrument.position_wander_m = non_negative(root, "position_wander_m");
  if (instrument.position_wander_m > instrument.position_noise_m)
    root.fail_at("position_wander_m", "is a part of position_noise_m and must not be larger");
  instrument.position_wander_time_constant_s = root.optional_number("position_wander_time_constant_s").value_or(4.0);
  if (!(instrument.position_wander_time_constant_s > 0.0))
    root.fail_at("position_wander_time_constant_s", "must be above zero");
  instrument.position_rate_Hz = root.optional_number("position_rate_Hz").value_or(60.0);
  if (instrument.position_rate_Hz <= 0.0) root.fail_at("position_rate_Hz", "must be above zero");
  instrument.geometry_error_m = root.optional_number("geometry_error_m").value_or(0.0);
  root.finish();
  return instrument;
}

std::string instrument_to_json(const InstrumentDescription& instrument) {
  const Vec3& step = instrument.force_step_N;
  const nlohmann::ordered_json json{{"schema", "touchstone-instrument/1"},
                                    {"force_noise_N", instrument.force_noise_N},
                                    {"force_noise_time_constant_s", instrument.force_noise_time_constant_s},
                                    {"force_step_N", {step.x(), step.y(), step.z()}},
                                    {"position_noise_m", instrument.position_noise_m},
                                    {"position_wander_m", instrument.position_wander_m},
                                    {"position_wander_time_constant_s", instrument.position_wander_time_constant_s},
                                    {"position_rate_Hz", instrument.position_rate_Hz},
                                    {"geometry_error_m", instrument.geometry_error_m}};
  return json.dump(1) + "\n";
}

InstrumentDescription estimate_instrument(const recording::Recording& recording) {
  InstrumentDescription instrument;
  instrument.declared = false;
  instrument.force_noise_N = noise_of(recording.f_W_N, 3, 1);
  instrument.position_noise_m = noise_of(recording.motion.p_W_m, 3, 1);
  if (recording.size() > 1) {
    const double span_s = recording.motion.t_s.back() - recording.motion.t_s.front();
    instrument.position_rate_Hz = static_cast<double>(recording.size() - 1) / span_s;
  }
  return instrument;
}

// Noise of white samples of unit deviation at `rate`, low-passed at c with the gain 1 / (1 + (f / c)^4), has
// differences of order k over a time L whose variance is the integral over all f of gain^2 (2 sin(pi f L))^(2 k) /
// rate.
double measured_low_pass(const MotionColumns& motion, const InstrumentDescription& instrument) {
  constexpr int order = 5;
  constexpr double least = 0.15, most = 0.5;  // beyond, samples of the tracker are white
  const double rate_Hz = instrument.position_rate_Hz;
  if (motion.size() < 2 || !(instrument.position_noise_m > 0.0)) return instrument.position_low_pass;
  const double step_s = (motion.t_s.back() - motion.t_s.front()) / static_cast<double>(motion.size() - 1);
  const auto lag = std::max(1L, std::lround(1.0 / (rate_Hz * step_s)));
  const double seen = noise_of(motion.p_W_m, order, static_cast<std::size_t>(lag)) / instrument.position_noise_m;
  const auto of_corner = [&](double share) {  // as noise_of() has it, by the trapezoidal rule
    constexpr int steps = 400;
    constexpr double white = 252.0;  // binomial(10, 5)
    const double end_Hz = 6.0 * share * rate_Hz;
    double sum = 0.0;
    for (int i = 1; i < steps; ++i) {
      const double f_Hz = end_Hz * i / steps;
      const double gain = 1.0 / (1.0 + std::pow(f_Hz / (share * rate_Hz), 4));
      const double swing = 2.0 * std::sin(std::numbers::pi * f_Hz * static_cast<double>(lag) * step_s);
      sum += gain * gain * std::pow(swing, 2 * order);
    }
    return std::sqrt(2.0 * sum * end_Hz / (steps * rate_Hz * white));
  };
  double low = least, high = most;
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    (of_corner(middle) < seen ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

MotionColumns with_position_noise(const MotionColumns& motion, const InstrumentDescription& instrument,
                                  Random& random) {
  MotionColumns noisy = motion;
  if (motion.size() == 0 || instrument.position_noise_m == 0.0) return noisy;
  // Tracker samples: the response has fallen below 1e-3 of its peak.
  const auto reach = static_cast<std::ptrdiff_t>(std::ceil(1.5 / instrument.position_low_pass));
  const double period_s = 1.0 / instrument.position_rate_Hz;
  const double start_s = motion.t_s.front() - static_cast<double>(reach + 1) * period_s;
  const auto count = static_cast<std::size_t>((motion.t_s.back() - start_s) / period_s) + reach + 3;
  std::vector<Vec3> draws(count);
  for (Vec3& draw : draws) draw = instrument.position_noise_m * Vec3(random.normal(), random.normal(), random.normal());
  const double cutoff_Hz = instrument.position_low_pass * instrument.position_rate_Hz;
  for (std::size_t i = 0; i < motion.size(); ++i) {
    const double place = (motion.t_s[i] - start_s) / period_s;
    const auto nearest = static_cast<std::ptrdiff_t>(std::lround(place));
    Vec3 sum = Vec3::Zero();
    for (std::ptrdiff_t j = nearest - reach; j <= nearest + reach; ++j) {
      const double weight = period_s * zero_phase_response((place - static_cast<double>(j)) * period_s, cutoff_Hz);
      sum += weight *
             draws[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(j, 0, static_cast<std::ptrdiff_t>(count) - 1))];
    }
    noisy.p_W_m[i] += sum;
  }
  return noisy;
}

double geometry_deviation_m(const InstrumentDescription& instrument) {
  return instrument.geometry_error_m / std::sqrt(3.0);
}

namespace {

// A random function of the place: a sum of waves of random direction and phase, of lengths from facets to the whole
// scan. Standard deviation 1.
class WavyField {
 public:
  WavyField(double extent_m, Random& random) {
    for (Wave& wave : waves_) {
      const double length_m = random.log_uniform(0.02 * extent_m, extent_m);
      wave.k_per_m = 2.0 * std::numbers::pi / length_m * random.direction();
      wave.phase = random.uniform(0.0, 2.0 * std::numbers::pi);
    }
  }
  [[nodiscard]] double at(const Vec3& p_W_m) const {
    double sum = 0.0;
    for (const Wave& wave : waves_) sum += std::sin(wave.k_per_m.dot(p_W_m) + wave.phase);
    return sum * std::sqrt(2.0 / static_cast<double>(waves_.size()));
  }

 private:
  struct Wave {
    Vec3 k_per_m;
    double phase = 0.0;
  };
  std::array<Wave, 24> waves_;
};

}  // namespace

MotionColumns with_geometry_error(const MotionColumns& motion, const std::vector<Vec3>& n_W,
                                  const InstrumentDescription& instrument, Random& random) {
  MotionColumns moved = motion;
  if (instrument.mesh_extent_m == 0.0 || instrument.geometry_error_m == 0.0) return moved;
  const WavyField height(instrument.mesh_extent_m, random);
  for (std::size_t i = 0; i < motion.size(); ++i) {
    moved.p_W_m[i] += geometry_deviation_m(instrument) * height.at(motion.p_W_m[i]) * n_W[i];
  }
  return moved;
}

std::vector<Vec3> normal_tilts(const MotionColumns& motion, const std::vector<Vec3>& n_W,
                               const InstrumentDescription& instrument, Random& random) {
  std::vector<Vec3> tilts(motion.size(), Vec3::Zero());
  const double extent = instrument.mesh_extent_m;
  if (extent == 0.0 || instrument.normal_error_rad == 0.0) return tilts;
  // Two of the three components lie in the tangent plane, each with half of the square.
  const double share = instrument.normal_error_rad / std::sqrt(2.0);
  const std::array<WavyField, 3> field{WavyField(extent, random), WavyField(extent, random), WavyField(extent, random)};
  for (std::size_t i = 0; i < tilts.size(); ++i) {
    const Vec3& p = motion.p_W_m[i];
    const Vec3 any = share * Vec3(field[0].at(p), field[1].at(p), field[2].at(p));
    tilts[i] = any - n_W[i].dot(any) * n_W[i];
  }
  return tilts;
}

std::vector<Vec3> force_noise(const MotionColumns& motion, const InstrumentDescription& instrument, Random& random) {
  std::vector<Vec3> noise(motion.size());
  Vec3 state = instrument.force_noise_N * Vec3(random.normal(), random.normal(), random.normal());
  for (std::size_t i = 0; i < noise.size(); ++i) {
    if (i > 0) {
      const double dt_s = motion.t_s[i] - motion.t_s[i - 1];
      const double keep =
          instrument.force_noise_time_constant_s > 0.0 ? std::exp(-dt_s / instrument.force_noise_time_constant_s) : 0.0;
      const double fresh = instrument.force_noise_N * std::sqrt(1.0 - keep * keep);
      state = keep * state + fresh * Vec3(random.normal(), random.normal(), random.normal());
    }
    const Vec3 rounding(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5));
    noise[i] = state + instrument.force_step_N.cwiseProduct(rounding);
  }
  return noise;
}

}  // namespace touchstone::discrepancy
