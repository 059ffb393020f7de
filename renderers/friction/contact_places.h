// What presses on a proxy at rest: the contacts, as friction and force shading ask for them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "harness/base/vec.h"
#include "harness/surface/surface.h"

namespace touchstone::renderers {

// Up to three unit normals.
template <class S>
struct ContactNormalsOf {
  std::array<Vec3Of<S>, 3> n;
  int size = 0;
};
using ContactNormals = ContactNormalsOf<double>;

// Where a proxy rests that touches at one place; triangle < 0 where it touches at none, or at several.
template <class S>
struct RestingPlaceOf {
  std::int32_t triangle = -1;
  surface::Feature feature = surface::Feature::face;
  std::size_t index = 0;            // of the edge or corner
  Vec3Of<S> p = Vec3Of<S>::Zero();  // on the triangle
};

// Where on which triangles they are.
template <class S>
struct ContactPlacesOf {
  struct Place {
    std::int32_t triangle = -1;
    surface::Feature feature = surface::Feature::face;
    std::size_t index = 0;  // of the edge or corner
    Vec3Of<S> p;            // on the triangle
    Vec3Of<S> n;            // unit normal of this contact
  };
  std::array<Place, 3> place;
  int size = 0;
};
using ContactPlaces = ContactPlacesOf<double>;

}  // namespace touchstone::renderers
