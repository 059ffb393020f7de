#include "harness/surface/box_tree.h"

#include <limits>
#include <numeric>

namespace touchstone::surface {
namespace {

constexpr std::size_t leaf = 4;

}  // namespace

BoxTree::BoxTree(const TriangleMesh& mesh) : order_(mesh.triangles.size()) {
  std::vector<Box3> boxes;
  boxes.reserve(mesh.triangles.size());
  double magnitude = 0.0;
  for (const auto& triangle : mesh.triangles) {
    Box3 box;
    for (const std::int32_t corner : triangle) box.extend(mesh.vertices_W_m[static_cast<std::size_t>(corner)]);
    magnitude = std::max({magnitude, box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff()});
    boxes.push_back(box);
  }
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.reserve(boxes.size() + 1);
  nodes_.emplace_back();
  split(boxes, 0, 0, boxes.size(), 256.0 * std::numeric_limits<double>::epsilon() * magnitude);
}

void BoxTree::split(const std::vector<Box3>& boxes, std::size_t node, std::size_t begin, std::size_t end,
                    double padding) {
  Box3 all;
  Box3 centers;
  const auto box_of = [&](std::size_t i) -> const Box3& { return boxes[static_cast<std::size_t>(order_[i])]; };
  for (std::size_t i = begin; i < end; ++i) {
    all.extend(box_of(i));
    centers.extend(Vec3(box_of(i).center()));
  }
  nodes_[node].low = all.min() - Vec3::Constant(padding);
  nodes_[node].high = all.max() + Vec3::Constant(padding);
  nodes_[node].first = static_cast<std::int32_t>(begin);
  nodes_[node].count = static_cast<std::int32_t>(end - begin);
  if (end - begin <= leaf) return;
  Eigen::Index axis = 0;
  centers.sizes().maxCoeff(&axis);
  const std::size_t middle = begin + (end - begin) / 2;
  // Equal centroids by index: the same tree everywhere.
  std::nth_element(order_.begin() + static_cast<std::ptrdiff_t>(begin),
                   order_.begin() + static_cast<std::ptrdiff_t>(middle),
                   order_.begin() + static_cast<std::ptrdiff_t>(end), [&](std::int32_t s, std::int32_t t) {
                     const double at_s = boxes[static_cast<std::size_t>(s)].center()[axis];
                     const double at_t = boxes[static_cast<std::size_t>(t)].center()[axis];
                     return at_s != at_t ? at_s < at_t : s < t;
                   });
  const std::size_t child = nodes_.size();
  nodes_[node].first = static_cast<std::int32_t>(child);
  nodes_[node].count = 0;
  nodes_.emplace_back();
  nodes_.emplace_back();
  split(boxes, child, begin, middle, padding);
  split(boxes, child + 1, middle, end, padding);
}

}  // namespace touchstone::surface
