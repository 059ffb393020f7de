#include "harness/pipeline/fitting/file_formats.h"

#include <array>

#include "harness/report/file_formats.h"

namespace touchstone::pipeline {
namespace {

constexpr auto fit_fields = std::to_array<FormatField>({
    {"title", "text", "", "heading of the report"},
    {"metric", "object", "", "what was minimised"},
    {"metric.name", "text", "", "a metric"},
    {"metric.unit", "text", "", "its unit"},
    {"parameters", "list of objects", "", "one for each"},
    {"parameters[].name", "text", "", "renderer's parameter, or EFFECT.PARAMETER"},
    {"parameters[].unit", "text", "", "its unit"},
    {"parameters[].initial", "number", "its \"unit\"", "value in the model that was given"},
    {"parameters[].value", "number or null", "its \"unit\"", "fitted value"},
    {"parameters[].bounds", "list of numbers", "its \"unit\"", "range of the search"},
    {"parameters[].interval95", "list of numbers or null", "its \"unit\"", "interval; null if the data give none"},
    {"parameters[].profile", "object", "", "the metric over this parameter"},
    {"parameters[].profile.value", "list of numbers", "its \"unit\"", "values of the parameter"},
    {"parameters[].profile.metric", "list of numbers", "metric's unit", "the metric there"},
    {"fit", "object", "", "on the time that was fitted"},
    {"fit.range", "text", "", "which time"},
    {"fit.samples", "whole number", "", "samples in it"},
    {"fit.before", "number or null", "metric's unit", "with the model as given"},
    {"fit.after", "number or null", "metric's unit", "with the fitted values"},
    {"score", "object", "", "on time that the fit did not see"},
    {"score.range", "text", "", "which time"},
    {"score.samples", "whole number", "", "samples in it"},
    {"score.before", "number or null", "metric's unit", "with the model as given"},
    {"score.after", "number or null", "metric's unit", "with the fitted values"},
    {"score.metrics", "list of objects", "", "every metric on that time", &report::metric_part},
    {"evaluations", "whole number", "", "evaluations of the metric"},
    {"interval_note", "text", "", "how the intervals were found"},
    {"warnings", "list of texts", "", "what the reader must know"},
    {"signals", "list of objects", "", "measured and predicted force", &report::series_part},
    {"model", "touchstone-model/1", "", "the fitted model"},
    {"provenance", "object", "", "where all this comes from", &report::provenance_part},
    {"repeat_floor?", "object", "", "what a repeated recording differs by"},
    {"repeat_floor.force_N", "number or null", "N", "RMS difference of the forces over the root of 2"},
    {"repeat_floor.position_m", "number or null", "m", "RMS difference of the positions over the root of 2"},
    {"repeat_floor.shift_s", "number or null", "s", "shift in time that was taken out"},
    {"repeat_floor.unshifted_N", "number or null", "N", "force_N without that"},
    {"repeat_floor.steadiest_N", "number or null", "N", "least RMS of a stretch"},
    {"repeat_floor.least_steady_N", "number or null", "N", "largest RMS of a stretch"},
    {"repeat_floor.repeat", "text", "", "the recording"},
});

}  // namespace

std::span<const FileFormat> fitting_file_formats() {
  static const auto formats = std::to_array<FileFormat>({
      {"touchstone-fit/1", "fit.json", "parameters that were fitted, with their intervals", "`fit`", "", fit_fields},
  });
  return formats;
}

}  // namespace touchstone::pipeline
