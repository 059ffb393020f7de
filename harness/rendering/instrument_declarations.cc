#include "harness/rendering/instrument_declarations.h"

#include <limits>

namespace touchstone {
namespace {

constexpr double kMost = std::numeric_limits<double>::max();

ParameterDeclaration any(const char* name, const char* unit, const char* meaning) {
  return {name, unit, -kMost, kMost, 0.0, meaning};
}

}  // namespace

const std::vector<NamedDeclaration>& instrument_declarations() {
  static const std::vector<NamedDeclaration> declarations{
      {"tool-weight",
       "the weight of what hangs on the force sensor: F + m g",
       {{"mass_kg", "kg", 0.0, kMost, 0.0, "mass beyond the sensor"}}},
      {"tool-inertia",
       "the inertia of what hangs on the force sensor: F - m a",
       {{"mass_kg", "kg", 0.0, kMost, 0.0, "mass beyond the sensor"}}},
      {"force-bias",
       "a constant added to the force",
       {any("fx_N", "N", "along x"), any("fy_N", "N", "along y"), any("fz_N", "N", "along z")}},
      {"force-drift",
       "a force that grows with time",
       {any("fx_N_per_s", "N/s", "along x"), any("fy_N_per_s", "N/s", "along y"), any("fz_N_per_s", "N/s", "along z")}},
      {"force-crosstalk",
       "fx += c_xz fz, fy += c_yz fz",
       {any("c_xz", "1", "of z on x"), any("c_yz", "1", "of z on y")}},
      {"force-saturation",
       "every axis clipped at +- the limit",
       {{"limit_N", "N", std::numeric_limits<double>::min(), kMost, kMost, "the largest force an axis shows"}}},
      {"time-lag", "the force is later than the position", {any("lag_s", "s", "lag of the force")}},
      {"registration",
       "measured = true + d + r x true",
       {any("dx_m", "m", "shift"), any("dy_m", "m", "shift"), any("dz_m", "m", "shift"),
        any("rx_rad", "rad", "rotation"), any("ry_rad", "rad", "rotation")}},
      {"surface-geometry",
       "a Gaussian bump that the mesh lacks",
       {any("amplitude_m", "m", "height"),
        any("x_m", "m", "centre"),
        any("y_m", "m", "centre"),
        {"width_m", "m", std::numeric_limits<double>::min(), kMost, 0.01, "standard deviation"}}},
  };
  return declarations;
}

}  // namespace touchstone
