#include "harness/recording/file_formats.h"

#include <array>

namespace touchstone::recording {
namespace {

constexpr auto recording_fields = std::to_array<FormatField>({
    {"t", "column", "s, ms or us", "time, ascending"},
    {"x", "column", "m, cm, mm, um or km", "position of the tip; of its centre if it is a ball"},
    {"y", "column", "m, cm, mm, um or km", "as x"},
    {"z", "column", "m, cm, mm, um or km", "as x"},
    {"qw?", "column", "", "orientation, a quaternion that turns the sensor's frame into the object's"},
    {"qx?", "column", "", "as qw"},
    {"qy?", "column", "", "as qw"},
    {"qz?", "column", "", "as qw"},
    {"fx?", "column", "N, mN or kN", "force; trajectories have none"},
    {"fy?", "column", "N, mN or kN", "as fx"},
    {"fz?", "column", "N, mN or kN", "as fx"},
    {"tx?", "column", "Nm, Nmm or mNm", "torque about the tip"},
    {"ty?", "column", "Nm, Nmm or mNm", "as tx"},
    {"tz?", "column", "Nm, Nmm or mNm", "as tx"},
    {"px?", "column", "m, cm, mm, um or km", "surface contact point, of rendered files"},
    {"py?", "column", "m, cm, mm, um or km", "as px"},
    {"pz?", "column", "m, cm, mm, um or km", "as px"},
    {"contact?", "column", "", "0 or 1, of rendered files"},
    {"cost?", "column", "us", "time of the step, of rendered files"},
});

constexpr auto dataset_fields = std::to_array<FormatField>({
    {"object", "text", "", "what was touched"},
    {"mesh", "object", "", "of the object"},
    {"mesh.file", "text", "", "in the folder"},
    {"mesh.unit", "text", "", "m, cm, mm, um or km"},
    {"tip_radius_m", "number", "m", "0 is a point"},
    {"instrument", "text", "", "sensor and tracker, in words"},
    {"instrument_file?", "text", "", "what their makers declare (touchstone-instrument/1)"},
    {"stiffness_N_per_m", "number", "N/m", "with which paths are made"},
    {"friction_coefficient?", "number", "1", "of tip and object, if it is known"},
    {"in_trajectory", "text", "", "synthesize, whole-force or measured"},
    {"recordings", "list of objects", "", "at least one"},
    {"recordings[].file", "text", "", "in the folder"},
    {"recordings[].shows", "text", "", "what"},
    {"recordings[].exact?", "text", "", "file with the exact answer"},
    {"recordings[].repeat?", "text", "", "another recording of the same motion"},
    {"source", "text", "", "who measured or made it, and how"},
    {"licence", "text", "", "of the data"},
    {"sha256?", "object", "", "hash of every file; `dataset` writes them"},
    {"sha256.*", "text", "", "of the file of that name"},
});

}  // namespace

std::span<const FileFormat> file_formats() {
  static const auto formats = std::to_array<FileFormat>({
      {"touchstone-recording/1", "R.csv, R.csv.gz or R.h5",
       "a recording, a trajectory or what was rendered. In CSV the first row names the columns; in HDF5 each column is "
       "a dataset of the root group, and the attribute \"schema\" is this name. Force is ON the probe BY the object; "
       "all is in the object's frame",
       "`acquire`, `convert`, `evaluate`, `hil`, `import`, `replay`, `synth`",
       "every command with a recording or a trajectory", recording_fields},
      {"touchstone-dataset/1", "dataset.json", "a folder with an object's mesh, what the probe was, and recordings",
       "`dataset`, `synth --dataset`", "`dataset`, `evaluate`, `fit`, `discrepancy`, `leaderboard`", dataset_fields},
  });
  return formats;
}

}  // namespace touchstone::recording
