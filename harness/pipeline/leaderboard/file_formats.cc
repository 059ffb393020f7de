#include "harness/pipeline/leaderboard/file_formats.h"

#include <array>

#include "harness/report/file_formats.h"

namespace touchstone::pipeline {
namespace {

constexpr auto submission_fields = std::to_array<FormatField>({
    {"in_trajectory", "text", "", "of the options; \"\" if it was not chosen"},
    {"tip", "text", "", "point or dataset"},
    {"fit", "list of texts", "", "parameters that were fitted"},
    {"fit_range", "text", "", "time that they were fitted on"},
    {"score_range", "text", "", "time that was scored"},
    {"models", "list of objects", "", "models that were given"},
    {"models[].name", "text", "", "name of its file"},
    {"models[].model", "text", "", "its text"},
    {"specification", "text", "", "canonical text of what ran on which data, with the SHA-256 of every file"},
    {"plugins", "list of objects", "", "libraries that renderers came from"},
    {"plugins[].name", "text", "", "file"},
    {"plugins[].sha256", "text", "", "hash of its contents"},
    {"sources", "list of objects", "", "what the libraries were built from"},
    {"sources[].name", "text", "", "file"},
    {"sources[].sha256", "text", "", "hash of its contents"},
    {"provenance", "object", "", "who ran it, and with what", &report::provenance_part},
    {"entries", "list of objects", "", "what was scored"},
    {"entries[].task", "text", "", "data set and recording"},
    {"entries[].renderer", "text", "", "name"},
    {"entries[].state", "text", "", "ran, does-not-enter or failed"},
    {"entries[].input_hash?", "text", "", "of the path that it got"},
    {"entries[].rms_force_error_N?", "number or null", "N", "RMS force error"},
    {"entries[].rms_force_error_jnd?", "number or null", "1", "in just noticeable differences"},
    {"entries[].rms_position_error_m?", "number or null", "m", "RMS position error"},
    {"entries[].mean_operations?", "number or null", "1", "operations of a step"},
    {"entries[].max_operations?", "number or null", "1", "of the most expensive step"},
    {"sha256", "text", "", "of all the rest"},
});

}  // namespace

std::span<const FileFormat> submission_file_formats() {
  static const auto formats = std::to_array<FileFormat>({
      {"touchstone-submission/1", "BUNDLE of `leaderboard --bundle`",
       "what somebody claims that renderers score, so that anyone can check it by running it again",
       "`leaderboard --bundle`", "`leaderboard verify`", submission_fields},
  });
  return formats;
}

}  // namespace touchstone::pipeline
