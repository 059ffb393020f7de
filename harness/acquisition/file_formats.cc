#include "harness/acquisition/file_formats.h"

#include <array>

namespace touchstone::acquisition {
namespace {

constexpr auto residual_part_fields = std::to_array<FormatField>({
    {"samples", "whole number", "", "that it is over"},
    {"force_component_rms_N", "number or null", "N", "RMS of one component"},
    {"force_vector_rms_N", "number or null", "N", "RMS of the vector"},
    {"force_axis_rms_N", "list of numbers", "N", "RMS of each axis"},
    {"torque_component_rms_Nm", "number or null", "Nm", "RMS of one component"},
});
constexpr FormatPart residual_part{residual_part_fields};

constexpr auto acquisition_fields = std::to_array<FormatField>({
    {"force", "object", "", "stream of the force sensor"},
    {"force.file?", "text", "", "relative to this file; not said if `hil record` brings the streams"},
    {"force.calibration?", "text", "", "ATI's file, for voltages"},
    {"force.serial?", "text", "", "checked against the calibration's"},
    {"force.bias_from_s?", "number", "s", "begin of a time in which nothing touches the probe"},
    {"force.bias_to_s?", "number", "s", "its end"},
    {"force.cutoff_Hz?", "number", "Hz", "smoothing of the force; 25 by default"},
    {"motion", "object", "", "stream of the tracker"},
    {"motion.file?", "text", "", "relative to this file"},
    {"motion.largest_gap_s?", "number", "s", "largest gap that is interpolated; 0.1 by default"},
    {"motion.keep_around_gaps?", "flag", "", "leaves longer gaps out instead of refusing the file"},
    {"motion.cutoff_Hz?", "number", "Hz", "smoothing of the positions; none by default"},
    {"probe", "object", "", "where tip and sensor are"},
    {"probe.tip_P_m", "list of numbers", "m", "tip in the probe body's frame"},
    {"probe.tip_S_m", "list of numbers", "m", "tip in the sensor's frame"},
    {"probe.tip_radius_m?", "number", "m", "0 (default) is a point"},
    {"probe.q_PS?", "list of numbers", "1", "turns the sensor's frame into the probe body's; w first"},
    {"tool?", "object", "", "weight of what the sensor carries"},
    {"tool.file?", "text", "", "static orientations that it is fitted to"},
    {"tool.mass_kg?", "number", "kg", "or given: mass"},
    {"tool.center_S_m?", "list of numbers", "m", "centre of mass"},
    {"tool.bias_N?", "list of numbers", "N", "bias of the force"},
    {"tool.bias_Nm?", "list of numbers", "Nm", "bias of the torque"},
    {"tool.gravity_T_m_per_s2?", "list of numbers", "m/s2", "in the tracker's frame; (0, 0, -9.81) by default"},
    {"clocks?", "object", "", "how the two clocks are brought together"},
    {"clocks.offset_s?", "number", "s", "known offset"},
    {"clocks.tap_normal_W?", "list of numbers", "1", "or taps: direction away from the surface"},
    {"clocks.tap_threshold_N?", "number", "N", "force of a tap; 0: found from the noise"},
    {"clocks.longest_tap_s?", "number", "s", "longest tap"},
    {"registration?", "object", "", "from the tracker's frame to the object's"},
    {"registration.markers", "text", "", "pairs of points"},
    {"registration.mesh?", "text", "", "refines it by contacts"},
    {"registration.mesh_unit?", "text", "", "of the mesh; m by default"},
    {"registration.contact_force_N?", "number", "N", "force above which the tip touches; 0.2 by default"},
    {"registration.largest_marker_residual_m?", "number", "m", "0.002 by default"},
});

constexpr auto acquisition_report_fields = std::to_array<FormatField>({
    {"force_samples", "object", "", "of the force sensor"},
    {"force_samples.total", "whole number", "", "samples"},
    {"force_samples.saturated", "whole number", "", "at the end of the range"},
    {"force_samples.out_of_range", "whole number", "", "beyond the calibration"},
    {"free_air", "object", "", "what remains if nothing touches", &residual_part},
    {"force_bandwidth_Hz", "number or null", "Hz", "of the smoothed force"},
    {"motion_bandwidth_Hz", "number or null", "Hz", "of the positions"},
    {"force_noise_gain", "number or null", "1", "noise after smoothing over noise before"},
    {"samples_without_tracking", "whole number", "", "of the tracker"},
    {"notes", "list of texts", "", "what the reader must know"},
    {"inputs?", "list of objects", "", "every file that was read"},
    {"inputs[].file", "text", "", "name"},
    {"inputs[].sha256", "text", "", "hash of its contents"},
    {"tool?", "object", "", "weight of the tool"},
    {"tool.mass_kg", "number", "kg", "mass"},
    {"tool.mass_sigma_kg", "number or null", "kg", "standard error"},
    {"tool.center_S_m", "list of numbers", "m", "centre of mass in the sensor's frame"},
    {"tool.center_sigma_m", "list of numbers", "m", "standard errors"},
    {"tool.bias_N", "list of numbers", "N", "of the force"},
    {"tool.bias_Nm", "list of numbers", "Nm", "of the torque"},
    {"tool.condition", "number or null", "1", "condition number of the fit"},
    {"tool.fit", "object", "", "residual of the fitted orientations", &residual_part},
    {"tool.held_out", "object", "", "of orientations that the fit did not see", &residual_part},
    {"clocks?", "object", "", "the two clocks"},
    {"clocks.offset_s", "number or null", "s", "of the force's clock at reference_s"},
    {"clocks.offset_sigma_s", "number or null", "s", "standard error"},
    {"clocks.reference_s", "number or null", "s", "time for which the offset is stated"},
    {"clocks.skew_ppm", "number or null", "1e-6", "difference of the clocks' rates"},
    {"clocks.skew_sigma_ppm", "number or null", "1e-6", "standard error"},
    {"clocks.skew_fitted", "flag", "", "fitted, not assumed to be 0"},
    {"clocks.taps", "whole number", "", "taps that were used"},
    {"clocks.free_motion", "whole number or number", "s", "free motion that was used"},
    {"clocks.residual_rms_s", "number or null", "s", "RMS residual of the events"},
    {"clocks.interval95_s", "number or null", "s", "half of the interval of the offset"},
    {"clocks.events?", "list of objects", "", "that the clocks were fitted to"},
    {"clocks.events[].force_s", "number", "s", "on the force's clock"},
    {"clocks.events[].motion_s", "number", "s", "on the tracker's clock"},
    {"clocks.events[].sigma_s", "number or null", "s", "standard error"},
    {"clocks.events[].residual_s", "number or null", "s", "of the fit"},
    {"clocks.events[].kind", "text", "", "tap or free motion"},
    {"markers?", "object", "", "registration by markers"},
    {"markers.residual_rms_m", "number or null", "m", "RMS residual"},
    {"markers.residual_m", "list of numbers", "m", "of each marker"},
    {"markers.q", "list of numbers", "1", "turns the tracker's frame into the object's; w first"},
    {"markers.t_m", "list of numbers", "m", "its translation"},
    {"contacts?", "object", "", "registration by contacts"},
    {"contacts.rms_before_m", "number or null", "m", "distance of tip and surface before"},
    {"contacts.rms_after_m", "number or null", "m", "and after"},
    {"contacts.determined_directions", "whole number", "", "of six"},
    {"contacts.converged", "flag", "", "whether it ended"},
    {"contacts.correction_t_m", "list of numbers", "m", "translation that was added"},
    {"contacts.object_move_m", "number or null", "m", "between earlier and later contacts, root mean square"},
    {"contacts.unnoticed_move_m", "number or null", "m", "what such a move may be without being clear"},
    {"contacts.residual_map_m", "list of numbers", "m", "residual of each contact"},
    {"contacts.contact_W_m?", "list of lists of numbers", "m", "where each is"},
});

constexpr auto free_air_fields = std::to_array<FormatField>({
    {"static_force_component_rms_N", "number or null", "N", "residual of the static orientations"},
    {"static_held_out_component_rms_N", "number or null", "N", "of those that the fit did not see"},
    {"tool_mass_kg", "number", "kg", "fitted mass"},
    {"moving_force_vector_rms_N", "number or null", "N", "residual while it moves"},
    {"moving_force_component_rms_N", "number or null", "N", "of one component"},
    {"at_rest_force_vector_rms_N", "number or null", "N", "residual while it rests"},
    {"rest_fraction", "number or null", "1", "share of the time that it rests"},
    {"bias_shift_N", "list of numbers", "N", "change of the bias"},
    {"contacts", "list of objects", "", "times in which something was touched"},
    {"contacts[].from_s", "number", "s", "begin"},
    {"contacts[].to_s", "number", "s", "end"},
    {"contacts[].force_N", "number", "N", "largest"},
    {"bands", "list of objects", "", "the same with the force smoothed"},
    {"bands[].cutoff_Hz", "number", "Hz", "of the smoothing"},
    {"bands[].weight_removed_N", "number or null", "N", "RMS without the weight"},
    {"bands[].bias_removed_N", "number or null", "N", "and without the shift of the bias"},
    {"bands[].inertia_removed_N", "number or null", "N", "and without inertia"},
    {"bands[].fitted_mass_kg", "number or null", "kg", "mass that removes most"},
    {"bands[].fitted_offset_s", "number or null", "s", "offset of the clocks that removes most"},
    {"bands[].fitted_removed_N", "number or null", "N", "RMS with both"},
});

}  // namespace

std::span<const FileFormat> file_formats() {
  static const auto formats = std::to_array<FileFormat>({
      {"touchstone-acquisition/1", "acquisition.json",
       "raw streams, how the sensor sits in the probe, and what to do with them (docs/how-to/acquire.md). S: sensor, "
       "P: probe body, T: tracker, W: object",
       "", "`acquire`, `hil record --acquire`", acquisition_fields},
      {"touchstone-acquisition-report/1", "FILE of `acquire --json`", "what acquisition did and how well",
       "`acquire run`, `hil record`", "", acquisition_report_fields},
      {"touchstone-free-air/1", "FILE of `acquire free-air --json`",
       "how well the tool's weight is removed while the probe moves in free air", "`acquire free-air`", "",
       free_air_fields},
  });
  return formats;
}

}  // namespace touchstone::acquisition
