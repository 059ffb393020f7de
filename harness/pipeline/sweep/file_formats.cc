#include "harness/pipeline/sweep/file_formats.h"

#include <array>

namespace touchstone::pipeline {
namespace {

constexpr auto vary_part_fields = std::to_array<FormatField>({
    {"set", "text", "",
     "JSON pointer into a case: /surface/..., /trajectory/..., /model/..., /scale, /speed; of tools /renderer/..., "
     "/contacts/..."},
    {"values?", "list of numbers", "", "values to take"},
    {"from?", "number", "", "or a range: its least value"},
    {"to?", "number", "", "its largest value"},
    {"count?", "whole number", "", "of a grid: how many values"},
    {"spacing?", "text", "", "linear (default) or log"},
});
constexpr FormatPart vary_part{vary_part_fields};

constexpr auto sweep_fields = std::to_array<FormatField>({
    {"design", "text", "", "grid, latin-hypercube or list"},
    {"surfaces", "object", "", "at least one"},
    {"surfaces.*", "object", "", "a surface, by its name in the results"},
    {"surfaces.*.name?", "text", "", "synthetic surface"},
    {"surfaces.*.parameters?", "object", "", "of the synthetic surface"},
    {"surfaces.*.parameters.*", "number", "as its name says", "value"},
    {"surfaces.*.triangles?", "whole number", "", "of its mesh"},
    {"surfaces.*.mesh?", "text", "", "or a mesh, relative to this file"},
    {"surfaces.*.unit?", "text", "", "of that mesh"},
    {"trajectories", "object", "", "at least one"},
    {"trajectories.*", "object", "", "a trajectory, by its name in the results"},
    {"trajectories.*.name?", "text", "", "synthetic trajectory"},
    {"trajectories.*.parameters?", "object", "", "of the synthetic trajectory"},
    {"trajectories.*.parameters.*", "number", "as its name says", "value"},
    {"trajectories.*.seed?", "whole number", "", "of its random numbers"},
    {"trajectories.*.rate_Hz?", "number", "Hz", "samples per second; 1000 by default"},
    {"trajectories.*.offset_m?", "list of numbers", "m", "added to its positions"},
    {"trajectories.*.file?", "text", "", "or a recorded path, relative to this file"},
    {"models", "object", "", "at least one"},
    {"models.*", "touchstone-model/1", "", "a model, by its name in the results"},
    {"vary?", "list of objects", "", "numbers that vary", &vary_part},
    {"seeds?", "list of numbers", "", "seeds of the trajectories"},
    {"truth?", "flag", "", "also compute the exact answer"},
    {"cases?", "list of objects or whole number", "", "of a list: the cases; of latin-hypercube: how many"},
    {"cases[].surface?", "text", "", "name; need not be said if there is one"},
    {"cases[].trajectory?", "text", "", "name"},
    {"cases[].model?", "text", "", "name"},
    {"cases[].seed?", "whole number", "", "of the trajectory"},
    {"cases[].set?", "object", "", "values by JSON pointer"},
    {"cases[].set.*", "number", "", "value"},
    {"design_seed?", "whole number", "", "of latin-hypercube; 1 by default"},
});

constexpr auto tool_sweep_fields = std::to_array<FormatField>({
    {"design", "text", "", "grid, latin-hypercube or list"},
    {"contacts", "object", "", "at least one"},
    {"contacts.*", "object", "", "a contact, by its name in the results"},
    {"contacts.*.case", "text", "", "`touchstone tool list`"},
    {"contacts.*.scale?", "number", "1", "multiplies every length; 1 by default"},
    {"contacts.*.clearance_m?", "number", "m", "of a peg"},
    {"renderers", "object", "", "at least one"},
    {"renderers.*", "object", "", "a renderer, by its name in the results"},
    {"renderers.*.renderer", "text", "", "`touchstone tool list`"},
    {"renderers.*.parameters?", "object", "", "of the renderer"},
    {"renderers.*.parameters.*", "number", "as its name says", "value"},
    {"renderers.*.stiffness_N_per_m?", "number", "N/m", "of the coupling"},
    {"renderers.*.rotational_stiffness_Nm_per_rad?", "number", "Nm/rad", "of the coupling"},
    {"vary?", "list of objects", "", "numbers that vary", &vary_part},
    {"cases?", "list of objects or whole number", "", "of a list: the cases; of latin-hypercube: how many"},
    {"cases[].contacts?", "text", "", "name; need not be said if there is one"},
    {"cases[].renderer?", "text", "", "name"},
    {"cases[].set?", "object", "", "values by JSON pointer"},
    {"cases[].set.*", "number", "", "value"},
    {"design_seed?", "whole number", "", "of latin-hypercube; 1 by default"},
});

}  // namespace

std::span<const FileFormat> sweep_file_formats() {
  static const auto formats = std::to_array<FileFormat>({
      {"touchstone-sweep/1", "sweep.json", "which synthetic cases a sweep runs (docs/how-to/many-cases.md)", "",
       "`sweep`", sweep_fields},
      {"touchstone-tool-sweep/1", "sweep.json", "the same of tools with a shape: contacts whose answer is known", "",
       "`sweep`", tool_sweep_fields},
  });
  return formats;
}

}  // namespace touchstone::pipeline
