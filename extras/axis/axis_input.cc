#include "axis_input.h"

#include <fmt/format.h>

#include <array>
#include <optional>

#include "harness/base/error.h"
#include "harness/recording/raw_table.h"
#include "harness/recording/recording_file.h"

namespace touchstone::axis {
using recording::Recording;

namespace {

struct AxisColumns {
  const char* place;
  const char* rate;
  const char* load;
  AxisWords words;
};

const std::array<AxisColumns, 2>& axis_columns() {
  static const std::array<AxisColumns, 2> known{
      AxisColumns{"q_rad", "qd_rad_per_s", "torque_Nm", {"angle", "rad", "torque", "N m"}},
      AxisColumns{"q_m", "qd_m_per_s", "force_N", {"place", "m", "force", "N"}}};
  return known;
}

const AxisWords indentation{"indentation", "m", "force", "N", true};

// A recording that presses along z: indentation grows downwards, the force pushes up.
AxisInput pressed_along_z(const std::string& path) {
  const Recording recording = recording::load_recording(path);
  AxisInput input{{recording.motion.t_s, {}, {}, {}, path, true}, indentation};
  for (std::size_t i = 0; i < recording.size(); ++i) {
    input.run.place.push_back(-recording.motion.p_W_m[i].z());
    input.run.load.push_back(recording.f_W_N[i].z());
  }
  return input;
}

}  // namespace

AxisInput load_axis(const std::string& path, bool flip_force) {
  const recording::RawTable table(path);
  std::optional<AxisInput> input;
  for (const AxisColumns& columns : axis_columns()) {
    if (!table.has(columns.place) || !table.has(columns.load)) continue;
    input =
        AxisInput{{table.times_s(), table.column(columns.place), {}, table.column(columns.load), path}, columns.words};
    if (table.has(columns.rate)) input->run.rate = table.column(columns.rate);
  }
  if (!input && (table.has("fz_N") || table.has("fz_mN"))) input = pressed_along_z(path);
  if (!input) {
    throw BadData(
        fmt::format("{}: the columns of an axis were expected: t_s with q_rad and torque_Nm (and "
                    "qd_rad_per_s), with q_m and force_N, or a recording that presses along z (x, y, z, fx, fy, "
                    "fz); `touchstone import` makes them",
                    path));
  }
  if (flip_force) {
    for (double& load : input->run.load) load = -load;
  }
  return *std::move(input);
}

Recording as_recording(const AxisRun& run) {
  Recording recording;
  recording.source = run.source;
  recording.motion.t_s = run.t_s;
  for (std::size_t i = 0; i < run.t_s.size(); ++i) {
    recording.motion.p_W_m.emplace_back(run.place[i], 0.0, 0.0);
    recording.f_W_N.emplace_back(run.load[i], 0.0, 0.0);
  }
  return recording;
}

}  // namespace touchstone::axis
