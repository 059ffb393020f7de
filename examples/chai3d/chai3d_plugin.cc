// CHAI3D's proxy, cAlgorithmFingerProxy, as a plug-in of Touchstone. Nothing of CHAI3D is in this file or its folder:
// it is linked with a CHAI3D of your own (see CMakeLists.txt). Tried with CHAI3D 3.3.0,
// commit 7c76b1f of github.com/chai3d/chai3d.
//
// What a user of CHAI3D chooses is chosen here by the renderer's name:
//   chai3d-static    one constraint is looked for per step (the default, m_useDynamicProxy = false)
//   chai3d-dynamic   up to three constraints per step (m_useDynamicProxy = true)
//   ...-mm           the same with the world in millimetres: CHAI3D's lengths are absolute (its epsilon is 1e-4 units,
//                    cAlgorithmFingerProxy::setEpsilonBaseValue), so that its answer depends on the unit of its world
#include <touchstone/engine_plugin.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "forces/CAlgorithmFingerProxy.h"
#include "world/CMesh.h"
#include "world/CWorld.h"

namespace {

// The constructor of cAlgorithmFingerProxy: setEpsilonBaseValue(0.0001), in units of its world.
constexpr double kEpsilonUnits = 1e-4;

enum Value : std::size_t { stiffness, mu_static, mu_dynamic, tip_radius, epsilon, world_unit, value_count };

// Epsilon and world unit are lengths, but of this engine and not of the object: they stay when the object is scaled,
// hence the unit "1".
constexpr std::array<touchstone_parameter, value_count> parameters_in(double unit_m) {
  return {{{"stiffness_N_per_m", "N/m", 1e-9, 1e9, 500.0, "k of the spring between proxy and tip"},
           {"mu_static", "1", 0.0, 10.0, 0.0, "static friction; 0 with mu_dynamic 0: none"},
           {"mu_dynamic", "1", 0.0, 10.0, 0.0, "dynamic friction"},
           {"tip_radius_m", "m", 0.0, 1e3, 0.0, "radius of the proxy; 0: a point"},
           {"epsilon_m", "1", 1e-12, 1.0, kEpsilonUnits * unit_m,
            "[m], setEpsilonBaseValue(): the proxy's distance from a triangle, and the move that is none"},
           {"world_unit_m", "1", 1e-6, 1e3, unit_m, "[m], what CHAI3D's world is counted in"}}};
}
constexpr std::array kInMetres = parameters_in(1.0);
constexpr std::array kInMillimetres = parameters_in(1e-3);

constexpr std::array kCannot = {
    touchstone_limitation{"start_inside", "the proxy starts where the tip is, inside too"},
};

constexpr const char* kSource = "Ruspini, Kolarov and Khatib, SIGGRAPH 1997, as CHAI3D's cAlgorithmFingerProxy has it";

touchstone_description description(const char* name, const char* summary,
                                   const std::array<touchstone_parameter, value_count>& parameters) {
  return {TOUCHSTONE_PLUGIN_SIZES, name,           summary,       kSource, parameters.data(),
          parameters.size(),       kCannot.data(), kCannot.size()};
}

const std::array<touchstone_description, 4>& descriptions() {
  static const std::array<touchstone_description, 4> all{
      description("chai3d-static", "CHAI3D's finger proxy, one constraint per step, world in metres", kInMetres),
      description("chai3d-dynamic", "CHAI3D's dynamic finger proxy, world in metres", kInMetres),
      description("chai3d-static-mm", "CHAI3D's finger proxy, one constraint per step, world in millimetres",
                  kInMillimetres),
      description("chai3d-dynamic-mm", "CHAI3D's dynamic finger proxy, world in millimetres", kInMillimetres)};
  return all;
}

}  // namespace

struct touchstone_renderer {
  explicit touchstone_renderer(const touchstone_creation& creation) : unit_m(creation.parameters[world_unit]) {
    const double* const value = creation.parameters;
    auto* const mesh = new chai3d::cMesh();  // the world's from here on
    world.addChild(mesh);
    for (std::size_t i = 0; i < creation.vertex_count; ++i) {
      const double* const v = creation.vertices_W_m + 3 * i;
      mesh->newVertex(v[0] / unit_m, v[1] / unit_m, v[2] / unit_m);
    }
    for (std::size_t i = 0; i < creation.triangle_count; ++i) {
      const std::int32_t* const t = creation.triangles + 3 * i;
      mesh->newTriangle(static_cast<unsigned>(t[0]), static_cast<unsigned>(t[1]), static_cast<unsigned>(t[2]));
    }
    const double radius = value[tip_radius] / unit_m;
    mesh->m_material->setStiffness(value[stiffness] * unit_m);
    mesh->m_material->setHapticTriangleSides(true, false);
    mesh->m_material->setUseHapticFriction(value[mu_static] > 0.0 || value[mu_dynamic] > 0.0);
    mesh->m_material->setStaticFriction(value[mu_static]);
    mesh->m_material->setDynamicFriction(value[mu_dynamic]);
    mesh->setHapticEnabled(true);
    mesh->createAABBCollisionDetector(radius);
    world.computeGlobalPositions(true);
    proxy.setProxyRadius(radius);
    proxy.setEpsilonBaseValue(value[epsilon] / unit_m);
    proxy.m_useDynamicProxy = creation.index % 2 == 1;
  }

  void restart() { first = true; }

  void step(const touchstone_tip& tip, touchstone_result& result) {
    const chai3d::cVector3d p(tip.p_W_m[0] / unit_m, tip.p_W_m[1] / unit_m, tip.p_W_m[2] / unit_m);
    if (first) proxy.initialize(&world, p);
    first = false;
    const chai3d::cVector3d force = proxy.computeForces(p, chai3d::cVector3d(0.0, 0.0, 0.0));
    std::copy_n(tip.p_W_m, 3, result.contact_W_m);
    if (proxy.getNumCollisionEvents() == 0) return;
    const chai3d::cVector3d at = proxy.getProxyGlobalPosition();
    const chai3d::cVector3d& n = proxy.m_collisionEvents[0]->m_globalNormal;
    result.contact = 1;
    for (unsigned i = 0; i < 3; ++i) {
      result.f_W_N[i] = force(i);
      result.contact_W_m[i] = at(i) * unit_m;
      result.n_W[i] = n(i);
      result.depth_m += n(i) * (at(i) - p(i)) * unit_m;
    }
    result.depth_m = std::max(0.0, result.depth_m);
  }

  double unit_m;
  chai3d::cWorld world;
  chai3d::cAlgorithmFingerProxy proxy;
  bool first = true;
  std::string error;
};

TOUCHSTONE_EXPORT_ENGINE(descriptions());
