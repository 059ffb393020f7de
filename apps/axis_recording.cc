#include "apps/axis_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "apps/extras.h"
#include "harness/recording/table_source.h"

namespace touchstone::apps {

bool is_axis_recording(const std::string& path) {
  constexpr std::array<std::pair<const char*, const char*>, 2> place_and_load{
      {{"q_rad", "torque_Nm"}, {"q_m", "force_N"}}};
  try {
    const std::vector<std::string> names = recording::open_table(path)->names();
    return std::ranges::any_of(place_and_load, [&](const auto& columns) {
      return std::ranges::count(names, columns.first) > 0 && std::ranges::count(names, columns.second) > 0;
    });
  } catch (const BadData&) {
    return false;  // what is wrong with it, the command that reads it says better
  }
}

ExitStatus run_axis(const AxisRecording& options) {
  if (!options.useless.empty()) {
    throw UsageError(
        fmt::format("{}: {} is a recording of one axis, which has no use for it: its terms are searched for and its "
                    "blocks held out without",
                    options.useless.front(), options.recording));
  }
  const std::optional<Extra> axis = find_extra("axis");
  if (!axis) {
    throw UsageError(
        fmt::format("{} is a recording of one axis, which the extra `touchstone axis` fits; the program "
                    "touchstone-axis is neither beside this one nor on PATH",
                    options.recording));
  }
  std::vector<std::string> words{options.recording};
  for (const auto& [flag, value] :
       {std::pair{"--repeat", options.repeat}, {"--out", options.out}, {"--json", options.json}}) {
    if (!value.empty()) words.insert(words.end(), {flag, value});
  }
  if (options.flip_force) words.emplace_back("--flip-force");
  return run_extra_and_wait(*axis, words);
}

}  // namespace touchstone::apps
