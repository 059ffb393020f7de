// The god-object of a point tip where a mesh cannot be walked on by neighbours: where bodies cross, touch or lie flush
// beside each other, at edges of three or more triangles, at triangles without area.
//
// Sources: Zilles and Salisbury 1995 as they print it: up to three active planes, found by intersecting the
// god-object's path with the surface; between two crossings it goes to the point nearest to the tip under the active
// planes (their section 4). D. C. Ruspini, K. Kolarov and O. Khatib, "The haptic display of complex graphical
// environments", SIGGRAPH 1997, section 4, and CHAI3D's cAlgorithmFingerProxy ("we make sure to keep the proxy slightly
// above any triangle and not directly on it"): the path is that of a proxy which keeps a small distance from the
// surface.
//
// Two points go together: the god-object itself, exactly on its planes, which gives the force, and a free point beside
// it, `lift` in front of them, which makes the way. Only the free point's way is tested against triangles:
// - A side that lies inside another body is never met: in front of it is no free space to come from.
// - A side whose upper rim is flush with the floor ends below the free point, which passes over it. A god-object on the
//   floor itself would meet the rim, by rounding or exactly, and stand before a wall that is not there.
// - Into the gap between two flush bodies it does not fall: outlines are taken wider by as much as counts as flush.
// Every step starts in free space at no plane but the only one, so that planes which hold it by an accident of rounding
// do not hold it in the next. The way's every piece is tested against all triangles: it passes through nothing that is
// larger than what counts as flush (flush.h).
//
// At non-manifold edges it may rest where a walk would slide on.
//
// Over any mesh with the members of ContactMesh that it uses: ContactMesh itself, and the bodies of a scene
// (posed_bodies.h), which may stand elsewhere at each step: carry() then says where the two points are.
#pragma once

#include <array>
#include <cstdint>

#include "renderers/friction/cone_friction.h"
#include "renderers/friction/nearest_in_polyhedron.h"
#include "renderers/mesh_traversal/contact_mesh.h"

namespace touchstone::renderers {

template <class Mesh>
class PlaneContactOf {
 public:
  using Scalar = double;
  explicit PlaneContactOf(const Mesh& mesh);

  // The god-object is at g on the triangle; or in free space.
  void start_on(std::int32_t triangle, const Vec3& g) noexcept;
  void start_free(const Vec3& g) noexcept;
  // In free space at the free point's distance from whatever is behind it.
  void start_lifted(const Vec3& free) noexcept;
  // The bodies have moved, and the two points with what they touch.
  void carry(const Vec3& g, const Vec3& free) noexcept;
  // Towards p, without friction.
  void pull(const Vec3& p) noexcept;

  [[nodiscard]] bool touching() const noexcept { return active_.size > 0; }
  [[nodiscard]] const Vec3& position() const noexcept { return g_; }
  [[nodiscard]] const Vec3& free_point() const noexcept { return free_; }
  // How far the free point is in front of the planes.
  [[nodiscard]] double lift() const noexcept { return lift_; }
  [[nodiscard]] Vec3 push(const Vec3& p) const noexcept { return touching() ? Vec3(g_ - p) : Vec3::Zero(); }
  [[nodiscard]] Vec3 normal(const Vec3& p) const noexcept;
  [[nodiscard]] ContactNormals contact_normals() const noexcept;
  [[nodiscard]] ContactPlaces contact_places() const noexcept;
  // The only active triangle, -1 where there are none or several.
  [[nodiscard]] std::int32_t single() const noexcept { return active_.size == 1 ? active_.triangle[0] : -1; }

 private:
  struct Active {
    std::array<std::int32_t, 4> triangle{-1, -1, -1, -1};  // a fourth only until the next solution
    int size = 0;

    [[nodiscard]] bool has(std::int32_t t) const noexcept;
    void add(std::int32_t t) noexcept { triangle[static_cast<std::size_t>(size++)] = t; }
    void remove(int index) noexcept;
  };

  // The place nearest to `to` that is `lift` in front of the active triangles' planes; they become those that hold it
  // there. False where there is no such place.
  bool nearest_in_front(const Vec3& to, double lift, Vec3& place) noexcept;
  void descend(const Vec3& p) noexcept;
  // The free point to where the way to `goal` leaves the outline of an active triangle, if that comes first.
  bool over_border(const Vec3& p, const Vec3& goal, double hit_fraction) noexcept;
  void meet(std::int32_t triangle, const Vec3& goal, const Vec3& p) noexcept;
  // The surface that the tip is in, to what counts as flush, and that ends at the place where the tip ran against a
  // side below it; -1 where there is none. The tip then touches that surface and not the side.
  [[nodiscard]] std::int32_t floor_over(std::int32_t side, const Vec3& place, const Vec3& p) const noexcept;
  // The free point to its distance in front of that triangle, where nothing hangs over it.
  void rise_over(std::int32_t triangle) noexcept;
  [[nodiscard]] bool behind(std::int32_t triangle, std::int32_t other) const noexcept;
  void rest(const Vec3& p, bool arrived) noexcept;

  const Mesh* mesh_;
  double flush_;
  double lift_;
  Vec3 g_ = Vec3::Zero();
  Vec3 free_ = Vec3::Zero();  // in front of all surfaces
  Vec3 pulled_to_;            // where the last pull went
  Active active_;
  bool lifted_ = false;     // the free point is off the surface, not just wherever the tip is
  std::int32_t left_ = -1;  // the triangle whose outline the way left last
};

using PlaneContact = PlaneContactOf<ContactMesh>;

}  // namespace touchstone::renderers
