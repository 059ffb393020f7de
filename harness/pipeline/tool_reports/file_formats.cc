#include "harness/pipeline/tool_reports/file_formats.h"

#include <array>

namespace touchstone::pipeline {
namespace {

constexpr auto tool_scorecard_fields = std::to_array<FormatField>({
    {"renderer", "text", "", "name"},
    {"summary", "text", "", "what it is"},
    {"source", "text", "", "where it is published"},
    {"library", "text", "", "of a plug-in"},
    {"library_sha256", "text", "", "of a plug-in"},
    {"options", "text", "", "parameters that were given"},
    {"clean", "flag", "", "everything ran, every check passed"},
    {"checks", "list of objects", "", "one for each check"},
    {"checks[].name", "text", "", "of the check"},
    {"checks[].applies", "flag", "", "whether the renderer claims what it checks"},
    {"checks[].passed", "flag", "", "whether it holds"},
    {"checks[].measured", "number or null", "its \"unit\"", "figure"},
    {"checks[].limit", "number or null", "its \"unit\"", "allowed"},
    {"checks[].unit", "text", "", "of both"},
    {"checks[].fault", "text", "", "name of the fault; \"\" if it passed"},
    {"cases", "list of objects", "", "contacts whose answer is known"},
    {"cases[].name", "text", "", "of the contact"},
    {"cases[].mean_force_error_N", "number or null", "N", "mean error"},
    {"cases[].max_force_error_N", "number or null", "N", "largest error"},
    {"cases[].mean_torque_error_Nm", "number or null", "Nm", "mean error"},
    {"cases[].max_torque_error_Nm", "number or null", "Nm", "largest error"},
    {"cases[].max_torque_error_jnd", "number or null", "1", "in just noticeable differences"},
    {"cases[].largest_right_force_N", "number or null", "N", "of the exact answer"},
    {"cases[].largest_right_torque_Nm", "number or null", "Nm", "of the exact answer"},
    {"problems", "list of objects", "", "what did not run"},
    {"problems[].case", "text", "", "contact, or \"\" for the checks"},
    {"problems[].what", "text", "", "why"},
    {"cost?", "object", "", "of a step"},
    {"cost.tool_triangles", "whole number", "", "of the tool"},
    {"cost.object_triangles", "whole number", "", "of the object"},
    {"cost.steps", "whole number", "", "steps that were timed"},
    {"cost.contacts", "number", "", "contacts in the mean"},
    {"cost.median_us", "number", "us", "median of a step"},
    {"cost.p99_us", "number", "us", "99th percentile"},
    {"cost.p999_us", "number", "us", "99.9th percentile"},
    {"cost.build_ms", "number", "ms", "time to build its structures"},
    {"cost.memory_bytes", "whole number or null", "byte", "memory; null: not known, as of every plug-in"},
});

}  // namespace

std::span<const FileFormat> tool_report_file_formats() {
  static const auto formats = std::to_array<FileFormat>({
      {"touchstone-tool-scorecard/1", "NAME.json of `tool scorecard`",
       "checks, exact cases and cost of a renderer of tools with a shape", "`tool scorecard`", "",
       tool_scorecard_fields},
  });
  return formats;
}

}  // namespace touchstone::pipeline
