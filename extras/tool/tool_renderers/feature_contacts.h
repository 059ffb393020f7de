// Where two meshes are nearly in contact: pairs of a vertex and a face, or of two edges, within a margin; and of a
// vertex beside an edge, so that no corner cuts across a ridge in one step. Each pair is a linear constraint on the
// tool's next displacement (dp, dw), see pose.h:
//   n . dp + ((x - p) x n) . dw >= -gap.
// Vertex-face and edge-edge pairs are all that two polyhedra in general position can touch with (Ortega, Redon and
// Coquillart 2007, section 3, after Redon et al. 2002). Vertices and edges count if they stick out (an edge at a ridge;
// a flat or reflex one never touches first). An edge pair counts if the normal lies between the face normals of both
// edges, so that the two bodies lie on its two sides.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "harness/surface/mesh_topology.h"
#include "harness/surface/triangle_mesh.h"
#include "harness/tool/pose.h"
#include "tool_renderers/sphere_tree.h"

namespace touchstone::tool_renderers {

struct NearPair {
  Vec3 at_W_m = Vec3::Zero();
  Vec3 n_W = Vec3::Zero();  // unit, from the object to the tool
  double gap_m = 0.0;       // along n; negative where they overlap
};

// One mesh made ready. Its vertices and edges each belong to one of their triangles, so that a pair is found once.
class FeatureMesh {
 public:
  explicit FeatureMesh(surface::TriangleMesh mesh);

  struct Edge {
    std::array<std::int32_t, 2> ends{};
    Vec3 outward;                // sum of the face normals, not unit
    std::array<Vec3, 2> inward;  // unit, in each of its faces, away from the edge
    Ball ball;                   // about it
  };
  struct Face {
    Vec3 n;
    std::array<std::int32_t, 3> vertices{};  // that it owns and that stick out, -1 for none
    std::array<std::int32_t, 3> edges{};     // that it owns and that are ridges, -1 for none
    Ball ball;                               // about it
    // At none of these edges the surface turns by more than a right angle: what overlaps there lies below the face.
    bool blunt = true;
  };
  [[nodiscard]] const surface::TriangleMesh& mesh() const { return mesh_; }
  [[nodiscard]] const Face& face(std::int32_t i) const { return faces_[surface::at(i)]; }
  [[nodiscard]] const Edge& edge(std::int32_t i) const { return edges_[surface::at(i)]; }
  [[nodiscard]] const Vec3& vertex(std::int32_t i) const { return mesh_.vertices_W_m[surface::at(i)]; }
  [[nodiscard]] const SphereTree& tree() const { return tree_; }
  // The farthest vertex from the origin of the frame.
  [[nodiscard]] double reach_m() const { return reach_m_; }
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

 private:
  surface::TriangleMesh mesh_;
  std::vector<Face> faces_;
  std::vector<Edge> edges_;
  SphereTree tree_;
  double reach_m_ = 0.0;
};

// Finds the near pairs of a tool that moves little from one question to the next. The pairs of triangles that could
// have any are kept with some way to spare (a Verlet list: Verlet 1967, of molecules), and the trees are visited again
// only when the tool has moved that way; the next list is made bit by bit before, so that no single step pays for it.
// A pair of the list that is apart sleeps until the tool's points have travelled what it is apart by. While the tool
// moves by micrometres, as it does from round to round of a step and between steps of a hand in contact, only those
// features of the pairs are asked that could have become near since (Awake). No answer depends on what was asked
// before.
class NearPairFinder {
 public:
  // Holds on to both. `unit_m`: how long one unit of their coordinates is, which lengths of the finder's own follow.
  NearPairFinder(const FeatureMesh& tool, const FeatureMesh& object, double unit_m = 1.0);

  // Fills `pairs` with pairs of -overlap_m <= gap <= margin_m, in the order of the trees; returns their number. When
  // there is no room the pairs with the least gaps stay. Allocates nothing.
  std::size_t find(const tool::Pose& pose, double margin_m, double overlap_m, std::span<NearPair> pairs) noexcept;
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

 private:
  struct TrianglePair {
    std::int32_t on_tool, on_object;
    // It is not asked while these are more than what was travelled and the range that is asked for; see Bounds.
    float apart_until_m, above_until_m;
  };
  // The pairs near one pose, and how far the tool has gone since.
  struct List {
    std::vector<TrianglePair> pairs;
    tool::Pose at;
    Mat3 rotation = Mat3::Identity();
    double reach_m = -1.0;  // less than 0: no list
    double lever_m = 0.0;   // no point of the tool or of a small triangle of the list is farther from the tool's origin
    double translated_m = 0.0, turned_rad = 0.0;  // sums over all steps
    [[nodiscard]] double travelled_m() const { return translated_m + lever_m * turned_rad; }
  };
  // Vertices, edges and faces of a pair of triangles that may be near, one bit for two of them: vertex_face and so on.
  using Features = std::uint64_t;
  struct AwakePair {
    std::int32_t on_tool, on_object;
    Features features;
  };
  // All features that can be near while the tool travels no farther than awake_m and no larger margin or overlap is
  // asked for, in the order of the trees. Gathered from a list bit by bit, at the poses of several questions, so that
  // what was travelled counts from the first of them.
  struct Awake {
    std::vector<AwakePair> pairs;
    bool whole = false;
    std::size_t looked_at = 0;  // of the list's pairs
    std::size_t asked = 0;      // of these, those that were not asleep
    double margin_m = 0.0, overlap_m = 0.0;
    double lever_m = 0.0, translated_m = 0.0, turned_rad = 0.0;  // as in List
    [[nodiscard]] double travelled_m() const { return translated_m + lever_m * turned_rad; }
  };
  // How much more than what is asked for counts as near, see Awake.
  struct Loose {
    double way_m;  // that the tool's points may move, and the object's points against it as far as `lever_m`
    double lever_m;
    double margin_m, overlap_m;  // of gaps, without the way
  };
  struct Open {
    std::int32_t a, b;  // nodes of the tool's and of the object's tree
  };
  // A tool's or object's vertices in the other frame, each turned once for a question.
  struct Turned {
    std::vector<Vec3> points;
    std::vector<std::uint64_t> question;
  };
  // How far two triangles are from having a pair. Every pair spans from a point of one triangle to a point of the
  // other, so that neither is farther apart than the balls about them or than either is from the other's plane.
  struct Bounds {
    double apart;  // no pair has a gap, or an overlap, of less than this
    // The same of gaps alone: above a face that is blunt what is farther than the margin can only touch by an overlap,
    // and that lies below. The least height of all of the tool's triangle above the object's plane, and of the object's
    // above the tool's; less than nothing where it tells nothing.
    double above_object, above_tool;
  };
  class Asked;

  // How high a large triangle lies above the tool's plane changes by more than the tool's points move: not shown by
  // what they travelled.
  [[nodiscard]] bool small(std::int32_t on_object) const;
  [[nodiscard]] double above_of(const Bounds& bounds, std::int32_t on_object) const;

  void begin(List& list, const tool::Pose& pose, double reach_m) noexcept;
  // Goes on with the list that is being made, until it is full, or there is no more to visit (open_ is 0).
  void visit(List& list, std::size_t most_nodes) noexcept;
  // Makes the next list the present one.
  void take_over() noexcept;
  // No point of the tool has moved farther since: a turn moves a point by no more than its angle times the point's
  // distance.
  [[nodiscard]] double moved_since(const List& list, const tool::Pose& pose) const noexcept;
  // Whether awake_ holds all that can be near; gathers the next in time where that is worth it.
  bool keep_awake(Asked& asked, const tool::Displacement& step, double margin_m, double overlap_m) noexcept;
  // Goes on gathering the next features that stay awake, from the present list for a tool at the pose that is asked
  // for, or begins to.
  void wake(Asked& asked, double step_m, double margin_m, double overlap_m) noexcept;

  const FeatureMesh& tool_;
  const FeatureMesh& object_;
  double unit_m_;
  List now_, next_;
  Awake awake_, next_awake_;
  bool gathering_ = false;                               // next_awake_, from now_
  std::size_t asked_last_ = 0;                           // pairs, for awake_
  double mean_step_m_ = 0.0;                             // from question to question
  std::array<Open, 2 * SphereTree::stack_depth> stack_;  // of the next list
  std::size_t open_ = 0;                                 // 0: none is being made
  std::size_t visited_ = 0, visited_last_ = 0;           // nodes, of the next list and of the one before
  bool too_many_ = false;                                // the last list did not hold all
  tool::Pose asked_at_;
  Turned tool_W_, object_T_;
  std::uint64_t question_ = 0;
};

}  // namespace touchstone::tool_renderers
