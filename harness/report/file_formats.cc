#include "harness/report/file_formats.h"

#include <array>

namespace touchstone::report {
namespace {

constexpr auto series_part_fields = std::to_array<FormatField>({
    {"name", "text", "", "what was sampled"},
    {"unit", "text", "", "of \"value\""},
    {"t_s", "list of numbers", "s", "times"},
    {"value", "list of numbers", "its \"unit\"",
     "values; of a thinned series each pair of neighbours is the least and the largest of a stretch"},
    {"samples", "whole number", "", "samples before thinning"},
    {"samples_per_pair", "whole number", "", "samples that each pair stands for; 1 if none was left out"},
});

constexpr auto histogram_part_fields = std::to_array<FormatField>({
    {"unit", "text", "", "of \"width\""},
    {"width", "number or null", "its \"unit\"", "width of a bin; the first begins at 0"},
    {"counts", "list of numbers", "", "samples in each bin"},
});
constexpr FormatPart histogram_part{histogram_part_fields};

constexpr auto metric_part_fields = std::to_array<FormatField>({
    {"name", "text", "", "as `touchstone list metrics` has it"},
    {"unit", "text", "", "of \"value\""},
    {"value", "number or null", "its \"unit\"", "null if status is not ok"},
    {"status", "text", "", "ok, missing or invalid"},
    {"meaning", "text", "", "what it measures"},
    {"note", "text", "", "what to know about this value; \"\" if nothing"},
    {"reference?", "number or null", "its \"unit\"", "a value to hold it against"},
    {"reference_meaning?", "text", "", "what the reference is"},
    {"t_s?", "number or null", "s", "when the value was reached"},
    {"series?", "object", "", "the metric over time", &series_part},
    {"histogram?", "object", "", "how its samples are distributed", &histogram_part},
});

constexpr auto build_part_fields = std::to_array<FormatField>({
    {"version", "text", "", "of Touchstone"},
    {"commit", "text", "", "that the program was built from"},
    {"dirty", "flag", "", "built from a changed checkout"},
    {"compiler", "text", "", "name and version"},
    {"build_type", "text", "", "of CMake"},
    {"flags", "text", "", "of the compiler"},
});
constexpr FormatPart build_part{build_part_fields};

constexpr auto provenance_part_fields = std::to_array<FormatField>({
    {"command", "text", "", "command line"},
    {"created_utc", "text", "", "time, ISO 8601"},
    {"inputs", "list of objects", "", "every file that was read"},
    {"inputs[].role", "text", "", "recording, mesh, model, ..."},
    {"inputs[].name", "text", "", "file"},
    {"inputs[].sha256", "text", "", "hash of its contents"},
    {"inputs[].bytes", "whole number", "byte", "size"},
    {"build", "object", "", "the program", &build_part},
});

constexpr auto input_part_fields = std::to_array<FormatField>({
    {"in_trajectory", "text", "", "how the path was made: synthesize, whole-force or measured"},
    {"stiffness_N_per_m", "number or null", "N/m", "with which it was made"},
    {"tip_radius_m", "number or null", "m", "0 is a point"},
    {"contact_threshold_N", "number or null", "N", "force above which the recording is in contact"},
    {"hash", "text", "", "of the path itself: equal hashes, equal inputs"},
});

constexpr auto result_fields = std::to_array<FormatField>({
    {"title", "text", "", "heading of the report"},
    {"renderer", "text", "", "name"},
    {"model", "text", "", "text of the model file"},
    {"input", "object", "", "the path that the renderer got", &input_part},
    {"settings", "list of objects", "", "options of the evaluation"},
    {"settings[].name", "text", "", "which"},
    {"settings[].value", "text", "", "its value"},
    {"messages", "list of texts", "", "what the reader must know"},
    {"metrics", "list of objects", "", "every metric", &metric_part},
    {"signals", "list of objects", "", "measured and rendered signals", &series_part},
    {"force_threshold_N", "number or null", "N", "error above which an episode begins"},
    {"position_threshold_m", "number or null", "m", "error above which an episode begins"},
    {"episodes", "list of objects", "", "stretches of time in which an error exceeds its threshold"},
    {"episodes[].of", "text", "", "which error"},
    {"episodes[].unit", "text", "", "of \"worst\""},
    {"episodes[].start_s", "number", "s", "begin"},
    {"episodes[].end_s", "number", "s", "end"},
    {"episodes[].worst", "number", "its \"unit\"", "largest error"},
    {"episodes[].worst_t_s", "number", "s", "when it was reached"},
    {"episodes[].worst_W_m", "list of numbers", "m", "where, in the object's frame"},
    {"episodes[].samples", "whole number", "", "samples of the episode"},
    {"episodes[].signals", "list of objects", "", "signals around it", &series_part},
    {"object", "object", "", "the mesh as it is drawn, with the error at each vertex"},
    {"object.vertices_W_m", "list of lists of numbers", "m", "vertices, in the object's frame"},
    {"object.triangles", "list of lists of numbers", "", "three indices of vertices each"},
    {"object.error", "list of numbers", "\"error_unit\"", "error at each vertex; null if nothing touched there"},
    {"object.error_name", "text", "", "which error"},
    {"object.error_unit", "text", "", "its unit"},
    {"object.noticed_share?", "list of numbers", "1", "share of moments at each vertex that a person would notice"},
    {"object.note", "text", "", "how the error was brought to vertices"},
    {"path_W_m", "list of lists of numbers", "m", "path of the tip, thinned, in the object's frame"},
    {"provenance", "object", "", "where all this comes from", &provenance_part},
});

constexpr auto list_kind_fields = std::to_array<FormatField>({
    {"*", "list of objects", "", "a kind: commands, renderers, effects, instrument, metrics, surfaces, trajectories"},
    {"*[].name", "text", "", "as files spell it"},
    {"*[].summary", "text", "", "a phrase, with the source"},
    {"*[].parameters?", "list of objects", "", "what may be set"},
    {"*[].parameters[].name", "text", "", "as files spell it"},
    {"*[].parameters[].unit", "text", "", "of its value"},
    {"*[].parameters[].default", "number", "its \"unit\"", "value if it is not set"},
    {"*[].parameters[].meaning", "text", "", "a phrase"},
});

}  // namespace

const FormatPart series_part{series_part_fields};
const FormatPart metric_part{metric_part_fields};
const FormatPart provenance_part{provenance_part_fields};
const FormatPart input_part{input_part_fields};

std::span<const FileFormat> file_formats() {
  static const auto formats = std::to_array<FileFormat>({
      {"touchstone-result/1", "result.json", "one evaluation: everything that its report.html shows", "`evaluate`",
       "`evaluate`, Python", result_fields},
      {"touchstone-list/1", "catalogue.json", "what models, sweeps and `synth` may name; a list for each kind",
       "`list --json`", "", list_kind_fields},
  });
  return formats;
}

}  // namespace touchstone::report
