// Plots over the time of a run with a tool, as reports show them.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "harness/base/wrench.h"
#include "harness/report/page.h"

namespace touchstone::tool_reports {

// One of several answers to a path: a wrench a sample, torque about the handle, axes of W.
struct WrenchLine {
  const char* name;
  report::Tone tone;
  bool dashed;
  std::function<Wrench(std::size_t)> at;
};

// Force along and torque about each axis, six plots that zoom together.
report::Section wrench_section(std::string title, std::span<const double> t_s, std::span<const WrenchLine> lines);

// A value a sample, as the plots above: thinned to what a screen can show, every peak kept.
report::LinePlot plot_over_time(std::string title, std::string y_label, std::span<const double> t_s,
                                std::string line_name, report::Tone tone,
                                const std::function<double(std::size_t)>& value);

}  // namespace touchstone::tool_reports
