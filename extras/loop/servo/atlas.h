// Where a renderer that is right in replay buzzes in the hand: renderers over shapes with edges, creases, thin walls
// and friction, each pressed and slid over by the same hand on the same device.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "harness/rendering/catalogue.h"
#include "harness/rendering/generators.h"
#include "servo/evaluation.h"

namespace touchstone::servo {

struct AtlasCase {
  std::string name;
  std::string surface;  // of the generators, with these parameters
  std::map<std::string, double, std::less<>> parameters;
  double friction = 0.0;  // coefficient of the effect coulomb-friction; 0: without
};
const std::vector<AtlasCase>& atlas_cases();

struct AtlasAnswer {
  std::string renderer;
  std::string where;
  Verdict verdict = Verdict::cannot_tell;
  Judgement worst;      // of the masses that are tried
  std::string refused;  // why the renderer does not run there; empty: it does
};

// 1 N down where `x` begins, and along x over the middle, following the shape as the hand sees it.
MotionColumns atlas_path(const surface::Surface& shape, const LoopParameters& parameters);

// The entry's model, its spring `stiffness_N_per_m` if it has that parameter.
rendering::Model atlas_model(const rendering::RendererEntry& entry, double stiffness_N_per_m);

AtlasAnswer atlas_answer(const rendering::Catalogue& catalogue, const rendering::Generators& generators,
                         rendering::Model model, const AtlasCase& where, const LoopSetup& setup,
                         const perception::Thresholds& thresholds);

}  // namespace touchstone::servo
