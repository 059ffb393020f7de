#include "renderers/proxy/shaded_normals.h"

#include <algorithm>
#include <cmath>

#include "harness/base/huge_pages.h"

namespace touchstone::renderers {
namespace {

struct Corner {
  Vec3 n;
  bool smooth = false;  // all edges about the vertex are
};

// Which of the fan's triangles belong together, and their mean.
class VertexGroups {
 public:
  VertexGroups(const ContactMesh& mesh, std::int32_t vertex, double cos_crease)
      : mesh_(&mesh), vertex_(vertex), cos_crease_(cos_crease), fan_(mesh.fan(vertex)), group_(fan_.size(), -1) {
    for (std::size_t i = 0; i < fan_.size(); ++i) {
      if (group_[i] >= 0) continue;
      group_[i] = static_cast<int>(mean_.size());
      mean_.emplace_back(Vec3::Zero());
      spread(i);
    }
    for (Vec3& n : mean_) n = n.isZero(0.0) ? n : Vec3(n.normalized());
  }
  [[nodiscard]] Corner corner(std::size_t i) const {
    return {mean_[static_cast<std::size_t>(group_[i])], mean_.size() == 1 && !broken_};
  }

 private:
  void spread(std::size_t first) {
    std::vector<std::size_t> todo{first};
    while (!todo.empty()) {
      const std::size_t i = todo.back();
      todo.pop_back();
      const Facet& facet = mesh_->facet(fan_[i]);
      const std::size_t c = facet.corner[0] == vertex_ ? 0 : facet.corner[1] == vertex_ ? 1 : 2;
      const Vec3& v = mesh_->vertex(vertex_);
      const Vec3 a = mesh_->vertex(facet.corner[(c + 1) % 3]) - v;
      const Vec3 b = mesh_->vertex(facet.corner[(c + 2) % 3]) - v;
      mean_.back() += std::atan2(a.cross(b).norm(), a.dot(b)) * facet.n;
      for (const std::size_t edge : {c, (c + 2) % 3}) {
        const std::int32_t other = facet.neighbour[edge];
        const auto found = std::find(fan_.begin(), fan_.end(), other);
        if (other < 0 || found == fan_.end() || !(facet.n.dot(mesh_->facet(other).n) > cos_crease_)) {
          broken_ = true;
          continue;
        }
        const auto j = static_cast<std::size_t>(found - fan_.begin());
        if (group_[j] >= 0) continue;
        group_[j] = group_[i];
        todo.push_back(j);
      }
    }
  }

  const ContactMesh* mesh_;
  std::int32_t vertex_;
  double cos_crease_;
  std::span<const std::int32_t> fan_;
  std::vector<int> group_;
  std::vector<Vec3> mean_;
  bool broken_ = false;  // a sharp edge, or a rim, ends here
};

}  // namespace

ShadedNormals::ShadedNormals(const ContactMesh& mesh, double crease_angle_rad) {
  const double cos_crease = std::cos(crease_angle_rad);
  const std::size_t count = mesh.triangle_count();
  std::vector<std::array<Corner, 3>> corners(count);
  std::int32_t vertices = 0;
  for (std::size_t t = 0; t < count; ++t) {
    const Facet& facet = mesh.facet(static_cast<std::int32_t>(t));
    corners[t].fill({facet.n, false});
    for (const std::int32_t v : facet.corner) vertices = std::max(vertices, v + 1);
  }
  for (std::int32_t v = 0; v < vertices; ++v) {
    const auto fan = mesh.fan(v);
    const VertexGroups groups(mesh, v, cos_crease);
    for (std::size_t i = 0; i < fan.size(); ++i) {
      const auto& corner = mesh.facet(fan[i]).corner;
      const auto c = static_cast<std::size_t>(std::find(corner.begin(), corner.end(), v) - corner.begin());
      corners[static_cast<std::size_t>(fan[i])][c] = groups.corner(i);
    }
  }
  reserve_in_huge_pages(shades_, count);
  shades_.resize(count);
  for (std::size_t t = 0; t < count; ++t) {
    const auto triangle = static_cast<std::int32_t>(t);
    const Facet& facet = mesh.facet(triangle);
    const auto [a, b, c] = mesh.corners(triangle);
    const double height1 = facet.inward[2].dot(b - a);
    const double height2 = facet.inward[0].dot(c - a);
    Shade& shade = shades_[t];
    shade.n0 = corners[t][0].n;
    shade.d1 = height1 > 0.0 ? Vec3((corners[t][1].n - shade.n0) / height1) : Vec3(Vec3::Zero());
    shade.d2 = height2 > 0.0 ? Vec3((corners[t][2].n - shade.n0) / height2) : Vec3(Vec3::Zero());
    for (std::size_t e = 0; e < 3; ++e) {
      shade.smooth_corner[e] = corners[t][e].smooth;
      shade.smooth_edge[e] = facet.neighbour[e] >= 0 && facet.n.dot(mesh.facet(facet.neighbour[e]).n) > cos_crease;
    }
  }
}

}  // namespace touchstone::renderers
