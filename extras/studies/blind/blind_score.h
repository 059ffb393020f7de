// Findings against the answers of blind cases: verdicts, names, parameters, the gap closed; with the bars to meet.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "harness/discrepancy/findings_verdict.h"

namespace touchstone::blind {

// One case's outcome.
struct BlindScore {
  std::string id;
  std::string set;
  discrepancy::FindingsVerdict expected_verdict = discrepancy::FindingsVerdict::unexplained;
  discrepancy::FindingsVerdict verdict = discrepancy::FindingsVerdict::unexplained;
  std::vector<std::string> expected;  // effects
  std::vector<std::string> named;     // in the order found
  bool right = false;                 // as the set asks
  bool weak = false;                  // the hidden effects are below half of the noise floor: counted apart
  bool data_blamed = false;
  double before_N = 0.0;  // held out: the true stiffness alone
  double floor_N = 0.0;   // held out: the true structure, refitted; NaN where no library has it
  double after_N = 0.0;
  double closed = 0.0;  // (before^2 - after^2) / (before^2 - floor^2); NaN without a floor
  struct Parameter {
    std::string effect;
    std::string name;
    double truth;
    double value;
    bool inside;  // its 95 % interval
  };
  std::vector<Parameter> parameters;
  // Of a set for whose effects a law is to be found.
  double law_closed = 0.0;         // of the held-out gap, by the law; 0: none was found
  bool law_follows = false;        // what the hidden effect follows is among what the law says
  std::string law;                 // its formulas' names
  std::optional<bool> told_apart;  // by the motion that the search asked for; none: nothing asked for, or not run
};

// `answers`: the file that `touchstone blind make` sealed, or one of its layout. `cases` and `results`: folders with
// one folder per case; `again`: results on the motions asked for, may be empty. Cases without findings.json count as
// not run and are left out; throws BadData when none was run.
std::vector<BlindScore> score_blind(const std::filesystem::path& answers, const std::filesystem::path& cases,
                                    const std::filesystem::path& results, const std::filesystem::path& again);

std::string blind_json(const std::vector<BlindScore>& scores);

}  // namespace touchstone::blind
