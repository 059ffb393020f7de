// Maps of coloured cells in rows and columns, as an SVG picture: what the atlases draw.
#pragma once

#include <string>
#include <vector>

namespace touchstone::report {

struct PictureCell {
  std::string text;    // in the cell; may be empty
  std::string colour;  // "#RRGGBB"
};

struct PictureCells {
  std::vector<std::string> across, up;          // names of the columns of cells, and of their rows from below
  std::vector<std::vector<PictureCell>> cells;  // [up][across]
};

struct MapPicture {
  std::string title;
  std::vector<std::string> columns, rows;       // names of the maps
  std::vector<std::vector<PictureCells>> maps;  // [row][column]
  std::string legend;
};

std::string map_picture_svg(const MapPicture& picture);

}  // namespace touchstone::report
