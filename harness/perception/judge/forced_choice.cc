#include "harness/perception/judge/forced_choice.h"

#include "harness/base/random.h"

namespace touchstone::perception {

double simulated_forced_choice(std::span<const double> evidence_jnd, std::size_t trials, std::uint64_t seed) {
  Random random(seed);
  double right = 0.0;
  for (std::size_t trial = 0; trial < trials; ++trial) {
    double rendering = 0.0;
    double real = 0.0;
    double weights = 0.0;
    for (const double jnd : evidence_jnd) {
      rendering += jnd * (jnd + random.normal());
      real += jnd * random.normal();
      weights += jnd * jnd;
    }
    // Without any evidence the answer is a guess.
    const bool picks_rendering = weights > 0.0 ? rendering > real : random.uniform() < 0.5;
    right += picks_rendering ? 1.0 : 0.0;
  }
  return right / static_cast<double>(trials);
}

}  // namespace touchstone::perception
