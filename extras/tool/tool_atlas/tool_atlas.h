// The atlas of tools: where renderers of a tool with a shape are off by more than a person notices. Each case is a
// contact whose answer is known (contacts/exact_cases.h), at a size or a clearance, behind a coupling, with one
// renderer; its error is the largest of eight poses at rest, in just noticeable differences of force and torque
// (harness/tool/tool_metrics.h).
//   A size s is the whole contact s times as large as in `touchstone tool list`; the hand presses as far as ever, 0.5
//   to 3 mm. A peg has its usual 20 mm, and clearances instead.
//   The coupling's rotational stiffness is that of its stiffness on an arm of 45 mm (2 Nm/rad for 1000 N/m).
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "case_engine.h"
#include "harness/tool/tool_renderer_entry.h"
#include "tool_errors.h"

namespace touchstone::tool_atlas {

struct ToolAtlasGrid {
  std::vector<std::string> renderers;
  std::vector<std::string> contacts{"sphere-plane", "sphere-sphere", "ellipsoid-plane", "ellipsoid-sphere", "box-face",
                                    "box-edge",     "box-corner",    "two-spheres",     "cylinder-groove",  "peg"};
  std::vector<double> sizes{0.5, 1.0, 2.0};
  std::vector<double> clearances_m{5e-5, 1e-4, 2e-4, 5e-4, 1e-3};
  std::vector<double> stiffnesses_N_per_m{500, 1000, 2000};
  std::map<std::string, double, std::less<>> parameters;  // of renderers that have them
  std::vector<std::string> plugins;                       // path and SHA-256 of each
};

struct ToolAtlasCase {
  std::string contacts;
  tool::ContactShape shape;
  double stiffness_N_per_m = 0.0;
  std::string renderer;
  tool::ToolErrors errors;
  std::string error;  // why it could not be run; empty: it ran

  [[nodiscard]] bool ran() const { return error.empty(); }
  // The larger of the force's and the torque's.
  [[nodiscard]] double jnd() const;
  // More than a person notices; what is no number is noticed.
  [[nodiscard]] bool noticed() const { return !(jnd() <= 1.0); }
  // The size, or the clearance in metres.
  [[nodiscard]] double place() const { return shape.clearance_m.value_or(shape.scale); }
};

std::uint64_t case_count(const ToolAtlasGrid& grid);
// What the case with that number is, below case_count(); not yet run. By contact, size or clearance, stiffness,
// renderer.
ToolAtlasCase case_at(const ToolAtlasGrid& grid, std::uint64_t number);
// Of one case, as JSON: a line of --dry-run.
std::string describe_case(const ToolAtlasGrid& grid, std::uint64_t number);

runs::CaseTable tool_atlas_table(const ToolAtlasGrid& grid);
// Throws UsageError for a renderer that is not among `entries`, or a parameter that none of them has.
runs::CaseJob tool_atlas_job(const ToolAtlasGrid& grid, std::vector<tool::ToolRendererEntry> entries);
// Of a store that has all of them, in their order.
std::vector<ToolAtlasCase> stored_cases(const ToolAtlasGrid& grid, const runs::CaseStore& store);
// {"tool", "atlas", "--renderers", ...}: the call that asks for this grid, but for plug-ins.
std::vector<std::string> tool_atlas_words(const ToolAtlasGrid& grid);

}  // namespace touchstone::tool_atlas
