#include "harness/report/gnuplot.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <string>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/report/ctest_measurement.h"

namespace touchstone {
namespace {

// Inside gnuplot's single quotes only the quote itself needs care; a line's end would end the command.
std::string quoted(const std::string& text) {
  std::string safe = "'";
  for (const char c : text) safe += c == '\'' ? std::string("''") : c == '\n' ? std::string(" ") : std::string(1, c);
  return safe + "'";
}

std::string script_of(const Plot& plot, const std::filesystem::path& png) {
  constexpr int panel_height = 260;
  const int height = panel_height * static_cast<int>(plot.panels.size()) + 60;
  std::string script = fmt::format(
      "set terminal pngcairo noenhanced size 1000,{} font 'sans,9'\nset output {}\nset datafile separator ' '\n"
      "set multiplot layout {},1 title {}\nset grid\nset xlabel {}\n",
      height, quoted(png.string()), plot.panels.size(), quoted(plot.title), quoted(plot.x_label));
  for (const PlotPanel& panel : plot.panels) {
    script += fmt::format("set title {}\nset ylabel {}\nset autoscale y\n", quoted(panel.title), quoted(panel.y_label));
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

}  // namespace

std::string write_plot(const Plot& plot, const std::filesystem::path& png) {
  const auto script = png.string() + ".gnuplot";
  write_file(script, script_of(plot, png));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
  std::string program = "gnuplot";
  std::string argument = script;
  std::array<char*, 3> arguments{program.data(), argument.data(), nullptr};
  pid_t child = 0;
  const int failed = posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  if (failed == 0) waitpid(child, &status, 0);
  std::error_code ignored;
  std::filesystem::remove(script, ignored);
  if (failed != 0) return "gnuplot is not installed (Debian package gnuplot-nox)";
  if (status != 0) return "gnuplot failed";
  return png_problem(png);
}

}  // namespace touchstone
