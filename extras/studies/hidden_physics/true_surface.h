// The true, smooth surface of a blind case: a graph z = h(x, y), inside below, of quadratics, waves and Gaussian bumps.
// Its closest point follows a moving tip by Newton's method from the last one, so that a 10 kHz simulation can ask at
// every step. Deliberately apart from the other surfaces of this folder and from the renderers: blind cases share no
// code with what they test.
#pragma once

#include <vector>

#include "harness/surface/triangle_mesh.h"

namespace touchstone::hidden_physics {

using Vec2 = Eigen::Vector2d;

class TrueSurface {
 public:
  struct Wave {
    double amplitude_m;
    Vec2 k_per_m;
    double phase_rad;
  };
  struct Bump {
    double amplitude_m;
    Vec2 centre_m;
    double width_m;  // standard deviation
  };

  double half_side_m = 0.05;  // of the square that is scanned and meshed
  Vec2 curvature_per_m = Vec2::Zero();
  std::vector<Wave> waves;
  std::vector<Bump> bumps;

  struct Jet {
    double h;
    Vec2 slope;
    Eigen::Matrix2d bend;
  };
  [[nodiscard]] Jet at(const Vec2& xy) const;

  struct Foot {
    Vec3 q_W_m = Vec3::Zero();
    Vec3 n_W = Vec3::UnitZ();
    double distance_m = 0.0;  // negative inside
  };
  // The closest point near `guess` (the foot of a tip that has hardly moved since).
  [[nodiscard]] Foot foot(const Vec3& p_W_m, const Vec2& guess_m) const;

  // A closed slab: `cells` x `cells` squares on top, walls, and a flat bottom `thickness_m` below the lowest point.
  [[nodiscard]] surface::TriangleMesh slab(std::size_t cells, double thickness_m) const;
  // The largest vertical distance between the mesh's top and this surface, over a grid four times as fine as the mesh.
  [[nodiscard]] double deviation_m(const TrueSurface& meshed, std::size_t cells) const;
};

}  // namespace touchstone::hidden_physics
