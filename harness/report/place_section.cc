#include "harness/report/place_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace touchstone::report {
namespace {

namespace pc = perception;

constexpr double most_jnd = 3.0;  // of the colours

// The sides of the map's cells, turned so that each goes with the object's axis that it is nearest to.
struct MapAxes {
  std::array<Vec3, 2> axis;
  std::array<std::string, 2> label;
};

MapAxes axes_of(const pc::PlaceMap& map) {
  MapAxes axes;
  for (std::size_t a = 0; a < 2; ++a) {
    Eigen::Index nearest = 0;
    const double along = map.side[a].cwiseAbs().maxCoeff(&nearest);
    axes.axis[a] = map.side[a][nearest] < 0.0 ? Vec3(-map.side[a]) : map.side[a];
    axes.label[a] = fmt::format("{}{} [mm]", along < 0.99 ? "about " : "", "xyz"[nearest]);
  }
  return axes;
}

bool is_more(const pc::PlaceDifference& cell) { return cell.rendered_N > cell.real_N; }

std::string where(const Vec3& centre_m) {
  const Vec3 at_mm = (1e4 * centre_m).array().round() / 10.0 + 0.0;
  return fmt::format("({:.1f}, {:.1f}, {:.1f}) mm", at_mm.x(), at_mm.y(), at_mm.z());
}

std::string in_words(const pc::PlaceDifference& cell) {
  if (!cell.known) return fmt::format("{}: cannot tell, one of the two was hardly there", where(cell.centre_m));
  return fmt::format("{}: {:.3g} N instead of {:.3g} N, {:.1f} +- {:.1f} JND", where(cell.centre_m), cell.rendered_N,
                     cell.real_N, cell.jnd, std::hypot(cell.standard_error, cell.by_hand));
}

// One cell for each place of the map: the layers of depth of one motion lie behind each other, of which the strongest
// known is shown.
std::vector<const pc::PlaceDifference*> seen_from_above(const pc::PlaceMap& map, const MapAxes& axes) {
  std::map<std::array<long, 2>, const pc::PlaceDifference*> shown;
  for (const auto& cell : map.cells) {
    const auto key = [&](std::size_t a) { return std::lround(10.0 * cell.centre_m.dot(axes.axis[a]) / map.cell_m); };
    const pc::PlaceDifference*& front = shown[{key(0), key(1)}];
    if (front == nullptr || (cell.known && (!front->known || cell.jnd > front->jnd))) front = &cell;
  }
  std::vector<const pc::PlaceDifference*> cells;
  cells.reserve(shown.size());
  for (const auto& [key, cell] : shown) cells.push_back(cell);
  return cells;
}

CellMap map_of(const std::string& name, const pc::PlaceMap& places,
               const std::vector<const pc::PlaceDifference*>& cells, const MapAxes& axes) {
  CellMap map;
  map.title = fmt::format("{}: {}, seen along the direction of pressing", name, places.quantity);
  map.x_label = axes.label[0];
  map.y_label = axes.label[1];
  map.below = fmt::format("JND: {} than the real one", places.less);
  map.above = fmt::format("JND: {}", places.more);
  map.most = most_jnd;
  map.half_width = true;
  const double half_mm = 0.5e3 * places.cell_m;
  std::size_t unknown = 0;
  std::size_t noticed = 0;
  for (const auto* cell : cells) {
    CellMap::Cell drawn;
    const double x = 1e3 * cell->centre_m.dot(axes.axis[0]);
    const double y = 1e3 * cell->centre_m.dot(axes.axis[1]);
    drawn.corners = {{{x - half_mm, y - half_mm},
                      {x + half_mm, y - half_mm},
                      {x + half_mm, y + half_mm},
                      {x - half_mm, y + half_mm}}};
    if (cell->known) drawn.value = is_more(*cell) ? cell->jnd : -cell->jnd;
    drawn.text = in_words(*cell);
    map.cells.push_back(std::move(drawn));
    unknown += cell->known ? 0 : 1;
    noticed += cell->known && cell->jnd > 1.0 ? 1 : 0;
  }
  const pc::PlaceDifference* const strongest = places.strongest();
  map.summary = fmt::format("{} places of {:.2g} mm: {} differ by more than one JND, {} cannot be told. {}",
                            cells.size(), 1e3 * places.cell_m, noticed, unknown,
                            strongest == nullptr || noticed == 0 ? std::string("None is noticed for certain.")
                                                                 : pc::describe_place(places, *strongest) + ".");
  return map;
}

// Mean force of the places that lie behind each other, along the map's longer side.
LinePlot profile_of(const std::string& name, const pc::PlaceMap& places,
                    const std::vector<const pc::PlaceDifference*>& cells, const MapAxes& axes) {
  std::array<double, 2> length{};
  for (std::size_t a = 0; a < 2; ++a) {
    const auto along = [&](const auto* one, const auto* other) {
      return one->centre_m.dot(axes.axis[a]) < other->centre_m.dot(axes.axis[a]);
    };
    const auto [low, high] = std::minmax_element(cells.begin(), cells.end(), along);
    length[a] = ((*high)->centre_m - (*low)->centre_m).dot(axes.axis[a]);
  }
  const std::size_t longer = length[1] > length[0] ? 1 : 0;
  struct Sums {
    double real_N = 0.0;
    double rendered_N = 0.0;
    double places = 0.0;
  };
  std::map<long, Sums> columns;  // by place along the side [1/100 mm]
  for (const auto* cell : cells) {
    Sums& sums = columns[std::lround(1e5 * cell->centre_m.dot(axes.axis[longer]))];
    if (!cell->known) continue;
    sums.real_N += cell->real_N;
    sums.rendered_N += cell->rendered_N;
    sums.places += 1.0;
  }
  LinePlot plot;
  plot.title = fmt::format("{}: {}, mean over the other side", name, places.quantity);
  plot.x_label = axes.label[longer];
  plot.y_label = fmt::format("{} [N]", places.quantity);
  plot.half_width = true;
  plot.height_px = 300;
  Line real{"real", {}, {}, Tone::measured, false, true};
  Line rendered{name, {}, {}, Tone::rendered, true, true};
  for (const auto& [at, sums] : columns) {
    for (auto* line : {&real, &rendered}) line->x.push_back(1e-2 * static_cast<double>(at));
    real.y.push_back(sums.real_N / sums.places);  // NaN, a gap, where nothing is known
    rendered.y.push_back(sums.rendered_N / sums.places);
  }
  plot.lines = {std::move(real), std::move(rendered)};
  return plot;
}

Table figures_of(const std::string& name, const pc::PlaceMap& places,
                 const std::vector<const pc::PlaceDifference*>& cells) {
  Table table;
  table.caption = fmt::format("{}: {}", name, places.quantity);
  table.columns = {"place", "real [N]", "here [N]", "JND", "+-"};
  for (const auto* cell : cells) {
    Table::Row row;
    row.cells = {text_cell(where(cell->centre_m))};
    for (const double value :
         {cell->real_N, cell->rendered_N, cell->jnd, std::hypot(cell->standard_error, cell->by_hand)})
      row.cells.push_back(cell->known ? number_cell(value, 3) : number_cell("cannot tell"));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

std::vector<Section> place_sections(const pc::JudgedConditions& judged) {
  Section maps;
  maps.title = "Where it differs";
  maps.intro =
      "The force, and the friction, at each place against those of the real process there, in just noticeable "
      "differences. Hatched: one of the two recordings was hardly there, or slid one way only.";
  Section figures;
  figures.title = "Every place in figures";
  figures.folded = true;
  for (const auto& condition : judged.conditions) {
    for (const auto* places : {&condition.judgement.places.force, &condition.judgement.places.friction}) {
      const auto known = [](const auto& cell) { return cell.known; };
      const bool friction = places == &condition.judgement.places.friction;
      if (friction && std::none_of(places->cells.begin(), places->cells.end(), known)) continue;
      const MapAxes axes = axes_of(*places);
      const auto cells = seen_from_above(*places, axes);
      if (cells.size() < 2) continue;
      maps.blocks.emplace_back(map_of(condition.name, *places, cells, axes));
      maps.blocks.emplace_back(profile_of(condition.name, *places, cells, axes));
      figures.blocks.emplace_back(figures_of(condition.name, *places, cells));
    }
  }
  if (maps.blocks.empty()) return {};
  return {std::move(maps), std::move(figures)};
}

}  // namespace touchstone::report
