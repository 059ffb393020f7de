// Runs one case of a sweep. Surfaces with the structures that renderers build on them, and trajectories, are shared by
// all cases and threads, never made anew for a case.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "design.h"
#include "harness/golden/exact_error.h"
#include "harness/golden/golden_summary.h"

namespace touchstone::sweep {

// Cases of points: surfaces and trajectories are those of golden cases (harness/golden/golden_case.h), a model is
// touchstone-model/1, /scale and /speed are of the whole; the seed is the trajectory's:
//   "surfaces": {"ball": {"name": "sphere", "parameters": {"radius_m": 0.03}, "triangles": 2000}},
//   "trajectories": {"scan": {"name": "hand-scan", "offset_m": [0, 0, 0.03]}}
runs::DesignParts sweep_parts();

struct SweepOutcome {
  runs::SweepCase one;
  std::string error;  // empty: it ran
  golden::GoldenSummary summary;
  std::optional<golden::ExactError> exact;  // where it is asked for, on generated surfaces
};

class SweepWorld {
 public:
  // Both must live as long as the world.
  SweepWorld(const golden::Catalogues& catalogues, const runs::SweepDesign& design);
  ~SweepWorld();
  SweepWorld(const SweepWorld&) = delete;
  SweepWorld& operator=(const SweepWorld&) = delete;

  // Thread-safe; the outcome depends on the case alone. Never throws for what the case is: that is its error.
  [[nodiscard]] SweepOutcome run(std::uint64_t number);
  // How many surfaces were made so far.
  [[nodiscard]] std::uint64_t surfaces_made() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace touchstone::sweep
