#include "harness/surface/embree_surface.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <vector>

#include "harness/base/error.h"
#include "harness/surface/mesh_file.h"
#include "harness/surface/mesh_topology.h"
#include "harness/surface/triangle_queries.h"
#include "harness/surface/triangle_surface.h"

namespace touchstone {
namespace {

// In units of half the mesh's size. Rounding a coordinate of magnitude 1 to float costs 2^-25 = 3e-8, a ray's course
// half a dozen such roundings; this is eight times that.
constexpr double padding = 2e-6;
// Beyond this distance (in the same units) float cannot tell the triangles apart at all.
constexpr double far_away = 1e6;

struct DeviceRelease {
  void operator()(RTCDevice device) const {
    if (device != nullptr) rtcReleaseDevice(device);
  }
};
struct SceneRelease {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};

// One for all surfaces that live: the library starts no more than some three hundred. Its errors are kept per thread.
std::shared_ptr<RTCDeviceTy> shared_device(const std::string& source) {
  static std::mutex mutex;
  static std::weak_ptr<RTCDeviceTy> known;
  const std::lock_guard lock(mutex);
  auto device = known.lock();
  if (device) return device;
  device.reset(rtcNewDevice(nullptr), DeviceRelease{});
  if (!device)
    throw Error(ExitStatus::bad_data, fmt::format("{}: Embree cannot start (error {})", source,
                                                  static_cast<int>(rtcGetDeviceError(nullptr))));
  known = device;
  return device;
}

class EmbreeSurface final : public TriangleSurface {
 public:
  explicit EmbreeSurface(const TriangleMesh& mesh) : TriangleSurface(mesh) {
    center_ = bounds().center();
    scale_ = 2.0 / bounds().sizes().maxCoeff();
    half_ = 0.5 * scale_ * bounds().sizes();
    balls_.reserve(mesh_.triangles.size());
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
      balls_.push_back(ball_around(static_cast<std::int32_t>(t)));
    device_ = shared_device(mesh_.source);
    scene_.reset(rtcNewScene(device_.get()));
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(mesh_.triangles.size()));
    rtcSetGeometryUserData(geometry, this);
    rtcSetGeometryBoundsFunction(geometry, triangle_bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, propose_crossing);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_.get());
    if (const RTCError error = rtcGetDeviceError(device_.get()); error != RTC_ERROR_NONE) {
      throw Error(ExitStatus::bad_data,
                  fmt::format("{}: Embree cannot build its hierarchy over {} triangles (error {})", mesh_.source,
                              mesh_.triangles.size(), static_cast<int>(error)));
    }
  }

  [[nodiscard]] SurfacePoint closest(const Vec3& p_W_m) const override {
    const Vec3 q = scale_ * (p_W_m - center_);
    ClosestSearch search{this, p_W_m, {}, -1, 0.0};
    const double magnitude = q.cwiseAbs().maxCoeff();
    if (!p_W_m.allFinite()) return no_point(p_W_m);
    if (!(magnitude <= far_away)) {
      for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) search.propose(static_cast<std::int32_t>(t));
      return finish(p_W_m, search.triangle, search.best);
    }
    search.slack = padding * (1.0 + magnitude);
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    RTCPointQuery query;
    query.x = static_cast<float>(q.x());
    query.y = static_cast<float>(q.y());
    query.z = static_cast<float>(q.z());
    query.time = 0.0F;
    query.radius = std::numeric_limits<float>::infinity();
    rtcPointQuery(scene_.get(), &query, &context, propose_closest, &search);
    return finish(p_W_m, search.triangle, search.best);
  }

  [[nodiscard]] std::optional<Crossing> first_crossing(const Vec3& a_W_m, const Vec3& b_W_m) const override {
    if (!a_W_m.allFinite() || !b_W_m.allFinite()) return std::nullopt;
    const Vec3 a = scale_ * (a_W_m - center_);
    const Vec3 b = scale_ * (b_W_m - center_);
    // Only the part near the mesh: there the ray's coordinates are of magnitude 1.
    double from = 0.0;
    double to = 1.0;
    for (Eigen::Index i = 0; i < 3; ++i) {
      const double wall = half_[i] + 8.0 * padding;
      const double step = b[i] - a[i];
      if (step == 0.0) {
        if (std::abs(a[i]) > wall) return std::nullopt;
        continue;
      }
      const double t0 = (-wall - a[i]) / step;
      const double t1 = (wall - a[i]) / step;
      from = std::max(from, std::min(t0, t1));
      to = std::min(to, std::max(t0, t1));
    }
    const double length = (b - a).norm();
    if (!(from <= to) || !(length > 0.0)) return std::nullopt;
    CrossingSearch search{};
    rtcInitIntersectContext(&search.context);
    search.a = a_W_m;
    search.b = b_W_m;
    search.length = length;
    search.begin = from * length - padding;
    search.triangle = -1;
    const Vec3 direction = (b - a) / length;
    const Vec3 origin = a + search.begin * direction;
    RTCRayHit hit{};
    hit.ray.org_x = static_cast<float>(origin.x());
    hit.ray.org_y = static_cast<float>(origin.y());
    hit.ray.org_z = static_cast<float>(origin.z());
    hit.ray.dir_x = static_cast<float>(direction.x());
    hit.ray.dir_y = static_cast<float>(direction.y());
    hit.ray.dir_z = static_cast<float>(direction.z());
    hit.ray.tnear = 0.0F;
    hit.ray.tfar = static_cast<float>((to - from) * length + 3.0 * padding);
    hit.ray.mask = ~0U;
    hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_.get(), &search.context, &hit);
    if (search.triangle < 0) return std::nullopt;
    return finish(a_W_m, b_W_m, search.triangle, search.best);
  }

 private:
  struct ClosestSearch {
    const EmbreeSurface* surface;
    Vec3 q;
    TriangleClosest best;
    std::int32_t triangle;
    double slack;

    // Of equally close triangles the one with the smaller index, whatever the order of visits.
    bool propose(std::int32_t t) {
      const Facet& facet = surface->facet(t);
      const TriangleClosest here = closest_on_triangle(facet.corners, facet.normal, q);
      if (triangle >= 0 && (here.squared_distance > best.squared_distance ||
                            (here.squared_distance == best.squared_distance && t > triangle)))
        return false;
      best = here;
      triangle = t;
      return true;
    }
  };
  // Embree hands its context to the callback: it must come first.
  struct CrossingSearch {
    RTCIntersectContext context;
    Vec3 a;
    Vec3 b;
    double length;  // of the segment, scaled
    double begin;   // where the ray starts along it
    TriangleCrossing best;
    std::int32_t triangle;
  };

  // Around a triangle, scaled and padded. Embree hands over whole leaves: most of their triangles are turned down by
  // this small array before their corners are fetched.
  struct Ball {
    float x;
    float y;
    float z;
    float radius;
    [[nodiscard]] bool beyond(const RTCPointQuery& query) const {
      const float dx = query.x - x;
      const float dy = query.y - y;
      const float dz = query.z - z;
      const float reach = query.radius + radius;
      return dx * dx + dy * dy + dz * dz > reach * reach;
    }
  };
  [[nodiscard]] Ball ball_around(std::int32_t triangle) const {
    Box3 box;
    for (const Vec3& corner : facet(triangle).corners) box.extend(Vec3(scale_ * (corner - center_)));
    const Vec3 middle = box.center();
    double radius2 = 0.0;
    for (const Vec3& corner : facet(triangle).corners) {
      radius2 = std::max(radius2, (scale_ * (corner - center_) - middle).squaredNorm());
    }
    return {static_cast<float>(middle.x()), static_cast<float>(middle.y()), static_cast<float>(middle.z()),
            static_cast<float>(std::sqrt(radius2) + padding)};
  }

  static void triangle_bounds(const RTCBoundsFunctionArguments* arguments) {
    const auto& self = *static_cast<const EmbreeSurface*>(arguments->geometryUserPtr);
    Box3 box;
    for (const Vec3& corner : self.facet(static_cast<std::int32_t>(arguments->primID)).corners)
      box.extend(Vec3(self.scale_ * (corner - self.center_)));
    RTCBounds& out = *arguments->bounds_o;
    out.lower_x = static_cast<float>(box.min().x() - padding);
    out.lower_y = static_cast<float>(box.min().y() - padding);
    out.lower_z = static_cast<float>(box.min().z() - padding);
    out.upper_x = static_cast<float>(box.max().x() + padding);
    out.upper_y = static_cast<float>(box.max().y() + padding);
    out.upper_z = static_cast<float>(box.max().z() + padding);
  }

  static bool propose_closest(RTCPointQueryFunctionArguments* arguments) {
    auto& search = *static_cast<ClosestSearch*>(arguments->userPtr);
    if (search.surface->balls_[arguments->primID].beyond(*arguments->query)) return false;
    if (!search.propose(static_cast<std::int32_t>(arguments->primID))) return false;
    const double radius =
        search.surface->scale_ * std::sqrt(search.best.squared_distance) * (1.0 + padding) + search.slack;
    arguments->query->radius = std::min(arguments->query->radius, static_cast<float>(radius));
    return true;
  }

  static void propose_crossing(const RTCIntersectFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) return;
    const auto& self = *static_cast<const EmbreeSurface*>(arguments->geometryUserPtr);
    auto& search = *reinterpret_cast<CrossingSearch*>(arguments->context);
    const auto t = static_cast<std::int32_t>(arguments->primID);
    const auto crossing = cross_triangle(self.facet(t).corners, self.facet(t).normal, search.a, search.b);
    if (!crossing) return;
    if (search.triangle >= 0 && (crossing->fraction > search.best.fraction ||
                                 (crossing->fraction == search.best.fraction && t > search.triangle)))
      return;
    search.best = *crossing;
    search.triangle = t;
    auto& hit = *reinterpret_cast<RTCRayHit*>(arguments->rayhit);
    hit.ray.tfar =
        std::min(hit.ray.tfar, static_cast<float>(crossing->fraction * search.length - search.begin + 2.0 * padding));
    hit.hit.geomID = arguments->geomID;
    hit.hit.primID = arguments->primID;
  }

  std::shared_ptr<RTCDeviceTy> device_;
  std::unique_ptr<RTCSceneTy, SceneRelease> scene_;
  std::vector<Ball> balls_;
  Vec3 center_;
  Vec3 half_;  // of the scaled mesh's box
  double scale_;
};

}  // namespace

std::shared_ptr<Surface> make_embree_surface(const TriangleMesh& mesh) { return std::make_shared<EmbreeSurface>(mesh); }

}  // namespace touchstone
