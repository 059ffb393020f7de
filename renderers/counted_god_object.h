// The god-object of a point tip with every operation of a step counted: the walk of surface_walk.h over a mesh of
// counting numbers. The same forces to the bit as PointProxy's on the surface of make_embree_surface().
//
// Counted: the walk, friction, the spring, and the search for what a god-object in the air meets, on a plain tree of
// boxes. Not counted: the query of the first step of a run for whether it starts inside; the exact arithmetic behind
// the filter that decides which side of a triangle's border a path passes (a handful of cases in a million).
#pragma once

#include <memory>

#include "harness/rendering/renderer.h"
#include "harness/surface/surface.h"
#include "renderers/cone_friction.h"

namespace touchstone {

// nullptr where the mesh has triangles that cannot be walked on (Facet::regular): the way over those is not counted.
std::unique_ptr<Renderer> make_counted_god_object(std::shared_ptr<const Surface> surface, double stiffness_N_per_m,
                                                  const ConeFriction& friction);

}  // namespace touchstone
