// What `touchstone acquire` is told: which raw streams there are, how the sensor sits in the probe, and what to do.
// JSON, schema "touchstone-acquisition/1"; files are relative to the description's folder. Frames: S sensor, P the
// tracked probe body, T tracker, W object.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "contact_registration.h"
#include "harness/recording/tool_load.h"
#include "tap_alignment.h"

namespace touchstone::acquisition {
using recording::ToolLoad;

struct AcquisitionDescription {
  struct Interval {
    double from_s = 0.0, to_s = 0.0;
  };
  std::filesystem::path file;
  // Force: t_s with v1_V .. v6_V (gauges) or fx_N .. tz_Nm, in the sensor's frame.
  std::filesystem::path force_file;
  std::optional<std::filesystem::path> calibration_file;  // needed for voltages
  std::string serial;                                     // checked against the calibration's where given
  std::optional<Interval> bias;                           // on the force's clock: nothing touches the probe then
  // Motion of the probe body: t_s, x_m, y_m, z_m, qw, qx, qy, qz, optionally tracked (0 or 1); in the tracker's frame.
  std::filesystem::path motion_file;
  double largest_gap_s = 0.1;
  bool keep_around_gaps = false;  // leave out the time without tracking instead of refusing the file
  Vec3 tip_P_m = Vec3::Zero();
  Vec3 tip_S_m = Vec3::Zero();
  Quat q_PS = Quat::Identity();
  double tip_radius_m = 0.0;
  // Tool load: static orientations (fx_N .. tz_Nm and q) or given values; weightless and unbiased without either.
  std::optional<std::filesystem::path> tool_file;
  std::optional<ToolLoad> tool;
  std::optional<double> weighed_kg;  // the tool's mass by a balance, beside the file: it tells the sensor's scale
  Vec3 gravity_T_m_per_s2 = Vec3(0, 0, -9.81);  // in the tracker's frame
  // Clocks: by taps against a surface with this normal, or a known offset.
  bool align_taps = true;
  Vec3 tap_normal_W = Vec3::UnitZ();
  TapOptions taps;
  double known_offset_s = 0.0;
  // Registration: marker pairs (x_m, y_m, z_m of the tracker, and mx_m, my_m, mz_m of the object).
  std::optional<std::filesystem::path> markers_file;
  std::optional<std::filesystem::path> mesh_file;  // refines by contacts where given
  std::string mesh_unit = "m";
  double contact_force_N = 0.2;
  double largest_marker_residual_m = 2e-3;
  // Smoothing of the force when it is brought to the motion's samples.
  double force_cutoff_Hz = 25.0;
  double motion_cutoff_Hz = 0.0;  // 0: positions as measured
};

// The raw streams where the description does not name them, as when they were recorded a moment ago.
struct RawStreams {
  std::filesystem::path force, motion;
};

// Throws BadData naming the file and the place in it. With `streams`, the description's force and motion name no file.
AcquisitionDescription read_description(const std::filesystem::path& path,
                                        const std::optional<RawStreams>& streams = std::nullopt);

}  // namespace touchstone::acquisition
