// What is wrong with a renderer of tools, by name; its errors where the answer is known; and what its steps cost: as
// the scorecards of renderers of points (harness/renderer_faults/scorecard.h), for six degrees of freedom.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "harness/report/page.h"
#include "harness/report/provenance.h"
#include "harness/tool/tool_checks.h"
#include "harness/tool/tool_renderer_entry.h"
#include "tool_errors.h"

namespace touchstone::tool_reports {

// Of a step: a ball pressed into a ball, slid and turned at 1 kHz, for 4,000 steps or 30 s.
struct ToolCost {
  std::size_t tool_triangles = 0;
  std::size_t object_triangles = 0;
  std::size_t steps = 0;  // in contact
  double contacts = 0.0;  // that a step lists, on average
  double median_us = 0.0, p99_us = 0.0, p999_us = 0.0;
  double build_ms = 0.0;
  std::optional<std::size_t> memory_bytes;
};

// Of one case that a renderer could not end.
struct ToolProblem {
  std::string contacts;  // the name of the case; empty: the checks or the timing
  std::string what;
};

struct ToolScorecard {
  std::string renderer, summary, source;
  std::string library, library_sha256;      // of a plug-in
  std::string options;                      // parameters that were given
  std::vector<tool::ToolFinding> findings;  // of tool_checks.h
  std::vector<tool::ToolErrors> errors;     // a row for each case
  std::optional<ToolCost> cost;
  std::vector<ToolProblem> problems;
};

// `cases` are for the coupling of `settings`. A renderer that breaks down is a problem in the card, not an error.
// Throws UsageError for settings that the renderer does not take.
ToolScorecard score_tool(const tool::ToolRendererEntry& entry, const tool::ToolSettings& settings,
                         std::span<const tool::KnownContacts> cases, bool cost);

// Every check that applies passed, nothing broke down, and every error is a number.
bool clean(const ToolScorecard& card);

// {"schema": "touchstone-tool-scorecard/1", ...}
std::string tool_scorecard_to_json(const ToolScorecard& card);
// A few lines for the terminal.
std::string tool_scorecard_to_text(const ToolScorecard& card);
// Several renderers side by side.
report::Page tool_scorecard_page(std::span<const ToolScorecard> cards, const report::Provenance& provenance);

}  // namespace touchstone::tool_reports
