// The noise floor of golden cases: how far results move when nothing but compiler, flags or machine changes. A
// tolerance must be at least ten times that, or it fails on what is no fault.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "harness/base/error.h"
#include "harness/golden/golden_case.h"

namespace touchstone::golden {

struct NoiseFloors {
  ExitStatus status = ExitStatus::passed;
  std::string text;  // for people: a table, and what is missing
};

// Runs the cases of the folder `golden` with each program (other builds of this one) and compares with the goldens;
// `failed` where a tolerance is less than ten times its floor. With `json` keeps what was found, and by which builds:
//   {"schema": "touchstone-golden-floor/1", "programs": [{"compiler", "flags", "cpu", "version", "commit"}],
//    "floors": [{"case", "model", "force_max_N", "contact_position_max_m", "drift_rows", "rows", "of_tolerance",
//                "golden_sha256", "tolerance_sha256", "commit"}]}
// and keeps the floors of other cases that are there already, if these programs differ from theirs by the commit alone.
// Throws UsageError for a program that cannot be run and for a file of other programs, BadData for one that fails.
NoiseFloors measure_noise_floors(const std::vector<GoldenCase>& cases, const std::string& golden,
                                 const std::vector<std::string>& programs, const std::filesystem::path& json);

// Judges the floors that were kept in `json`: `failed` where a tolerance is less than ten times its floor; `skipped`
// where none is but some model has no floor, or one of another golden or tolerance than today's.
NoiseFloors judge_noise_floors(const std::vector<GoldenCase>& cases, const std::filesystem::path& json);

}  // namespace touchstone::golden
