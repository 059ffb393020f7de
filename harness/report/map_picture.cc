#include "harness/report/map_picture.h"

#include <fmt/format.h>

#include <algorithm>

namespace touchstone::report {
namespace {

constexpr int cell_side = 22;
constexpr int picture_left = 130;
constexpr int picture_top = 44;

void add_text(std::string& svg, int x, int y, const std::string& what, const char* extra = "") {
  svg += fmt::format("<text x=\"{}\" y=\"{}\" {}>{}</text>\n", x, y, extra, what);
}

void add_map(std::string& svg, const PictureCells& map, int x, int y) {
  const std::size_t rows = map.up.size();
  for (std::size_t k = 0; k < rows; ++k) {
    const int cell_y = y + static_cast<int>(rows - 1 - k) * cell_side;
    add_text(svg, x - 4, cell_y + 15, map.up[k], "text-anchor=\"end\" font-size=\"8\"");
    for (std::size_t s = 0; s < map.across.size(); ++s) {
      const PictureCell& cell = map.cells[k][s];
      const int cell_x = x + static_cast<int>(s) * cell_side;
      svg += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\" stroke=\"white\"/>\n", cell_x,
                         cell_y, cell_side, cell_side, cell.colour);
      if (!cell.text.empty()) add_text(svg, cell_x + cell_side / 2, cell_y + 15, cell.text, "text-anchor=\"middle\"");
    }
  }
  for (std::size_t s = 0; s < map.across.size(); ++s) {
    add_text(svg, x + static_cast<int>(s) * cell_side + cell_side / 2, y + static_cast<int>(rows) * cell_side + 11,
             map.across[s], "text-anchor=\"middle\" font-size=\"8\"");
  }
}

}  // namespace

std::string map_picture_svg(const MapPicture& picture) {
  std::size_t most_across = 0, most_up = 0;
  for (const auto& row : picture.maps) {
    for (const PictureCells& map : row) {
      most_across = std::max(most_across, map.across.size());
      most_up = std::max(most_up, map.up.size());
    }
  }
  const int map_width = static_cast<int>(most_across) * cell_side + 46;
  const int map_height = static_cast<int>(most_up) * cell_side + 34;
  const int width = picture_left + map_width * static_cast<int>(picture.columns.size());
  const int height = picture_top + map_height * static_cast<int>(picture.rows.size()) + 34;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"sans-serif\" font-size=\"10\"><rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
      width, height);
  add_text(svg, 8, 18, picture.title, "font-size=\"14\"");
  for (std::size_t m = 0; m < picture.columns.size(); ++m)
    add_text(svg, picture_left + static_cast<int>(m) * map_width, 36, picture.columns[m], "font-weight=\"bold\"");
  for (std::size_t r = 0; r < picture.rows.size(); ++r) {
    const int y = picture_top + static_cast<int>(r) * map_height;
    add_text(svg, 8, y + map_height / 2, picture.rows[r], "font-weight=\"bold\" font-size=\"12\"");
    for (std::size_t m = 0; m < picture.columns.size(); ++m)
      add_map(svg, picture.maps[r][m], picture_left + static_cast<int>(m) * map_width, y);
  }
  add_text(svg, 8, height - 12, picture.legend);
  return svg + "</svg>\n";
}

}  // namespace touchstone::report
