// Is the force's sign reversed? A force ON the probe BY the object pushes outward; recordings of the force BY the probe
// push inward.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "harness/base/vec.h"

namespace touchstone::recording {

enum class SignVerdict : std::uint8_t {
  outward,    // as it should be
  reversed,   // the force is BY the probe: negate it
  undecided,  // too few samples, or no side prevails
};

struct ForceSign {
  SignVerdict verdict = SignVerdict::undecided;
  // sum of f.n over sum of |f.n|, within [-1, 1]: 1 where every force pushes outward. Weighted by size, so that noise
  // off contact counts little.
  double statistic = 0.0;
  // Two-sided sign test over blocks of consecutive samples: how likely so one-sided an outcome is if neither sign
  // prevailed. Blocks, because neighbouring samples are not independent.
  double p_value = 1.0;
  std::size_t blocks = 0;
  std::size_t samples = 0;  // with a force and a normal that are finite and not zero

  // One sentence for a message: "the forces push into the object (statistic -0.99, p = 2e-06): ...".
  [[nodiscard]] std::string explain() const;
};

// `normals` are outward unit normals at the closest surface point, one per force. A verdict needs |statistic| > 0.5 and
// p < 0.01. Throws std::invalid_argument when the sizes differ.
ForceSign check_force_sign(std::span<const Vec3> normals, std::span<const Vec3> forces);

// The sign by how the load changes: `loads_N` (force along the outward normal) against `depths_m` (zero outside), one
// per sample. The statistic is that of the products of both deviations from their means over a block; blocks in which
// either is constant do not count. A weight or a bias, however large, changes nothing; a constant load leaves it
// undecided. The same limits decide. Throws std::invalid_argument when the sizes differ.
ForceSign check_load_change(std::span<const double> depths_m, std::span<const double> loads_N);

}  // namespace touchstone::recording
