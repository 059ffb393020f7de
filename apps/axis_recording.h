// The fit of one axis (harness/pipeline/axis) for the commands that take such a recording: `axis`, and `fit` and
// `discrepancy`, which need neither model nor mesh for it.
#pragma once

#include <string>

#include "apps/command.h"
#include "harness/pipeline/axis/axis_run.h"

namespace touchstone::apps {

struct AxisOptions {
  pipeline::AxisRequest request;
  std::string out, json;  // a folder for axis.json and report.html, and a file for axis.json; empty: none
};

// Fits, prints, writes. Throws as pipeline::run_axis() does.
ExitStatus axis_command(const AxisOptions& options);

}  // namespace touchstone::apps
