// Which triangles may meet a segment or a ball: candidates for renderers that decide for themselves, in double
// precision, what counts as contact. A bounding volume hierarchy (Embree 3) in single precision over padded boxes: it
// never leaves out a triangle that meets the segment or ball, but proposes others too. The mesh is centred and scaled
// to a unit box, so that neither the user's unit nor the origin changes the candidates' completeness. Thread-safe;
// visits allocate nothing.
#pragma once

#include <cstdint>
#include <memory>
#include <type_traits>

#include "harness/base/vec.h"
#include "harness/surface/triangle_mesh.h"

namespace touchstone::surface {

class TriangleTree {
 public:
  // Keeps a reference: the mesh must outlive the tree. Needs at least one triangle and finite, valid corners. Throws
  // Error naming the mesh if Embree cannot build its hierarchy.
  explicit TriangleTree(const TriangleMesh& mesh);
  ~TriangleTree();
  TriangleTree(const TriangleTree&) = delete;
  TriangleTree& operator=(const TriangleTree&) = delete;

  // Calls visit(triangle) -> double for the candidates of the segment a-b, in no particular order. The answer is the
  // fraction of the segment beyond which further candidates are of no interest (1: all are). Both ends finite.
  template <class Visit>
  void along_segment(const Vec3& a, const Vec3& b, Visit&& visit) const {
    segment(a, b, {&visit, [](void* self, std::int32_t t) {
                     return (*static_cast<std::remove_reference_t<Visit>*>(self))(t);
                   }});
  }

  // Calls visit(triangle) -> double for the candidates within `radius` of `center`, in no particular order. The answer
  // is the radius beyond which further candidates are of no interest.
  template <class Visit>
  void within(const Vec3& center, double radius, Visit&& visit) const {
    ball(center, radius,
         {&visit, [](void* self, std::int32_t t) { return (*static_cast<std::remove_reference_t<Visit>*>(self))(t); }});
  }

  // Calls visit(s, t) for the pairs of triangles whose boxes overlap, every pair at least once in some order (s may
  // equal t), from several threads at a time.
  template <class Visit>
  void overlapping_pairs(Visit&& visit) const {
    pairs({&visit, [](void* self, std::int32_t s, std::int32_t t) {
             (*static_cast<std::remove_reference_t<Visit>*>(self))(s, t);
           }});
  }

 private:
  struct PairVisitor {
    void* self;
    void (*call)(void*, std::int32_t, std::int32_t);
  };
  void pairs(PairVisitor visitor) const;
  struct Visitor {
    void* self;
    double (*call)(void*, std::int32_t);
  };
  struct Embree;
  void segment(const Vec3& a, const Vec3& b, Visitor visitor) const;
  void ball(const Vec3& center, double radius, Visitor visitor) const;

  std::unique_ptr<Embree> embree_;
};

}  // namespace touchstone::surface
