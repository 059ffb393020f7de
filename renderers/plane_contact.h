// The god-object of a point tip where a mesh cannot be walked on by neighbours: at triangles that cross each other, at
// edges of three or more triangles, at triangles without area.
//
// Source: Zilles and Salisbury 1995 as they print it: up to three active planes, found by intersecting the god-object's
// path with the surface; between two crossings it goes to the point nearest to the tip under the active planes (their
// section 4). A plane is active while the god-object is over its triangle.
// It follows the tip in moves that are each tested against all triangles near, so that it passes through none of them;
// at non-manifold edges it may rest where a walk would slide on.
#pragma once

#include <array>
#include <cstdint>

#include "renderers/cone_friction.h"
#include "renderers/contact_mesh.h"

namespace touchstone {

class PlaneContact {
 public:
  using Scalar = double;
  explicit PlaneContact(const ContactMesh& mesh) : mesh_(&mesh) {}

  // The god-object is at g on the triangle.
  void start(const Vec3& g, std::int32_t triangle) noexcept;
  // Towards p, without friction.
  void pull(const Vec3& p) noexcept;

  [[nodiscard]] bool touching() const noexcept { return size_ > 0; }
  [[nodiscard]] const Vec3& position() const noexcept { return g_; }
  [[nodiscard]] Vec3 push(const Vec3& p) const noexcept { return touching() ? Vec3(g_ - p) : Vec3::Zero(); }
  [[nodiscard]] Vec3 normal(const Vec3& p) const noexcept;
  [[nodiscard]] ContactNormals contact_normals() const noexcept;
  [[nodiscard]] ContactPlaces contact_places() const noexcept;
  // The only active triangle, -1 where there are none or several.
  [[nodiscard]] std::int32_t single() const noexcept { return size_ == 1 ? active_[0] : -1; }

 private:
  [[nodiscard]] bool active(std::int32_t triangle) const noexcept;
  void remove(int index) noexcept;
  bool over_border(const Vec3& p, const Vec3& goal, double hit_fraction, std::int32_t& left) noexcept;

  const ContactMesh* mesh_;
  Vec3 g_ = Vec3::Zero();
  std::array<std::int32_t, 4> active_{};  // a fourth only until the next solution
  int size_ = 0;
};

}  // namespace touchstone
