// Plots as PNG files by gnuplot, run without a shell.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace touchstone::report {

struct PlotLine {
  std::string title;
  std::vector<std::pair<double, double>> points;
  bool dots = false;  // points rather than a line
};

struct PlotPanel {
  std::string title;
  std::string y_label;
  std::vector<PlotLine> lines;
  std::pair<double, double> y_range{0.0, 0.0};  // equal: by the data
};

struct Plot {
  std::string title;
  std::string x_label;
  std::vector<PlotPanel> panels;  // one above the other over the same x
};

// Empty when the picture was written, else why not (no gnuplot, for instance): a missing picture never hides a result.
std::string write_plot(const Plot& plot, const std::filesystem::path& png);

}  // namespace touchstone::report
