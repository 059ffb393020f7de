// HAPI's renderers as a plug-in of Touchstone. Nothing of HAPI is in this file or its folder: it is linked with
// libraries of your own (see CMakeLists.txt). Tried with HAPI 1.3.1, commit 533299c of
// github.com/ChristianFrisson/HAPI, and H3DUtil, commit 4d13ea0 of github.com/ChristianFrisson/H3DUtil.
//
//   hapi-god-object   GodObjectRenderer, a point
//   hapi-ruspini      RuspiniRenderer, a ball
//
// HAPI's surfaces are two-sided by default (Collision::FRONT_AND_BACK), and so they are here.
#include <HAPI/FrictionSurface.h>
#include <HAPI/GodObjectRenderer.h>
#include <HAPI/HAPIHapticsDevice.h>
#include <HAPI/HapticTriangleTree.h>
#include <HAPI/RuspiniRenderer.h>
#include <touchstone/engine_plugin.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace {

// GodObjectRendererConstants::min_distance, in metres: "the minimum distance the proxy will be from the surface".
constexpr double kEpsilon_m = 1e-7;
// What HAPI's friction takes the time of a step from.
constexpr unsigned kRate_Hz = 1000;

enum Value : std::size_t { stiffness, mu_static, mu_dynamic, epsilon, tip_radius };

// HAPI has its epsilon as a constant: the value says what it is and cannot be another. It does not follow the unit of
// length, hence the unit "1".
constexpr std::array kPointParameters = {
    touchstone_parameter{"stiffness_N_per_m", "N/m", 1e-9, 1e9, 500.0, "k of the spring between proxy and tip"},
    touchstone_parameter{"mu_static", "1", 0.0, 10.0, 0.0, "static friction; 0 with mu_dynamic 0: none"},
    touchstone_parameter{"mu_dynamic", "1", 0.0, 10.0, 0.0, "dynamic friction"},
    touchstone_parameter{"epsilon_m", "1", kEpsilon_m, kEpsilon_m, kEpsilon_m,
                         "[m], the proxy's distance from the surface; HAPI's constant"},
};
constexpr std::array kBallParameters = {
    kPointParameters[stiffness],
    kPointParameters[mu_static],
    kPointParameters[mu_dynamic],
    kPointParameters[epsilon],
    touchstone_parameter{"tip_radius_m", "m", 1e-9, 1e3, 0.0025, "radius of the proxy"},
};

constexpr std::array kPointCannot = {
    touchstone_limitation{"start_inside", "the proxy starts where the tip is, inside too"},
    touchstone_limitation{"ball_tip", "GodObjectRenderer has a point proxy only"},
};

const std::array<touchstone_description, 2>& descriptions() {
  static const std::array<touchstone_description, 2> all{
      touchstone_description{TOUCHSTONE_PLUGIN_SIZES, "hapi-god-object", "HAPI's GodObjectRenderer, in metres",
                             "Zilles and Salisbury 1995, as HAPI's GodObjectRenderer has it", kPointParameters.data(),
                             kPointParameters.size(), kPointCannot.data(), kPointCannot.size()},
      touchstone_description{TOUCHSTONE_PLUGIN_SIZES, "hapi-ruspini", "HAPI's RuspiniRenderer, a ball, in metres",
                             "Ruspini, Kolarov and Khatib 1997, as HAPI's RuspiniRenderer has it",
                             kBallParameters.data(), kBallParameters.size(), kPointCannot.data(), 1}};
  return all;
}

// Where HAPI reads the tip from: a device without a thread or hardware.
class Tip final : public HAPI::HAPIHapticsDevice {
 public:
  Tip() { haptics_rate = kRate_Hz; }
  void put(const HAPI::Vec3& p) { current_device_values.position = p; }

 private:
  void sendOutput(DeviceOutput&, HAPI::HAPITime) override {}
  bool initHapticsDevice(int) override { return true; }
  bool releaseHapticsDevice() override { return true; }
};

HAPI::Vec3 vec(const double* v) { return {v[0], v[1], v[2]}; }

}  // namespace

struct touchstone_renderer {
  explicit touchstone_renderer(const touchstone_creation& creation) : ball(creation.index == 1) {
    const double* const value = creation.parameters;
    radius_m = ball ? value[tip_radius] : 0.0;
    std::vector<HAPI::Collision::Triangle> triangles;
    triangles.reserve(creation.triangle_count);
    for (std::size_t i = 0; i < creation.triangle_count; ++i) {
      const std::int32_t* const t = creation.triangles + 3 * i;
      const auto corner = [&](int j) { return vec(creation.vertices_W_m + 3 * static_cast<std::size_t>(t[j])); };
      triangles.emplace_back(corner(0), corner(1), corner(2));
    }
    // The shapes own the shape, the shape its tree and surface.
    shapes.push_back(new HAPI::HapticTriangleTree(
        new HAPI::Collision::AABBTree(triangles),
        new HAPI::FrictionSurface(value[stiffness], 0.0, value[mu_static], value[mu_dynamic], false)));
    restart();
  }

  void restart() {
    if (ball) {
      proxy = std::make_unique<HAPI::RuspiniRenderer>(radius_m);
    } else {
      proxy = std::make_unique<HAPI::GodObjectRenderer>();
    }
    first = true;
  }

  void step(const touchstone_tip& tip, touchstone_result& result) {
    const HAPI::Vec3 p = vec(tip.p_W_m);
    device.put(p);
    const double dt_s = first ? 1.0 / kRate_Hz : tip.t_s - before_s;
    before_s = tip.t_s;
    first = false;
    const HAPI::Vec3 force = proxy->renderHapticsOneStep(&device, shapes, dt_s).force;
    std::copy_n(tip.p_W_m, 3, result.contact_W_m);
    const auto contacts = proxy->getContacts();
    if (contacts.empty()) return;
    const HAPI::Vec3 at = proxy->getProxyPosition();
    HAPI::HAPISurfaceObject::ContactInfo contact = contacts.front().second;
    const HAPI::Vec3 n = contact.vectorToGlobal(HAPI::Vec3(0.0, 1.0, 0.0));
    result.contact = 1;
    const std::array<double, 3> f{force.x, force.y, force.z}, place{at.x, at.y, at.z}, normal{n.x, n.y, n.z};
    std::copy(f.begin(), f.end(), result.f_W_N);
    std::copy(place.begin(), place.end(), result.contact_W_m);
    std::copy(normal.begin(), normal.end(), result.n_W);
    result.depth_m = std::max(0.0, n * (at - p));
  }

  bool ball;
  double radius_m = 0.0;
  HAPI::HAPIHapticsRenderer::HapticShapeVector shapes;
  Tip device;
  std::unique_ptr<HAPI::HAPIProxyBasedRenderer> proxy;
  bool first = true;
  double before_s = 0.0;
  std::string error;
};

TOUCHSTONE_EXPORT_ENGINE(descriptions());
