// Which of the instrument's effects (tool_effects.h) a recording with a tool needs: nested comparisons.
//
// A set of effects is changed by one at a time, and the two models are held against one another on blocks that neither
// was fitted to: the gain of one over the other is the difference of their log-likelihoods there, a block each, and its
// p-value that of a paired, one-sided t test over those blocks. So neighbouring samples need not be independent; blocks
// must be. An effect belongs to the set if
//   - the fitted blocks reject that it is nought (F test over blocks, 5 % divided among the effects, Bonferroni),
//   - the model with it predicts the blocks that were not fitted better than the one without it (5 %), and
//   - at least one of its values is determined: its standard error is well below what any instrument could have.
// The search starts with the effects that stand out with all others beside them, takes away what fails, adds what gains
// most, and ends when neither changes the set.
//
// A rival of an effect is one that in its place predicts those blocks about as well (the set is not better at 5 %): the
// recording cannot tell the two apart.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "tool_fitting/tool_fitter.h"

namespace touchstone::tool_fitting {

// Of one model over another on the blocks by which effects are chosen.
struct ToolGain {
  double per_sample = 0.0;  // nats
  double p = 1.0;           // of its not being above nought
};
ToolGain gain_of(ToolFitter& fitter, const ToolSolution& model, const ToolSolution& over);

struct ToolChoice {
  ToolSolution best;
  // One per effect: with it; of an effect of the set `with` is `best`, else the set and it.
  struct OfEffect {
    ToolSolution with;
    double p = 1.0;  // of its being nought
    ToolGain gain;   // of `with` over the same without it
    std::vector<std::size_t> rivals;
  };
  std::vector<OfEffect> effects;
};
ToolChoice choose_effects(ToolFitter& fitter);

// A way in which files of force and torque are often misread: the torque's or the wrench's sign, or the frame of their
// components. Suspected if
//   - beside biases and weight alone, the recording read so predicts blocks that were not fitted better than as it is
//     recorded (0.1 %, divided among the readings), with less than half of the error in force or torque, and
//   - the effects that are chosen for it so predict them no worse than those chosen as it is recorded (5 %), and are
//     without a lever arm: where one point of the tool touches all the time, a lever arm can stand for a wrong sign.
struct ToolMisreading {
  std::string name;                 // "torque-sign"
  std::string what;                 // a sentence
  ToolErrors as_recorded, read_so;  // on blocks that were not fitted, beside biases and weight alone
};
// `fitter` is that of `measured`, and `chosen` what was chosen with it.
std::optional<ToolMisreading> find_misreading(const recording::Recording& measured, const MakeTool& make,
                                              const tool::Coupling& declared, ToolFitter& fitter,
                                              const ToolChoice& chosen);

}  // namespace touchstone::tool_fitting
