#include "renderers/instrument/catalogue.h"

#include "harness/rendering/smooth_field.h"
#include "harness/rendering/surface_frame.h"
#include "renderers/instrument/geometry_effects.h"
#include "renderers/instrument/sensor_effects.h"
#include "renderers/instrument/tool_effects.h"

namespace touchstone::renderers {
namespace {

rendering::ParameterDeclaration force(std::string name, std::string unit) {
  return {std::move(name), std::move(unit), -1e3, 1e3, 0.0, "in the sensor's frame"};
}

std::vector<InstrumentEntry> make_instrument_catalogue() {
  using Stage = rendering::InstrumentStage;
  return {
      {"tool-weight",
       "the tool's weight beyond the sensor: F + m g",
       "Newton",
       Stage::object_frame,
       {{"mass_kg", "kg", 0.0, 100.0, 0.0, "of the tool beyond the sensor"}},
       &make_tool_weight,
       tool_weight_traits()},
      {"tool-inertia",
       "the tool's inertia beyond the sensor: F - m a",
       "Newton; Savitzky and Golay 1964",
       Stage::object_frame,
       {{"mass_kg", "kg", 0.0, 100.0, 0.0, "of the tool beyond the sensor"},
        {"window_s", "s", 1e-4, 1.0, 1.0 / 30.0, "window of the acceleration's quadratic fit"}},
       &make_tool_inertia,
       tool_inertia_traits()},
      {"force-bias",
       "a constant offset of the sensor",
       "sensor zero",
       Stage::sensor_offset,
       {force("fx_N", "N"), force("fy_N", "N"), force("fz_N", "N")},
       &make_force_bias,
       force_bias_traits()},
      {"force-drift",
       "an offset that grows with time",
       "sensor zero drift",
       Stage::sensor_offset,
       {force("fx_N_per_s", "N/s"), force("fy_N_per_s", "N/s"), force("fz_N_per_s", "N/s")},
       &make_force_drift,
       force_drift_traits()},
      {"gain-drift",
       "a gain that grows with time: F (1 + rate t)",
       "sensor sensitivity drift",
       Stage::sensor_linear,
       {{"rate_per_s", "1/s", -1.0, 1.0, 0.0, "of the gain"}},
       &make_gain_drift,
       gain_drift_traits()},
      {"force-crosstalk",
       "the sensor's axes leak: fx += c_xz fz, fy += c_yz fz",
       "sensor calibration matrix",
       Stage::sensor_linear,
       {{"c_xz", "1", -1.0, 1.0, 0.0, "fz into fx"}, {"c_yz", "1", -1.0, 1.0, 0.0, "fz into fy"}},
       &make_force_crosstalk,
       force_crosstalk_traits()},
      {"force-saturation",
       "every axis clipped at +- the limit",
       "sensor range",
       Stage::saturation,
       {{"limit_N", "N", 1e-6, 1e6, 1e6, "of every axis"}},
       &make_force_saturation,
       force_saturation_traits()},
      {"time-lag",
       "the force comes later than the position",
       "clock offset",
       Stage::time,
       {{"lag_s", "s", 0.0, 1.0, 0.0, "force later than position"}},
       &make_time_lag,
       time_lag_traits()},
      {"registration",
       "tracker and mesh do not agree: measured = true + d + r x (true - pivot)",
       "small rigid motion",
       Stage::pose,
       {{"dx_m", "m", -1.0, 1.0, 0.0, "shift"},
        {"dy_m", "m", -1.0, 1.0, 0.0, "shift"},
        {"dz_m", "m", -1.0, 1.0, 0.0, "shift"},
        {"rx_rad", "rad", -0.5, 0.5, 0.0, "turn about x"},
        {"ry_rad", "rad", -0.5, 0.5, 0.0, "turn about y"},
        {"rz_rad", "rad", -0.5, 0.5, 0.0, "turn about z"},
        {"pivot_x_m", "m", -1e6, 1e6, 0.0, "about which it turns"},
        {"pivot_y_m", "m", -1e6, 1e6, 0.0, "about which it turns"},
        {"pivot_z_m", "m", -1e6, 1e6, 0.0, "about which it turns"}},
       &make_registration,
       registration_traits()},
      {"tracker-scale",
       "the tracker's unit of length is off: measured = pivot + (1 + scale) (true - pivot)",
       "Helmert 1880, similarity transform",
       Stage::pose,
       {{"scale", "1", -0.5, 0.5, 0.0, "share by which lengths come out too long"},
        {"pivot_x_m", "m", -1e6, 1e6, 0.0, "place that is measured rightly"},
        {"pivot_y_m", "m", -1e6, 1e6, 0.0, "place that is measured rightly"},
        {"pivot_z_m", "m", -1e6, 1e6, 0.0, "place that is measured rightly"}},
       &make_tracker_scale,
       tracker_scale_traits()},
      {"surface-geometry", "a Gaussian bump that the mesh lacks", "scan error", Stage::geometry,
       rendering::with_frame({{"amplitude_m", "m", -1.0, 1.0, 0.0, "height, outward"},
                              {"x_m", "m", -1e3, 1e3, 0.0, "place in the object's xy plane"},
                              {"y_m", "m", -1e3, 1e3, 0.0, "place in the object's xy plane"},
                              {"width_m", "m", 1e-9, 1e3, 1e-2, "standard deviation"}}),
       &make_surface_geometry, surface_geometry_traits()},
      {"height-field", "a surface that is smoothly higher or lower than the mesh: h(x, y), outward",
       "tensor-product B-splines: de Boor 1978; Eilers and Marx 1996", Stage::geometry,
       rendering::field_parameters("m", 1.0, "of the height, outward"), &make_height_field, height_field_traits()},
  };
}

}  // namespace

const std::vector<InstrumentEntry>& instrument_catalogue() {
  static const std::vector<InstrumentEntry> entries = make_instrument_catalogue();
  return entries;
}

const InstrumentEntry* find_instrument_effect(std::string_view name) {
  for (const InstrumentEntry& entry : instrument_catalogue()) {
    if (entry.name == name) return &entry;
  }
  return nullptr;
}

}  // namespace touchstone::renderers
