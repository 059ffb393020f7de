#include "harness/diagnosis/file_formats.h"

#include <array>

namespace touchstone::diagnosis {
namespace {

constexpr auto named_reason_fields = std::to_array<FormatField>({
    {"name", "text", "", "of the fault"},
    {"reason", "text", "", "why"},
});
constexpr FormatPart named_reason{named_reason_fields};

constexpr auto scorecard_fields = std::to_array<FormatField>({
    {"engine", "object", "", "what was judged"},
    {"engine.name", "text", "", "renderer"},
    {"engine.summary", "text", "", "what it is"},
    {"engine.source", "text", "", "where it is published"},
    {"engine.library", "text", "", "of a plug-in; \"\" for this program's own"},
    {"engine.sha256", "text", "", "of that library"},
    {"engine.options", "text", "", "parameters and facts that were given"},
    {"engine.epsilon_m", "number", "m", "distance that the engine keeps from the surface"},
    {"engine.world_unit_m", "number", "m", "length of the engine's unit"},
    {"verdict", "text", "", "passed, failed, or skipped (cases were wanted and none ran)"},
    {"allowed", "list of texts", "", "faults and cases that are known to fail, and do not count"},
    {"fix_first", "text", "", "fault, or \"case NAME\"; \"\" if nothing was found"},
    {"findings", "list of objects", "",
     "faults: causes, in the order in which they are worth fixing, then what follows"},
    {"findings[].name", "text", "", "of the fault"},
    {"findings[].what", "text", "", "a sentence"},
    {"findings[].smallest_case", "text", "", "that shows it"},
    {"findings[].value", "number", "its \"unit\"", "size"},
    {"findings[].unit", "text", "", "of value"},
    {"findings[].follows_from", "text", "", "the finding that explains it; \"\" of a cause"},
    {"said", "list of objects", "", "what was seen and is no fault"},
    {"said[].name", "text", "", "of what was seen"},
    {"said[].what", "text", "", "a sentence"},
    {"clean", "list of texts", "", "faults that were looked for and not found"},
    {"declared", "list of objects", "", "limits that the engine declares", &named_reason},
    {"could_not_run", "list of objects", "", "detectors that did not run", &named_reason},
    {"felt_tolerance_jnd", "number", "1", "errors up to this are not felt"},
    {"cases", "list of objects", "", "golden cases"},
    {"cases[].name", "text", "", "of the case"},
    {"cases[].problem?", "text", "", "why there is no score; the other figures are not there then"},
    {"cases[].skipped?", "flag", "", "the problem is that the case is none for this engine"},
    {"cases[].shape?", "text", "", "of the object"},
    {"cases[].reference?", "text", "", "what the right force is from"},
    {"cases[].samples?", "whole number", "", "that were judged"},
    {"cases[].force_mean_N?", "number", "N", "mean error"},
    {"cases[].force_rms_N?", "number", "N", "RMS error"},
    {"cases[].force_max_N?", "number", "N", "largest error"},
    {"cases[].force_jump_N?", "number", "N", "largest jump between two samples"},
    {"cases[].right_max_N?", "number", "N", "largest right force"},
    {"cases[].force_max_jnd?", "number", "1", "largest error in just noticeable differences"},
    {"cases[].exact?", "flag", "", "within the golden's tolerance"},
    {"cases[].felt?", "flag", "", "within felt_tolerance_jnd"},
    {"passed", "object", "", "how many"},
    {"passed.cases", "whole number", "", "in all"},
    {"passed.skipped", "whole number", "", "not for this engine"},
    {"passed.exact", "whole number", "", "within the golden's tolerance"},
    {"passed.felt", "whole number", "", "that nobody would feel"},
    {"cost", "object or null", "", "of a step"},
    {"cost.triangles", "whole number", "", "of the object"},
    {"cost.steps", "whole number", "", "that were timed"},
    {"cost.median_us", "number", "us", "median of a step"},
    {"cost.p99_us", "number", "us", "99th percentile"},
    {"cost.p999_us", "number", "us", "99.9th percentile"},
    {"cost.build_ms", "number", "ms", "time to build its structures"},
});

}  // namespace

std::span<const FileFormat> file_formats() {
  static const auto formats = std::to_array<FileFormat>({
      {"touchstone-scorecard/1", "ENGINE.json of `scorecard`", "one engine's faults by name, golden cases and cost",
       "`scorecard`", "", scorecard_fields},
  });
  return formats;
}

}  // namespace touchstone::diagnosis
