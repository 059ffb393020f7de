// The report of `perceive`: how likely a person tells each condition from the real process, by which channel, when and
// where, what to change, and what other authors' metrics say beside it.
#pragma once

#include <string>
#include <vector>

#include "harness/perception/judge/judged_conditions.h"
#include "harness/report/page.h"
#include "harness/report/provenance.h"

namespace touchstone::report {

Page judgement_page(const std::string& title, const perception::JudgedConditions& judged,
                    const perception::JudgeOptions& options, const std::vector<std::string>& notes,
                    const Provenance& provenance);

}  // namespace touchstone::report
