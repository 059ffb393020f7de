#include "harness/tool/file_formats.h"

#include <array>

namespace touchstone::tool {
namespace {

constexpr auto tool_timing_fields = std::to_array<FormatField>({
    {"steps", "whole number", "", "steps that were timed"},
    {"median_us", "number", "us", "median of a step"},
    {"p99_us", "number", "us", "99th percentile"},
    {"p999_us", "number", "us", "99.9th percentile"},
    {"max_us", "number", "us", "largest"},
    {"memory_bytes", "whole number or null", "byte", "memory of the renderer; null: not known, as of every plug-in"},
});

constexpr auto tool_comparison_fields = std::to_array<FormatField>({
    {"samples", "whole number", "", "samples"},
    {"rms_force_error_N", "number or null", "N", "RMS"},
    {"rms_torque_error_Nm", "number or null", "Nm", "RMS"},
    {"max_force_error_N", "list of numbers", "N", "largest, along x, y and z"},
    {"max_torque_error_Nm", "list of numbers", "Nm", "largest, about x, y and z"},
    {"max_force_error_jnd", "number or null", "1", "in just noticeable differences"},
    {"max_torque_error_jnd", "number or null", "1", "in just noticeable differences"},
    {"max_proxy_translation_m?", "number", "m", "largest distance of the proxies"},
    {"max_proxy_rotation_rad?", "number", "rad", "largest angle between them"},
    {"max_proxy_translation_jnd?", "number", "1", "in just noticeable differences of force"},
    {"max_proxy_rotation_jnd?", "number", "1", "in just noticeable differences of torque"},
});

}  // namespace

std::span<const FileFormat> file_formats() {
  static const auto formats = std::to_array<FileFormat>({
      {"tool-timing", "T.json of `tool replay --timing`", "the cost of the steps alone; no key \"schema\"",
       "`tool replay`", "", tool_timing_fields},
      {"tool-comparison", "FILE of `tool compare --json`",
       "how force and torque of two recordings differ; no key \"schema\"", "`tool compare`", "",
       tool_comparison_fields},
  });
  return formats;
}

}  // namespace touchstone::tool
