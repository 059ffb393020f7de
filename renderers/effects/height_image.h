// Texture of a picture: its grey values are heights over the object's xy plane. The depth grows by
//   A (grey - 1/2),  grey from 0 (black) to 1 (white),
// at the place of the foot, the surface point under the tip, interpolated linearly between the middles of pixels along
// both axes (the corners' weights are the areas opposite); the picture repeats. Its first row is at the largest y, as
// pictures are shown. Normals stay those of the smooth surface, as for heights far below the size of a pixel.
// Sources: M. Minsky, "Computational haptics", PhD thesis, MIT 1995 (textures from pictures); C. Ho, C. Basdogan and
// M. Srinivasan, "Efficient point-based rendering techniques for haptic display of virtual objects", Presence 8, 1999,
// section 5 (height maps). Conservative to first order in the slope.
//
// Pictures are greyscale in the PGM format (netpbm: P2 or P5, 8 or 16 bits), which every program for pictures writes.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "harness/rendering/effect.h"

namespace touchstone::renderers {

struct HeightImage {
  std::size_t width = 0;
  std::size_t height = 0;
  std::vector<float> grey;  // 0 to 1, row after row from the top

  // At u pixels from the left and v from the bottom edge, repeated.
  [[nodiscard]] double at(double u, double v) const noexcept;
};

// Throws BadData with the file and what is wrong.
HeightImage load_height_image(const std::filesystem::path& path);

// Values: amplitude_m, pixel_m, x_m, y_m (of the picture's lower left corner). Needs gaps outside contact.
std::unique_ptr<rendering::Effect> make_height_image(std::span<const double> values, HeightImage image);

}  // namespace touchstone::renderers
