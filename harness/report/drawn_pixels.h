// What is drawn in a picture, counted: a plot whose lines are missing still has its frame, grid and legend, and looks
// like a picture to every check of the file alone.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

namespace touchstone::report {

// The picture cut into `strips` of equal height, from the top after `header` pixels: in how many of its columns each
// has a pixel in a colour. Lines are drawn in colours; frame, grid and text are grey. Empty when it cannot be decoded.
std::vector<std::size_t> coloured_columns(const std::filesystem::path& png, std::size_t strips, std::size_t header = 0);

// How many of its pixels are in a colour.
std::size_t coloured_pixels(const std::filesystem::path& png);

}  // namespace touchstone::report
