// Runs one case of a sweep. Surfaces with the structures that renderers build on them, and trajectories, are shared by
// all cases and threads, never made anew for a case.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "apps/sweep/design.h"
#include "harness/baseline/golden_summary.h"

namespace touchstone::apps {

// How far the rendered forces and surface contact points are from the exact answer on the analytic surface
// (synthetic/surfaces/exact_contact.h): for god-object and spring-linear without effects, on generated surfaces.
struct ExactError {
  double force_rms_N = 0.0;
  double force_max_N = 0.0;
  double contact_rms_m = 0.0;  // over the samples in contact on both sides
};

struct SweepOutcome {
  SweepCase one;
  std::string error;  // empty: it ran
  GoldenSummary summary;
  std::optional<ExactError> exact;
};

class SweepWorld {
 public:
  explicit SweepWorld(const SweepDesign& design);
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

}  // namespace touchstone::apps
