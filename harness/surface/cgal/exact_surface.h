// The slow, exact twin of the Embree surface: CGAL's AABB tree with exact predicates finds the triangles, exact
// rational arithmetic decides among them and computes the answer, which is rounded once at the end. For checking the
// fast one, and for whoever would rather wait than wonder.
//
// Its .cc files use CGAL packages under the GPL (AABB tree, polygon mesh processing). A program that links them is to
// be distributed under the GPL. Built with TOUCHSTONE_WITH_CGAL=OFF this room contains no CGAL, and says so.
#pragma once

#include <memory>

#include "harness/surface/surface.h"

namespace touchstone::surface {

// Whether this build has it.
bool exact_surface_available() noexcept;

// As make_embree_surface(), except that queries allocate. Throws UsageError where it is not available.
std::shared_ptr<Surface> make_exact_surface(const TriangleMesh& mesh);

}  // namespace touchstone::surface
