// What a recording should show if a model were true: the model's renderer with its effects over the recorded positions,
// then its instrument entries. Fitting and the search for missing effects know renderers and sensors only through this.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "harness/recording/trajectory.h"
#include "harness/rendering/effect_traits.h"
#include "harness/rendering/model.h"
#include "harness/rendering/renderer.h"

namespace touchstone::rendering {

// One prediction: all vectors have the recording's length.
struct Prediction {
  std::vector<Vec3> f_W_N;       // what the sensor would show, in the object's frame
  std::vector<Vec3> n_W;         // contact normal, zero when free
  std::vector<double> depth_m;   // >= 0
  std::vector<double> normal_N;  // normal force of the contact, before the instrument
};

class Predictor {
 public:
  virtual ~Predictor() = default;
  // Throws BadData for a model that cannot run. Many threads may call it at once. Calls with the same geometry
  // (renderer, tip, registration) share the search for contact, so that fitting stiffness and effects costs
  // microseconds a sample or less.
  virtual Prediction predict(const Model& model) = 0;
};

using MakePredictor = std::function<std::unique_ptr<Predictor>(const MotionColumns&)>;

enum class Side : std::uint8_t { contact, instrument };

// An effect that may be missing.
struct Candidate {
  std::string name;
  Side side;
  std::vector<ParameterDeclaration> parameters;
  EffectTraits traits = {};
  std::shared_ptr<const DeclaredEffect> law = {};  // of an effect that a user declared
};

}  // namespace touchstone::rendering
