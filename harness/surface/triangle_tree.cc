#include "harness/surface/triangle_tree.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <vector>

#include "harness/base/error.h"
#include "harness/base/huge_pages.h"
#include "harness/base/in_parallel.h"

namespace touchstone::surface {
namespace {

// In units of half the mesh's size. Rounding a coordinate of magnitude 1 to float costs 2^-25 = 3e-8, a ray's course
// half a dozen such roundings; this is eight times that.
constexpr double padding = 2e-6;
// From here on the hierarchy is built along a space-filling curve (C. Lauterbach and others, Eurographics 2009) in
// place of by the surface area heuristic: a third of the time, which of a million triangles is most of what a user
// waits for, and queries of no other answers and of the same cost within what can be measured.
constexpr std::size_t many_triangles = 250'000;
// Beyond this distance (in the same units) float cannot tell the triangles apart at all.
constexpr double far_away = 1e6;

// What differs between Embree 3 and 4: how a ray's context is named and handed over.
#if RTC_VERSION_MAJOR >= 4
using RayContext = RTCRayQueryContext;
void intersect(RTCScene scene, RayContext& context, RTCRayHit& hit) {
  rtcInitRayQueryContext(&context);
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.context = &context;
  rtcIntersect1(scene, &hit, &arguments);
}
#else
using RayContext = RTCIntersectContext;
void intersect(RTCScene scene, RayContext& context, RTCRayHit& hit) {
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &hit);
}
#endif

struct DeviceRelease {
  void operator()(RTCDevice device) const {
    if (device != nullptr) rtcReleaseDevice(device);
  }
};
struct SceneRelease {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};

// One for all trees that live: the library starts no more than some three hundred. Its errors are kept per thread.
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

// Around a triangle, scaled and padded. Embree hands over whole leaves: most of their triangles are turned down by this
// small array before their corners are fetched.
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

}  // namespace

struct TriangleTree::Embree {
  const TriangleMesh* mesh = nullptr;
  Vec3 center;
  Vec3 half;  // of the scaled mesh's box
  double scale = 0.0;
  std::vector<Ball> balls;
  std::shared_ptr<RTCDeviceTy> device;
  std::unique_ptr<RTCSceneTy, SceneRelease> scene;
  mutable WorkOrder order;  // of the build

  [[nodiscard]] Vec3 scaled(std::int32_t vertex) const {
    return scale * (mesh->vertices_W_m[static_cast<std::size_t>(vertex)] - center);
  }
  [[nodiscard]] Ball ball_around(std::size_t triangle) const {
    Box3 box;
    for (const std::int32_t corner : mesh->triangles[triangle]) box.extend(scaled(corner));
    const Vec3 middle = box.center();
    double radius2 = 0.0;
    for (const std::int32_t corner : mesh->triangles[triangle])
      radius2 = std::max(radius2, (scaled(corner) - middle).squaredNorm());
    return {static_cast<float>(middle.x()), static_cast<float>(middle.y()), static_cast<float>(middle.z()),
            static_cast<float>(std::sqrt(radius2) + padding)};
  }

  // Embree hands its context to the callback: it must come first.
  struct SegmentVisit {
    RayContext context;
    Visitor visitor;
    double length;  // of the segment, scaled
    double begin;   // where the ray starts along it
  };
  struct BallVisit {
    const Embree* tree;
    Visitor visitor;
    double scale;
    double slack;
  };

  static void bounds(const RTCBoundsFunctionArguments* arguments) {
    const auto& self = *static_cast<const Embree*>(arguments->geometryUserPtr);
    const WorkOrder::Piece piece(self.order);
    Box3 box;
    for (const std::int32_t corner : self.mesh->triangles[arguments->primID]) box.extend(self.scaled(corner));
    RTCBounds& out = *arguments->bounds_o;
    out.lower_x = static_cast<float>(box.min().x() - padding);
    out.lower_y = static_cast<float>(box.min().y() - padding);
    out.lower_z = static_cast<float>(box.min().z() - padding);
    out.upper_x = static_cast<float>(box.max().x() + padding);
    out.upper_y = static_cast<float>(box.max().y() + padding);
    out.upper_z = static_cast<float>(box.max().z() + padding);
  }

  static void on_segment(const RTCIntersectFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) return;
    auto& visit = *reinterpret_cast<SegmentVisit*>(arguments->context);
    const double beyond = visit.visitor.call(visit.visitor.self, static_cast<std::int32_t>(arguments->primID));
    if (!(beyond < 1.0)) return;
    auto& hit = *reinterpret_cast<RTCRayHit*>(arguments->rayhit);
    const auto reach = static_cast<float>(std::max(0.0, beyond * visit.length - visit.begin) + 2.0 * padding);
    if (reach < hit.ray.tfar) {
      hit.ray.tfar = reach;
      hit.hit.geomID = arguments->geomID;
      hit.hit.primID = arguments->primID;
    }
  }

  static bool in_ball(RTCPointQueryFunctionArguments* arguments) {
    auto& visit = *static_cast<BallVisit*>(arguments->userPtr);
    if (visit.tree->balls[arguments->primID].beyond(*arguments->query)) return false;
    const double beyond = visit.visitor.call(visit.visitor.self, static_cast<std::int32_t>(arguments->primID));
    const auto radius = static_cast<float>(visit.scale * beyond * (1.0 + padding) + visit.slack);
    if (!(radius < arguments->query->radius)) return false;
    arguments->query->radius = radius;
    return true;
  }
};

TriangleTree::TriangleTree(const TriangleMesh& mesh) : embree_(std::make_unique<Embree>()) {
  Box3 box;
  for (const auto& triangle : mesh.triangles) {
    for (const std::int32_t corner : triangle) box.extend(mesh.vertices_W_m[static_cast<std::size_t>(corner)]);
  }
  Embree& self = *embree_;
  self.mesh = &mesh;
  self.center = box.center();
  self.scale = 2.0 / box.sizes().maxCoeff();
  self.half = 0.5 * self.scale * box.sizes();
  const auto fail = [&](RTCError error) {
    throw Error(ExitStatus::bad_data, fmt::format("{}: Embree cannot build its hierarchy over {} triangles (error {})",
                                                  mesh.source, mesh.triangles.size(), static_cast<int>(error)));
  };
  reserve_in_huge_pages(self.balls, mesh.triangles.size());
  self.balls.resize(mesh.triangles.size());
  in_parallel(self.balls.size(), [&](std::size_t t) { self.balls[t] = self.ball_around(t); });
  self.device = shared_device(mesh.source);
  self.scene.reset(rtcNewScene(self.device.get()));
  rtcSetSceneFlags(self.scene.get(), RTC_SCENE_FLAG_ROBUST);
  const RTCGeometry geometry = rtcNewGeometry(self.device.get(), RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(mesh.triangles.size()));
  rtcSetGeometryUserData(geometry, &self);
  rtcSetGeometryBoundsFunction(geometry, Embree::bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, Embree::on_segment);
  if (mesh.triangles.size() >= many_triangles) {
    rtcSetSceneBuildQuality(self.scene.get(), RTC_BUILD_QUALITY_LOW);
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_LOW);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(self.scene.get(), geometry);
  rtcReleaseGeometry(geometry);
  // In isolation: whoever builds under a lock must not, while it waits, take up a task that wants the same lock.
  {
    const WorkOrder::Whole whole(self.order);
    tbb::this_task_arena::isolate([&] { rtcCommitScene(self.scene.get()); });
  }
  if (const RTCError error = rtcGetDeviceError(self.device.get()); error != RTC_ERROR_NONE) fail(error);
}

TriangleTree::~TriangleTree() = default;

void TriangleTree::segment(const Vec3& a_W_m, const Vec3& b_W_m, Visitor visitor) const {
  const Embree& self = *embree_;
  const Vec3 a = self.scale * (a_W_m - self.center);
  const Vec3 b = self.scale * (b_W_m - self.center);
  // Only the part near the mesh: there the ray's coordinates are of magnitude 1.
  double from = 0.0;
  double to = 1.0;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double wall = self.half[i] + 8.0 * padding;
    const double step = b[i] - a[i];
    if (step == 0.0) {
      if (std::abs(a[i]) > wall) return;
      continue;
    }
    const double t0 = (-wall - a[i]) / step;
    const double t1 = (wall - a[i]) / step;
    from = std::max(from, std::min(t0, t1));
    to = std::min(to, std::max(t0, t1));
  }
  const double length = (b - a).norm();
  if (!(from <= to) || !(length > 0.0)) return;
  Embree::SegmentVisit visit{};
  visit.visitor = visitor;
  visit.length = length;
  visit.begin = from * length - padding;
  const Vec3 direction = (b - a) / length;
  const Vec3 origin = a + visit.begin * direction;
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
  intersect(self.scene.get(), visit.context, hit);
}

void TriangleTree::ball(const Vec3& center_W_m, double radius_m, Visitor visitor) const {
  const Embree& self = *embree_;
  const Vec3 q = self.scale * (center_W_m - self.center);
  const double magnitude = q.cwiseAbs().maxCoeff();
  if (!(magnitude <= far_away)) {
    for (std::size_t t = 0; t < self.mesh->triangles.size(); ++t)
      visitor.call(visitor.self, static_cast<std::int32_t>(t));
    return;
  }
  Embree::BallVisit visit{&self, visitor, self.scale, padding * (1.0 + magnitude)};
  RTCPointQueryContext context{};
  rtcInitPointQueryContext(&context);
  RTCPointQuery query{};
  query.x = static_cast<float>(q.x());
  query.y = static_cast<float>(q.y());
  query.z = static_cast<float>(q.z());
  query.time = 0.0F;
  query.radius = static_cast<float>(self.scale * radius_m * (1.0 + padding) + visit.slack);
  rtcPointQuery(self.scene.get(), &query, &context, Embree::in_ball, &visit);
}

void TriangleTree::pairs(PairVisitor visitor) const {
  struct Visit {
    PairVisitor visitor;
    WorkOrder order;
  } visit{visitor, {}};
  const auto found = [](void* self, RTCCollision* collisions, unsigned count) {
    auto& [to, order] = *static_cast<Visit*>(self);
    const WorkOrder::Piece piece(order);
    for (unsigned i = 0; i < count; ++i) {
      to.call(to.self, static_cast<std::int32_t>(collisions[i].primID0),
              static_cast<std::int32_t>(collisions[i].primID1));
    }
  };
  const WorkOrder::Whole whole(visit.order);
  tbb::this_task_arena::isolate([&] { rtcCollide(embree_->scene.get(), embree_->scene.get(), found, &visit); });
}

}  // namespace touchstone::surface
