// What noise alone would leave between a model and a recording, by simulation: tracker noise is an error in the
// variable that the model bends (contact begins, friction turns), so that no formula of the force noise serves.
// Replicas of the motion are perturbed by the declared noise, the model runs on each, and the blocks' spread and mean
// are kept. Given the recorded positions the true ones scatter about them (Berkson 1950; the prior is flat over the
// range of the noise), so that what the model makes of the replicas is what the sensor would have shown.
// How large the noise is needs no more than that. What it does to a fit needs the true path itself, which the
// neighbours of a sample tell better than the sample (see smooth_motion.h): in the null recordings the tip follows the
// smoothed motion, off by what smoothing leaves of the noise, while the models are fitted at the recorded positions. So
// a null world weakens coefficients and rewards laws that only pass less noise on just as the recording does (errors in
// the variables; Carroll, Ruppert, Stefanski and Crainiceanu 2006, chapter 2). The mesh's declared error is smooth
// along the surface: its part is what the model makes of a mesh that is off by its standard deviation everywhere.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "harness/discrepancy/instrument_description.h"
#include "harness/discrepancy/residual_blocks.h"
#include "harness/rendering/predictor.h"

namespace touchstone::discrepancy {

class NoiseModel {
 public:
  // `n_W`: contact normals of every sample by a model that touches (zero in free air, where the nearest contact's is
  // taken). `make` is used once per replica. Deterministic for its seeds; recordings of one object have the same error
  // of the mesh, and so one `mesh_seed`, but each its own noise.
  NoiseModel(const MotionColumns& motion, const std::vector<Vec3>& n_W, const InstrumentDescription& instrument,
             const rendering::MakePredictor& make, std::uint64_t noise_seed, std::uint64_t mesh_seed);

  // The noise of each block if `model` were the truth. `nominal`: the model's prediction at the recorded positions.
  [[nodiscard]] std::vector<BlockNoise> of(const rendering::Model& model, const rendering::Prediction& nominal,
                                           const std::vector<ResidualBlock>& blocks);

  // What the sensor would have shown beyond `nominal`, were `model` the truth and the tip off from where it was
  // recorded by draw number `index` (< replica_count) of the tracker's noise. Faster noise than that of simulated
  // recordings: these follow the smoothed motion, which has some of the recorded noise in it.
  static constexpr std::size_t replica_count = 8;
  [[nodiscard]] std::vector<Vec3> simulated_noise_residual(const rendering::Model& model,
                                                           const rendering::Prediction& nominal, std::size_t index);

  // At the recorded positions with draw number `index` (< replica_count) of the tracker's noise added once more.
  [[nodiscard]] rendering::Predictor& noisier_predictor(std::size_t index) const {
    return *replicas_.at(index).predictor;
  }

  // The mean square of the 3-D force error that noise would leave at each sample if `model` were the truth [N^2].
  [[nodiscard]] std::vector<double> expected_squares(const rendering::Model& model,
                                                     const rendering::Prediction& nominal);

  // The motion without the tracker's noise, as far as it is known (see smooth_motion.h).
  [[nodiscard]] const MotionColumns& smoothed_motion() const { return smoothed_motion_; }
  [[nodiscard]] rendering::Predictor& likely_predictor() const { return *likely_; }

  // What the sensor would have shown, were `model` the truth, in a world whose noise and mesh error are number `index`
  // (< null_worlds): for null distributions of the case itself.
  static constexpr std::size_t null_simulations = 10;
  [[nodiscard]] std::vector<Vec3> null_forces(const rendering::Model& model, const rendering::Prediction& nominal,
                                              std::size_t index);

 private:
  struct World {
    std::unique_ptr<rendering::Predictor> predictor;
    std::vector<Vec3> force_noise;
    std::vector<Vec3> tilt_W;  // of the true normal against the facet's; null recordings only
  };

  InstrumentDescription instrument_;
  MotionColumns smoothed_motion_;
  std::unique_ptr<rendering::Predictor> likely_;
  std::vector<World> replicas_;                      // noise alone
  std::vector<World> nulls_;                         // noise and mesh error
  std::unique_ptr<rendering::Predictor> displaced_;  // the mesh off by its standard deviation
};

}  // namespace touchstone::discrepancy
