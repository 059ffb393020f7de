#include "harness/report/gnuplot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/other_program.h"
#include "harness/report/ctest_measurement.h"
#include "harness/report/drawn_pixels.h"

namespace touchstone::report {
namespace {

// Inside gnuplot's single quotes only the quote itself needs care; a line's end would end the command.
std::string quoted(const std::string& text) {
  std::string safe = "'";
  for (const char c : text) safe += c == '\'' ? std::string("''") : c == '\n' ? std::string(" ") : std::string(1, c);
  return safe + "'";
}

constexpr std::size_t picture_width = 1000;
constexpr std::size_t title_height = 60;

std::string script_of(const Plot& plot, const std::filesystem::path& png) {
  constexpr std::size_t panel_height = 260;
  const auto height = panel_height * plot.panels.size() + title_height;
  std::string script = fmt::format(
      "set terminal pngcairo noenhanced size {},{} font 'sans,9'\nset output {}\nset datafile separator ' '\n"
      "set multiplot layout {},1 title {}\nset grid\nset key outside\nset xlabel {}\n",
      picture_width, height, quoted(png.string()), plot.panels.size(), quoted(plot.title), quoted(plot.x_label));
  for (const PlotPanel& panel : plot.panels) {
    // The offsets keep a line at the lowest or highest value off the frame, which would hide it.
    script += fmt::format("set title {}\nset ylabel {}\nset autoscale y\nset offsets 0,0,graph 0.05,graph 0.05\n",
                          quoted(panel.title), quoted(panel.y_label));
    if (panel.y_range.first < panel.y_range.second) {
      script += fmt::format("set yrange [{}:{}]\n", panel.y_range.first, panel.y_range.second);
    }
    script += "plot ";
    for (std::size_t i = 0; i < panel.lines.size(); ++i) {
      script += fmt::format("{}'-' with {} title {}", i > 0 ? ", " : "",
                            panel.lines[i].dots ? "linespoints pt 7" : "lines", quoted(panel.lines[i].title));
    }
    script += '\n';
    for (const PlotLine& line : panel.lines) {
      for (const auto& [x, y] : line.points) {
        if (std::isfinite(x) && std::isfinite(y)) script += fmt::format("{:.9g} {:.9g}\n", x, y);
      }
      script += "e\n";
    }
  }
  return script + "unset multiplot\n";
}

// Whether a line goes through most of the panel's width, so that it must show.
bool goes_across(const PlotPanel& panel) {
  double low = INFINITY;
  double high = -INFINITY;
  double widest = 0.0;
  for (const PlotLine& line : panel.lines) {
    double first = INFINITY;
    double last = -INFINITY;
    for (const auto& [x, y] : line.points) {
      if (!std::isfinite(x) || !std::isfinite(y)) continue;
      first = std::min(first, x);
      last = std::max(last, x);
    }
    low = std::min(low, first);
    high = std::max(high, last);
    if (last > first) widest = std::max(widest, last - first);
  }
  return widest > 0.5 * (high - low) && widest > 0.0;
}

// A decoded picture may still show no data: the columns of pixels that a line through the panel takes are counted.
std::string picture_problem(const Plot& plot, const std::filesystem::path& png) {
  if (auto problem = png_problem(png); !problem.empty()) return problem;
  const auto drawn = coloured_columns(png, plot.panels.size(), title_height);
  for (std::size_t i = 0; i < plot.panels.size(); ++i) {
    // Far more than the legend's sample of the line.
    if (goes_across(plot.panels[i]) && (i >= drawn.size() || drawn[i] < picture_width / 4))
      return "the panel '" + plot.panels[i].title + "' is blank although it has data";
  }
  return {};
}

}  // namespace

std::string write_plot(const Plot& plot, const std::filesystem::path& png) {
  AtomicFile picture(png);
  const AtomicFile script_file(png.string() + ".gnuplot");  // for gnuplot alone: never put in place
  const std::string script = script_file.path().string();
  write_file(script, script_of(plot, picture.path()));
  const auto end = run_other({{"gnuplot", script}, Printed::dropped, Printed::dropped});
  if (!end) return "gnuplot is not installed (Debian package gnuplot-nox)";
  if (end->status != 0) return "gnuplot failed";
  if (auto problem = picture_problem(plot, picture.path()); !problem.empty()) return problem;
  picture.commit();
  return {};
}

}  // namespace touchstone::report
