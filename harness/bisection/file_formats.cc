#include "harness/bisection/file_formats.h"

#include <array>

namespace touchstone::bisection {
namespace {

constexpr auto bisection_answer_fields = std::to_array<FormatField>({
    {"metric", "text", "", "what was measured"},
    {"good", "object", "", "first commit"},
    {"good.commit", "text", "", "its hash"},
    {"good.value", "number", "", "metric there"},
    {"bad", "object", "", "last commit"},
    {"bad.commit", "text", "", "its hash"},
    {"bad.value", "number", "", "metric there"},
    {"noise", "number or null", "", "standard deviation of a measurement"},
    {"ends_differ", "flag", "", "by more than noise"},
    {"smallest_change_searched", "number or null", "", "changes below this were not searched for"},
    {"culprits", "list of objects", "", "steps that were found"},
    {"culprits[].commit", "text or null", "", "its hash; null if several come into question"},
    {"culprits[].candidates", "list of texts", "", "all that come into question"},
    {"culprits[].title", "text", "", "subject of the commit"},
    {"culprits[].change", "number", "", "of the metric"},
    {"culprits[].standard_error", "number or null", "", "of the change"},
    {"culprits[].share", "number or null", "1", "of the whole change"},
    {"culprits[].confidence", "number or null", "1", "probability that it is this one"},
    {"culprits[].sure", "flag", "", "confidence suffices"},
    {"culprits[].merge?", "text", "", "merge that brought it"},
    {"culprits[].by_merging", "flag", "", "the change is the merge's own"},
    {"drifts", "list of objects", "", "changes that are spread over many commits"},
    {"drifts[].first", "text", "", "begin"},
    {"drifts[].last", "text", "", "end"},
    {"drifts[].commits", "whole number", "", "between the two"},
    {"drifts[].change", "number", "", "of the metric"},
    {"drifts[].share", "number or null", "1", "of the whole change"},
    {"not_located_share", "number or null", "1", "of the whole change; null if the ends do not differ"},
    {"builds", "whole number", "", "that were made"},
    {"broken", "whole number", "", "commits that could not be built or run"},
    {"measured", "list of objects", "", "every commit that was measured"},
    {"measured[].commit", "text", "", "its hash"},
    {"measured[].value", "number", "", "mean of its runs"},
    {"measured[].runs", "whole number", "", "how many"},
});

}  // namespace

std::span<const FileFormat> file_formats() {
  static const auto formats = std::to_array<FileFormat>({
      {"touchstone-bisection-answer/1", "answer.json", "which commits changed a metric (docs/how-to/bisect.md)",
       "`bisect`", "", bisection_answer_fields},
  });
  return formats;
}

}  // namespace touchstone::bisection
