// What was measured and what is derived from it, as distinct types over shared columns, so that a recording cannot be
// passed where an in-trajectory is wanted. SI units; the object's (world) frame W; force is ON the probe BY the object.
// Terms: Ruffaldi et al. 2006, section 3.1.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "harness/base/motion.h"
#include "harness/base/vec.h"

namespace touchstone::recording {

// What a probe measured on a real (or simulated) object.
struct Recording {
  MotionColumns motion;
  std::vector<Vec3> f_W_N;        // force on the probe by the object
  std::vector<Vec3> torque_W_Nm;  // about the tip; empty where not recorded
  std::string source;             // the file it came from, for messages

  [[nodiscard]] std::size_t size() const noexcept { return motion.size(); }
};

// The path of the tip on or above the surface, never inside it.
struct OutTrajectory {
  MotionColumns motion;
  std::vector<Vec3> n_W;               // outward unit normal at the closest surface point
  std::vector<double> gap_m;           // distance kept from the surface, >= 0 (0 in contact)
  std::vector<double> normal_force_N;  // pushing part of the recorded force along n_W, >= 0; 0 where not in contact

  [[nodiscard]] std::size_t size() const noexcept { return motion.size(); }
};

// The path that a virtual probe takes through a renderer, inside the object when in contact.
struct InTrajectory {
  MotionColumns motion;

  [[nodiscard]] std::size_t size() const noexcept { return motion.size(); }
};

// What a renderer made of an in-trajectory.
struct RenderedTrajectory {
  std::vector<double> t_s;
  std::vector<Vec3> tip_W_m;           // the in-trajectory's position
  std::vector<Vec3> contact_W_m;       // surface contact point (proxy); the tip itself when free
  std::vector<Vec3> f_W_N;             // force on the probe
  std::vector<unsigned char> contact;  // 0 or 1
  std::vector<double> cost_us;         // time of each step; empty where not timed

  [[nodiscard]] std::size_t size() const noexcept { return t_s.size(); }
};

}  // namespace touchstone::recording
