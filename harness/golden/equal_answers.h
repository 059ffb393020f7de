// Golden answers that are one of several: a spring from the closest surface point has as many right answers as points
// are equally close (the medial axis: H. Blum, "A transformation for extracting new descriptors of shape", 1967). A
// golden holds one of them, and so does an exact answer; another one is as right.
#pragma once

#include <cstddef>

#include "harness/golden/comparison/tolerance.h"
#include "harness/golden/comparison/trajectory_columns.h"
#include "harness/surface/surface.h"

namespace touchstone::golden {

// Where `obtained` gives another equal answer, its contact point and force become the expected ones (time, tip and the
// rest stay); returns in how many rows.
// Equal: the surface contact point is another point of the surface at the least distance, and the force, as large as
// expected, is along the way from the tip to it; all within tolerance. For a renderer that pushes to the closest point.
std::size_t take_equal_answers(const surface::Surface& surface, const Tolerance& tolerance,
                               const TrajectoryColumns& obtained, TrajectoryColumns& expected);

}  // namespace touchstone::golden
