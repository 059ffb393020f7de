// Straight strokes: one line at any speed and angle, to and fro over an edge, and a raster.
#pragma once

#include "synthetic/trajectories/path.h"

namespace touchstone::synthetic {

// To and fro along a line through the origin at constant speed, at a depth below z = 0. The line's direction in the
// plane is `azimuth_rad` from x; with `descent_rad` it dips below the horizontal in the direction of travel.
struct Stroke {
  double length_m;
  double speed_m_per_s;
  double azimuth_rad;
  double descent_rad;
  double depth_m;
  double passes;
};

class StrokePath final : public Path {
 public:
  explicit StrokePath(const Stroke& stroke) : stroke_(stroke) {}
  [[nodiscard]] Vec3 position_W_m(double t_s) const override;
  [[nodiscard]] double duration_s() const override { return stroke_.passes * stroke_.length_m / stroke_.speed_m_per_s; }

 private:
  Stroke stroke_;
};

// A star of strokes through the origin, each from another angle, joined by arcs about it: crosses an edge along y under
// every angle of incidence at constant speed.
class EdgeCrossingPath final : public Path {
 public:
  EdgeCrossingPath(double length_m, double speed_m_per_s, double depth_m, double strokes)
      : length_m_(length_m), speed_m_per_s_(speed_m_per_s), depth_m_(depth_m), strokes_(strokes) {}
  [[nodiscard]] Vec3 position_W_m(double t_s) const override;
  [[nodiscard]] double duration_s() const override;

 private:
  double length_m_;
  double speed_m_per_s_;
  double depth_m_;
  double strokes_;
};

// Lines along y, one beside the other in x, joined by steps along x: constant speed over a square about the origin.
class RasterPath final : public Path {
 public:
  RasterPath(double side_m, double lines, double speed_m_per_s, double depth_m)
      : side_m_(side_m), lines_(lines), speed_m_per_s_(speed_m_per_s), depth_m_(depth_m) {}
  [[nodiscard]] Vec3 position_W_m(double t_s) const override;
  [[nodiscard]] double duration_s() const override { return (lines_ * side_m_ + side_m_) / speed_m_per_s_; }

 private:
  double side_m_;
  double lines_;  // at least 2
  double speed_m_per_s_;
  double depth_m_;
};

}  // namespace touchstone::synthetic
