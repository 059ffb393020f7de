#include "tool_reports/tool_plots.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace touchstone::tool_reports {
namespace {

using report::Line;
using report::LinePlot;
using report::Section;
using report::Tone;

// More points than this cannot be told apart on a screen.
constexpr std::size_t most_plotted = 4000;

// Of each bin of neighbours the sample that is farthest from zero: no peak is left out.
Line line_over_time(std::span<const double> t_s, std::string name, Tone tone, bool dashed,
                    const std::function<double(std::size_t)>& value) {
  Line line{std::move(name), {}, {}, tone, dashed, false};
  const std::size_t stride = t_s.size() / most_plotted + 1;
  for (std::size_t begin = 0; begin < t_s.size(); begin += stride) {
    std::size_t shown = begin;
    for (std::size_t i = begin; i < std::min(begin + stride, t_s.size()); ++i) {
      if (!(std::abs(value(i)) <= std::abs(value(shown)))) shown = i;
    }
    line.x.push_back(t_s[shown]);
    line.y.push_back(value(shown));
  }
  return line;
}

LinePlot plot(std::string title, std::string y_label) {
  LinePlot plot;
  plot.title = std::move(title);
  plot.x_label = "time [s]";
  plot.y_label = std::move(y_label);
  plot.link = "time";
  return plot;
}

}  // namespace

Section wrench_section(std::string title, std::span<const double> t_s, std::span<const WrenchLine> lines) {
  Section section{std::move(title), "", {}, false};
  for (const bool torque : {false, true}) {
    for (int k = 0; k < 3; ++k) {
      const char axis_name = "xyz"[k];
      LinePlot axis =
          plot(torque ? fmt::format("torque about {}", axis_name) : fmt::format("force along {}", axis_name),
               torque ? "torque [mNm]" : "force [N]");
      for (const WrenchLine& line : lines) {
        axis.lines.push_back(line_over_time(t_s, line.name, line.tone, line.dashed, [&](std::size_t i) {
          const Wrench wrench = line.at(i);
          return torque ? 1e3 * wrench.torque_Nm[k] : wrench.f_N[k];
        }));
      }
      section.blocks.emplace_back(std::move(axis));
    }
  }
  return section;
}

LinePlot plot_over_time(std::string title, std::string y_label, std::span<const double> t_s, std::string line_name,
                        Tone tone, const std::function<double(std::size_t)>& value) {
  LinePlot made = plot(std::move(title), std::move(y_label));
  made.lines = {line_over_time(t_s, std::move(line_name), tone, false, value)};
  return made;
}

}  // namespace touchstone::tool_reports
