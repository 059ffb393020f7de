// What `touchstone loop` writes: result.json for programs, report.html for people.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "harness/report/page.h"
#include "harness/report/provenance.h"
#include "servo/evaluation.h"
#include "servo/recorded_run.h"

namespace touchstone::loop {

nlohmann::json to_json(const servo::LoopEvaluation& evaluation, const servo::LoopSetup& setup,
                       const std::optional<servo::RecordedComparison>& recorded);
report::Page loop_page(const servo::LoopEvaluation& evaluation, const servo::LoopSetup& setup,
                       const std::optional<servo::RecordedComparison>& recorded, const report::Provenance& provenance);

// What every report of the loop says of its figures, and of what is not in the simulation.
report::Section setup_section(const servo::LoopSetup& setup);
report::Section not_modelled_section();
report::Tone tone_of(servo::Verdict verdict);

}  // namespace touchstone::loop
