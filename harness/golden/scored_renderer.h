// One renderer, judged as a scorecard shows it (harness/renderer_faults/scorecard.h): its faults by name, what its
// steps cost, and its errors on the golden cases, where it takes the place of a case's own renderer.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "harness/golden/catalogues.h"
#include "harness/golden/felt_verdict.h"
#include "harness/golden/golden_case.h"
#include "harness/plugin/plugin.h"
#include "harness/renderer_faults/entry_engine.h"
#include "harness/renderer_faults/scorecard.h"
#include "harness/rendering/renderer_entry.h"

namespace touchstone::golden {

struct ScoreRequest {
  renderer_faults::EngineFacts facts;
  FeltTolerance felt;   // its epsilon_m is the renderer's own
  std::string options;  // what was given, as the card shows it
  // Of the cases, whose place the renderer takes: what the case sets (stiffness, tip, friction) stays, if the renderer
  // has such a parameter. Cases without the model do not count; where the tip is another one it is a problem.
  std::string model = "god-object";
  bool cost = true;                       // time the steps
  bool with_cases = true;                 // else the verdict is that of the diagnosis alone
  std::vector<std::string> allowed = {};  // faults and cases that are known to fail
  std::filesystem::path out;              // cases that fail leave what there is to see in `out`/cases
};

// The renderers of these names, the plug-ins' before the program's `own`; without names all of the plug-ins'. Throws
// UsageError for a name that there is not, and if there is neither.
std::vector<std::shared_ptr<const rendering::RendererEntry>> entries_to_score(
    std::span<const rendering::RendererEntry> own, const plugin::Plugins& plugins,
    const std::vector<std::string>& names);

// One case, as the card has it. `request.felt.epsilon_m` is the renderer's own.
renderer_faults::CaseScore score_case(const Catalogues& catalogues,
                                      const std::shared_ptr<const rendering::RendererEntry>& entry,
                                      const ScoreRequest& request, const GoldenCase& golden);

// A case that cannot run is a problem in the card, not an error. Throws UsageError if the renderer's stiffness is
// neither given nor declared or what is allowed is neither a fault nor a case, BadData for parameters that it does not
// declare.
renderer_faults::Scorecard score_renderer(const Catalogues& catalogues,
                                          const std::shared_ptr<const rendering::RendererEntry>& entry,
                                          const ScoreRequest& request, const std::vector<GoldenCase>& cases);

}  // namespace touchstone::golden
