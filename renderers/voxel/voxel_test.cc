// The voxel renderer against exact answers and its own grid's definition; its known limits pinned: each test named
// PinnedLimit... expects the wrong answer and fails when the right one comes.
#include "renderers/voxel/voxel.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "harness/base/counted.h"
#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/testing/tiny_meshes.h"
#include "renderers/hand_for_test.h"
#include "renderers/voxel/voxel_grid.h"
#include "synthetic/surface_catalogue.h"

namespace touchstone::renderers {
using rendering::Ability;
using rendering::StepResult;
using surface::Surface;

namespace {

constexpr double stiffness = 500.0;

std::unique_ptr<rendering::Renderer> voxel(std::shared_ptr<const Surface> surface,
                                           std::map<std::string, double> parameters = {},
                                           const std::string& name = "voxel") {
  parameters.try_emplace("stiffness_N_per_m", stiffness);
  return make_renderer(model_of(name, std::move(parameters)), std::move(surface));
}

std::shared_ptr<const Surface> mesh_surface(const std::string& name, std::size_t triangles, double scale = 1.0) {
  return make_embree_surface(
      surface::moved(synthetic::make_mesh(name, {}, triangles).mesh, Quat::Identity(), Vec3::Zero(), scale));
}

bool same(const VoxelPlane* a, const VoxelPlane* b) {
  if (a == nullptr || b == nullptr) return a == b;
  return a->nx == b->nx && a->ny == b->ny && a->nz == b->nz && a->offset == b->offset;
}

template <class Visit>
void every_voxel(const VoxelIndex& count, const Visit& visit) {
  VoxelIndex at;
  for (at[2] = 0; at[2] < count[2]; ++at[2]) {
    for (at[1] = 0; at[1] < count[1]; ++at[1]) {
      for (at[0] = 0; at[0] < count[0]; ++at[0]) visit(at);
    }
  }
}

TEST(VoxelGrid, EachVoxelOfTheBandHoldsThePlaneNearestToItsCentreAndNoOtherDoes) {
  for (const char* name : {"duck", "torus", "extrusion", "gauss"}) {
    const auto surface = mesh_surface(name, 2000);
    const VoxelGridOptions options{24, 2.0, 3.0};
    const SparseVoxelGrid sparse = make_sparse_grid(*surface, options);
    const DenseVoxelGrid dense = make_dense_grid(*surface, options);
    const VoxelLayout& layout = sparse.layout;
    EXPECT_EQ(*std::max_element(layout.count.begin(), layout.count.end()), 24) << name;
    std::size_t held = 0;
    every_voxel(layout.count, [&](const VoxelIndex& at) {
      const VoxelPlane* const plane = sparse.voxels.find(at);
      ASSERT_TRUE(same(plane, dense.voxels.find(at)));
      const Vec3 center = layout.center_W_m(at);
      const surface::SurfacePoint nearest = surface->closest(center);
      const double height = nearest.signed_distance_m / layout.voxel_m;
      ASSERT_EQ(plane != nullptr, height <= 0.5 * std::sqrt(3.0) && height >= -3.0) << name;
      if (plane == nullptr) return;
      ++held;
      const Vec3 n = Vec3(plane->nx, plane->ny, plane->nz).normalized();
      ASSERT_LE((n - nearest.n_W).norm(), 2e-7);
      ASSERT_NEAR(plane->offset, n.dot(nearest.p_W_m - center) / layout.voxel_m, 4e-7 * (1.0 + std::abs(height)));
    });
    EXPECT_EQ(held, sparse.voxels.voxel_count());
    // The body lies within: no voxel at the grid's border is needed.
    const Box3 box = surface->bounds();
    EXPECT_TRUE((box.min().array() >= layout.origin_W_m.array() + 2.0 * layout.voxel_m).all());
    const Vec3 end = layout.origin_W_m + layout.voxel_m * Vec3(layout.count[0], layout.count[1], layout.count[2]);
    EXPECT_TRUE((box.max().array() <= end.array() - 2.0 * layout.voxel_m + 1e-9).all()) << name;
  }
}

TEST(VoxelGrid, IsTheSameToTheBitWhateverTheNumberOfThreads) {
  const auto surface = mesh_surface("duck", 3000);
  const SparseVoxelGrid many = make_sparse_grid(*surface, {});
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const SparseVoxelGrid single = make_sparse_grid(*surface, {});
  ASSERT_EQ(many.layout.count, single.layout.count);
  every_voxel(many.layout.count,
              [&](const VoxelIndex& at) { ASSERT_TRUE(same(many.voxels.find(at), single.voxels.find(at))); });
}

TEST(VoxelGrid, RefusesOptionsThatLeaveNoRoom) {
  try {
    make_sparse_grid(*mesh_surface("sphere", 500), {8, 4.0, 4.0});
    FAIL();
  } catch (const BadData& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("8 voxels with a margin of 4"));
  }
}

TEST(Voxel, DenseAndSparseGiveTheSameForcesToTheBit) {
  for (const char* name : {"duck", "extrusion", "thin-shell", "gauss"}) {
    for (const double scale : {1e-3, 1.0, 1e3}) {
      for (const double resolution : {16.0, 30.0}) {
        const auto surface = mesh_surface(name, 1500, scale);
        const auto dense = voxel(surface, {{"resolution", resolution}});
        const auto sparse = voxel(surface, {{"resolution", resolution}}, "voxel-sparse");
        Hand left(*dense);
        Hand right(*sparse);
        Random random(11);
        const Box3 box = surface->bounds();
        int touching = 0;
        for (int i = 0; i < 4000; ++i) {
          const Vec3 along(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
          const Vec3 tip = box.center() + 0.7 * box.sizes().cwiseProduct(along);
          const StepResult a = left.to(tip);
          const StepResult b = right.to(tip);
          ASSERT_EQ(a.f_W_N, b.f_W_N);
          ASSERT_EQ(a.contact_W_m, b.contact_W_m);
          ASSERT_EQ(a.n_W, b.n_W);
          ASSERT_EQ(a.contact, b.contact);
          touching += a.contact ? 1 : 0;
        }
        EXPECT_GT(touching, 100) << name;
      }
    }
  }
}

// On a plane every voxel's plane is the plane: the answer is exact but for single precision.
TEST(Voxel, IsExactOnAPlaneAtEveryScaleAndResolution) {
  for (const double scale : unit_scales()) {
    for (const double resolution : {8.0, 64.0, 200.0}) {
      const std::shared_ptr<const Surface> plane = synthetic::make_surface("plane", {{"half_side_m", 0.05 * scale}});
      const auto renderer =
          voxel(plane, {{"stiffness_N_per_m", stiffness / scale}, {"resolution", resolution}, {"margin_voxels", 3.0}},
                "voxel-sparse");
      const double h = 0.1 * scale / (resolution - 6.5);
      Hand hand(*renderer);
      Random random(3);
      for (int i = 0; i < 500; ++i) {
        const double depth = random.uniform(-1.0, 2.0) * h;
        const StepResult result =
            hand.to({scale * random.uniform(-0.045, 0.045), scale * random.uniform(-0.045, 0.045), -depth});
        const double expected = stiffness / scale * std::max(0.0, depth);
        ASSERT_LE((result.f_W_N - Vec3(0, 0, expected)).norm(), stiffness / scale * h * 5e-7) << i;
      }
    }
  }
}

// The tip is at most half a diagonal of a voxel (s) from the voxel's centre: the plane that touches the sphere nearest
// to the centre lies above the sphere there by at most s^2 / 2R', R' the least radius at which the tip is.
TEST(Voxel, OnASphereIsOffByTheSagittaOfAVoxelAndNoMore) {
  const double radius = 0.03;
  double last_worst = 0.0;
  for (const double resolution : {24.0, 48.0, 96.0}) {
    const std::shared_ptr<const Surface> sphere = synthetic::make_surface("sphere", {{"radius_m", radius}});
    const auto renderer = voxel(sphere, {{"resolution", resolution}}, "voxel-sparse");
    const double h = 2.0 * radius / (resolution - 4.5);
    const double deepest = 1e-3;
    const double s = 0.5 * std::sqrt(3.0) * h;
    const double bound = s * s / (2.0 * (radius - deepest - s));
    Hand hand(*renderer);
    Random random(5);
    double worst = 0.0;
    for (int i = 0; i < 20000; ++i) {
      const double depth = random.uniform(0.0, deepest);
      const Vec3 out = random.direction();
      const StepResult result = hand.to((radius - depth) * out);
      if (!result.contact) {
        ASSERT_LE(depth, 1e-6 * h) << "the planes lie above the ball";
        continue;
      }
      ASSERT_LE(std::acos(std::min(1.0, result.n_W.dot(out))), s / (radius - deepest - s) + 1e-6);
      ASSERT_GE(result.depth_m, depth - 1e-6 * h) << "the planes lie above the ball";
      ASSERT_LE(result.depth_m, depth + bound);
      worst = std::max(worst, result.depth_m - depth);
    }
    EXPECT_GT(worst, bound / 12.0) << "the bound says something";
    if (last_worst > 0.0) {
      EXPECT_NEAR(last_worst / worst, 4.0, 1.2) << "second order in the voxel";
    }
    last_worst = worst;
  }
}

TEST(Voxel, SixtyFourCubedFitsThePapersMemoryAndSparseATenthOfIt) {
  const auto duck = mesh_surface("duck", 20000);
  const std::size_t dense = voxel(duck)->memory_bytes().value();
  const std::size_t sparse = voxel(duck, {}, "voxel-sparse")->memory_bytes().value();
  fmt::print("64^3 over the duck: dense {} bytes, sparse {} bytes\n", dense, sparse);
  EXPECT_LE(dense, 8'000'000U);
  EXPECT_LE(sparse, 800'000U);
  // A body that fills its box needs the most of a dense grid.
  EXPECT_LE(voxel(make_embree_surface(testing::cube(0.02)))->memory_bytes().value(), 8'000'000U);
}

TEST(Voxel, CountedItGivesTheSameBitsAtFortySixOperationsAStep) {
  const auto surface = mesh_surface("duck", 3000);
  for (const char* name : {"voxel", "voxel-sparse"}) {
    const rendering::Model model = model_of(name, {{"stiffness_N_per_m", stiffness}, {"resolution", 40.0}});
    const rendering::RendererEntry& entry = find_renderer(model);
    const rendering::Parameters parameters(entry.parameters, model.parameters, "renderer", "test", "");
    const auto plain = entry.make(parameters, surface);
    const auto counted = entry.make_counted(parameters, surface);
    Hand left(*plain);
    Hand right(*counted);
    Random random(12);
    for (int i = 0; i < 3000; ++i) {
      const Vec3 tip = random.uniform(0.0, 0.06) * random.direction();
      const StepResult a = left.to(tip);
      const OperationCounts before = operations_on_this_thread();
      const StepResult b = right.to(tip);
      const OperationCounts counts = operations_on_this_thread() - before;
      ASSERT_EQ(a.f_W_N, b.f_W_N);
      ASSERT_EQ(a.contact_W_m, b.contact_W_m);
      // By hand: to voxels 3 + 3, inside the grid 6, centre 3, unit normal 2 + 3 + 1 + 1 + 3, plane 6 + 3, depth 1,
      // push and force 3 + 8.
      if (a.contact) {
        ASSERT_EQ(counts, (OperationCounts{17, 17, 3, 1, 8}));
      } else {
        ASSERT_LE(counts.total(), 36U);
      }
    }
  }
}

TEST(Voxel, PinnedLimitAShellThinnerThanAVoxelLetsTheTipThrough) {
  const double thickness = 2e-4;
  const auto surface = make_embree_surface(synthetic::make_mesh("thin-shell", {{"thickness_m", thickness}}, 200).mesh);
  const auto renderer = voxel(surface);
  Hand hand(*renderer);
  bool pushed_down = false;
  StepResult now;
  for (int i = 0; i <= 400; ++i) {
    now = hand.to({0.0013, 0.0021, 1e-3 - 1e-5 * i});
    pushed_down = pushed_down || now.f_W_N.z() < 0.0;
  }
  EXPECT_TRUE(pushed_down || !now.contact) << "known limit";
  EXPECT_FALSE(now.contact) << "known limit: 3 mm below the shell the tip is free";
  EXPECT_NE(find_limitation(voxel_entry().cannot, Ability::thin_shells), nullptr);
}

TEST(Voxel, PinnedLimitDeeperThanItsReachTheTipIsFree) {
  const std::shared_ptr<const Surface> sphere = synthetic::make_surface("sphere", {{"radius_m", 0.03}});
  const auto renderer = voxel(sphere);
  const double h = 0.06 / 59.5;
  Hand hand(*renderer);
  EXPECT_TRUE(hand.to({0.0, 0.0, 0.03 - 3.0 * h}).contact);
  EXPECT_FALSE(hand.to({0.0, 0.0, 0.03 - 6.0 * h}).contact) << "known limit";
  EXPECT_FALSE(hand.to({0.0, 0.0, 0.0}).contact) << "known limit";
  const auto deep = voxel(sphere, {{"reach_voxels", 64.0}});
  EXPECT_TRUE(Hand(*deep).to({0.0, 0.0, 0.03 - 6.0 * h}).contact) << "with more reach it is felt";
  EXPECT_NE(find_limitation(voxel_entry().cannot, Ability::start_inside), nullptr);
}

TEST(Voxel, PinnedLimitTheForceJumpsFromVoxelToVoxel) {
  const std::shared_ptr<const Surface> sphere = synthetic::make_surface("sphere", {{"radius_m", 0.03}});
  const auto renderer = voxel(sphere, {{"resolution", 32.0}});
  Hand hand(*renderer);
  double largest = 0.0;
  Vec3 last = Vec3::Zero();
  for (int i = 0; i < 20000; ++i) {
    const double angle = 1e-4 * i;
    const StepResult now = hand.to(0.0295 * Vec3(std::cos(angle), std::sin(angle), 0.1).normalized());
    if (i > 0) largest = std::max(largest, (now.f_W_N - last).norm());
    last = now.f_W_N;
  }
  // Steps of 3 um: a force that follows them changes by 0.25 N / 0.0295 m * 3 um.
  EXPECT_GT(largest, 100.0 * stiffness * 5e-4 / 0.0295 * 3e-6) << "known limit";
  EXPECT_NE(find_limitation(voxel_entry().cannot, Ability::continuous_force), nullptr);
}

TEST(Voxel, PinnedLimitATipBesideAnEdgeIsPushedThoughItIsFree) {
  const auto renderer = voxel(make_embree_surface(testing::cube(0.02)));
  Hand hand(*renderer);
  Random random(8);
  int wrong = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 tip(0.02 - random.uniform(0.0, 5e-4), random.uniform(-0.01, 0.01), 0.02 + random.uniform(1e-6, 5e-4));
    wrong += hand.to(tip).contact ? 1 : 0;
  }
  EXPECT_GT(wrong, 10) << "known limit: an edge is rounded off or thickened by up to a voxel";
  EXPECT_NE(find_limitation(voxel_entry().cannot, Ability::surface_contact), nullptr);
}

TEST(Voxel, PinnedLimitTheGridLiesAlongTheAxes) {
  const surface::TriangleMesh mesh = synthetic::make_mesh("bumpy", {}, 3000).mesh;
  const auto straight = voxel(make_embree_surface(mesh), {{"resolution", 32.0}});
  const auto turned =
      voxel(make_embree_surface(surface::moved(mesh, awkward_rotation(), Vec3::Zero())), {{"resolution", 32.0}});
  Hand left(*straight);
  Hand right(*turned);
  Random random(9);
  double most = 0.0;
  for (int i = 0; i < 500; ++i) {
    const Vec3 tip = 0.029 * random.direction();
    const Vec3 there = awkward_rotation().conjugate() * right.to(awkward_rotation() * tip).f_W_N;
    most = std::max(most, (left.to(tip).f_W_N - there).norm());
  }
  EXPECT_GT(most, 1e-3) << "known limit";
  EXPECT_NE(find_limitation(voxel_entry().cannot, Ability::rigid_motion), nullptr);
}

}  // namespace
}  // namespace touchstone::renderers
