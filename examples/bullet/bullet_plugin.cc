// A ball against a mesh by Bullet's narrow phase as a plug-in of Touchstone: F = k d along the normal of the deepest
// contact that btCollisionWorld::contactPairTest reports between a btSphereShape and a btBvhTriangleMeshShape. Nothing
// of Bullet is in this file or its folder. Tried with Bullet 3.24 in double precision (Debian: libbullet-dev).
//
// It is not a haptic renderer of Bullet's, which has none, but what a user of a physics engine writes first.
#include <btBulletCollisionCommon.h>
#include <touchstone/engine_plugin.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

static_assert(sizeof(btScalar) == sizeof(double), "Bullet in double precision: -DBT_USE_DOUBLE_PRECISION");

namespace {

enum Value : std::size_t { stiffness, tip_radius };

constexpr std::array kParameters = {
    touchstone_parameter{"stiffness_N_per_m", "N/m", 1e-9, 1e9, 500.0, "k of F = k d"},
    touchstone_parameter{"tip_radius_m", "m", 1e-9, 1e3, 0.0025, "radius of the ball"},
};
constexpr std::array kCannot = {
    touchstone_limitation{"thin_shells", "it remembers no side"},
    touchstone_limitation{"large_jumps", "it remembers no side"},
    touchstone_limitation{"start_inside", "it knows triangles, not what is inside"},
    touchstone_limitation{"continuous_force", "the deepest contact changes from triangle to triangle"},
};

const std::array<touchstone_description, 1>& descriptions() {
  static const std::array<touchstone_description, 1> all{touchstone_description{
      TOUCHSTONE_PLUGIN_SIZES, "bullet-deepest-contact", "Bullet's deepest contact of a ball and a mesh, as a spring",
      "btCollisionWorld::contactPairTest of Bullet 3", kParameters.data(), kParameters.size(), kCannot.data(),
      kCannot.size()}};
  return all;
}

struct Deepest final : btCollisionWorld::ContactResultCallback {
  const btCollisionObject* ball = nullptr;
  btScalar distance_m = 0.0;
  btVector3 normal{0.0, 0.0, 0.0};  // towards the ball

  btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper* first, int, int,
                           const btCollisionObjectWrapper*, int, int) override {
    if (point.getDistance() < distance_m) {
      distance_m = point.getDistance();
      // It points from the second object to the first.
      normal = first->getCollisionObject() == ball ? point.m_normalWorldOnB : -point.m_normalWorldOnB;
    }
    return 0.0;
  }
};

}  // namespace

struct touchstone_renderer {
  explicit touchstone_renderer(const touchstone_creation& creation)
      : stiffness_N_per_m(creation.parameters[stiffness]),
        vertices(creation.vertices_W_m, creation.vertices_W_m + 3 * creation.vertex_count),
        indices(creation.triangles, creation.triangles + 3 * creation.triangle_count),
        triangles(static_cast<int>(creation.triangle_count), indices.data(), 3 * sizeof(int),
                  static_cast<int>(creation.vertex_count), vertices.data(), 3 * sizeof(double)),
        mesh(&triangles, false),
        ball(creation.parameters[tip_radius]) {
    mesh.setMargin(0.0);
    object.setCollisionShape(&mesh);
    tip.setCollisionShape(&ball);
    world.addCollisionObject(&object);
    world.addCollisionObject(&tip);
  }
  ~touchstone_renderer() {
    world.removeCollisionObject(&tip);
    world.removeCollisionObject(&object);
  }

  void restart() {}

  void step(const touchstone_tip& at, touchstone_result& result) {
    const btVector3 p(at.p_W_m[0], at.p_W_m[1], at.p_W_m[2]);
    tip.setWorldTransform(btTransform(btQuaternion::getIdentity(), p));
    Deepest deepest;
    deepest.ball = &tip;
    world.contactPairTest(&tip, &object, deepest);
    std::copy_n(at.p_W_m, 3, result.contact_W_m);
    if (!(deepest.distance_m < 0.0)) return;
    const btScalar depth_m = -deepest.distance_m;
    for (int axis = 0; axis < 3; ++axis) {
      result.f_W_N[axis] = stiffness_N_per_m * depth_m * deepest.normal[axis];
      result.contact_W_m[axis] += depth_m * deepest.normal[axis];
      result.n_W[axis] = deepest.normal[axis];
    }
    result.depth_m = depth_m;
    result.contact = 1;
  }

  double stiffness_N_per_m;
  std::vector<double> vertices;
  std::vector<int> indices;
  btTriangleIndexVertexArray triangles;
  btBvhTriangleMeshShape mesh;
  btSphereShape ball;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btCollisionWorld world{&dispatcher, &broadphase, &configuration};
  btCollisionObject object, tip;
  std::string error;
};

TOUCHSTONE_EXPORT_ENGINE(descriptions());
