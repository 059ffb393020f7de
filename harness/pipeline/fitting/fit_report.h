// What a fit leaves behind: model.json to go on with, fit.json (schema "touchstone-fit/1") for programs, report.html.
#pragma once

#include <filesystem>
#include <string>

#include "harness/pipeline/fitting/fit.h"

namespace touchstone::pipeline {

std::string fit_to_json(const FitResult& result);
std::string fit_table(const FitResult& result);
void write_fit(const FitResult& result, const std::filesystem::path& folder);

}  // namespace touchstone::pipeline
