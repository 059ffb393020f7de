// Every surface of the catalogue: its mesh is sound and as near as it says, its queries agree with each other and with
// brute force over a fine mesh, at several unit scales.
#include "synthetic/surface_catalogue.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <map>
#include <utility>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "synthetic/surfaces/exact_contact.h"

namespace touchstone::synthetic {
using surface::TriangleMesh;

namespace {

constexpr std::uint64_t seed = 20060325;

// Every length of a surface's parameters times `scale`.
ParameterOverrides scaled(const SurfaceEntry& entry, double scale) {
  ParameterOverrides overrides;
  for (const Parameter& p : entry.parameters) {
    if (p.unit == "m") overrides[p.name] = p.initial * scale;
  }
  return overrides;
}

struct MeshCounts {
  std::size_t open_edges = 0;
  std::size_t bad_edges = 0;  // not shared by two triangles in opposite directions
  long euler = 0;
  double volume_m3 = 0.0;
  double least_area_m2 = 1e300;
};

MeshCounts count(const TriangleMesh& mesh) {
  MeshCounts counts;
  std::map<std::pair<std::int32_t, std::int32_t>, int> directed;
  for (std::size_t i = 0; i < mesh.triangle_count(); ++i) {
    const auto& t = mesh.triangles[i];
    for (std::size_t k = 0; k < 3; ++k) ++directed[{t[k], t[(k + 1) % 3]}];
    const Vec3 n = mesh.scaled_normal(i);
    counts.volume_m3 += mesh.vertices_W_m[static_cast<std::size_t>(t[0])].dot(n) / 6.0;
    counts.least_area_m2 = std::min(counts.least_area_m2, 0.5 * n.norm());
  }
  std::size_t edges = 0;
  for (const auto& [edge, times] : directed) {
    if (times != 1) ++counts.bad_edges;
    const bool paired = directed.contains({edge.second, edge.first});
    if (!paired) ++counts.open_edges;
    if (!paired || edge.first < edge.second) ++edges;
  }
  counts.euler =
      static_cast<long>(mesh.vertices_W_m.size()) - static_cast<long>(edges) + static_cast<long>(mesh.triangle_count());
  return counts;
}

// The distance to a mesh by trying every triangle (Ericson 2005, 5.1.5, by clamping in the plane and on the edges).
double brute_distance(const TriangleMesh& mesh, const Vec3& p) {
  double best = 1e300;
  for (std::size_t i = 0; i < mesh.triangle_count(); ++i) {
    const auto corner = [&](std::size_t k) {
      return mesh.vertices_W_m[static_cast<std::size_t>(mesh.triangles[i][k])];
    };
    const Vec3 n = mesh.scaled_normal(i);
    bool within = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 a = corner(k);
      const Vec3 e = corner((k + 1) % 3) - a;
      if (n.dot(e.cross(p - a)) < 0.0) within = false;
      const double along = std::clamp((p - a).dot(e) / e.squaredNorm(), 0.0, 1.0);
      best = std::min(best, (p - a - along * e).norm());
    }
    if (within) best = std::min(best, std::abs((p - corner(0)).dot(n)) / n.norm());
  }
  return best;
}

Vec3 random_point(Random& random, const Box3& box, double margin) {
  const Vec3 size = box.sizes() + Vec3::Constant(0.1 * box.sizes().maxCoeff());
  const Vec3 low = box.center() - 0.5 * margin * size;
  return low + margin * Vec3(random.uniform() * size.x(), random.uniform() * size.y(), random.uniform() * size.z());
}

class EverySurface : public ::testing::TestWithParam<std::size_t> {
 protected:
  [[nodiscard]] const SurfaceEntry& entry() const { return surface_catalogue()[GetParam()]; }
};

INSTANTIATE_TEST_SUITE_P(Catalogue, EverySurface, ::testing::Range<std::size_t>(0, surface_catalogue().size()),
                         [](const auto& instance) {
                           std::string name = surface_catalogue()[instance.param].name;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST_P(EverySurface, MeshIsManifoldAndOriented) {
  for (const std::size_t triangles : {200UL, 3000UL, 20000UL}) {
    const auto surface = make_surface(entry().name);
    const TriangleMesh mesh = surface->tessellate(triangles).mesh;
    const MeshCounts counts = count(mesh);
    EXPECT_EQ(counts.bad_edges, 0U);
    EXPECT_GT(counts.least_area_m2, 0.0);
    EXPECT_GT(static_cast<double>(mesh.triangle_count()), 0.6 * static_cast<double>(triangles));
    EXPECT_LT(static_cast<double>(mesh.triangle_count()), 1.6 * static_cast<double>(triangles));
    if (surface->closed()) {
      EXPECT_EQ(counts.open_edges, 0U);
      EXPECT_EQ(counts.euler, entry().name == "torus" ? 0 : 2);
      EXPECT_GT(counts.volume_m3, 0.0);
    } else {
      EXPECT_EQ(counts.euler, 1);
      for (std::size_t i = 0; i < mesh.triangle_count(); ++i) ASSERT_GT(mesh.scaled_normal(i).z(), 0.0);
    }
  }
}

TEST_P(EverySurface, MeshIsAsNearAsItSays) {
  Random random(seed);
  for (const double scale : {1e-3, 1.0, 1e3}) {
    ParameterOverrides overrides = scaled(entry(), scale);
    // Waves that the coarser mesh resolves: below that no order of convergence shows.
    if (entry().name == "texture") overrides["wavelength_m"] *= 20.0;
    const auto surface = make_surface(entry().name, overrides);
    double worst_before = 0.0;
    for (const std::size_t triangles : {1000UL, 16000UL}) {
      const Tessellation made = surface->tessellate(triangles);
      const double rounding = 1e-14 * made.mesh.bounds().sizes().maxCoeff();
      double worst = 0.0;
      for (int i = 0; i < 3000; ++i) {
        const auto& t = made.mesh.triangles[random.below(made.mesh.triangle_count())];
        const double a = random.uniform();
        const double b = random.uniform() * (1.0 - a);
        const auto v = [&](std::size_t k) { return made.mesh.vertices_W_m[static_cast<std::size_t>(t[k])]; };
        worst = std::max(worst, surface->closest(a * v(0) + b * v(1) + (1.0 - a - b) * v(2)).distance_m);
      }
      EXPECT_LE(worst, made.deviation_bound_m + rounding) << "scale " << scale;
      if (made.deviation_bound_m > 0.0) {
        EXPECT_GT(worst, made.deviation_bound_m / 12.0) << "the bound is slack";
      }
      // Sixteen times the triangles: a quarter of the size, a sixteenth of the deviation.
      if (worst_before > 0.0 && made.deviation_bound_m > 0.0) {
        EXPECT_LT(worst, worst_before / 8.0);
        EXPECT_GT(worst, worst_before / 32.0);
      }
      worst_before = worst;
    }
  }
}

TEST_P(EverySurface, ClosestPointIsOnTheSurfaceAndNoMeshPointIsCloser) {
  Random random(seed + 1);
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const auto surface = make_surface(entry().name, scaled(entry(), scale));
    const Tessellation made = surface->tessellate(4000);
    const double size = made.mesh.bounds().sizes().maxCoeff();
    for (int i = 0; i < 150; ++i) {
      // Half of the queries near the surface, half anywhere around it.
      const auto& v = made.mesh.vertices_W_m[random.below(made.mesh.vertices_W_m.size())];
      const Vec3 p = i % 2 == 0 ? random_point(random, made.mesh.bounds(), 0.8)
                                : Vec3(v * 0.98 + random.direction() * random.log_uniform(1e-9, 1e-2) * size);
      const surface::SurfacePoint at = surface->closest(p);
      EXPECT_NEAR((p - at.p_W_m).norm(), at.distance_m, 1e-14 * size);
      EXPECT_EQ(std::abs(at.signed_distance_m), at.distance_m);
      EXPECT_NEAR(at.n_W.norm(), 1.0, 1e-14);
      EXPECT_LE(surface->closest(at.p_W_m).distance_m, 4e-15 * size);
      // The foot lies along the normal where the surface is smooth; at an edge within its normals' cone.
      EXPECT_GE((p - at.p_W_m).dot(at.n_W) * (at.signed_distance_m < 0.0 ? -1.0 : 1.0), -1e-13 * size);
      // An open patch's surface goes on beyond its mesh.
      if (!surface->closed() && !made.mesh.bounds().contains(at.p_W_m)) continue;
      const double brute = brute_distance(made.mesh, p);
      EXPECT_NEAR(at.distance_m, brute, made.deviation_bound_m + 1e-14 * size) << p.transpose();
    }
  }
}

TEST_P(EverySurface, CrossingsAgreeWithSignedDistances) {
  Random random(seed + 2);
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const auto surface = make_surface(entry().name, scaled(entry(), scale));
    const Box3 box = surface->bounds();
    const double size = box.sizes().maxCoeff();
    int found = 0;
    for (int i = 0; i < 300; ++i) {
      const Vec3 a = random_point(random, box, 1.2);
      const Vec3 b = i % 3 == 0 ? random_point(random, box, 1.2)
                                : Vec3(a + random.direction() * random.log_uniform(1e-6, 0.5) * size);
      const bool in_a = surface->signed_distance(a) < 0.0;
      const bool in_b = surface->signed_distance(b) < 0.0;
      const auto crossing = surface->first_crossing(a, b);
      if (in_a != in_b) {
        ASSERT_TRUE(crossing) << a.transpose() << " to " << b.transpose();
      }
      const double end = crossing ? crossing->fraction : 1.0;
      for (int k = 0; k < 20; ++k) {
        const double t = end * (k + 0.5) / 20.5;
        EXPECT_EQ(surface->signed_distance(a + t * (b - a)) < 0.0, in_a) << "an earlier crossing was missed";
      }
      if (!crossing) continue;
      ++found;
      EXPECT_LE(surface->closest(crossing->p_W_m).distance_m, 4e-15 * size);
      EXPECT_LE((a + crossing->fraction * (b - a) - crossing->p_W_m).norm(), 1e-13 * size);
      EXPECT_EQ(crossing->entering, !in_a);
      EXPECT_LE(crossing->n_W.dot(b - a) * (crossing->entering ? 1.0 : -1.0), 1e-12 * (b - a).norm());
    }
    EXPECT_GT(found, 15);
  }
}

TEST_P(EverySurface, ExactContactObeysHooke) {
  Random random(seed + 3);
  const auto surface = make_surface(entry().name);
  const double k = 700.0;
  const double size = surface->bounds().sizes().maxCoeff();
  for (int i = 0; i < 100; ++i) {
    const Vec3 p = random_point(random, surface->bounds(), 0.8);
    const double tip_radius = i % 2 == 0 ? 0.0 : 0.001;
    const ExactContact contact = exact_contact(*surface, p, k, tip_radius);
    EXPECT_EQ(contact.contact, surface->signed_distance(p) < tip_radius);
    EXPECT_NEAR((contact.f_W_N - k * (contact.proxy_W_m - p)).norm(), 0.0, 1e-12 * k * size);
    EXPECT_GE(contact.depth_m, 0.0);
  }
}

TEST(SurfaceCatalogue, RefusesWhatItDoesNotKnow) {
  EXPECT_THROW(make_surface("plan"), UsageError);
  EXPECT_THROW(make_surface("plane", {{"radius_m", 1.0}}), UsageError);
  EXPECT_THROW(make_surface("plane", {{"half_side_m", -1.0}}), UsageError);
  EXPECT_THROW(make_surface("plane", {{"half_side_m", std::nan("")}}), UsageError);
  EXPECT_THROW(make_surface("bowl", {{"thickness_m", 0.03}}), UsageError);
  EXPECT_THROW(make_surface("extrusion", {{"edge_radius_m", 0.02}}), UsageError);
  EXPECT_THROW(make_mesh("plane", {}, 0), UsageError);
}

}  // namespace
}  // namespace touchstone::synthetic
