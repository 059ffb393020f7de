// What noise alone would leave between a model and a recording, by simulation: tracker noise is an error in the
// variable that the model bends (contact begins, friction turns), so that no formula of the force noise serves.
// Replicas of the motion are perturbed by the declared noise, the model runs on each, and the blocks' spread and mean
// are kept.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "harness/discrepancy/instrument_description.h"
#include "harness/discrepancy/residual_blocks.h"

namespace touchstone {

class NoiseModel {
 public:
  // `make` is used once per replica. Deterministic for a seed.
  NoiseModel(const MotionColumns& motion, const InstrumentDescription& instrument, const MakePredictor& make,
             std::size_t replicas, std::uint64_t seed);

  // The noise of each block if `model` were the truth, `stiffness_N_per_m` its normal stiffness (for the part of the
  // mesh's declared error, which is smooth along the surface and therefore no replica of sample noise).
  // `nominal`: the model's prediction at the recorded positions.
  [[nodiscard]] std::vector<BlockNoise> of(const Model& model, const Prediction& nominal,
                                           const std::vector<SampleBlock>& blocks);

  // A recording as it would be were `model` the truth, seen through replica `index`: forces of the model at the
  // recorded positions plus force noise; the positions carry fresh tracker noise. For null distributions.
  [[nodiscard]] Recording null_recording(const Prediction& nominal, std::size_t index) const;

 private:
  InstrumentDescription instrument_;
  MotionColumns motion_;
  std::vector<MotionColumns> moved_;
  std::vector<std::unique_ptr<Predictor>> replicas_;
  std::vector<std::vector<Vec3>> force_noise_;
};

}  // namespace touchstone
