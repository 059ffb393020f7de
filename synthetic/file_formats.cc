#include "synthetic/file_formats.h"

#include <array>

namespace touchstone::synthetic {
namespace {

constexpr auto generator_part_fields = std::to_array<FormatField>({
    {"name", "text", "", "as files spell it"},
    {"summary", "text", "", "a phrase"},
    {"parameters", "list of objects", "", "what may be set"},
    {"parameters[].name", "text", "", "as files spell it"},
    {"parameters[].unit", "text", "", "of its value"},
    {"parameters[].minimum", "number or null", "its \"unit\"", "least value allowed"},
    {"parameters[].maximum", "number or null", "its \"unit\"", "largest value allowed"},
    {"parameters[].default", "number", "its \"unit\"", "value if it is not set"},
    {"parameters[].meaning", "text", "", "a phrase"},
});
constexpr FormatPart generator_part{generator_part_fields};

constexpr auto synthetic_fields = std::to_array<FormatField>({
    {"datasets", "list of objects", "", "data sets"},
    {"datasets[].name", "text", "", "as `synth --dataset` takes it"},
    {"datasets[].object", "text", "", "what is touched"},
    {"datasets[].shows", "text", "", "what it is for"},
    {"surfaces", "list of objects", "", "surfaces", &generator_part},
    {"trajectories", "list of objects", "", "trajectories", &generator_part},
});

constexpr auto synth_mesh_fields = std::to_array<FormatField>({
    {"triangles", "whole number", "", "of the mesh"},
    {"vertices", "whole number", "", "of the mesh"},
    {"deviation_bound_m", "number", "m", "no point of the mesh is further from the surface"},
});

constexpr auto synth_trajectory_fields = std::to_array<FormatField>({
    {"samples", "whole number", "", "of the trajectory"},
    {"duration_s", "number", "s", "of the motion"},
});

constexpr auto tool_golden_fields = std::to_array<FormatField>({
    {"case", "text", "", "contact whose answer is known"},
    {"seconds", "number", "s", "of the path"},
    {"keep_every", "whole number", "", "every n-th sample of the path at 1 kHz is kept"},
    {"stiffness_N_per_m", "number", "N/m", "of the coupling"},
    {"rotational_stiffness_Nm_per_rad", "number", "Nm/rad", "of the coupling"},
    {"renderers", "list of texts", "", "that have a golden"},
    {"tolerance", "object", "", "how far an answer may be from it"},
    {"tolerance.force_N", "list of numbers", "N", "along x, y and z"},
    {"tolerance.torque_Nm", "list of numbers", "Nm", "about x, y and z"},
    {"tolerance.reason", "text", "", "why these"},
    {"accepted", "list of objects", "", "every acceptance"},
    {"accepted[].renderer", "text", "", "whose answer"},
    {"accepted[].reason", "text", "", "why it changed"},
    {"accepted[].commit", "text", "", "of the program that made it"},
});

}  // namespace

std::span<const FileFormat> file_formats() {
  static const auto formats = std::to_array<FileFormat>({
      {"touchstone-synthetic/1", "FILE of `synth --list --json`",
       "synthetic data sets, surfaces and trajectories with their parameters", "`synth --list`", "", synthetic_fields},
      {"synth-mesh", "FILE of `synth --surface --json`", "a mesh that was made; no key \"schema\"", "`synth`", "",
       synth_mesh_fields},
      {"synth-trajectory", "FILE of `synth --trajectory --json`", "a trajectory that was made; no key \"schema\"",
       "`synth`", "", synth_trajectory_fields},
      {"touchstone-tool-golden/1", "CASE.json",
       "goldens of renderers of tools with a shape; the accepted answers stand beside it", "`tool golden --accept`",
       "`tool golden`", tool_golden_fields},
  });
  return formats;
}

}  // namespace touchstone::synthetic
