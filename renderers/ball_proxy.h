// The god-object of a ball tip: the ball's centre follows the tip, never closer to the surface than the ball's radius.
//
// Sources: D. C. Ruspini, K. Kolarov and O. Khatib, "The haptic display of complex graphical environments", SIGGRAPH
// 1997 (virtual proxy: a ball that moves towards the goal among configuration-space obstacles, section 4); C. B. Zilles
// and J. K. Salisbury 1995 for the rest position under up to three constraints. Instead of their facets grown by the
// radius, here the centre keeps its exact distance from each triangle as a convex set (faces, edges as cylinders,
// corners as balls), solved by Newton's method (ball_constraints.h).
//
// Why the ball passes through nothing: the centre only moves between points at distance r from all triangles near, and
// either (a) for each triangle both ends lie in a half-space n . x >= n . q + r tangential to it (q its closest point
// to an earlier centre, n from q to that centre), then so does the way between them; or (b) the least distance along
// the way, which is a convex function, is r too; or (c) the move is no longer than r, then every point of the way keeps
// 0.86 r: two balls of radius r whose centres are u apart cover the ball of radius sqrt(r^2 - u^2/4) about the middle.
//
// Triangles that can matter are gathered from the tree once and used while the centre stays within a margin of where
// that was, with the half-spaces of (a) as the quick test that one does not matter now.
//
// Closed meshes stop the ball from both sides (it is never inside). Open ones from the front: a triangle does not count
// while the centre is behind its plane or already closer than r, which is how a ball that came from behind passes.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "renderers/ball_constraints.h"
#include "renderers/cone_friction.h"
#include "renderers/nearest_in_polyhedron.h"
#include "renderers/surface_walk.h"

namespace touchstone {

class BallProxy {
 public:
  BallProxy(const ContactMesh& mesh, const Surface& surface, double radius_m, const ConeFriction& friction = {});

  // The first position of a run: where the ball overlaps the object it starts at the place outside that is closest.
  void start(const Vec3& p) noexcept;
  void follow(const Vec3& p) noexcept;
  // Towards p, without friction.
  void pull(const Vec3& p) noexcept;

  [[nodiscard]] bool touching() const noexcept { return holding_.size > 0; }
  // The ball's centre, and from the tip to it (zero when free).
  [[nodiscard]] const Vec3& position() const noexcept { return c_; }
  [[nodiscard]] Vec3 push(const Vec3& p) const noexcept { return touching() ? Vec3(c_ - p) : Vec3::Zero(); }
  // From the contact to the centre; of several contacts the direction of the push. `p` is where the tip is.
  [[nodiscard]] Vec3 normal(const Vec3& p) const noexcept;
  [[nodiscard]] ContactNormals contact_normals() const noexcept;
  [[nodiscard]] bool frictionless() const noexcept { return cone_.friction().none(); }
  // For force shading: where on which triangles it rests, be it one.
  static RestingPlaceOf<double> resting_place() noexcept { return {}; }
  [[nodiscard]] ContactPlaces contact_places() const noexcept;

  // For statistics and tests.
  void forget_near() noexcept { margin_ = -1.0; }  // the next step asks the tree
  [[nodiscard]] std::uint64_t gathers() const noexcept { return gathers_; }
  [[nodiscard]] std::uint64_t moves() const noexcept { return moves_; }

 private:
  // The triangles near the ball, each with a half-space that it leaves free: n . (x - gathered_at_) >= b means distance
  // >= r. In columns, so that all of them are asked a few at a time.
  class Near {
   public:
    explicit Near(std::size_t most)
        : planes_(static_cast<Eigen::Index>(most), 4), slack_(static_cast<Eigen::Index>(most)) {
      triangles_.reserve(most);
    }
    void clear() noexcept { triangles_.clear(); }
    [[nodiscard]] std::size_t size() const noexcept { return triangles_.size(); }
    void add(std::int32_t triangle, const Vec3& n, double b) noexcept {
      triangles_.push_back(triangle);
      set(triangles_.size() - 1, n, b);
    }
    void set(std::size_t i, const Vec3& n, double b) noexcept {
      const auto row = static_cast<Eigen::Index>(i);
      planes_(row, 0) = n.x();
      planes_(row, 1) = n.y();
      planes_(row, 2) = n.z();
      planes_(row, 3) = b;
    }
    [[nodiscard]] std::int32_t triangle(std::size_t i) const noexcept { return triangles_[i]; }
    // n . offset - b of all of them, valid until the next call.
    [[nodiscard]] const double* slack(const Vec3& offset) noexcept {
      const auto size = static_cast<Eigen::Index>(triangles_.size());
      const auto column = [&](Eigen::Index i) { return planes_.col(i).head(size); };
      slack_.head(size) = column(0) * offset.x() + column(1) * offset.y() + column(2) * offset.z() - column(3);
      return slack_.data();
    }

   private:
    Eigen::ArrayXXd planes_;  // n and b, a row each
    Eigen::ArrayXd slack_;
    std::vector<std::int32_t> triangles_;
  };
  struct Check {
    std::int32_t worst = -1;  // the triangle that the ball would overlap most
    bool safe_way = true;     // every half-space holds at both ends
  };

  [[nodiscard]] double rounding_at(const Vec3& x) const noexcept;
  void gather(const Vec3& at, double margin) noexcept;
  [[nodiscard]] bool covered(const Vec3& x) const noexcept { return (x - gathered_at_).norm() <= margin_; }
  Check check(const Vec3& x, const Holding& held) noexcept;
  // Whether the way from the centre to x keeps the distance r from the triangle.
  [[nodiscard]] bool stays_clear(std::int32_t triangle, const Vec3& x) const noexcept;
  [[nodiscard]] bool ignored(std::int32_t triangle) const noexcept;
  // Onto the face under the ball where that is the held triangle's own or a few edges farther on and nothing else is
  // touched there: nearly every step over a smooth surface. Else false, with nothing changed.
  bool glide(const Vec3& p, Holding& holding, Vec3& x, bool& safe_way) noexcept;
  // The rest position for p near the centre; false where the search does not settle.
  bool settle(const Vec3& p, Holding& holding, Vec3& x, bool& safe_way) noexcept;
  // Off an edge or corner below which the tip is deeper than the ball's radius, onto the face that the tip pulls to:
  // the face on which the god-object of a point comes to rest. False where there is none near.
  bool roll(const Vec3& p, Holding& holding, Vec3& x) noexcept;
  bool exchange(const Vec3& p, std::int32_t added, Holding& holding, Vec3& x) const noexcept;
  // One safe move: to x if the way is safe, else as far towards it as is. True when x was reached.
  bool advance(const Vec3& x, bool safe_way, const Holding& holding) noexcept;
  // One move within the half-spaces at the centre; false when that leads nowhere.
  bool creep(const Vec3& goal) noexcept;

  const ContactMesh* mesh_;
  const Surface* surface_;
  double r_;
  ConeFollower cone_;
  Vec3 c_ = Vec3::Zero();
  Holding holding_;
  SurfaceWalk feeler_;  // of roll()
  Near near_;
  std::vector<std::int32_t> candidates_;
  std::vector<HalfSpace> half_spaces_;  // scratch of creep(), and whose they are
  std::vector<std::int32_t> limiting_;
  Vec3 gathered_at_ = Vec3::Zero();
  double margin_ = -1.0;  // of the gathered triangles; < 0: none gathered
  double next_margin_;
  double rounding_ = 0.0;  // of distances at the present centre
  std::uint64_t gathers_ = 0;
  std::uint64_t moves_ = 0;
};

}  // namespace touchstone
