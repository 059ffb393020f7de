#include "apps/axis_recording.h"

#include <fmt/format.h>

#include "harness/base/atomic_file.h"

namespace touchstone::apps {

ExitStatus axis_command(const AxisOptions& options) {
  pipeline::AxisInput input = pipeline::load_axis(options.request.recording, options.request.flip_force);
  for (const std::string& remark : check_axis(input)) fmt::print(stderr, "warning: {}\n", remark);
  const pipeline::AxisResult result = run_axis(options.request, std::move(input));
  fmt::print("{}", result.text());
  if (!options.json.empty()) write_file(options.json, result.json());
  if (!options.out.empty()) {
    fmt::print("report: {}\n", write_axis(options.request, result, command_line(), options.out).string());
  }
  return ExitStatus::passed;
}

}  // namespace touchstone::apps
