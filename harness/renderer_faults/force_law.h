// What a renderer's output does to a right force, found from settled forces on the faces of blocks that lie in many
// directions, up to 10 N. Each fault is a small map of the force; the map that explains all readings best is named.
//
//   mirrored-axis    f_a = -f_a on some axes, or only where the right f_a has one sign
//   exchanged-axes   f_a = f_b
//   lost-axis        f_a = 0, on one axis or two, or on all but the strongest
//   saturation       f_a = clamp(f_a, -L, U) along each axis with limits of its own, along the axes of a turned frame
//   or
//                    one axis alone, or f = f min(1, L / |f|) by magnitude
//   quantised        f_a = q round(f_a / q), or cut off towards 0 or downwards
//
// The right force is k d along the face's normal, with the declared k, the slope of the lightest readings, or their
// power law: whichever explains the readings best.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "harness/base/vec.h"
#include "harness/renderer_faults/engine.h"

namespace touchstone::renderer_faults {

inline constexpr double no_limit_N = std::numeric_limits<double>::infinity();

enum class Rounding : std::uint8_t { nearest, towards_zero, down };

// Applied in this order: axes, saturation, steps.
struct ForceMap {
  std::array<int, 3> from{0, 1, 2};         // f_a is taken from this axis; -1: it is lost
  std::array<double, 3> positive{1, 1, 1};  // factor of a positive f_a, and of a negative one
  std::array<double, 3> negative{1, 1, 1};
  bool strongest_only = false;      // the other two axes are 0
  Mat3 limited = Mat3::Identity();  // its rows: the axes along which components are limited
  Vec3 least_N{-no_limit_N, -no_limit_N, -no_limit_N};
  Vec3 most_N{no_limit_N, no_limit_N, no_limit_N};
  double limit_N = no_limit_N;  // of the magnitude
  double step_N = 0.0;          // 0: no steps
  Rounding rounding = Rounding::nearest;

  [[nodiscard]] Vec3 operator()(const Vec3& f) const;
  // Whether some component is limited.
  [[nodiscard]] bool limits_components() const;
  // Without saturation and steps.
  [[nodiscard]] ForceMap axes_alone() const;
  // What undoes the axes; nothing where they cannot be undone.
  [[nodiscard]] std::optional<ForceMap> inverse() const;
};

struct ForceFaults {
  ForceMap map;
  bool axes = false;  // the map's axes are not the right ones
  bool saturated = false;
  bool quantised = false;
  double before = 0.0;  // rms of what is off, over the rms of the right force: as if the map were none
  double after = 0.0;   // with the map
  // What the best map of each kind leaves by itself: other axes, a limit, steps (infinite where the readings have
  // none).
  double axes_leave = no_limit_N, limits_leave = no_limit_N, steps_leave = no_limit_N;
};

// `settle_samples` of the engine must be what its timing needs. Throws what making the renderer throws.
ForceFaults identify_force_map(const Engine& engine);

// The engine's own answer with the map on top of it.
Engine with_map(const Engine& engine, const ForceMap& map);

// A right renderer of this stiffness, tip and friction (against the last move) without other memory: the closest
// surface point, F = k d. What it lacks (thin shells) it lacks with and without a map.
Engine reference_engine(const Engine& like);

}  // namespace touchstone::renderer_faults
