// A renderer as the detectors of this room see it: how to make one, and what its author says of it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "harness/rendering/limitation.h"
#include "harness/rendering/renderer.h"
#include "harness/surface/surface.h"

namespace touchstone::renderer_faults {

struct Engine {
  std::string name;  // letters, digits and underscores
  // Over a world whose lengths are multiplied by `unit`: lengths among the parameters must be too, and stiffnesses
  // divided, so that forces stay what they are.
  std::function<std::unique_ptr<rendering::Renderer>(std::shared_ptr<const surface::Surface>, double unit)> make;
  double stiffness_N_per_m = 500.0;  // the steepest rise of force with depth at unit 1
  double friction = 0.0;             // largest |f_t| / f_n
  double tip_radius_m = 0.0;
  std::vector<rendering::Limitation> cannot;
  // Lengths below this are nothing to the renderer: its author says so. 0: to rounding.
  double epsilon_m = 0.0;
  // Of the loop that asks it.
  double rate_Hz = 1000.0;
  // Its author says that every answer may be that of so many samples ago: the value of a parameter lag_samples.
  int lag_samples = 0;
  // How long a probe rests at every place before it reads the answer: 0 for the answer of the moving tip.
  int settle_samples = 0;
  // Allocations of this thread so far; empty where they are not counted.
  std::function<std::uint64_t()> allocations = {};
};

}  // namespace touchstone::renderer_faults
