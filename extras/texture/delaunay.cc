#include "delaunay.h"

#include <boost/polygon/voronoi.hpp>
#include <cmath>
#include <cstdint>

namespace touchstone::texture {

std::vector<std::array<std::size_t, 3>> delaunay(const std::vector<std::array<double, 2>>& points) {
  constexpr double grid = 16777216.0;  // 2^24
  std::vector<boost::polygon::point_data<std::int32_t>> whole;
  for (const auto& [x, y] : points)
    whole.emplace_back(static_cast<std::int32_t>(std::lround(x * grid)),
                       static_cast<std::int32_t>(std::lround(y * grid)));
  boost::polygon::voronoi_diagram<double> diagram;
  boost::polygon::construct_voronoi(whole.begin(), whole.end(), &diagram);
  std::vector<std::array<std::size_t, 3>> triangles;
  for (const auto& vertex : diagram.vertices()) {
    std::vector<std::size_t> around;
    const auto* edge = vertex.incident_edge();
    do {
      around.push_back(edge->cell()->source_index());
      edge = edge->rot_next();
    } while (edge != vertex.incident_edge());
    for (std::size_t i = 2; i < around.size(); ++i) triangles.push_back({around[0], around[i - 1], around[i]});
  }
  return triangles;
}

}  // namespace touchstone::texture
