// Which fitted values the recording determines. Information matrix of the joint fit (Bates and Watts 1988, section
// 2.2): its inverse is the covariance that the noise leaves, and a direction of small eigenvalue is a combination of
// parameters that may change together without the forces showing it ("practically non-identifiable": Raue et al. 2009,
// Bioinformatics 25:1923). A value whose 95 % interval is wider than the scale on which it is sought is not determined,
// and its interval is open. A fit along a straight line, say, moves a bump across the line for free, so that its
// derivative is zero and a covariance without such directions would show no width at all.
#pragma once

#include <string>
#include <vector>

#include "harness/discrepancy/effect_library.h"
#include "harness/discrepancy/evidence.h"

namespace touchstone::discrepancy {

struct Undetermined {
  std::string effect;
  std::string parameter;
  std::string why;  // a clause: "the tip slides along y one way only"
};

// Of the effects' free parameters. `data`: the blocks that the fit was made on, of `recording`.
std::vector<Undetermined> find_undetermined(const FitData& data, const recording::Recording& recording,
                                            const rendering::Model& model, const std::vector<FreeParameter>& parameters,
                                            const EffectLibrary& library);

// Of the way that the tip slides in contact: the share that goes along an axis (0: x, 1: y) and is gone back at the
// same place, within a cell of a twentieth of the scan's diagonal. 1: all of it; 0: none, or every place one way only.
// There and back in different places does not count: the surface may be tilted one way here and the other way there.
double both_ways_share(const recording::Recording& recording, const rendering::Prediction& prediction, int axis);

// Whether it says how much of an effect there is: no place, angle, time or length.
bool is_size(const FreeParameter& parameter);

// Effects none of whose sizes is determined. An effect without a size (a time constant alone) is never one of them.
std::vector<std::string> without_size(const std::vector<Undetermined>& undetermined,
                                      const std::vector<FreeParameter>& parameters);

// What of the values is hard to believe, in sentences: at the end of what the catalogue or the recording allows, a law
// that degenerates into another one, a tip that sticks over a longer path than the object gives way sideways, a
// registration along the surface that is far beyond any press.
struct Question {
  std::string effect;
  std::string sentence;
};
std::vector<Question> question_values(const recording::Recording& recording, const rendering::Prediction& prediction,
                                      const rendering::Model& model, const std::vector<FreeParameter>& parameters,
                                      const JointFit& fit, double position_noise_m, const EffectLibrary& library);

}  // namespace touchstone::discrepancy
