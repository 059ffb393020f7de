#include "harness/pipeline/discrepancy/thinning.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace touchstone::pipeline {
using discrepancy::InstrumentDescription;
using recording::Recording;

std::size_t samples_per_mean(const MotionColumns& motion, double window_s) {
  constexpr double left_in_block = 4.0;
  if (motion.size() < 2) return 1;
  const double step_s = (motion.t_s.back() - motion.t_s.front()) / static_cast<double>(motion.size() - 1);
  if (!(step_s > 0.0)) return 1;
  // A step of 2 ms, measured, is 2 ms less a rounding error.
  constexpr double rounding = 1e-6;
  return std::max<std::size_t>(1, static_cast<std::size_t>(window_s / (left_in_block * step_s) + rounding));
}

Recording thinned(const Recording& recording, std::size_t count, const discrepancy::Part& part) {
  if (count <= 1 || recording.size() < 2) return recording;
  const MotionColumns& all = recording.motion;
  const double first_s = all.t_s.front();
  const double step_s = (all.t_s.back() - first_s) / static_cast<double>(all.size() - 1);
  const double longest_s = 2.0 * static_cast<double>(count) * step_s;
  Recording out;
  out.source = recording.source;
  const auto mean_of = [&](std::size_t begin, std::size_t end) {
    const auto n = static_cast<double>(end - begin);
    double t_s = 0.0;
    Vec3 p_W_m = Vec3::Zero();
    Vec3 f_W_N = Vec3::Zero();
    for (std::size_t i = begin; i < end; ++i) {
      t_s += (all.t_s[i] - all.t_s[begin]) / n;
      p_W_m += all.p_W_m[i] / n;
      f_W_N += recording.f_W_N[i] / n;
    }
    out.motion.t_s.push_back(all.t_s[begin] + t_s);
    out.motion.p_W_m.push_back(p_W_m);
    if (!all.q_WS.empty()) out.motion.q_WS.push_back(all.q_WS[begin + (end - begin) / 2]);
    out.f_W_N.push_back(f_W_N);
  };
  mean_of(0, 1);
  std::size_t begin = 1;
  for (std::size_t i = 2; i <= all.size(); ++i) {
    const bool ends = i == all.size() || i - begin == count || all.t_s[i] - all.t_s[begin] > longest_s ||
                      part.blocks.contains(all.t_s[i], first_s) != part.blocks.contains(all.t_s[begin], first_s);
    if (!ends) continue;
    mean_of(begin, i);
    begin = i;
  }
  return out;
}

InstrumentDescription instrument_of_means(const InstrumentDescription& instrument, const MotionColumns& motion,
                                          std::size_t count) {
  if (count <= 1 || motion.size() < 2) return instrument;
  const auto n = static_cast<double>(count);
  const double step_s = (motion.t_s.back() - motion.t_s.front()) / static_cast<double>(motion.size() - 1);
  const double keep =
      instrument.force_noise_time_constant_s > 0.0 ? std::exp(-step_s / instrument.force_noise_time_constant_s) : 0.0;
  // The mean of n neighbours whose correlation falls by `keep` from one to the next.
  double pairs = n;
  for (std::size_t apart = 1; apart < count; ++apart) {
    pairs += 2.0 * (n - static_cast<double>(apart)) * std::pow(keep, static_cast<double>(apart));
  }
  InstrumentDescription means = instrument;
  means.force_noise_N *= std::sqrt(pairs) / n;
  means.force_step_N /= std::sqrt(n);
  return means;
}

double square_beyond_means_N2(const InstrumentDescription& samples, const InstrumentDescription& means) {
  const auto square = [](const InstrumentDescription& one) {
    // Rounding to steps is even over one of them.
    return 3.0 * one.force_noise_N * one.force_noise_N + one.force_step_N.squaredNorm() / 12.0;
  };
  return std::max(0.0, square(samples) - square(means));
}

namespace {

// So much of a recording is looked at for lines and bands: half a minute at 1 kHz.
constexpr std::size_t spectrum_samples = 32768;

Recording first_samples(const Recording& recording, std::size_t most) {
  Recording first;
  const auto n = static_cast<std::ptrdiff_t>(std::min(most, recording.size()));
  const MotionColumns& motion = recording.motion;
  first.motion.t_s.assign(motion.t_s.begin(), motion.t_s.begin() + n);
  first.motion.p_W_m.assign(motion.p_W_m.begin(), motion.p_W_m.begin() + n);
  if (!motion.q_WS.empty()) first.motion.q_WS.assign(motion.q_WS.begin(), motion.q_WS.begin() + n);
  first.f_W_N.assign(recording.f_W_N.begin(), recording.f_W_N.begin() + n);
  first.source = recording.source;
  return first;
}

// A recording at its own rate, as its spectrum asks for it.
struct AtOwnRate {
  Recording recording;
  std::unique_ptr<rendering::Predictor> predictor;
  discrepancy::NoiseModel noise;
  discrepancy::FitData blocks;

  AtOwnRate(const Recording& whole, const rendering::Model& model, const InstrumentDescription& instrument,
            const rendering::MakePredictor& make, std::uint64_t noise_seed, std::uint64_t mesh_seed)
      : recording(first_samples(whole, spectrum_samples)),
        predictor(make(recording.motion)),
        noise(recording.motion, predictor->predict(model).n_W, instrument, make, noise_seed, mesh_seed) {
    blocks.predictor = predictor.get();
  }
  [[nodiscard]] discrepancy::DetectorSide side() { return {&recording, &blocks, &noise}; }
};

}  // namespace

discrepancy::ResidualSpectrum spectrum_of_samples(const SampledRecordings& of, const rendering::Model& model,
                                                  double window_s) {
  AtOwnRate held(of.holdout == nullptr ? *of.train : *of.holdout, model, of.sensor, of.make, of.seed + 1, of.seed + 2);
  if (of.holdout == nullptr) return residual_spectrum(held.side(), held.side(), model, window_s);
  AtOwnRate learnt(*of.train, model, of.sensor, of.make, of.seed, of.seed + 2);
  return residual_spectrum(learnt.side(), held.side(), model, window_s);
}

}  // namespace touchstone::pipeline
