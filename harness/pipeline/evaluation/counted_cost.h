// The platform-independent cost of a renderer on a recording: floating-point operations of its steps, as the 2006 paper
// counts them (harness/rendering/operations.h). Beside the catalogue of metrics because counting needs a renderer, not
// samples.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "harness/metrics/metric.h"
#include "harness/rendering/catalogue.h"
#include "harness/rendering/model.h"
#include "harness/rendering/replay.h"
#include "harness/surface/surface.h"

namespace touchstone::pipeline {

// What --metrics may name: "operations" for all, or one result.
const std::vector<std::string>& operation_metrics();
bool is_operation_metric(std::string_view name);
bool asks_for_operations(std::span<const std::string> names);

// total_operations, mean_operations, median_operations and max_operations of a step, unit "1": those of `names`, all
// where it is empty or has "operations". `missing`, with the reason, where the renderer's operations are not counted.
std::vector<metrics::MetricResult> count_of_steps(const rendering::Catalogue& catalogue, const rendering::Model& model,
                                                  const std::shared_ptr<const surface::Surface>& surface,
                                                  const rendering::TipSource& source,
                                                  std::span<const std::string> names);

}  // namespace touchstone::pipeline
