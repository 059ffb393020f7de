// The voxel renderer: looks up the voxel that holds the tip and pushes the tip out of that voxel's plane.
//
// Source: Ruffaldi et al. 2006, section 4.1; McNeely, Puterbaugh and Troy 1999, section 3: F = k d n with d the depth
// of the tip below the voxel's plane and n its normal. See voxel_grid.h for what a voxel knows. The tip is a point.
//
// "voxel" stores every voxel, "voxel-sparse" only those near the surface: the same forces to the bit.
#pragma once

#include "harness/rendering/renderer_entry.h"

namespace touchstone::renderers {

rendering::RendererEntry voxel_entry();
rendering::RendererEntry voxel_sparse_entry();

}  // namespace touchstone::renderers
