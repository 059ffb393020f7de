// The page of two runs of one path with a tool: force, torque and the proxy's pose, their errors per axis, and what of
// them a person could feel.
#pragma once

#include <optional>

#include "harness/recording/trajectory.h"
#include "harness/report/page.h"
#include "harness/report/provenance.h"
#include "tool_metrics.h"

namespace touchstone::tool_reports {

struct ComparedTools {
  recording::Recording expected, obtained;
  // Both or none.
  std::optional<recording::InTrajectory> expected_proxy, obtained_proxy;
  tool::Coupling coupling;  // behind the proxy
  Vec3 force_tolerance_N = Vec3::Zero();
  Vec3 torque_tolerance_Nm = Vec3::Zero();
};

// Throws as tool::compare_tools() and tool::compare_proxies() do.
tool::ToolComparison compared_errors(const ComparedTools& compared);

// `errors`: compared_errors() of the same.
report::Page tool_comparison_page(const ComparedTools& compared, const tool::ToolComparison& errors,
                                  const report::Provenance& provenance);

}  // namespace touchstone::tool_reports
