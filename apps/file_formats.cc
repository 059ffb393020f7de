#include "apps/file_formats.h"

#include <algorithm>
#include <array>
#include <iterator>

#include "apps/extra_formats.h"
#include "harness/acquisition/file_formats.h"
#include "harness/baseline/file_formats.h"
#include "harness/bisection/file_formats.h"
#include "harness/diagnosis/file_formats.h"
#include "harness/discrepancy/file_formats.h"
#include "harness/perception/file_formats.h"
#include "harness/pipeline/evaluation/file_formats.h"
#include "harness/pipeline/fitting/file_formats.h"
#include "harness/pipeline/golden/file_formats.h"
#include "harness/pipeline/tool_fitting/file_formats.h"
#include "harness/pipeline/tool_reports/file_formats.h"
#include "harness/recording/file_formats.h"
#include "harness/rendering/file_formats.h"
#include "harness/report/file_formats.h"
#include "harness/report/history_formats.h"
#include "harness/runs/file_formats.h"
#include "harness/surface/file_formats.h"
#include "harness/tool/file_formats.h"
#include "hil/file_formats.h"
#include "synthetic/file_formats.h"

namespace touchstone::apps {
namespace {

constexpr auto formats_fields = std::to_array<FormatField>({
    {"formats", "list of objects", "", "one for each file"},
    {"formats[].schema", "text", "", "its name"},
    {"formats[].file", "text", "", "how the file is usually called"},
    {"formats[].summary", "text", "", "a phrase"},
    {"formats[].written_by?", "text", "", "commands"},
    {"formats[].read_by?", "text", "", "commands"},
    {"formats[].internal?", "flag", "", "may change with any version"},
    {"formats[].fields?", "list of objects", "", "its keys; of an internal one, none"},
    {"formats[].fields[].path", "text", "", "from the root, as in the tables here"},
    {"formats[].fields[].type", "text", "", "as in the tables here"},
    {"formats[].fields[].unit?", "text", "", "SI"},
    {"formats[].fields[].meaning", "text", "", "a phrase"},
    {"formats[].fields[].part?", "any", "",
     "such fields of the object, or of each object of the list; or \"provenance\""},
});

// Of the program's own tools: their readers stand beside their writers.
constexpr auto internal_formats = std::to_array<FileFormat>({
    {"touchstone-bench-compare/1", "FILE of compare_runs", "two runs of a benchmark", "`ci/bench`", "", {}, true},
    {"touchstone-bisection/1", "measured.jsonl", "what a bisection has measured", "`bisect`", "`bisect`", {}, true},
    {"touchstone-formats/1", "share/touchstone/formats/NAME.json", "the files that an extra reads and writes", "",
     "`formats`", formats_fields, true},
});

}  // namespace

std::vector<const FileFormat*> file_formats() {
  std::vector<const FileFormat*> all;
  for (const std::span<const FileFormat> of_room : {recording::file_formats(),
                                                    rendering::file_formats(),
                                                    report::file_formats(),
                                                    pipeline::evaluation_file_formats(),
                                                    discrepancy::file_formats(),
                                                    perception::file_formats(),
                                                    diagnosis::file_formats(),
                                                    baseline::file_formats(),
                                                    pipeline::golden_floor_file_formats(),
                                                    pipeline::fitting_file_formats(),
                                                    acquisition::file_formats(),
                                                    runs::file_formats(),
                                                    bisection::file_formats(),
                                                    report::history_file_formats(),
                                                    surface::file_formats(),
                                                    hil::file_formats(),
                                                    tool::file_formats(),
                                                    pipeline::tool_fitting_file_formats(),
                                                    pipeline::tool_report_file_formats(),
                                                    synthetic::file_formats(),
                                                    std::span<const FileFormat>(internal_formats)}) {
    for (const FileFormat& format : of_room) all.push_back(&format);
  }
  std::ranges::copy(extra_formats(), std::back_inserter(all));
  std::ranges::stable_sort(all, std::ranges::less{}, &FileFormat::internal);
  return all;
}

}  // namespace touchstone::apps
