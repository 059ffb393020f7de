// A plain bounding volume hierarchy of axis-aligned boxes over triangles, over any scalar: the tree on which operations
// are counted. Embree (triangle_tree.h, embree_surface.h) is faster, and cannot be counted: it works on several boxes
// at a time in single precision, in code that is not ours. Both propose candidates only; the answer is the caller's.
//
// Built by splitting at the median centroid of the longest axis, at most four triangles in a leaf. Boxes are padded by
// more than the rounding of a query, so that no triangle that matters is left out. Visits allocate nothing.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "harness/base/vec.h"
#include "harness/surface/triangle_mesh.h"

namespace touchstone::surface {

class BoxTree {
 public:
  // Needs at least one triangle. Keeps no reference to the mesh.
  explicit BoxTree(const TriangleMesh& mesh);

  // Calls visit(triangle) -> S for candidates of the point nearest to q, nearer boxes first. The answer is the squared
  // distance beyond which further candidates are of no interest.
  template <class S, class Visit>
  void nearest(const Vec3Of<S>& q, Visit&& visit) const {
    struct Open {  // NOLINT(cppcoreguidelines-pro-type-member-init): see below
      std::int32_t node;
      S square;
    };
    // Each is written before it is read; zeros would cost every query.
    std::array<Open, stack_depth> stack;  // NOLINT(cppcoreguidelines-pro-type-member-init)
    std::size_t size = 0;
    stack[size++] = {0, squared_distance(nodes_[0], q)};
    S beyond(0.0);
    bool any = false;
    while (size > 0) {
      const Open open = stack[--size];
      if (any && open.square > beyond) continue;
      const Node& node = nodes_[static_cast<std::size_t>(open.node)];
      if (node.count > 0) {
        for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
          beyond = visit(order_[static_cast<std::size_t>(i)]);
          any = true;
        }
        continue;
      }
      Open near{node.first, squared_distance(nodes_[static_cast<std::size_t>(node.first)], q)};
      Open far{node.first + 1, squared_distance(nodes_[static_cast<std::size_t>(node.first) + 1], q)};
      if (far.square < near.square) std::swap(near, far);
      stack[size++] = far;
      stack[size++] = near;
    }
  }

  // Calls visit(triangle) -> S for the candidates of the segment a-b, see TriangleTree::along_segment.
  template <class S, class Visit>
  void along_segment(const Vec3Of<S>& a, const Vec3Of<S>& b, Visit&& visit) const {
    // As in nearest().
    std::array<std::int32_t, stack_depth> stack;  // NOLINT(cppcoreguidelines-pro-type-member-init)
    std::size_t size = 0;
    stack[size++] = 0;
    S until(1.0);
    const Vec3Of<S> way = b - a;
    while (size > 0) {
      const Node& node = nodes_[static_cast<std::size_t>(stack[--size])];
      if (!meets(node, a, b, way, until)) continue;
      if (node.count == 0) {
        stack[size++] = node.first + 1;
        stack[size++] = node.first;
        continue;
      }
      for (std::int32_t i = node.first; i < node.first + node.count; ++i)
        until = std::min(until, S(visit(order_[static_cast<std::size_t>(i)])));
    }
  }

  // Calls visit(triangle) -> S for the candidates within `radius` of q, see TriangleTree::within.
  template <class S, class Visit>
  void within(const Vec3Of<S>& q, const S& radius, Visit&& visit) const {
    // As in nearest().
    std::array<std::int32_t, stack_depth> stack;  // NOLINT(cppcoreguidelines-pro-type-member-init)
    std::size_t size = 0;
    stack[size++] = 0;
    S square = radius * radius;
    while (size > 0) {
      const Node& node = nodes_[static_cast<std::size_t>(stack[--size])];
      if (squared_distance(node, q) > square) continue;
      if (node.count == 0) {
        stack[size++] = node.first + 1;
        stack[size++] = node.first;
        continue;
      }
      for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
        const S beyond = visit(order_[static_cast<std::size_t>(i)]);
        square = std::min(square, S(beyond * beyond));
      }
    }
  }

  [[nodiscard]] std::size_t memory_bytes() const noexcept {
    return nodes_.capacity() * sizeof(Node) + order_.capacity() * sizeof(std::int32_t);
  }

 private:
  static constexpr std::size_t stack_depth = 128;  // medians: twice the logarithm of 2^63 triangles

  struct Node {
    Vec3 low;
    Vec3 high;
    std::int32_t first = 0;  // of a leaf: in order_; else the first of its two children
    std::int32_t count = 0;  // of triangles; 0: not a leaf
  };

  template <class S>
  static S squared_distance(const Node& node, const Vec3Of<S>& q) {
    Vec3Of<S> away;
    for (Eigen::Index i = 0; i < 3; ++i)
      away[i] = std::max(S(0.0), std::max(S(node.low[i]) - q[i], q[i] - S(node.high[i])));
    return squared_norm(away);
  }

  // Whether the part of the segment up to `until` may meet the box: the slabs of its three axes.
  template <class S>
  bool meets(const Node& node, const Vec3Of<S>& a, const Vec3Of<S>& b, const Vec3Of<S>& way, const S& until) const {
    S from(0.0);
    S to = until + S(slack);
    for (Eigen::Index i = 0; i < 3; ++i) {
      const S low(node.low[i]);
      const S high(node.high[i]);
      if (std::max(a[i], b[i]) < low || std::min(a[i], b[i]) > high) return false;
      if (way[i] == S(0.0)) continue;
      const S first = (low - a[i]) / way[i];
      const S second = (high - a[i]) / way[i];
      from = std::max(from, std::min(first, second));
      to = std::min(to, std::max(first, second));
    }
    return from <= to + S(slack);
  }
  // Of fractions of a segment: many times the rounding of the divisions above.
  static constexpr double slack = 1e-12;

  void split(const std::vector<Box3>& boxes, std::size_t node, std::size_t begin, std::size_t end, double padding);

  std::vector<Node> nodes_;
  std::vector<std::int32_t> order_;
};

}  // namespace touchstone::surface
