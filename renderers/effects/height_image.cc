#include "renderers/effects/height_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <string>
#include <string_view>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/input_files.h"

namespace touchstone::renderers {
namespace {

// More pixels than any height map that a servo loop reads.
constexpr std::size_t most_pixels = std::size_t{1} << 28;
constexpr std::size_t most_grey = 65535;

class PgmReader {
 public:
  PgmReader(std::string_view text, std::string source) : rest_(text), source_(std::move(source)) {}

  HeightImage read() {
    const bool binary = rest_.starts_with("P5");
    if (!binary && !rest_.starts_with("P2"))
      fail("a greyscale picture in the PGM format was expected, which begins with P2 or P5");
    rest_.remove_prefix(2);
    HeightImage image;
    image.width = number("the width", most_pixels);
    image.height = number("the height", most_pixels);
    const std::size_t white = number("the value of white", most_grey);
    if (image.width == 0 || image.height == 0 || white == 0 || image.height > most_pixels / image.width)
      fail(fmt::format("{} x {} pixels with white {} are no picture", image.width, image.height, white));
    const std::size_t count = image.width * image.height;
    const std::size_t least = count * (binary && white > 255 ? 2 : 1);  // as text a digit at least
    if (binary && !rest_.empty()) rest_.remove_prefix(1);               // one white space ends the header
    if (rest_.size() < least)
      fail(fmt::format("it ends early: {} pixels need {} bytes at least, {} are there", count, least, rest_.size()));
    image.grey.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t value = !binary       ? number("a pixel", white)
                                : white > 255 ? 256 * byte(2 * i) + byte(2 * i + 1)
                                              : byte(i);
      if (value > white) fail(fmt::format("pixel {} is {}, above white, {}", i, value, white));
      image.grey.push_back(static_cast<float>(static_cast<double>(value) / static_cast<double>(white)));
    }
    return image;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw BadData(fmt::format("{}: {}", source_, what)); }
  [[nodiscard]] std::size_t byte(std::size_t i) const { return static_cast<unsigned char>(rest_[i]); }

  std::size_t number(const char* what, std::size_t most) {
    while (!rest_.empty() && (std::isspace(static_cast<unsigned char>(rest_.front())) != 0 || rest_.front() == '#')) {
      // A comment goes to the end of its line.
      rest_.remove_prefix(rest_.front() == '#' ? std::min(rest_.find('\n'), rest_.size()) : 1);
    }
    std::size_t value = 0;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    if (error != std::errc() || value > most)
      fail(fmt::format("{} is missing, or no whole number up to {}", what, most));
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return value;
  }

  std::string_view rest_;
  std::string source_;
};

class HeightImageEffect final : public rendering::Effect {
 public:
  HeightImageEffect(std::span<const double> values, HeightImage image)
      : amplitude_(values[0]), pixel_(values[1]), x_(values[2]), y_(values[3]), image_(std::move(image)) {}

  void reset() noexcept override {}

  void apply(rendering::ContactState& contact) noexcept override {
    // Far from the surface the heights cannot make a contact; the normal is unknown there.
    if (contact.n_W.isZero()) return;
    const double u = (contact.proxy_W_m.x() - x_) / pixel_;
    const double v = (contact.proxy_W_m.y() - y_) / pixel_;
    contact.depth_m += amplitude_ * (image_.at(u, v) - 0.5);
  }

 private:
  double amplitude_;
  double pixel_;
  double x_;
  double y_;
  HeightImage image_;
};

}  // namespace

double HeightImage::at(double u, double v) const noexcept {
  // In pixels' middles.
  const double across = u - 0.5;
  const double up = v - 0.5;
  const double column = std::floor(across);
  const double row = std::floor(up);
  const auto wrapped = [](double i, std::size_t size) {
    const double n = static_cast<double>(size);
    return static_cast<std::size_t>(i - n * std::floor(i / n));
  };
  const std::size_t left = wrapped(column, width);
  const std::size_t right = wrapped(column + 1.0, width);
  const std::size_t low = height - 1 - wrapped(row, height);
  const std::size_t high = height - 1 - wrapped(row + 1.0, height);
  const double x = across - column;
  const double y = up - row;
  const auto pixel = [&](std::size_t r, std::size_t c) { return static_cast<double>(grey[r * width + c]); };
  return (1.0 - y) * ((1.0 - x) * pixel(low, left) + x * pixel(low, right)) +
         y * ((1.0 - x) * pixel(high, left) + x * pixel(high, right));
}

HeightImage load_height_image(const std::filesystem::path& path) {
  note_input_file(path);
  const std::string text = read_file(path);
  return PgmReader(text, path.string()).read();
}

std::unique_ptr<rendering::Effect> make_height_image(std::span<const double> values, HeightImage image) {
  return std::make_unique<HeightImageEffect>(values, std::move(image));
}

}  // namespace touchstone::renderers
