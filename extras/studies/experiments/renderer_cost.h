// What a step of every renderer costs, on one body at several densities of its mesh: floating-point operations
// (Ruffaldi et al. 2006, section 3.3), microseconds, memory, and the time to make the renderer. One motion for all: 10
// s at 1 kHz over the bumpy body, three turns about it, up to 1 mm deep, in the air once a second.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "harness/rendering/operations.h"
#include "harness/rendering/replay.h"
#include "harness/report/page.h"
#include "harness/report/provenance.h"

namespace touchstone::experiments {

struct RendererCost {
  std::string what;      // renderer, tip and friction
  std::string renderer;  // its name in the catalogue
  double tip_radius_m = 0.0;
  double mu = 0.0;
  std::size_t triangles = 0;
  rendering::ReplayTiming timing;
  std::optional<rendering::OperationReport> operations;
  std::string not_counted;  // why there are no operations, or what of the model is left out
  double in_contact = 0.0;  // share of the steps
};

struct CostOptions {
  std::vector<std::size_t> triangles{1000, 10000, 140000};
  std::size_t steps = 10000;
  std::size_t voxels = 64;  // or nodes along the longest side, of renderers that need a grid
};

// Every renderer of the catalogue, point tips first; those with friction and those with a ball tip too; each over
// every different size, the smallest first. Throws UsageError for no size or no step.
std::vector<RendererCost> measure_costs(const CostOptions& options, const std::function<void(std::size_t)>& done = {});
std::size_t cost_cases(const CostOptions& options);

std::string cost_table(const std::vector<RendererCost>& costs);
report::Page cost_page(const std::vector<RendererCost>& costs, const report::Provenance& provenance);
std::string cost_to_json(const std::vector<RendererCost>& costs);

// The positions of the tip: as the benchmark's.
std::vector<Vec3> path_over_the_bumpy_body(double tip_radius_m, std::size_t steps);

}  // namespace touchstone::experiments
