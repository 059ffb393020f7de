// The exact surface passes the suite, and the fast one is held against it.
#include "harness/surface/cgal/exact_surface.h"

#include <numbers>

#include "harness/surface/embree_surface.h"
#include "harness/surface/triangle_surface.h"
#include "harness/testing/surface_conformance.h"
#include "harness/testing/tiny_meshes.h"

namespace {

using touchstone::surface::TriangleMesh;

// Of a body that each case makes for itself: its parameters are copied in every process that runs one of them.
auto of(TriangleMesh (*mesh)()) {
  return [mesh](double scale, const touchstone::Quat& rotation, const touchstone::Vec3& shift_m) {
    return touchstone::surface::make_exact_surface(touchstone::surface::moved(mesh(), rotation, shift_m, scale));
  };
}

}  // namespace

TOUCHSTONE_SURFACE_CONFORMANCE(
    Exact, {"cube", of([] { return touchstone::testing::cube(0.5); }), {.allocates = true, .queries = 40}},
    {"torus", of([] { return touchstone::testing::torus(0.4, 0.15, 20, 12); }), {.allocates = true, .queries = 40}},
    {"sheet",
     of([] { return touchstone::testing::grid(0.5, 10); }),
     {.closed = false, .allocates = true, .queries = 40}});

namespace touchstone::surface {
namespace {

using testing::ball;
using testing::cube;
using testing::grid;
using testing::torus;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

// Named bound: the fast surface's distances and points agree with the exact ones within this many units of rounding of
// the coordinates of object and query; the worst found must come within a twelfth of it.
constexpr double embree_roundings = 2.0;

// A fan of triangles hundreds of times longer than wide, the hard case for double.
TriangleMesh slivers() {
  TriangleMesh mesh;
  mesh.vertices_W_m.emplace_back(0, 0, 0.3);
  for (int i = 0; i <= 200; ++i) {
    const double u = 0.003 * i;
    mesh.vertices_W_m.emplace_back(std::cos(u), std::sin(u), 0.0);
  }
  for (std::int32_t i = 1; i <= 200; ++i) mesh.triangles.push_back({0, i, i + 1});
  mesh.source = "slivers";
  return mesh;
}

struct Worst {
  double distance = 0.0;
  double point = 0.0;
  double crossing = 0.0;
};

void compare(const TriangleMesh& mesh, double scale, Random& random, int queries, Worst& worst) {
  const auto fast = make_embree_surface(mesh);
  const auto exact = make_exact_surface(mesh);
  const Box3 box = fast->bounds();
  const double size = box.diagonal().norm();
  const double largest = std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
  for (int i = 0; i < queries; ++i) {
    // At random, next to an edge, next to a vertex.
    const auto& t = mesh.triangles[random.below(mesh.triangles.size())];
    const Vec3& a = mesh.vertices_W_m[static_cast<std::size_t>(t[0])];
    const Vec3& b = mesh.vertices_W_m[static_cast<std::size_t>(t[1])];
    Vec3 q = i % 3 == 0 ? Vec3(box.center()) : i % 3 == 1 ? Vec3(a + random.uniform() * (b - a)) : a;
    q += size * random.log_uniform(1e-14, i % 3 == 0 ? 10.0 : 1.0) * random.direction();
    SCOPED_TRACE(fmt::format("{} at scale {}: query ({}, {}, {})", mesh.source, scale, q.x(), q.y(), q.z()));
    const double unit = epsilon * (largest + size + q.cwiseAbs().maxCoeff());
    const SurfacePoint f = fast->closest(q);
    const SurfacePoint e = exact->closest(q);
    const double distance_error = std::abs(f.distance_m - e.distance_m) / unit;
    worst.distance = std::max(worst.distance, distance_error);
    ASSERT_LE(distance_error, embree_roundings);
    // Inside against outside may only differ where the point is on the surface to rounding.
    ASSERT_TRUE(f.signed_distance_m * e.signed_distance_m >= 0.0 || e.distance_m <= embree_roundings * unit);
    // The same triangle gives the same point; another one is as close.
    if (f.triangle == e.triangle && f.feature == e.feature) {
      const double point_error = (f.p_W_m - e.p_W_m).norm() / unit;
      worst.point = std::max(worst.point, point_error);
      ASSERT_LE(point_error, embree_roundings);
    }
    const Vec3 end = i % 2 == 0 ? Vec3(box.center() + size * random.uniform() * random.direction())
                                : Vec3(q + size * random.log_uniform(1e-13, 1.0) * random.direction());
    // Both decide exactly: whether the segment crosses is the same, always.
    const auto fc = fast->first_crossing(q, end);
    const auto ec = exact->first_crossing(q, end);
    ASSERT_EQ(fc.has_value(), ec.has_value()) << "to " << end.transpose();
    if (!fc) continue;
    // Rounding along a grazing segment grows with the sine of the angle.
    const double steepness = std::abs(ec->n_W.dot((end - q).normalized()));
    const double crossing_error = (fc->p_W_m - ec->p_W_m).norm() * steepness / unit;
    if (steepness > 1e-6) {
      worst.crossing = std::max(worst.crossing, crossing_error);
      ASSERT_LE(crossing_error, embree_roundings);
    }
  }
}

TEST(EmbreeAgainstExact, RandomNearEdgeAndNearVertex) {
  const std::uint64_t seed = 77;
  Random random(seed);
  Worst worst;
  for (const double scale : {1e-3, 1.0, 1e3}) {
    for (const double offset : {0.0, 1e4}) {
      for (const TriangleMesh& mesh : {cube(0.5), grid(0.5, 8), ball(0.5, 3), torus(0.4, 0.15, 24, 16), slivers()}) {
        compare(moved(mesh, random.rotation(), offset * scale * random.direction(), scale), scale, random, 120, worst);
        if (HasFatalFailure()) FAIL() << "seed " << seed << ", offset " << offset;
      }
    }
  }
  fmt::print("Embree against exact, units of rounding: distance {:.2f}, point {:.2f}, crossing {:.2f} (bound {})\n",
             worst.distance, worst.point, worst.crossing, embree_roundings);
  EXPECT_GT(std::max({worst.distance, worst.point, worst.crossing}), embree_roundings / 12.0);
}

TEST(EmbreeAgainstExact, PredicatesThroughSharedEdgesAndVertices) {
  Random random(8);
  const TriangleMesh mesh = moved(torus(0.4, 0.15, 24, 16), random.rotation(), Vec3(0.1, 0.2, 0.3));
  const auto fast = make_embree_surface(mesh);
  const auto exact = make_exact_surface(mesh);
  for (int i = 0; i < 600; ++i) {
    const auto& t = mesh.triangles[random.below(mesh.triangles.size())];
    const Vec3& a = mesh.vertices_W_m[static_cast<std::size_t>(t[0])];
    const Vec3& b = mesh.vertices_W_m[static_cast<std::size_t>(t[1])];
    const Vec3 target = i % 2 == 0 ? a : Vec3(0.5 * (a + b));
    const Vec3 reach = random.log_uniform(1e-9, 1.0) * random.direction();
    // Ends on, starts on, and passes through.
    for (const auto& [from, to] :
         {std::pair<Vec3, Vec3>{target - reach, target}, {target, target + reach}, {target - reach, target + reach}}) {
      const auto f = fast->first_crossing(from, to);
      const auto e = exact->first_crossing(from, to);
      ASSERT_EQ(f.has_value(), e.has_value()) << from.transpose() << " to " << to.transpose();
      // Where several triangles are crossed in one point either may be named.
      const double steepness = f ? std::abs(e->n_W.dot((to - from).normalized())) : 0.0;
      ASSERT_LE(f ? (f->p_W_m - e->p_W_m).norm() * steepness : 0.0, embree_roundings * epsilon * 2.0);
    }
  }
}

}  // namespace
}  // namespace touchstone::surface
