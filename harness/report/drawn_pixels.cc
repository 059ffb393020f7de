#include "harness/report/drawn_pixels.h"

#include <png.h>

#include <algorithm>
#include <cstdint>

namespace touchstone::report {
namespace {

struct DecodedPicture {
  std::size_t width = 0;
  std::size_t height = 0;
  std::vector<std::uint8_t> rgb;

  // Anti-aliased grey stays grey; a line's colour differs between its channels by far more.
  [[nodiscard]] bool coloured(std::size_t x, std::size_t y) const {
    constexpr int least_difference = 60;
    const std::uint8_t* const p = &rgb[3 * (y * width + x)];
    const auto [low, high] = std::minmax({p[0], p[1], p[2]});
    return high - low >= least_difference;
  }
};

DecodedPicture decode_picture(const std::filesystem::path& png) {
  DecodedPicture decoded;
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&image, png.c_str()) == 0) return decoded;
  image.format = PNG_FORMAT_RGB;
  decoded.rgb.resize(PNG_IMAGE_SIZE(image));
  const png_color white{255, 255, 255};
  if (png_image_finish_read(&image, &white, decoded.rgb.data(), 0, nullptr) != 0) {
    decoded.width = image.width;
    decoded.height = image.height;
  }
  png_image_free(&image);
  return decoded;
}

}  // namespace

std::vector<std::size_t> coloured_columns(const std::filesystem::path& png, std::size_t strips, std::size_t header) {
  const DecodedPicture picture = decode_picture(png);
  if (picture.height <= header || strips == 0) return {};
  std::vector<std::size_t> columns(strips, 0);
  const std::size_t height = (picture.height - header) / strips;
  for (std::size_t strip = 0; strip < strips; ++strip) {
    for (std::size_t x = 0; x < picture.width; ++x) {
      bool any = false;
      for (std::size_t y = 0; y < height && !any; ++y) any = picture.coloured(x, header + strip * height + y);
      columns[strip] += any ? 1 : 0;
    }
  }
  return columns;
}

std::size_t coloured_pixels(const std::filesystem::path& png) {
  const DecodedPicture picture = decode_picture(png);
  std::size_t count = 0;
  for (std::size_t y = 0; y < picture.height; ++y) {
    for (std::size_t x = 0; x < picture.width; ++x) count += picture.coloured(x, y) ? 1 : 0;
  }
  return count;
}

}  // namespace touchstone::report
