#include "harness/golden/pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "harness/report/gnuplot.h"

namespace touchstone::golden {
using report::Plot;

namespace {

constexpr std::array<const char*, 3> axes{"fx", "fy", "fz"};
constexpr std::size_t most_points = 2000;

// Every sample of short runs, the extremes of each stretch of long ones, so that a single wrong sample stays visible.
// What is not finite is left out: the tables say where it is.
std::vector<std::pair<double, double>> thinned(const std::vector<double>& t, const std::vector<double>& values) {
  std::vector<std::pair<double, double>> points;
  const std::size_t rows = std::min(t.size(), values.size());
  // Two points for each stretch.
  const std::size_t stretch = rows <= most_points ? 1 : 2 * rows / most_points;
  for (std::size_t first = 0; first < rows; first += stretch) {
    std::size_t low = rows;
    std::size_t high = rows;
    for (std::size_t i = first; i < std::min(first + stretch, rows); ++i) {
      if (!std::isfinite(values[i])) continue;
      if (low == rows || values[i] < values[low]) low = i;
      if (high == rows || values[i] > values[high]) high = i;
    }
    if (low == rows) continue;
    points.emplace_back(t[std::min(low, high)], values[std::min(low, high)]);
    if (low != high) points.emplace_back(t[std::max(low, high)], values[std::max(low, high)]);
  }
  return points;
}

std::pair<double, double> range_of(const std::vector<double>* a, const std::vector<double>* b) {
  double low = 0.0;
  double high = 0.0;
  for (const auto* const values : {a, b}) {
    for (const double v : values == nullptr ? std::vector<double>{} : *values) {
      if (std::isfinite(v)) {
        low = std::min(low, v);
        high = std::max(high, v);
      }
    }
  }
  const double margin = high > low ? 0.05 * (high - low) : 1.0;
  return {low - margin, high + margin};
}

Plot forces(const TrajectoryColumns& set, const TrajectoryColumns& other, const std::string& title) {
  Plot plot{title, "t [s]", {}};
  for (const char* const axis : axes) {
    report::PlotPanel panel{axis, "N", {}, range_of(set.find(axis), other.find(axis))};
    if (set.find(axis) != nullptr && set.find("t") != nullptr)
      panel.lines.push_back({title, thinned(*set.find("t"), *set.find(axis)), false});
    plot.panels.push_back(std::move(panel));
  }
  return plot;
}

Plot difference(const TrajectoryColumns& expected, const TrajectoryColumns& obtained) {
  Plot plot{"obtained - golden", "t [s]", {}};
  for (const char* const axis : axes) {
    report::PlotPanel panel{axis, "N", {}, {0.0, 0.0}};
    const auto* const e = expected.find(axis);
    const auto* const o = obtained.find(axis);
    std::vector<double> error;
    for (std::size_t i = 0; e != nullptr && o != nullptr && i < std::min(e->size(), o->size()); ++i)
      error.push_back((*o)[i] - (*e)[i]);
    if (!error.empty()) panel.lines.push_back({"difference", thinned(*expected.find("t"), error), false});
    panel.y_range = range_of(&error, nullptr);
    plot.panels.push_back(std::move(panel));
  }
  return plot;
}

}  // namespace

std::vector<std::pair<std::string, std::filesystem::path>> draw_pictures(const TrajectoryColumns& expected,
                                                                         const TrajectoryColumns& obtained,
                                                                         const std::filesystem::path& folder) {
  std::vector<std::pair<std::string, std::filesystem::path>> pictures;
  const auto draw = [&](const char* name, const char* file, const Plot& plot) {
    const auto problem = write_plot(plot, folder / file);
    if (problem.empty()) {
      pictures.emplace_back(name, folder / file);
    } else {
      fmt::print(stderr, "no picture {}: {}\n", file, problem);
    }
  };
  if (!expected.columns.empty()) draw("ValidImage", "golden.png", forces(expected, obtained, "golden"));
  if (!obtained.columns.empty()) draw("TestImage", "obtained.png", forces(obtained, expected, "obtained"));
  if (pictures.size() == 2) draw("DifferenceImage2", "difference.png", difference(expected, obtained));
  return pictures;
}

}  // namespace touchstone::golden
