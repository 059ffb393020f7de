#include "harness/report/ctest_measurement.h"

#include <fmt/format.h>
#include <png.h>

#include <cmath>
#include <vector>

#include "harness/base/markup.h"

namespace touchstone::report {
namespace {

// On one line, and without control characters, of which XML 1.0 has hardly any.
std::string escaped(std::string_view text) {
  std::string plain(text);
  for (char& c : plain) c = static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  return escape_xml(plain);
}

}  // namespace

std::string measurement(std::string_view name, double value) {
  if (!std::isfinite(value)) return fmt::format("measurement {} is not sent: its value is {}\n", name, value);
  return fmt::format("<CTestMeasurement type=\"numeric/double\" name=\"{}\">{:.17g}</CTestMeasurement>", escaped(name),
                     value);
}

std::string measurement(std::string_view name, std::string_view text) {
  return fmt::format("<CTestMeasurement type=\"text/string\" name=\"{}\">{}</CTestMeasurement>", escaped(name),
                     escaped(text));
}

std::string picture_measurement(std::string_view name, const std::filesystem::path& png) {
  if (const auto problem = png_problem(png); !problem.empty())
    return fmt::format("picture {} is not sent: {}: {}\n", name, png.string(), problem);
  return fmt::format("<CTestMeasurementFile type=\"image/png\" name=\"{}\">{}</CTestMeasurementFile>", escaped(name),
                     escaped(png.string()));
}

std::string png_problem(const std::filesystem::path& png) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  std::string problem;
  if (png_image_begin_read_from_file(&image, png.c_str()) != 0) {
    image.format = PNG_FORMAT_GRAY;
    std::vector<png_byte> pixels(PNG_IMAGE_SIZE(image));
    png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr);
  }
  if (PNG_IMAGE_FAILED(image) || image.warning_or_error != 0) problem = static_cast<const char*>(image.message);
  png_image_free(&image);
  return problem;
}

}  // namespace touchstone::report
