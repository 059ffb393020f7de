#include "tool_renderers/sphere_tree.h"

#include <algorithm>
#include <numeric>

namespace touchstone::tool_renderers {

SphereTree::SphereTree(std::span<const Ball> items) {
  std::vector<std::int32_t> indices(items.size());
  std::iota(indices.begin(), indices.end(), 0);
  nodes_.reserve(2 * items.size());
  nodes_.emplace_back();
  split(0, items, indices);
}

void SphereTree::split(std::size_t node, std::span<const Ball> items, std::span<std::int32_t> indices) {
  const auto item = [&](std::int32_t i) -> const Ball& { return items[static_cast<std::size_t>(i)]; };
  if (indices.size() == 1) {
    nodes_[node].ball = item(indices[0]);
    nodes_[node].item = indices[0];
    return;
  }
  Box3 box;
  for (const std::int32_t i : indices) box.extend(item(i).center);
  Ball ball{box.center(), 0.0};
  for (const std::int32_t i : indices)
    ball.radius = std::max(ball.radius, (item(i).center - ball.center).norm() + item(i).radius);
  nodes_[node].ball = ball;
  Eigen::Index axis = 0;
  box.diagonal().maxCoeff(&axis);
  const auto middle = indices.begin() + static_cast<std::ptrdiff_t>(indices.size() / 2);
  // Ties by the index: the same tree on every machine.
  std::nth_element(indices.begin(), middle, indices.end(), [&](std::int32_t a, std::int32_t b) {
    const double x = item(a).center[axis];
    const double y = item(b).center[axis];
    return x < y || (x == y && a < b);
  });
  const std::size_t child = nodes_.size();
  nodes_[node].child = static_cast<std::int32_t>(child);
  nodes_.resize(child + 2);
  split(child, items, indices.first(indices.size() / 2));
  split(child + 1, items, indices.subspan(indices.size() / 2));
}

void SphereTree::tag(std::span<const std::uint8_t> item_tags) noexcept {
  // Children stand behind their parent.
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    Node& node = nodes_[i];
    node.tags = node.child < 0 ? item_tags[static_cast<std::size_t>(node.item)]
                               : static_cast<std::uint8_t>(nodes_[static_cast<std::size_t>(node.child)].tags |
                                                           nodes_[static_cast<std::size_t>(node.child) + 1].tags);
  }
}

}  // namespace touchstone::tool_renderers
