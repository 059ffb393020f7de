// leaderboard.json, schema "touchstone-leaderboard/1" (docs/how-to/leaderboard.md): everything that the site shows but
// times, which are another in each run and stand in timings.json. The same rows give the same bytes. SI units; a number
// that is not there is null.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "harness/pipeline/board.h"

namespace touchstone::pipeline {

std::string board_to_json(const Board& board);
// "touchstone-leaderboard-timings/1".
std::string timings_to_json(const Board& board);

// Scores, states and floors of an earlier leaderboard.json, for what changed since.
struct EarlierEntry {
  std::string task;
  std::string renderer;
  EntryState state = EntryState::ran;
  double rms_force_error_N = 0.0;
  std::string input_hash;
};
struct EarlierBoard {
  std::vector<EarlierEntry> entries;
  std::map<std::string, std::optional<double>> floors_N;  // by task; empty where it had none
};
// Throws BadData with the place for anything that is no such file.
EarlierBoard load_earlier(const std::filesystem::path& file);

// A line for each entry that is new, gone, ran then and not now or the other way round, or scores otherwise, and for
// each floor of a recording of both runs that is new, gone or another; inputs that differ are said, not compared.
// Empty: nothing changed.
std::vector<std::string> changes_since(const EarlierBoard& before, const Board& now);

// The errors of an entry as one line of text, and back; throws BadData for other text.
std::string errors_to_text(const BinnedErrors& errors);
BinnedErrors errors_from_text(std::string_view text, std::string_view source);

}  // namespace touchstone::pipeline
