// Where the maps of a model lie, and what a misplaced object is moved by, in any frame of the world.
//
// A map over a surface (a soft place, a texture, a field) is a function of x and y. Without more they are the object's;
// `frame_x_m` to `frame_rz_rad` of its entry in a model file give it a frame of its own, so that a surface that does
// not face the object's z has maps too: an origin, and a rotation vector that turns the object's axes into the frame's.
//
// A misplaced object (`registration`) is moved by d + r x (true - pivot). The set of these motions is the same whatever
// the pivot, and turns and shifts with the world; what a fit can tell of d is not: about a pivot far away it is all
// lever arm.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "harness/base/vec.h"
#include "harness/rendering/renderer.h"

namespace touchstone::rendering {

struct SurfaceFrame {
  Vec3 origin_W_m = Vec3::Zero();
  Quat q_WF = Quat::Identity();

  [[nodiscard]] bool is_objects() const noexcept { return origin_W_m.isZero(0.0) && q_WF.vec().isZero(0.0); }
  [[nodiscard]] Vec3 place(const Vec3& p_W_m) const noexcept { return q_WF.conjugate() * (p_W_m - origin_W_m); }
  [[nodiscard]] Vec3 direction(const Vec3& v_W) const noexcept { return q_WF.conjugate() * v_W; }
  // Whose z is a surface's mean normal, by the least turn of the object's axes.
  static SurfaceFrame facing(const Vec3& normal_W, const Vec3& origin_W_m);
};

// A map's parameters, with those of its frame at their end.
std::vector<ParameterDeclaration> with_frame(std::vector<ParameterDeclaration> map);
bool has_frame(const std::vector<ParameterDeclaration>& declared);
SurfaceFrame frame_of(const std::map<std::string, double>& parameters);
// Of all values of a map.
SurfaceFrame frame_of(std::span<const double> values);
// Nothing where the frame is the object's.
void add_frame(const SurfaceFrame& frame, std::map<std::string, double>& parameters);

struct ObjectDisplacement {
  Vec3 shift_W_m = Vec3::Zero();  // of the pivot
  Vec3 turn_W_rad = Vec3::Zero();
  Vec3 pivot_W_m = Vec3::Zero();

  [[nodiscard]] Vec3 at(const Vec3& true_W_m) const noexcept {
    return shift_W_m + turn_W_rad.cross(true_W_m - pivot_W_m);
  }
};

// Of a registration: dx_m, dy_m, dz_m, rx_rad, ry_rad, rz_rad and pivot_x_m, pivot_y_m, pivot_z_m; what is not given is
// zero.
ObjectDisplacement displacement_of(const std::map<std::string, double>& parameters);

}  // namespace touchstone::rendering
