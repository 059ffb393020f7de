#include "harness/surface/file_formats.h"

#include <array>

namespace touchstone::surface {
namespace {

constexpr auto mesh_diagnosis_fields = std::to_array<FormatField>({
    {"mesh", "text", "", "file"},
    {"sound", "flag", "", "nothing that matters to rendering was found"},
    {"triangles", "whole number", "", "of the mesh"},
    {"vertices", "whole number", "", "of the mesh"},
    {"components", "whole number", "", "connected parts"},
    {"open_edges", "whole number", "", "edges of one triangle"},
    {"boundary_loops", "whole number", "", "holes"},
    {"bounds_m", "list of lists of numbers", "m", "least and largest corner"},
    {"area_m2", "number", "m2", "of all triangles"},
    {"volume_m3", "number", "m3", "enclosed; of an open mesh without meaning"},
    {"self_intersection_checked", "flag", "", "needs a build with CGAL"},
    {"findings", "list of objects", "", "faults"},
    {"findings[].name", "text", "", "of the fault"},
    {"findings[].severity", "text", "", "matters or note"},
    {"findings[].count", "whole number", "", "how often"},
    {"findings[].what", "text", "", "a sentence"},
    {"findings[].meaning", "text", "", "what it does to rendering"},
    {"findings[].places", "list of objects", "", "the first of them"},
    {"findings[].places[].triangles", "list of numbers", "", "indices from 0"},
    {"findings[].places[].vertices", "list of numbers", "", "indices from 0"},
    {"findings[].places[].p_m", "list of numbers", "m", "where"},
});

}  // namespace

std::span<const FileFormat> file_formats() {
  static const auto formats = std::to_array<FileFormat>({
      {"touchstone-mesh-diagnosis/1", "FILE of `doctor --json`", "faults of a mesh", "`doctor`", "",
       mesh_diagnosis_fields},
  });
  return formats;
}

}  // namespace touchstone::surface
