// The files of a texture model, as the toolkit's own reader takes them (autoGenHashMatrix.h there): the line spectral
// frequencies count, the coefficients beside them do not.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <pugixml.hpp>
#include <sstream>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "line_spectrum.h"
#include "texture_model.h"

namespace touchstone::texture {
namespace {

constexpr std::size_t most_nodes = 10000;
constexpr double most_rate_Hz = 1e6;

class Reader {
 public:
  Reader(const std::string& xml, std::string source) : xml_(xml), source_(std::move(source)) {
    const pugi::xml_parse_result parsed = document_.load_buffer(xml.data(), xml.size());
    if (!parsed)
      throw BadData(fmt::format("{}: line {}: no XML: {}", source_, line(parsed.offset), parsed.description()));
    root_ = document_.child("modelSet");
    if (!root_)
      throw BadData(
          fmt::format("{}: no model of a texture: the element modelSet was expected, as in the files Models_*.xml of "
                      "the Penn Haptic Texture Toolkit",
                      source_));
  }

  TextureModel read() {
    check_unit("AccelUnits", "m/s^2");
    check_unit("SpeedUnits", "mm/s");
    check_unit("ForceUnits", "N");
    TextureModel model;
    model.material = root_.child_value("material");
    model.rate_Hz = number(child(root_, "SampleRate"), 1.0, most_rate_Hz);
    model.mu = number(child(root_, "mu"), 0.0, 100.0);
    model.largest_speed_m_per_s = number(child(root_, "maxSpeed"), 1e-6, 1e9) / 1000.0;
    model.largest_force_N = number(child(root_, "maxForce"), 1e-9, 1e9);
    const std::size_t ar_count = count("numARCoeff", 1, most_coefficients);
    const std::size_t ma_count = count("numMACoeff", 0, most_coefficients);
    for (const pugi::xml_node& node : root_.children("model"))
      model.nodes.push_back(read_node(node, ar_count, ma_count));
    check_count("model", model.nodes.size(), "numMod", count("numMod", 3, most_nodes));
    for (const pugi::xml_node& node : root_.children("tri")) model.triangles.push_back(read_triangle(node, model));
    check_count("tri", model.triangles.size(), "numTri", count("numTri", 1, 2 * most_nodes));
    check_covered(model);
    return model;
  }

 private:
  [[nodiscard]] std::size_t line(std::ptrdiff_t offset) const {
    const auto end = xml_.begin() + std::clamp<std::ptrdiff_t>(offset, 0, static_cast<std::ptrdiff_t>(xml_.size()));
    return 1 + static_cast<std::size_t>(std::count(xml_.begin(), end, '\n'));
  }
  [[noreturn]] void fail(const pugi::xml_node& node, const std::string& what) const {
    throw BadData(fmt::format("{}: line {}: <{}>: {}", source_, line(node.offset_debug()), node.name(), what));
  }
  [[nodiscard]] pugi::xml_node child(const pugi::xml_node& parent, const char* name) const {
    const pugi::xml_node found = parent.child(name);
    if (!found) fail(parent, fmt::format("has no <{}>, which was expected in it", name));
    return found;
  }
  [[nodiscard]] double number(const pugi::xml_node& node, double least, double most) const {
    std::istringstream text(node.child_value());
    text.imbue(std::locale::classic());
    double value = 0.0;
    std::string rest;
    if (!(text >> value) || text >> rest || !(value >= least && value <= most)) {
      fail(node,
           fmt::format("'{}' is no number from {:g} to {:g}, which was expected", node.child_value(), least, most));
    }
    return value;
  }
  [[nodiscard]] std::size_t count(const char* name, std::size_t least, std::size_t most) const {
    const pugi::xml_node node = child(root_, name);
    const double value = number(node, static_cast<double>(least), static_cast<double>(most));
    if (value != std::floor(value)) fail(node, fmt::format("{:g} is no whole number", value));
    return static_cast<std::size_t>(value);
  }
  void check_count(const char* name, std::size_t found, const char* declared_by, std::size_t declared) const {
    if (found != declared)
      fail(child(root_, declared_by), fmt::format("says {}, but there are {} elements <{}>", declared, found, name));
  }
  void check_unit(const char* name, const char* unit) const {
    const pugi::xml_node node = child(root_, name);
    if (std::string(node.child_value()) != unit)
      fail(node,
           fmt::format("'{}' is another unit than {}, the toolkit's; convert the file", node.child_value(), unit));
  }

  [[nodiscard]] std::vector<double> angles(const pugi::xml_node& model, const char* name, std::size_t wanted) const {
    const pugi::xml_node list = child(model, name);
    std::vector<double> result;
    for (const pugi::xml_node& value : list.children("value")) {
      result.push_back(number(value, 0.0, std::numbers::pi));
      const double before = result.size() > 1 ? result[result.size() - 2] : 0.0;
      if (!(result.back() > before) || result.back() == std::numbers::pi)
        fail(value, fmt::format("{:g}: line spectral frequencies ascend between 0 and pi; else the filter is unstable",
                                result.back()));
    }
    if (result.size() != wanted) fail(list, fmt::format("has {} values, {} were expected", result.size(), wanted));
    return result;
  }
  [[nodiscard]] TextureNode read_node(const pugi::xml_node& model, std::size_t ar_count, std::size_t ma_count) const {
    TextureNode node;
    node.speed_m_per_s = number(child(model, "speedMod"), 0.0, 1e9) / 1000.0;
    node.force_N = number(child(model, "forceMod"), 0.0, 1e9);
    node.variance = number(child(model, "var"), 0.0, 1e12);
    node.ar_rad = angles(model, "ARlsf", ar_count);
    if (ma_count > 0) {
      node.ma_rad = angles(model, "MAlsf", ma_count);
      node.gain = number(child(model, "gain"), 0.0, 1e12);
    }
    return node;
  }
  [[nodiscard]] std::array<std::size_t, 3> read_triangle(const pugi::xml_node& node, const TextureModel& model) const {
    std::array<std::size_t, 3> triangle{};
    std::size_t corners = 0;
    for (const pugi::xml_node& value : node.children("value")) {
      const double corner = number(value, 1.0, static_cast<double>(model.nodes.size()));
      if (corner != std::floor(corner)) fail(value, fmt::format("{:g} is no number of a <model>", corner));
      if (corners < 3) triangle[corners] = static_cast<std::size_t>(corner) - 1;
      ++corners;
    }
    if (corners != 3) fail(node, fmt::format("has {} corners, 3 were expected", corners));
    const auto& [a, b, c] = triangle;
    const auto& nodes = model.nodes;
    const double area = (nodes[b].speed_m_per_s - nodes[a].speed_m_per_s) * (nodes[c].force_N - nodes[a].force_N) -
                        (nodes[b].force_N - nodes[a].force_N) * (nodes[c].speed_m_per_s - nodes[a].speed_m_per_s);
    if (area == 0.0) fail(node, "its corners lie on one line of speed and force");
    return triangle;
  }
  // The triangles fill the rectangle up to the largest speed and force; else no filter is known in the gaps.
  void check_covered(const TextureModel& model) const {
    constexpr double gap = 1e-3;  // of the rectangle
    double area = 0.0;
    for (const auto& [a, b, c] : model.triangles) {
      const auto& n = model.nodes;
      area += 0.5 * std::abs((n[b].speed_m_per_s - n[a].speed_m_per_s) * (n[c].force_N - n[a].force_N) -
                             (n[b].force_N - n[a].force_N) * (n[c].speed_m_per_s - n[a].speed_m_per_s));
    }
    const double whole = model.largest_speed_m_per_s * model.largest_force_N;
    if (!(std::abs(area / whole - 1.0) <= gap)) {
      fail(root_,
           fmt::format("the triangles cover {:.4g} % of the speeds up to <maxSpeed> and forces up to <maxForce>; "
                       "100 % were expected",
                       100.0 * area / whole));
    }
  }

  const std::string& xml_;
  std::string source_;
  pugi::xml_document document_;
  pugi::xml_node root_;
};

void add(pugi::xml_node& parent, const char* name, const std::string& text) {
  parent.append_child(name).text().set(text.c_str());
}

pugi::xml_node add_list(pugi::xml_node& parent, const char* name, const std::vector<double>& values) {
  pugi::xml_node list = parent.append_child(name);
  for (const double value : values) add(list, "value", fmt::format("{:.12g}", value));
  return list;
}

void add_filter(pugi::xml_node& parent, const char* coefficients, const char* frequencies,
                const std::vector<double>& angles_rad) {
  std::vector<double> polynomial(angles_rad.size() + 1);
  polynomial_of(angles_rad, polynomial);
  add_list(parent, coefficients, polynomial);
  add_list(parent, frequencies, angles_rad);
}

}  // namespace

TextureModel parse_texture_model(const std::string& xml, const std::string& source) {
  return Reader(xml, source).read();
}

TextureModel read_texture_model(const std::filesystem::path& file) {
  return parse_texture_model(read_file(file), file.string());
}

std::string texture_model_to_xml(const TextureModel& model) {
  pugi::xml_document document;
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "utf-8";
  pugi::xml_node root = document.append_child("modelSet");
  root.append_attribute("texture") = "1";
  const auto number = [&root](const char* name, double value) { add(root, name, fmt::format("{:.12g}", value)); };
  add(root, "material", model.material);
  add(root, "AccelUnits", "m/s^2");
  add(root, "SpeedUnits", "mm/s");
  add(root, "ForceUnits", "N");
  number("SampleRate", model.rate_Hz);
  number("mu", model.mu);
  number("numMod", static_cast<double>(model.nodes.size()));
  number("numTri", static_cast<double>(model.triangles.size()));
  number("maxSpeed", 1000.0 * model.largest_speed_m_per_s);
  number("maxForce", model.largest_force_N);
  std::vector<double> speeds_mm_per_s, forces_N;
  for (const TextureNode& node : model.nodes) {
    speeds_mm_per_s.push_back(1000.0 * node.speed_m_per_s);
    forces_N.push_back(node.force_N);
  }
  add_list(root, "speedList", speeds_mm_per_s).append_attribute("type") = "array";
  add_list(root, "forceList", forces_N).append_attribute("type") = "array";
  for (const auto& [a, b, c] : model.triangles) {
    add_list(root, "tri", {static_cast<double>(a + 1), static_cast<double>(b + 1), static_cast<double>(c + 1)})
        .append_attribute("type") = "array";
  }
  number("numARCoeff", static_cast<double>(model.nodes.front().ar_rad.size()));
  number("numMACoeff", static_cast<double>(model.nodes.front().ma_rad.size()));
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    const TextureNode& node = model.nodes[i];
    pugi::xml_node element = root.append_child("model");
    add(element, "modNum", fmt::format("{}", i + 1));
    add_filter(element, "ARcoeff", "ARlsf", node.ar_rad);
    if (!node.ma_rad.empty()) add_filter(element, "MAcoeff", "MAlsf", node.ma_rad);
    add(element, "var", fmt::format("{:.12g}", node.variance));
    if (!node.ma_rad.empty()) add(element, "gain", fmt::format("{:.12g}", node.gain));
    add(element, "speedMod", fmt::format("{:.12g}", speeds_mm_per_s[i]));
    add(element, "forceMod", fmt::format("{:.12g}", forces_N[i]));
  }
  std::ostringstream text;
  document.save(text, "   ");
  return text.str();
}

}  // namespace touchstone::texture
