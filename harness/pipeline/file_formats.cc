#include "harness/pipeline/file_formats.h"

#include <array>

namespace touchstone::pipeline {
namespace {

constexpr auto scores_part_fields = std::to_array<FormatField>({
    {"rms_force_error_N", "number or null", "N", "RMS force error"},
    {"rms_force_error_jnd", "number or null", "1", "the same in just noticeable differences"},
    {"rms_position_error_m", "number or null", "m", "RMS position error"},
    {"mean_operations", "number or null", "1", "operations of a step"},
    {"max_operations", "number or null", "1", "of the most expensive step"},
});
constexpr FormatPart scores_part{scores_part_fields};

constexpr auto ranking_part_fields = std::to_array<FormatField>({
    {"order", "list of objects", "", "renderers, best score first"},
    {"order[].renderer", "text", "", "name"},
    {"order[].rank", "list of numbers", "", "best and worst rank that the data allow"},
    {"order[].score_N", "number or null", "N", "score: RMS force error; over data sets their geometric mean"},
    {"order[].interval95_N", "list of numbers", "N", "its interval"},
    {"groups", "list of lists of texts", "", "renderers that cannot be told apart, best first"},
    {"pairs", "list of objects", "", "every pair once"},
    {"pairs[].better", "text", "", "the one with the better score"},
    {"pairs[].other", "text", "", "the other one"},
    {"pairs[].error_ratio", "number or null", "1", "of their scores, at most 1"},
    {"pairs[].interval95", "list of numbers", "1", "interval of the ratio"},
    {"pairs[].t", "number or null", "1", "of the paired difference; 0 if it was not tested"},
    {"pairs[].degrees", "number or null", "1", "degrees of freedom of Student's distribution; 0: cannot be tested"},
    {"pairs[].p", "number or null", "1", "two-sided"},
    {"pairs[].level", "number or null", "1", "that p must not exceed (Holm)"},
    {"pairs[].told_apart", "flag", "", "p is at most level"},
    {"datasets_resampled", "flag", "", "intervals are over data sets drawn anew, and not over blocks of each"},
    {"block_bins", "list of numbers", "", "length of a block of each data set, in bins"},
    {"why_not", "text", "", "why nothing can be ranked; \"\" if it can"},
});
constexpr FormatPart ranking_part{ranking_part_fields};

constexpr auto leaderboard_fields = std::to_array<FormatField>({
    {"title", "text", "", "heading"},
    {"level", "number", "1", "of the tests of all pairs together"},
    {"draws", "whole number", "", "random draws of each interval"},
    {"seed", "whole number", "", "of the draws"},
    {"tasks", "list of objects", "", "one for each recording"},
    {"tasks[].name", "text", "", "data set and recording"},
    {"tasks[].about", "text", "", "what it shows"},
    {"tasks[].input", "text", "", "how the path was made"},
    {"tasks[].licence", "text", "", "of the data"},
    {"tasks[].measured", "text", "", "with what the forces were measured, or simulated"},
    {"tasks[].measured_rms_N", "number or null", "N", "RMS of the measured force"},
    {"tasks[].floor?", "object", "", "error that a perfect renderer would have"},
    {"tasks[].floor.rms_N", "number or null", "N", "RMS force error"},
    {"tasks[].floor.interval95_N", "list of numbers", "N", "its interval"},
    {"tasks[].floor.how", "text", "", "how it was found"},
    {"tasks[].repeat?", "object", "", "what a repeated recording differs by"},
    {"tasks[].repeat.rms_N", "number or null", "N", "RMS"},
    {"tasks[].repeat.how", "text", "", "which recording"},
    {"tasks[].entries", "list of objects", "", "one for each renderer"},
    {"tasks[].entries[].renderer", "text", "", "name"},
    {"tasks[].entries[].state", "text", "", "ran, does-not-enter or failed"},
    {"tasks[].entries[].why?", "text", "", "why it did not run"},
    {"tasks[].entries[].input_hash?", "text", "", "of the path that it got"},
    {"tasks[].entries[].scores?", "object", "", "its figures", &scores_part},
    {"tasks[].entries[].fitted?", "text", "", "parameters that were fitted, with their values"},
    {"tasks[].entries[].report?", "text", "", "its report, relative to the leaderboard"},
    {"tasks[].ranking?", "object", "", "of this recording; its groups are of renderers here", &ranking_part},
    {"overall?", "object", "", "over all recordings, if two or more renderers ran on each"},
    {"overall.renderers", "list of objects", "", "one for each"},
    {"overall.renderers[].renderer", "text", "", "name"},
    {"overall.renderers[].scores", "object", "", "over all recordings", &scores_part},
    {"overall.renderers[].pareto", "flag", "", "no other is better in error, felt error and operations at once"},
    {"overall.ranking", "object", "", "over all recordings", &ranking_part},
    {"overall.left_out", "list of texts", "", "renderers that did not run everywhere, with the reason"},
    {"overall.floor_N", "number or null", "N", "geometric mean of the floors"},
});

constexpr auto leaderboard_timings_fields = std::to_array<FormatField>({
    {"entries", "list of objects", "", "one for each entry that ran"},
    {"entries[].task", "text", "", "data set and recording"},
    {"entries[].renderer", "text", "", "name"},
    {"entries[].median_us", "number or null", "us", "median of a step"},
    {"entries[].p99_us", "number or null", "us", "99th percentile"},
    {"pareto_with_time?", "list of texts", "",
     "renderers that no other beats in error, felt error, operations and time at once"},
});

}  // namespace

std::span<const FileFormat> leaderboard_file_formats() {
  static const auto formats = std::to_array<FileFormat>({
      {"touchstone-leaderboard/1", "leaderboard.json",
       "renderers ranked over recordings, as far as the data can tell (docs/how-to/leaderboard.md)", "`leaderboard`",
       "`leaderboard --against`", leaderboard_fields},
      {"touchstone-leaderboard-timings/1", "timings.json",
       "what a step took; apart from the scores, since it differs in every run", "`leaderboard`", "",
       leaderboard_timings_fields},
  });
  return formats;
}

}  // namespace touchstone::pipeline
