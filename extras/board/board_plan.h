// What a leaderboard runs: data sets times renderers, each with one input, and the floor of each recording.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "case_engine.h"
#include "harness/pipeline/board.h"
#include "harness/pipeline/evaluation/campaign.h"

namespace touchstone::board {

// The tip that all renderers get.
enum class BoardTip : std::uint8_t {
  point,    // where the probe touched: every renderer can represent it
  dataset,  // the probe's own; renderers that know points only do not enter where it is a ball
};

struct BoardRequest {
  std::vector<std::filesystem::path> datasets;
  std::vector<pipeline::ModelOfFile> models;  // none: every renderer of the catalogue and of the plug-ins
  const plugin::Plugins* plugins = nullptr;
  pipeline::EvaluationRequest base;   // what holds for all
  bool in_trajectory_chosen = false;  // else: the data set's, and the whole force where it declares friction
  BoardTip tip = BoardTip::point;
  std::vector<std::string> fit;   // parameters fitted on `fit_range` where the renderer has them: "mu_dynamic=0:1"
  metrics::TimeRanges fit_range;  // the scores are of base.time_ranges
  // The renderer whose law the floor's simulated recordings obey (input_floor.h): a proxy with Coulomb friction.
  std::string floor_law = "friction-cone";
  bool reports = true;
  std::filesystem::path out;
};

// One recording with what its data set says of it.
struct BoardTask {
  std::string name, about, licence, measured;
  std::filesystem::path instrument;  // "" where there is none
  std::optional<double> friction;
  pipeline::EvaluationRequest request;  // without a model: for the floor
};

// A renderer on a recording, or the recording's floor.
struct BoardCell {
  std::size_t task = 0;
  std::optional<pipeline::PlannedEvaluation> evaluation;  // empty: the floor
};

struct BoardPlan {
  BoardRequest request;
  std::vector<BoardTask> tasks;
  std::vector<BoardCell> cells;
  std::string specification;  // canonical JSON: the same text, the same rows
};

// Reads the data sets. Throws UsageError for two of the same name.
BoardPlan plan_board(const rendering::Catalogue& catalogue, const BoardRequest& request);

runs::CaseTable board_table(const BoardPlan& plan);
// One after the other: they measure times. Catalogue and plan must live as long as the job.
runs::CaseJob board_job(const rendering::Catalogue& catalogue, const BoardPlan& plan);

// The board of all rows, not ranked yet. A floor that could not be simulated is left out.
pipeline::Board board_of_rows(const BoardPlan& plan, const runs::CaseStore& store);

}  // namespace touchstone::board
