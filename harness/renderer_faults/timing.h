// When the answer of a renderer comes, found before any shape or frame is judged: a late answer looks like a force that
// sticks at edges, floats above the surface or turns the wrong way, and is none of these once the tip rests.
//
// The tip rests at each of 32 depths over one place of a level block until its force has settled, which gives S(depth).
// Then it jumps among them at every sample, and the force F_i, along where S grows to, is explained by depths of
// earlier samples:
//   late       F_i = S_(i-L): one lag L for all samples, of up to 40 ms; up to 23 samples also lags that alternate with
//              a period, or lags without one
//   held       F_i = F_(i-1) although the depth changed, until the next update
//   filter     a linear difference equation (harness/renderer_faults/arx.h) that answers less than S_i at once: of
//              first or second order, or a mean over samples. A contact with damping or relaxation answers at least S_i
//              at once: Kelvin-Voigt has a = 0, b_0 = 1 + b / (k T), b_1 = -b / (k T); behind a dead time it is late,
//              too
//   clipped    |F_i - F_(i-1)| is never above one figure, which many steps have; also with steps of 2 mm and up to 10 N
// A contact point that is late or held shows only while the tip slides (sliding_timing.h).
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "harness/renderer_faults/engine.h"

namespace touchstone::renderer_faults {

enum class TimingKind : std::uint8_t {
  exact,      // the answer to the tip of now
  viscous,    // damped or relaxing in contact: at once at least the settled force
  delay,      // every answer is the same number of samples late
  alternate,  // some samples of a period are late and others are not
  held,       // an answer is given again until the next update
  jitter,     // late by numbers of samples that follow no period
  filter,     // low-pass
  clipped,    // the force changes by no more than a figure from sample to sample
  unclear     // the force is that of no earlier depth, and no filter's
};

struct Timing {
  TimingKind kind = TimingKind::exact;
  double lag_samples = 0.0;      // the largest; of a filter its mean delay
  double period_samples = 0.0;   // of held and alternate answers
  double time_constant_s = 0.0;  // of a filter
  double per_sample_N = 0.0;     // the largest change of a clipped rate
  std::string what;              // one sentence with the figures; empty where nothing is said
  // Samples for which the tip must rest until the answer is that of its place.
  int settle_samples = 0;

  bool declared = false;  // the engine's author says it
  // The other kinds by their faults' names, and how much of the force each explains.
  std::vector<std::pair<std::string, std::string>> considered = {};

  // The name of the fault; empty where there is none or it is declared.
  [[nodiscard]] std::string fault() const;
};

// Every answer is `lag` samples late; `more` ends the sentence.
Timing delayed(const Engine& engine, double lag, const std::string& more = "");

// Throws what making the renderer throws, and RendererFailed.
Timing identify_timing(const Engine& engine);

}  // namespace touchstone::renderer_faults
