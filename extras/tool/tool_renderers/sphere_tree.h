// A tree of bounding spheres over small balls (triangles or points of a body): spheres turn with the body without being
// made anew, so that the tree of a moving tool is visited as it is. Split at the median of the longest axis.
// Source of the idea: Quinlan, Efficient Distance Computation between Non-Convex Objects (1994).
//
// Why not a collision library: FCL and Embree's collide() answer with intersecting pairs or with the one nearest pair,
// and FCL allocates; a constraint solver needs all pairs of features within a margin. Their candidates could be no
// fewer.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "harness/base/vec.h"

namespace touchstone::tool_renderers {

struct Ball {
  Vec3 center = Vec3::Zero();
  double radius = 0.0;
};

class SphereTree {
 public:
  struct Node {
    Ball ball;
    std::int32_t child = -1;  // of an inner node: the first of two; else -1
    std::int32_t item = -1;   // of a leaf
    std::uint8_t tags = 0;    // of all items below, see tag()
  };
  static constexpr std::size_t stack_depth = 128;  // of the stack of a visit: medians halve

  // At least one item; each ball holds all of its item.
  explicit SphereTree(std::span<const Ball> items);

  // One byte of marks per item; a node carries those of all items below it, so that a visit can pass over what has
  // none.
  void tag(std::span<const std::uint8_t> item_tags) noexcept;
  [[nodiscard]] const Node& node(std::int32_t i) const { return nodes_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] std::size_t size() const noexcept { return nodes_.size(); }
  [[nodiscard]] std::size_t memory_bytes() const noexcept { return nodes_.capacity() * sizeof(Node); }

 private:
  void split(std::size_t node, std::span<const Ball> items, std::span<std::int32_t> indices);
  std::vector<Node> nodes_;
};

}  // namespace touchstone::tool_renderers
