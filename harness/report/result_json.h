// result.json, schema "touchstone-result/1": everything that the HTML page shows, readable by a program. SI units.
// Metrics carry every digit; plotted series nine significant digits. A value that is not a number is null, and its
// status says why.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "harness/report/evaluation.h"

namespace touchstone::report {

std::string result_to_json(const EvaluationResult& result);
// Throws BadData naming `source` and the place for anything that is not such a file.
EvaluationResult parse_result(std::string_view text, std::string_view source);
EvaluationResult load_result(const std::filesystem::path& path);

}  // namespace touchstone::report
