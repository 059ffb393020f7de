// One page and one JSON per engine: what is wrong by name, errors on the golden cases, cost, and what to fix first.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "harness/renderer_faults/diagnosis.h"

namespace touchstone::renderer_faults {

// An engine on one golden case, against the right answer of that case.
struct CaseScore {
  std::string name;       // "sphere-scan"
  std::string shape;      // "sphere": what generates the body, or the file of its mesh; "scene" for several bodies
  std::string reference;  // "exact": of the smooth body; "golden": of its mesh
  std::size_t samples = 0;
  double mean_N = 0.0;  // of the magnitude of the error, as are the next two
  double rms_N = 0.0;
  double max_N = 0.0;
  double jump_N = 0.0;   // the largest change of the error from one sample to the next
  double right_N = 0.0;  // the largest right force, which the three are compared with
  double max_jnd = 0.0;  // the largest error in just noticeable differences of the right force
  bool exact = false;    // within the case's own tolerance
  bool felt = false;     // within the felt tolerance
  std::string problem;   // why it could not run; then nothing above counts
  bool skipped = false;  // the problem is that the case is none for this engine
};

// Of a step over a ball of `triangles` triangles.
struct CostScore {
  std::size_t triangles = 0;
  std::size_t steps = 0;
  double median_us = 0.0;
  double p99_us = 0.0;
  double p999_us = 0.0;
  double build_ms = 0.0;
};

struct Scorecard {
  std::string engine, summary, source;
  std::string library, library_sha256;  // of a plug-in
  std::string options;                  // parameters and facts that were given
  double felt_tolerance_jnd = 1.0;
  double epsilon_m = 0.0;
  double world_unit_m = 1.0;  // of the engine's own world
  Diagnosis diagnosis;
  std::vector<CaseScore> cases;
  std::optional<CostScore> cost;
  bool cases_wanted = false;         // else the verdict is that of the diagnosis alone
  std::vector<std::string> allowed;  // faults and golden cases that are known to fail, and do not count
};

// Whether it could not run, though it is a case for this engine, or has an error that a hand would notice.
bool fails(const CaseScore& one);

// Whether the engine passes. A fault, a detector that could not run, a case that could not run, and a case with an
// error that a hand would notice fail, unless they are allowed. If cases were wanted and none ran, nothing is known.
enum class CardVerdict : std::uint8_t { passed, failed, skipped };
CardVerdict verdict_of(const Scorecard& card);
std::string_view to_string(CardVerdict verdict);

// Strokes over a ball; single steps, each with the clock's own cost in it (some 20 ns).
CostScore measure_cost(const Engine& engine, int levels);

// {"schema": "touchstone-scorecard/1", ...}
std::string scorecard_to_json(const Scorecard& card);
// One page without scripts or outside files. Several engines: side by side.
std::string scorecard_to_html(const std::vector<Scorecard>& cards);
// One table in Markdown, shapes by engines: error in per cent of the largest right force, and the faults by name.
std::string scorecard_to_markdown(const std::vector<Scorecard>& cards);
// A few lines for the terminal.
std::string scorecard_to_text(const Scorecard& card);

}  // namespace touchstone::renderer_faults
