// Where a renderer that is right in replay buzzes in the hand: renderers over shapes with edges, creases, thin walls
// and friction, each pressed and slid over by the same hand on the same device. What is wrong gets a name:
//
//   unstable-below-limit  the passive plane buzzes or throws the hand off, or the plane does where the god-object does
//                         not. On the passive plane the device has the viscous friction with which the stiffness is 80
//                         % of Colgate and Schenkel's limit (limits.h): a passive renderer is stable there in every
//                         hand, beside the exact wall.
//   buzz-at-edges         so does another shape without friction
//   buzz-with-friction    so does the plane with friction
//   kick                  at contact the force exceeds that of an ideal servo by more than is just noticed
//
// The last three only where the god-object (Zilles and Salisbury 1995) is right in the same loop: a stiffness that no
// renderer is stable with is no renderer's fault.
#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
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
  bool passive = false;   // on a device with friction above Colgate and Schenkel's limit, in place of the user's
};
const std::vector<AtlasCase>& atlas_cases();

struct AtlasAnswer {
  std::string renderer;
  std::string where;  // the case's name
  Verdict verdict = Verdict::cannot_tell;
  Judgement worst;      // of the masses that are tried
  std::string refused;  // why the renderer does not run there; empty: it does
};

// 1 N down where `x` begins, and along x over the middle, following the shape as the hand sees it.
MotionColumns atlas_path(const surface::Surface& shape, const LoopParameters& parameters);

// The entry's model, its spring `stiffness_N_per_m` if it has that parameter.
rendering::Model atlas_model(const rendering::RendererEntry& entry, double stiffness_N_per_m);

// `refused` if the case needs a stiffness and the model has no parameter stiffness_N_per_m.
AtlasAnswer atlas_answer(const rendering::Catalogue& catalogue, const rendering::Generators& generators,
                         rendering::Model model, const AtlasCase& where, const LoopSetup& setup,
                         const perception::Thresholds& thresholds);

inline constexpr std::array<std::string_view, 4> atlas_finding_names{"unstable-below-limit", "buzz-at-edges",
                                                                     "buzz-with-friction", "kick"};
struct AtlasFinding {
  std::string name;
  std::vector<std::string> where;  // the cases, the worst first
  double jnd = 0.0;                // there
  std::string follows_from;        // another finding that explains it; empty: none
};

// Of one renderer's answers; `reference`: the god-object's to the same cases.
std::vector<AtlasFinding> atlas_findings(const std::vector<AtlasAnswer>& answers,
                                         const std::vector<AtlasAnswer>& reference);

}  // namespace touchstone::servo
