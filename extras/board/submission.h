// A submission: what somebody claims that renderers score, in a file that anyone can check by running it again.
// Schema "touchstone-submission/1": the options and models of the leaderboard, the SHA-256 of every recording, mesh,
// plug-in and source file, the build, and every entry's state, input hash and scores; "sha256" is of all of that. Who
// vouches for it: signature.h.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "board_plan.h"
#include "harness/report/provenance.h"

namespace touchstone::board {

struct Submission {
  std::vector<pipeline::ModelOfFile> models;  // empty: every renderer
  bool in_trajectory_chosen = false;
  recording::InTrajectoryMode in_trajectory = recording::InTrajectoryMode::synthesize;
  BoardTip tip = BoardTip::point;
  std::vector<std::string> fit;
  std::string fit_range, score_range;
  std::string specification;  // of the plan: which data and models
  std::vector<report::InputFile> plugins, sources;
  std::string entries;  // canonical JSON of what was scored
};

// `plugins`: the libraries that the plan's renderers came from, `sources` what they were built of.
std::string submission_to_json(const BoardPlan& plan, const pipeline::Board& board,
                               const std::vector<std::filesystem::path>& plugins,
                               const std::vector<std::filesystem::path>& sources);

// Throws BadData for a file that is no submission, or whose contents are not what its "sha256" says.
Submission load_submission(const std::filesystem::path& file, const plugin::Plugins& plugins);

// What differs between a submission and the same run here, a line each; empty: the same numbers, to the last digit.
std::vector<std::string> differences(const Submission& claimed, const BoardPlan& plan, const pipeline::Board& board);

// Plug-ins and source files of the submission that are not among those here, a line each. A library that was built anew
// has another hash; that alone is no difference of numbers.
std::vector<std::string> files_not_as_claimed(const Submission& claimed,
                                              const std::vector<std::filesystem::path>& plugins,
                                              const std::vector<std::filesystem::path>& sources);

}  // namespace touchstone::board
