// The atlas of a renderer's geometric correctness (Ruffaldi et al. 2006, section 5 and figure 8): sharpness x stiffness
// x friction x renderer, each case a run whose exact answer is known, told apart by the detectors of
// extras/studies/atlas/anomalies.h.
//
// Two scenes, both extruded along y, traced along x at 20 mm/s and 1 kHz by a hand that presses with 1.5 N:
//   bump   a ridge 3 mm high and 8 mm wide on a block; sharpness: the angle of its sides against the block [rad]. The
//          out-trajectory follows its outline with the exact normals; the in-trajectory is equation 2. At a corner the
//          normal turns at once, and with it the tip, as deep as stiffness lets it be: the case of figure 8.
//   shell  a flat plate; sharpness: its thickness [m]. Deeper than it is thick the tip is beyond its far side.
// Friction: renderers with mu_static and mu_dynamic of their own run with both at the coefficient, others with the
// effect coulomb-friction; how far friction may rightly hold the contact point back is allowed for.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "atlas/anomalies.h"

namespace touchstone::atlas {

enum class Scene : std::uint8_t { bump, shell };
std::string name_of(Scene scene);

struct AtlasGrid {
  std::vector<std::string> renderers{"god-object", "friction-cone", "force-shading", "penalty", "voxel"};
  std::vector<double> side_angles_rad{0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4, 1.55};
  std::vector<double> thicknesses_m{2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5};
  std::vector<double> stiffnesses_N_per_m{100, 200, 400, 800, 1600, 3200};
  std::vector<double> mus{0.0, 0.2, 0.5, 1.0};
  double force_N = 1.5;
};

struct AtlasCase {
  Scene scene;
  std::string renderer;
  double sharpness;  // rad or m, see above
  double stiffness_N_per_m;
  double mu;
  Anomalies found;
  std::string error;  // why it could not be run; empty: it ran
};

// How many cases that is.
std::uint64_t case_count(const AtlasGrid& grid);
// What the case with that number is, below case_count(); not yet run. The bump first, then by renderer, sharpness,
// stiffness, friction.
AtlasCase case_at(const AtlasGrid& grid, std::uint64_t number);

// The bodies and the ways over them, made when a case first needs them and shared by all.
class AtlasWorld {
 public:
  // Throws BadData for an unknown renderer.
  explicit AtlasWorld(const AtlasGrid& grid);
  ~AtlasWorld();
  AtlasWorld(const AtlasWorld&) = delete;
  AtlasWorld& operator=(const AtlasWorld&) = delete;

  // Thread-safe; depends on the case alone. Throws BadData where the renderer refuses.
  [[nodiscard]] Anomalies run(const AtlasCase& one);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// One case, for tests.
AtlasCase run_case(Scene scene, const std::string& renderer, double sharpness, double stiffness_N_per_m, double mu,
                   double force_N = 1.5);

// What is wrong, shortest first: "" for nothing, else of "s" sticks, "p" pops through, "l" loses contact, "i" pulls
// inward, each where at least 1 % of the samples show it.
std::string letters(const Anomalies& found);
// The same of a case; "?" for one that could not be run.
std::string letters(const AtlasCase& one);

}  // namespace touchstone::atlas
