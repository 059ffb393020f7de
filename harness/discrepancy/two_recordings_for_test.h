// For tests of the search: what an instrument measures where the truth is known, and two such recordings with all that
// the search asks of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "harness/discrepancy/effect_search.h"
#include "harness/rendering/predictor.h"

namespace touchstone::discrepancy {

// `unit` is the unit of length over the metre.
inline InstrumentDescription small_noise(double unit) {
  InstrumentDescription instrument;
  instrument.force_noise_N = 0.01;
  instrument.force_noise_time_constant_s = 0.01;
  instrument.position_noise_m = 5e-5 * unit;
  return instrument;
}

// The path and the true force along it, each with the instrument's noise.
inline recording::Recording measured(const MotionColumns& path, std::vector<Vec3> f_W_N,
                                     const InstrumentDescription& instrument, std::uint64_t seed) {
  Random random(seed);
  recording::Recording recording;
  recording.motion = with_position_noise(path, instrument, random);
  const auto noise = force_noise(path, instrument, random);
  for (std::size_t i = 0; i < noise.size(); ++i) f_W_N[i] += noise[i];
  recording.f_W_N = std::move(f_W_N);
  return recording;
}

// Neither copied nor moved: `data` points into it.
class TwoRecordings {
 public:
  TwoRecordings(recording::Recording train, recording::Recording holdout, const InstrumentDescription& instrument,
                const rendering::Model& model, const rendering::MakePredictor& make)
      : train_(std::move(train), instrument, model, make, 1),
        holdout_(std::move(holdout), instrument, model, make, 2),
        data(divided(instrument)) {}
  TwoRecordings(const TwoRecordings&) = delete;
  TwoRecordings& operator=(const TwoRecordings&) = delete;

 private:
  struct Half {
    recording::Recording recording;
    std::unique_ptr<rendering::Predictor> predictor;
    NoiseModel noise;

    Half(recording::Recording measured, const InstrumentDescription& instrument, const rendering::Model& model,
         const rendering::MakePredictor& make, std::uint64_t seed)
        : recording(std::move(measured)),
          predictor(make(recording.motion)),
          noise(recording.motion, predictor->predict(model).n_W, instrument, make, seed, 3) {}
    Evidence evidence() { return {&recording, predictor.get(), &noise, {}}; }
  };
  SearchData divided(const InstrumentDescription& instrument) {
    const double window_s = block_window_s(60.0, train_.recording.motion);
    SearchData all = divide(train_.evidence(), holdout_.evidence(), window_s);
    all.force_floor_N = 0.06;
    all.position_noise_m = instrument.position_noise_m;
    all.geometry_error_m = instrument.geometry_error_m;
    return all;
  }

  Half train_;
  Half holdout_;

 public:
  const SearchData data;
};

}  // namespace touchstone::discrepancy
