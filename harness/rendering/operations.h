// How many floating-point operations a renderer's steps take: exact and repeatable, from a renderer whose arithmetic
// runs on harness/base/counted.h (renderers/catalogue.h makes it).
// Source: Ruffaldi et al. 2006, section 3.3: "the mean, median, and maximum numbers of floating-point operations
// required to compute a surface contact point and/or penalty force and the floating-point operation count for the
// complete trajectory".
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "harness/base/counted.h"
#include "harness/rendering/replay.h"

namespace touchstone::rendering {

// What every count of a renderer on triangles is of, to be said where it is shown.
inline constexpr std::string_view how_searches_are_counted =
    "searches are counted on a plain tree of boxes, not inside Embree or CGAL";

struct OperationReport {
  std::uint64_t steps = 0;
  OperationCounts counts;  // of the whole trajectory, by kind
  double mean = 0.0;       // per step, all kinds
  double median = 0.0;     // of an even number of steps the mean of the middle two
  std::uint64_t max = 0;
  std::string not_counted;  // what of the model is not in the numbers; empty: nothing

  [[nodiscard]] std::uint64_t total() const noexcept { return counts.total(); }
};

// Resets the renderer and steps it over the positions. Throws BadData as replay() does.
OperationReport count_operations(Renderer& counted, const TipSource& source);

// {"total", "mean", "median", "max", "add", "multiply", "divide", "square_root", "compare", "not_counted",
// "searches": how_searches_are_counted}
std::string operations_to_json(const OperationReport& report);

}  // namespace touchstone::rendering
