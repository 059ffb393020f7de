// The Delaunay triangulation of points in the unit square (Delaunay 1934), as the dual of the Voronoi diagram by
// Boost.Polygon, which is exact on whole numbers: the points are rounded to a grid of 2^-24.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace touchstone::texture {

// Corners by their place among the points, counterclockwise. Points on one circle are joined as a fan.
std::vector<std::array<std::size_t, 3>> delaunay(const std::vector<std::array<double, 2>>& points);

}  // namespace touchstone::texture
