#include "harness/report/page_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "harness/report/json_numbers.h"

namespace touchstone::report {
namespace {

using nlohmann::json;

const char* name_of(Tone tone) {
  switch (tone) {
    case Tone::measured:
      return "measured";
    case Tone::rendered:
      return "rendered";
    case Tone::error:
      return "error";
    case Tone::reference:
      return "reference";
    case Tone::good:
      return "good";
    case Tone::warning:
      return "warning";
    case Tone::neutral:
      return "neutral";
  }
  return "neutral";
}

json flat(const std::vector<Vec3>& points) {
  json out = json::array();
  for (const Vec3& p : points) {
    for (int i = 0; i < 3; ++i) out.push_back(plotted_number(p[i]));
  }
  return out;
}

json to_json(const TextBlock& block) { return {{"kind", "text"}, {"text", block.text}, {"tone", name_of(block.tone)}}; }

json to_json(const Table& table) {
  json rows = json::array();
  for (const Table::Row& row : table.rows) {
    json cells = json::array();
    for (const Table::Cell& cell : row.cells) {
      cells.push_back({{"text", cell.text}, {"number", cell.number}, {"tone", name_of(cell.tone)}});
    }
    json one{{"cells", std::move(cells)}, {"detail", row.detail}};
    if (row.zoom) one["zoom"] = {row.zoom->first, row.zoom->second};
    rows.push_back(std::move(one));
  }
  return {{"kind", "table"},
          {"caption", table.caption},
          {"columns", table.columns},
          {"rows", std::move(rows)},
          {"zoom_link", table.zoom_link}};
}

json to_json(const LinePlot& plot) {
  json lines = json::array();
  for (const Line& line : plot.lines) {
    lines.push_back({{"name", line.name},
                     {"x", plotted_numbers(line.x)},
                     {"y", plotted_numbers(line.y)},
                     {"tone", name_of(line.tone)},
                     {"dashed", line.dashed},
                     {"markers", line.markers}});
  }
  json levels = json::array();
  for (const auto& [label, value] : plot.levels) levels.push_back({{"label", label}, {"value", plotted_number(value)}});
  json bands = json::array();
  for (const auto& [from, to] : plot.bands) bands.push_back({plotted_number(from), plotted_number(to)});
  json x_names = json::array();
  for (const auto& [at, name] : plot.x_names) x_names.push_back({{"at", plotted_number(at)}, {"name", name}});
  return {{"kind", "lines"},           {"title", plot.title},
          {"x_label", plot.x_label},   {"y_label", plot.y_label},
          {"lines", std::move(lines)}, {"levels", std::move(levels)},
          {"bands", std::move(bands)}, {"x_names", std::move(x_names)},
          {"log_x", plot.log_x},       {"log_y", plot.log_y},
          {"note", plot.note},         {"link", plot.link},
          {"height", plot.height_px},  {"half", plot.half_width}};
}

json to_json(const BarPlot& plot) {
  return {{"kind", "bars"},
          {"title", plot.title},
          {"x_label", plot.x_label},
          {"y_label", plot.y_label},
          {"first", plot.first},
          {"width", plot.width},
          {"heights", plotted_numbers(plot.heights)},
          {"log_y", plot.log_y},
          {"note", plot.note},
          {"height", plot.height_px},
          {"half", plot.half_width}};
}

json to_json(const Scene& scene) {
  json triangles = json::array();
  for (const auto& triangle : scene.triangles) {
    for (const std::int32_t index : triangle) triangles.push_back(index);
  }
  json paths = json::array();
  for (const Scene::Path& path : scene.paths) {
    paths.push_back({{"name", path.name}, {"points", flat(path.points)}, {"tone", name_of(path.tone)}});
  }
  json marks = json::array();
  for (const Scene::Mark& mark : scene.marks) marks.push_back({{"p", flat({mark.p})}, {"label", mark.label}});
  return {{"kind", "scene"},
          {"title", scene.title},
          {"unit", scene.unit},
          {"vertices", flat(scene.vertices)},
          {"triangles", std::move(triangles)},
          {"values", plotted_numbers(scene.values)},
          {"value_label", scene.value_label},
          {"paths", std::move(paths)},
          {"marks", std::move(marks)},
          {"note", scene.note},
          {"height", scene.height_px}};
}

json to_json(const CellMap& map) {
  json cells = json::array();
  for (const CellMap::Cell& cell : map.cells) {
    json corners = json::array();
    for (const auto& [x, y] : cell.corners) corners.push_back({plotted_number(x), plotted_number(y)});
    cells.push_back({{"corners", std::move(corners)},
                     {"value", cell.value ? plotted_number(*cell.value) : json()},
                     {"text", cell.text}});
  }
  return {{"kind", "cells"},        {"title", map.title},       {"x_label", map.x_label}, {"y_label", map.y_label},
          {"below", map.below},     {"above", map.above},       {"most", map.most},       {"summary", map.summary},
          {"half", map.half_width}, {"cells", std::move(cells)}};
}

json to_json(const Facts& facts) {
  json rows = json::array();
  for (const auto& [label, value] : facts.rows) rows.push_back({label, value});
  return {{"kind", "facts"}, {"rows", std::move(rows)}};
}

json to_json(const Code& code) { return {{"kind", "code"}, {"caption", code.caption}, {"text", code.text}}; }

}  // namespace

std::string page_to_json(const Page& page) {
  json headlines = json::array();
  for (const Headline& one : page.headlines) {
    headlines.push_back({{"label", one.label},
                         {"value", one.value},
                         {"unit", one.unit},
                         {"note", one.note},
                         {"tone", name_of(one.tone)}});
  }
  json sections = json::array();
  for (const Section& section : page.sections) {
    json blocks = json::array();
    for (const Block& block : section.blocks) {
      blocks.push_back(std::visit([](const auto& one) { return to_json(one); }, block));
    }
    sections.push_back({{"title", section.title},
                        {"intro", section.intro},
                        {"blocks", std::move(blocks)},
                        {"folded", section.folded}});
  }
  const json document{{"title", page.title},
                      {"subtitle", page.subtitle},
                      {"headlines", std::move(headlines)},
                      {"sections", std::move(sections)},
                      {"footer", page.footer}};
  // Names from input files may hold any bytes: what is not UTF-8 is replaced, never refused.
  return document.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace touchstone::report
