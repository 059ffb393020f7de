// The bodies of a scene as one mesh in W, at the moment at hand: what a proxy by planes (plane_contact.h) wants of a
// mesh, each answer turned by the pose of its body. Triangles and vertices of all bodies are numbered through, body by
// body. Which triangles may be met is asked of each body's own tree in its own frame, so that nothing is built again
// when bodies move.
//
// Neighbours share the same turned corners, to the bit: nothing slips between the triangles of a body.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "harness/rendering/scene.h"
#include "renderers/mesh_traversal/contact_mesh.h"
#include "renderers/mesh_traversal/flush.h"

namespace touchstone::renderers {

class PosedBody {
 public:
  PosedBody(const rendering::SceneBody& body, std::int32_t first_triangle, std::int32_t first_vertex);

  [[nodiscard]] const surface::Surface& surface() const noexcept { return *surface_; }
  [[nodiscard]] const ContactMesh& mesh() const noexcept { return *mesh_; }
  [[nodiscard]] std::int32_t first_triangle() const noexcept { return first_triangle_; }
  [[nodiscard]] std::int32_t first_vertex() const noexcept { return first_vertex_; }

  [[nodiscard]] Vec3 to_W(const Vec3& x_B) const noexcept { return p_ + turn_ * x_B; }
  [[nodiscard]] Vec3 to_B(const Vec3& x_W) const noexcept { return turn_.transpose() * (x_W - p_); }
  [[nodiscard]] Vec3 direction_to_W(const Vec3& v_B) const noexcept { return turn_ * v_B; }
  [[nodiscard]] Vec3 direction_to_B(const Vec3& v_W) const noexcept { return turn_.transpose() * v_W; }
  // Where it was at the last step.
  [[nodiscard]] Vec3 before_to_W(const Vec3& x_B) const noexcept { return p_before_ + turn_before_ * x_B; }
  [[nodiscard]] Vec3 before_to_B(const Vec3& x_W) const noexcept {
    return turn_before_.transpose() * (x_W - p_before_);
  }
  [[nodiscard]] bool moved() const noexcept { return moved_; }

  // False where the track does not reach.
  bool move_to(double t_s, bool first) noexcept;
  [[nodiscard]] const rendering::PoseTrack& track() const noexcept { return track_; }
  // A ball about the body, in W.
  [[nodiscard]] Vec3 center() const noexcept { return to_W(center_B_); }
  [[nodiscard]] double radius() const noexcept { return radius_; }
  [[nodiscard]] const Vec3& origin() const noexcept { return p_; }

 private:
  std::shared_ptr<const surface::Surface> surface_;
  std::shared_ptr<const ContactMesh> mesh_;
  rendering::PoseTrack track_;
  std::size_t segment_ = 0;
  std::int32_t first_triangle_;
  std::int32_t first_vertex_;
  Vec3 center_B_;
  double radius_;
  Mat3 turn_ = Mat3::Identity(), turn_before_ = Mat3::Identity();
  Vec3 p_ = Vec3::Zero(), p_before_ = Vec3::Zero();
  bool moved_ = false;
};

class PosedBodies {
 public:
  using Scalar = double;
  // Throws BadData that names the body for one without triangles.
  explicit PosedBodies(const rendering::BodyScene& scene);

  // All bodies to where they are then; with `first` they were there before, too. False where a track does not reach.
  bool move_to(double t_s, bool first) noexcept;
  // Some body is elsewhere than at the last step.
  [[nodiscard]] bool moved() const noexcept { return moved_; }
  // Why move_to() was false.
  [[nodiscard]] std::string out_of_reach(double t_s) const;

  [[nodiscard]] const std::vector<PosedBody>& bodies() const noexcept { return bodies_; }
  [[nodiscard]] std::size_t body_of(std::int32_t triangle) const noexcept;

  [[nodiscard]] Facet facet(std::int32_t triangle) const noexcept;
  [[nodiscard]] Vec3 vertex(std::int32_t index) const noexcept;
  [[nodiscard]] Vec3 vertex_normal(std::int32_t index) const noexcept;
  [[nodiscard]] std::array<Vec3, 3> corners(std::int32_t triangle) const noexcept;

  class Tree {
   public:
    explicit Tree(const std::vector<PosedBody>& bodies) : bodies_(&bodies) {}
    // As TriangleTree's.
    template <class Visit>
    void along_segment(const Vec3& a, const Vec3& b, Visit&& visit) const {
      const Vec3 middle = 0.5 * (a + b);
      const double half = 0.5 * (b - a).norm();
      for (const PosedBody& body : *bodies_) {
        if (!reaches(body, middle, half)) continue;
        const std::int32_t first = body.first_triangle();
        body.mesh().tree().along_segment(body.to_B(a), body.to_B(b),
                                         [&](std::int32_t t) -> double { return visit(first + t); });
      }
    }
    template <class Visit>
    void within(const Vec3& center, double radius, Visit&& visit) const {
      for (const PosedBody& body : *bodies_) {
        if (!reaches(body, center, radius)) continue;
        const std::int32_t first = body.first_triangle();
        // A body before it may have said that less is of interest; this one's own answers say so again.
        body.mesh().tree().within(body.to_B(center), radius,
                                  [&](std::int32_t t) -> double { return visit(first + t); });
      }
    }

   private:
    static bool reaches(const PosedBody& body, const Vec3& center, double radius) noexcept {
      const double reach = body.radius() + radius;
      return (body.center() - center).squaredNorm() <= reach * reach;
    }
    const std::vector<PosedBody>* bodies_;
  };
  [[nodiscard]] Tree tree() const noexcept { return Tree(bodies_); }

  // What counts as flush between surfaces: of the coarsest body's coordinates, wherever the bodies are.
  [[nodiscard]] double flush() const noexcept { return flush_; }
  // The largest magnitude of a coordinate now.
  [[nodiscard]] double magnitude() const noexcept { return magnitude_; }
  // At least the length of the bounding box's diagonal now.
  [[nodiscard]] double extent() const noexcept { return extent_; }
  [[nodiscard]] bool open() const noexcept;
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

 private:
  std::vector<PosedBody> bodies_;
  double flush_ = 0.0;
  double magnitude_ = 0.0;
  double extent_ = 0.0;
  bool moved_ = false;
};

}  // namespace touchstone::renderers
