#include "harness/pipeline/evaluation/file_formats.h"

#include <array>

#include "harness/report/file_formats.h"

namespace touchstone::pipeline {
namespace {

constexpr auto evaluations_fields = std::to_array<FormatField>({
    {"evaluations", "list of objects", "", "one for each renderer and recording"},
    {"evaluations[].group", "text", "", "recording"},
    {"evaluations[].name", "text", "", "renderer or model"},
    {"evaluations[].folder", "text", "", "of its report"},
    {"evaluations[].metrics", "list of objects", "", "every metric; empty if it did not run", &report::metric_part},
    {"evaluations[].failure?", "text", "", "why it failed"},
    {"evaluations[].does_not_enter?", "text", "", "why the renderer cannot run on this recording"},
    {"evaluations[].input?", "object", "", "the path that it got", &report::input_part},
});

}  // namespace

std::span<const FileFormat> evaluation_file_formats() {
  static const auto formats = std::to_array<FileFormat>({
      {"touchstone-evaluations/1", "FILE of `evaluate --json`", "the metrics of every evaluation of a run",
       "`evaluate --json`", "", evaluations_fields},
  });
  return formats;
}

}  // namespace touchstone::pipeline
