#include "harness/pipeline/golden/file_formats.h"

#include <array>

namespace touchstone::pipeline {
namespace {

constexpr auto golden_floor_fields = std::to_array<FormatField>({
    {"programs", "list of objects", "", "builds of Touchstone that were compared"},
    {"programs[].compiler", "text", "", "name and version"},
    {"programs[].flags", "text", "", "of the compiler"},
    {"programs[].cpu", "text", "", "processor"},
    {"programs[].version", "text", "", "of Touchstone"},
    {"programs[].commit", "text", "", "that it was built from"},
    {"floors", "list of objects", "", "one for each golden"},
    {"floors[].case", "text", "", "golden case"},
    {"floors[].model", "text", "", "its model"},
    {"floors[].force_max_N", "number", "N", "largest difference of the force"},
    {"floors[].contact_position_max_m", "number", "m", "largest difference of the surface contact point"},
    {"floors[].drift_rows", "whole number", "", "rows in which a bit differs"},
    {"floors[].rows", "whole number", "", "rows of the run"},
    {"floors[].of_tolerance", "number", "1", "largest share of the tolerance"},
    {"floors[].golden_sha256", "text", "", "of the golden"},
    {"floors[].tolerance_sha256", "text", "", "of the tolerance"},
    {"floors[].commit?", "text", "", "when it was measured"},
});

}  // namespace

std::span<const FileFormat> golden_floor_file_formats() {
  static const auto formats = std::to_array<FileFormat>({
      {"touchstone-golden-floor/1", "noise-floor.json",
       "how far goldens move if only compiler, flags or machine change", "`golden floor`", "`golden floor`",
       golden_floor_fields},
  });
  return formats;
}

}  // namespace touchstone::pipeline
