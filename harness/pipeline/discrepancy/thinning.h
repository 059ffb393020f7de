// Recordings sampled far more finely than their tracker moves: means over a few samples carry all that blocks of
// 2/60 s can show, at a fraction of the work. What is faster than the blocks is looked at in the samples themselves
// (residual_spectrum.h).
#pragma once

#include <cstddef>
#include <cstdint>

#include "harness/discrepancy/evidence.h"
#include "harness/discrepancy/residual_spectrum.h"
#include "harness/rendering/predictor.h"

namespace touchstone::pipeline {

// How many samples to take the mean of, so that four remain in each block of `window_s`: a hand's path between them is
// straight to a small part of a tracker's noise. 1: leave the recording as it is.
std::size_t samples_per_mean(const MotionColumns& motion, double window_s);

// Means of times, positions and forces over `count` samples, and the orientation in their middle. The first sample
// stays as it is, so that the blocks of a part (evidence.h) begin where they did, and no mean reaches from a part's
// blocks into those that are left out, nor over a gap in time.
recording::Recording thinned(const recording::Recording& recording, std::size_t count, const discrepancy::Part& part);

// The instrument of such means. Noise with a time constant (a process of first order) keeps that; each of the sensor's
// steps rounds on its own.
discrepancy::InstrumentDescription instrument_of_means(const discrepancy::InstrumentDescription& instrument,
                                                       const MotionColumns& motion, std::size_t count);

// What the sensor's noise adds to the mean square of the 3-D force of a sample beyond that of a mean [N^2].
double square_beyond_means_N2(const discrepancy::InstrumentDescription& samples,
                              const discrepancy::InstrumentDescription& means);

// What recordings show at their sensor's own rate.
struct SampledRecordings {
  const recording::Recording* train = nullptr;
  const recording::Recording* holdout = nullptr;  // none: `train` holds what is held out
  std::uint64_t seed = 1;                         // of the simulated noise
  discrepancy::InstrumentDescription sensor;
  rendering::MakePredictor make;
};
discrepancy::ResidualSpectrum spectrum_of_samples(const SampledRecordings& of, const rendering::Model& model,
                                                  double window_s);

}  // namespace touchstone::pipeline
