// Measurements on a test's output, as ctest collects them and CDash shows them. Servers accept a NaN or a broken
// picture without a word, so both are checked here: of what is not fit to be shown a line of plain text says so. Print
// them whether the test passes or fails; those of skipped tests are dropped by ctest. No line break follows an element:
// ctest takes the element out of the output, and a break would stay behind as an empty line.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace touchstone::report {

// <CTestMeasurement type="numeric/double" name="...">value</CTestMeasurement>, of a finite value.
std::string measurement(std::string_view name, double value);
std::string measurement(std::string_view name, std::string_view text);
// <CTestMeasurementFile type="image/png" ...>, of a complete PNG. The names TestImage, ValidImage and DifferenceImage2
// make CDash's interactive comparison.
std::string picture_measurement(std::string_view name, const std::filesystem::path& png);

// Empty when the whole PNG can be decoded, else why not.
std::string png_problem(const std::filesystem::path& png);

}  // namespace touchstone::report
