#include "synthetic/trajectories/strokes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone::synthetic {

Vec3 StrokePath::position_W_m(double t_s) const {
  const double t = std::clamp(t_s, 0.0, duration_s());
  const double along = stroke_.length_m * (to_and_fro(t * stroke_.speed_m_per_s / stroke_.length_m) - 0.5);
  const double level = std::cos(stroke_.descent_rad);
  return {along * level * std::cos(stroke_.azimuth_rad), along * level * std::sin(stroke_.azimuth_rad),
          -stroke_.depth_m - along * std::sin(stroke_.descent_rad)};
}

double EdgeCrossingPath::duration_s() const {
  const double turn = std::numbers::pi / strokes_;
  return (strokes_ * length_m_ + (strokes_ - 1.0) * 0.5 * length_m_ * turn) / speed_m_per_s_;
}

Vec3 EdgeCrossingPath::position_W_m(double t_s) const {
  const double radius = 0.5 * length_m_;
  const double turn = std::numbers::pi / strokes_;
  const double leg = length_m_ + radius * turn;
  const double travelled = speed_m_per_s_ * std::clamp(t_s, 0.0, duration_s());
  const double stroke = std::min(std::floor(travelled / leg), strokes_ - 1.0);
  const double within = travelled - stroke * leg;
  // Travel starts half a turn away from where it ends; the next stroke comes back in from the end of the arc.
  const double heading = 0.5 * turn + stroke * (std::numbers::pi + turn);
  const double along = std::min(within, length_m_) - radius;
  const double angle = heading + std::max(0.0, within - length_m_) / radius;
  return {along * std::cos(angle), along * std::sin(angle), -depth_m_};
}

Vec3 RasterPath::position_W_m(double t_s) const {
  const double pitch = side_m_ / (lines_ - 1.0);
  const double travelled = speed_m_per_s_ * std::clamp(t_s, 0.0, duration_s());
  const double line = std::min(std::floor(travelled / (side_m_ + pitch)), lines_ - 1.0);
  const double within = travelled - line * (side_m_ + pitch);
  const bool up = std::fmod(line, 2.0) == 0.0;
  const double along = std::min(within, side_m_);
  const double y = (up ? along : side_m_ - along) - 0.5 * side_m_;
  const double x = line * pitch + std::max(0.0, within - side_m_) - 0.5 * side_m_;
  return {std::min(x, 0.5 * side_m_), y, -depth_m_};
}

}  // namespace touchstone::synthetic
