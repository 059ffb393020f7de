// How a commit is measured: by the golden reference of a case that the commit's program or plug-in replays, or by any
// command.
#pragma once

#include <filesystem>
#include <string>

#include "harness/bisection/bisection.h"

namespace touchstone::bisection {

struct ReplayMeasure {
  std::filesystem::path reference;  // mesh.obj, trajectory.csv, MODEL.json, MODEL.h5 or MODEL.golden.csv
  std::string model;
  std::string metric;          // of the comparison ("force_rms_N"), or operations, or time
  std::string program;         // within $BUILD; empty with a plug-in
  std::string plugin;          // within $BUILD
  std::filesystem::path self;  // the touchstone that replays a plug-in
  std::filesystem::path
      out;  // the good end's program or rendering is kept there where it is what others are held against
};

// Replays in a child process, so that a commit that crashes is one that does not run. Without a golden file in the
// reference the first rendering, that of the good end, is what later ones are compared with. Times are those of the
// good end's program, run in turn, so that what slows the machine slows both.
// Throws UsageError when the reference lacks a file.
Measure replay_measure(const ReplayMeasure& request);

// Where the force error of a commit's rendering sits, as `touchstone compare --where` shows it; empty for operations,
// time, and a commit without a rendering.
std::string where_it_differs(const ReplayMeasure& request, const std::string& commit);

// The last line that the command prints must be a number; exit status 125, or any other failure: it does not run.
Measure command_measure(const std::string& command);

}  // namespace touchstone::bisection
