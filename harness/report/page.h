// A report as one HTML page that opens offline: sections of text, tables, plots and a 3-D view. Commands build a Page
// from their results; page_html.h writes it. Everything here is data: nothing in it is ever read as HTML or script.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "harness/base/vec.h"

namespace touchstone::report {

// Colours by role, the same in every plot of a report; chosen from Okabe and Ito's palette, which the colour-blind tell
// apart (Wong, Nature Methods 8, 2011). Line styles differ too.
enum class Tone : std::uint8_t { measured, rendered, error, reference, good, warning, neutral };

// A paragraph.
struct TextBlock {
  std::string text;
  Tone tone = Tone::neutral;  // warning: set apart as a message
};

struct Table {
  struct Cell {
    std::string text;
    bool number = false;  // set in figures that line up
    Tone tone = Tone::neutral;
  };
  struct Row {
    std::vector<Cell> cells;
    std::string detail;  // shown when the reader asks for it: what the row means
    // Zooms every plot of the link group `zoom_link` to this part of its x axis.
    std::optional<std::pair<double, double>> zoom;
  };
  std::string caption;
  std::vector<std::string> columns;
  std::vector<Row> rows;
  std::string zoom_link;
};
// Cells of words, and of a figure; a value that is not finite reads "none".
Table::Cell text_cell(std::string value);
Table::Cell number_cell(std::string value);
Table::Cell number_cell(double value, int digits = 4);

struct Line {
  std::string name;
  std::vector<double> x;
  std::vector<double> y;  // NaN: a gap
  Tone tone = Tone::neutral;
  bool dashed = false;
  bool markers = false;
};

struct LinePlot {
  std::string title;
  std::string x_label;  // with its unit: "time [s]"
  std::string y_label;
  std::vector<Line> lines;
  // Level lines across the plot, e.g. a threshold.
  std::vector<std::pair<std::string, double>> levels;
  // Shaded parts of the x axis, e.g. the time ranges of a fit, or an interval of uncertainty.
  std::vector<std::pair<double, double>> bands;
  std::string note;
  std::string link;  // plots of one link group zoom and pan together
  int height_px = 260;
  bool half_width = false;
  // Names instead of numbers at places of the x axis, e.g. of conditions.
  std::vector<std::pair<double, std::string>> x_names = {};
  // Logarithmic axes, of positive values; not together with bands or names.
  bool log_x = false;
  bool log_y = false;
};

struct BarPlot {
  std::string title;
  std::string x_label;
  std::string y_label;
  double first = 0.0;  // left end of the first bar
  double width = 1.0;
  std::vector<double> heights;
  bool log_y = false;
  std::string note;
  int height_px = 260;
  bool half_width = false;
};

// A triangulated object with a value at each vertex, and paths and marks on it.
struct Scene {
  struct Path {
    std::string name;
    std::vector<Vec3> points;
    Tone tone = Tone::measured;
  };
  struct Mark {
    Vec3 p;
    std::string label;
  };
  std::string title;
  std::string unit;  // of the coordinates
  std::vector<Vec3> vertices;
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<double> values;  // per vertex; NaN: nothing known there, drawn grey
  std::string value_label;     // with its unit
  std::vector<Path> paths;
  std::vector<Mark> marks;
  std::string note;
  int height_px = 620;
};

// A flat map of four-sided cells, each in the colour of its value: from one colour below zero over white to another
// above.
struct CellMap {
  struct Cell {
    std::array<std::array<double, 2>, 4> corners{};  // in turn
    std::optional<double> value;                     // nothing: not known there, hatched
    std::string text;                                // what the cell says in words
  };
  std::string title;
  std::string x_label;  // with its unit
  std::string y_label;
  std::string below;    // what a value below zero means
  std::string above;    // and one above
  double most = 1.0;    // of the colours; beyond they are the same
  std::string summary;  // the whole map in words, for those who do not see it
  std::vector<Cell> cells;
  bool half_width = false;
};

// Name and value pairs: provenance, settings.
struct Facts {
  std::vector<std::pair<std::string, std::string>> rows;
};

// Text kept as it is, e.g. a model file.
struct Code {
  std::string caption;
  std::string text;
};

using Block = std::variant<TextBlock, Table, LinePlot, BarPlot, Scene, CellMap, Facts, Code>;

struct Section {
  std::string title;
  std::string intro;
  std::vector<Block> blocks;
  bool folded = false;  // closed until the reader opens it
};

// The few numbers that a reader wants first.
struct Headline {
  std::string label;
  std::string value;
  std::string unit;
  std::string note;
  Tone tone = Tone::neutral;
};

struct Page {
  std::string title;
  std::string subtitle;
  std::vector<Headline> headlines;
  std::vector<Section> sections;
  std::string footer;
};

}  // namespace touchstone::report
