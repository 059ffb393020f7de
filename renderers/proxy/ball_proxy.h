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
// Which triangles can matter for a ball that touches one of them is kept by triangle (ball_vicinity.h). Elsewhere, in
// the air and at sharp edges, they are gathered from the tree once and used while the centre stays within a margin of
// where that was, with the half-spaces of (a) as the quick test that one does not matter now. Both give the same places
// to the bit.
//
// Closed meshes stop the ball from both sides (it is never inside). Open ones from the front: a triangle does not count
// while the centre is behind its plane or already closer than r, which is how a ball that came from behind passes.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <vector>

#include "renderers/friction/cone_friction.h"
#include "renderers/friction/fixed_order.h"
#include "renderers/friction/nearest_in_polyhedron.h"
#include "renderers/mesh_traversal/surface_walk.h"
#include "renderers/proxy/ball_constraints.h"
#include "renderers/proxy/ball_vicinity.h"

namespace touchstone::renderers {

// Over ContactMesh, and over CountedContactMesh whose scalar counts operations. Which triangles are gathered does not
// depend on the tree that proposes them, nor do the operations.
template <class Mesh>
class BallProxyOf {
 public:
  using Scalar = typename Mesh::Scalar;
  using S = Scalar;
  using V = Vec3Of<S>;

  BallProxyOf(const Mesh& mesh, const surface::Surface& surface, double radius_m, const ConeFriction& friction = {});

  // The first position of a run: where the ball overlaps the object it starts at the place outside that is closest, of
  // bodies that touch or overlap outside of all of them.
  void start(const V& p) noexcept;
  void follow(const V& p) noexcept;
  // Towards p, without friction.
  void pull(const V& p) noexcept;

  [[nodiscard]] bool touching() const noexcept { return holding_.size > 0; }
  // The ball's centre, and from the tip to it (zero when free).
  [[nodiscard]] const V& position() const noexcept { return c_; }
  [[nodiscard]] V push(const V& p) const noexcept { return touching() ? V(c_ - p) : V(V::Zero()); }
  // From the contact to the centre; of several contacts the direction of the push. `p` is where the tip is.
  [[nodiscard]] V normal(const V& p) const noexcept;
  [[nodiscard]] ContactNormalsOf<S> contact_normals() const noexcept;
  [[nodiscard]] bool frictionless() const noexcept { return cone_.friction().none(); }
  // For force shading: where on which triangles it rests, be it one.
  static RestingPlaceOf<S> resting_place() noexcept { return {}; }
  [[nodiscard]] ContactPlacesOf<S> contact_places() const noexcept;

  // Beside the mesh's own.
  [[nodiscard]] std::size_t memory_bytes() const noexcept { return vicinity_ ? vicinity_->memory_bytes() : 0; }

  // For statistics and tests. forget_near(): the next step asks the tree.
  void forget_near() noexcept {
    margin_ = S(-1.0);
    vicinity_.reset();
  }
  [[nodiscard]] std::uint64_t gathers() const noexcept { return gathers_; }
  [[nodiscard]] std::uint64_t moves() const noexcept { return moves_; }

 private:
  // The triangles near the ball, each with a half-space that it leaves free: n . (x - gathered_at_) >= b means distance
  // >= r. Four to a block, which are asked together.
  class Near {
   public:
    explicit Near(std::size_t most) {
      blocks_.resize((most + 3) / 4);
      triangles_.reserve(most);
    }
    void clear() noexcept { triangles_.clear(); }
    [[nodiscard]] std::size_t size() const noexcept { return triangles_.size(); }
    void add(std::int32_t triangle, const V& n, const S& b) noexcept {
      triangles_.push_back(triangle);
      set(triangles_.size() - 1, n, b);
    }
    void set(std::size_t i, const V& n, const S& b) noexcept {
      const auto lane = static_cast<Eigen::Index>(i % 4);
      Block& block = blocks_[i / 4];
      block(lane, 0) = n.x();
      block(lane, 1) = n.y();
      block(lane, 2) = n.z();
      block(lane, 3) = b;
    }
    [[nodiscard]] std::int32_t triangle(std::size_t i) const noexcept { return triangles_[i]; }
    // Calls visit(i) in order for those with n . offset - b < limit. The visit may set(i).
    template <class Visit>
    void each_below(const V& offset, const S& limit, Visit&& visit) noexcept {
      for (std::size_t first = 0; first < size(); first += 4) {
        const Block& block = blocks_[first / 4];
        const auto count = static_cast<Eigen::Index>(std::min<std::size_t>(4, size() - first));
        Eigen::Array<S, 4, 1> slack;
        if constexpr (std::is_same_v<S, double>) {
          slack = block.col(0) * offset.x() + block.col(1) * offset.y() + block.col(2) * offset.z() - block.col(3);
          if (count == 4 && slack.minCoeff() >= limit) continue;
        } else {
          for (Eigen::Index i = 0; i < count; ++i)
            slack[i] = block(i, 0) * offset.x() + block(i, 1) * offset.y() + block(i, 2) * offset.z() - block(i, 3);
        }
        for (Eigen::Index i = 0; i < count; ++i) {
          if (!(slack[i] >= limit)) visit(first + static_cast<std::size_t>(i));
        }
      }
    }

   private:
    using Block = Eigen::Array<S, 4, 4>;  // n and b, a row each
    std::vector<Block> blocks_;
    std::vector<std::int32_t> triangles_;
  };
  struct Check {
    std::int32_t worst = -1;  // the triangle that the ball would overlap most
    bool safe_way = true;     // every half-space holds at both ends
    bool complete = false;    // no triangle that was not asked can matter on a way of up to half a radius
  };

  [[nodiscard]] S rounding_at(const V& x) const noexcept;
  void gather(const V& at, S margin) noexcept;
  bool gather_within(const V& at, const S& margin) noexcept;
  [[nodiscard]] bool covered(const V& x) const noexcept { return distance<S>(x, gathered_at_) <= margin_; }
  // Whether what can be met at x was gathered in this step.
  [[nodiscard]] bool just_gathered(const V& x) const noexcept { return gathered_now_ && covered(x); }
  // Gathers what is near the centre if that is not known.
  void know_near() noexcept {
    if (!(margin_ >= S(0.0)) || !covered(c_)) gather(c_, next_margin_);
  }
  Check check(const V& x, const Holding& held) noexcept;
  // By the lists of a triangle that the ball touches at x; none where they do not reach as far. check_face(): for the
  // ball on the triangle's face.
  std::optional<Check> check_listed(const V& x, const Holding& held) noexcept;
  std::optional<Check> check_face(const V& x, std::int32_t triangle) noexcept;
  void ask_listed(std::span<const std::int32_t> triangles, const V& x, const Holding& held, S& least,
                  Check& result) const noexcept;
  [[nodiscard]] bool ignored(std::int32_t triangle) const noexcept;
  // Onto the face under the ball where that is the held triangle's own or a few edges farther on and nothing else is
  // touched there: nearly every step over a smooth surface. Else false, with nothing changed.
  bool glide(const V& p, Holding& holding, V& x, Check& result) noexcept;
  // The rest position for p near the centre; false where the search does not settle.
  bool settle(const V& p, Holding& holding, V& x, Check& result) noexcept;
  // Off an edge or corner below which the tip is deeper than the ball's radius, onto the face that the tip pulls to:
  // the face on which the god-object of a point comes to rest. False where there is none near.
  bool roll(const V& p, Holding& holding, V& x) noexcept;
  bool exchange(const V& p, std::int32_t added, Holding& holding, V& x) const noexcept;
  // One safe move: to x if the way is safe, else as far towards it as is. True when x was reached.
  bool advance(const V& x, const Check& checked, const Holding& holding) noexcept;
  // One move within the half-spaces at the centre; false when that leads nowhere.
  bool constrained_step(const V& goal) noexcept;

  const Mesh* mesh_;
  const surface::Surface* surface_;
  S r_;
  ConeFollower cone_;
  V c_ = V::Zero();
  Holding holding_;
  SurfaceWalkOf<Mesh> probe_walk_;  // of roll()
  std::optional<BallVicinity> vicinity_;
  Near near_;
  std::vector<std::int32_t> candidates_;
  std::vector<HalfSpaceOf<S>> half_spaces_;  // scratch of constrained_step(), and whose they are
  std::vector<std::int32_t> limiting_;
  V gathered_at_ = V::Zero();
  S margin_ = S(-1.0);         // of the gathered triangles; < 0: none gathered
  bool gathered_now_ = false;  // in this step: no need to list what is near, too
  S most_margin_;              // beyond which it would gather many on a level surface
  S next_margin_;
  S rounding_ = S(0.0);  // of distances at the present centre
  std::uint64_t gathers_ = 0;
  std::uint64_t moves_ = 0;
};

using BallProxy = BallProxyOf<ContactMesh>;

}  // namespace touchstone::renderers
