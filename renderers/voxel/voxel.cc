#include "renderers/voxel/voxel.h"

#include <cmath>
#include <limits>
#include <type_traits>

#include "harness/base/counted.h"
#include "renderers/voxel/voxel_grid.h"

namespace touchstone::renderers {
using rendering::Ability;
using rendering::Parameters;
using rendering::Renderer;
using rendering::RendererEntry;

namespace {

template <class S, class Grid>
class VoxelRenderer final : public Renderer {
 public:
  VoxelRenderer(Grid grid, double stiffness_N_per_m)
      : grid_(std::move(grid)),
        origin_W_m_(grid_.layout.origin_W_m.template cast<S>()),
        voxel_m_(grid_.layout.voxel_m),
        per_m_(grid_.layout.per_m),
        count_(S(grid_.layout.count[0]), S(grid_.layout.count[1]), S(grid_.layout.count[2])),
        stiffness_N_per_m_(stiffness_N_per_m) {}

  [[nodiscard]] std::optional<std::size_t> memory_bytes() const noexcept override {
    return grid_.voxels.memory_bytes();
  }

 private:
  void do_reset() override {}

  rendering::StepResult do_step(const rendering::TipState& tip) noexcept override {
    rendering::StepResult result;
    result.contact_W_m = tip.p_W_m;
    const Vec3Of<S> p_W_m = tip.p_W_m.template cast<S>();
    const Vec3Of<S> q = (p_W_m - origin_W_m_) * per_m_;  // in voxels from here on
    Vec3Of<S> center;
    VoxelIndex at;
    // By name and not in a loop, and the normal's length here and not in unit(): what goes through memory between two
    // operations waits for it, and this step is one chain of operations.
    const auto along = [&]<std::size_t i>(std::integral_constant<std::size_t, i>) {
      constexpr auto axis = static_cast<Eigen::Index>(i);
      if (!(q[axis] >= S(0.0) && q[axis] < count_[axis])) return false;
      // Not negative: to cut off the fraction is to round down.
      at[i] = static_cast<std::int32_t>(static_cast<double>(q[axis]));
      center[axis] = S(at[i]) + S(0.5);
      return true;
    };
    if (!along(std::integral_constant<std::size_t, 0>{}) || !along(std::integral_constant<std::size_t, 1>{}) ||
        !along(std::integral_constant<std::size_t, 2>{}))
      return result;
    const VoxelPlane* const plane = grid_.voxels.find(at);
    if (plane == nullptr) return result;
    // Single precision is unit to 1e-7 only.
    using std::sqrt;
    S x(plane->nx);
    S y(plane->ny);
    S z(plane->nz);
    const S square = (x * x + y * y) + z * z;
    if (square > S(0.0)) {
      const S length = sqrt(square);
      x /= length;
      y /= length;
      z /= length;
    }
    const Vec3Of<S> n(x, y, z);
    const S depth = S(plane->offset) - dot(n, q - center);
    if (!(depth > S(0.0))) return result;
    const S depth_m = depth * voxel_m_;
    const Vec3Of<S> push_m = depth_m * n;
    result.contact = true;
    result.f_W_N = ((stiffness_N_per_m_ * depth_m) * n).template cast<double>();
    result.contact_W_m = (p_W_m + push_m).template cast<double>();
    result.n_W = n.template cast<double>();
    result.depth_m = static_cast<double>(depth_m);
    return result;
  }

  Grid grid_;
  Vec3Of<S> origin_W_m_;
  S voxel_m_;
  S per_m_;
  Vec3Of<S> count_;  // of voxels
  S stiffness_N_per_m_;
};

VoxelGridOptions options_of(const Parameters& parameters) {
  return {static_cast<int>(std::lround(parameters.at("resolution"))), parameters.at("margin_voxels"),
          parameters.at("reach_voxels")};
}

template <class S>
std::unique_ptr<Renderer> make_dense(const Parameters& parameters,
                                     const std::shared_ptr<const surface::Surface>& surface) {
  return std::make_unique<VoxelRenderer<S, DenseVoxelGrid>>(make_dense_grid(*surface, options_of(parameters)),
                                                            parameters.at("stiffness_N_per_m"));
}

template <class S>
std::unique_ptr<Renderer> make_sparse(const Parameters& parameters,
                                      const std::shared_ptr<const surface::Surface>& surface) {
  return std::make_unique<VoxelRenderer<S, SparseVoxelGrid>>(make_sparse_grid(*surface, options_of(parameters)),
                                                             parameters.at("stiffness_N_per_m"));
}

RendererEntry entry(std::string name, const std::string& summary, double most_resolution) {
  RendererEntry made;
  made.name = std::move(name);
  made.summary = "pushes the tip out of the plane stored in its voxel of a fixed grid; " + summary;
  made.source = "Ruffaldi et al. 2006, section 4.1; McNeely, Puterbaugh and Troy 1999";
  made.parameters = {
      {"stiffness_N_per_m", "N/m", std::numeric_limits<double>::min(), 1e9, 500.0, "of the spring out of the plane"},
      {"resolution", "1", 4.0, most_resolution, 64.0, "voxels along the body's longest side, margin included"},
      {"margin_voxels", "1", 0.0, 64.0, 2.0, "free voxels about the body; below an open surface, how deep it is felt"},
      {"reach_voxels", "1", 1.0, 4096.0, 4.0, "how deep below the surface voxels push; deeper is free space"}};
  made.cannot = {
      {Ability::thin_shells, "in a body thinner than two voxels the nearest triangle may be one of the far side"},
      {Ability::large_jumps, "it remembers no side: a tip that jumps through a body is free on the far side"},
      {Ability::start_inside, "deeper than reach_voxels is free space; the way out is along the voxel's plane"},
      {Ability::continuous_force, "the plane changes from voxel to voxel"},
      {Ability::rigid_motion, "the grid lies along the axes"},
      {Ability::passive, "planes that change from voxel to voxel are no potential"},
      {Ability::surface_contact, "the contact point is on the voxel's plane, not on the surface"},
      {Ability::ball_tip, "it renders a point"}};
  return made;
}

}  // namespace

RendererEntry voxel_entry() {
  RendererEntry made = entry("voxel", "every voxel stored", 512.0);
  made.make = make_dense<double>;
  made.make_counted = make_dense<Counted>;
  return made;
}

RendererEntry voxel_sparse_entry() {
  RendererEntry made = entry("voxel-sparse", "only the voxels near the surface stored", 2048.0);
  made.make = make_sparse<double>;
  made.make_counted = make_sparse<Counted>;
  return made;
}

}  // namespace touchstone::renderers
