// A board with known answers, for the tests of this room.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "harness/base/random.h"
#include "harness/pipeline/board.h"

namespace touchstone::pipeline {

// `scale`: the RMS error of renderer-0, renderer-1, ...; behind them one that does not enter and one that failed.
inline Board sample_board(const std::vector<double>& scale, std::size_t tasks = 1) {
  Board board;
  board.title = "A sample";
  board.options.draws = 500;
  const Random root(7);
  for (std::size_t t = 0; t < tasks; ++t) {
    Random random = root.stream(t);
    Task task;
    task.name = "task " + std::to_string(t);
    task.about = "a plate; strokes";
    task.input = "the measured positions as they are; point tip";
    task.measured_rms_N = 2.0;
    task.floor = Floor{0.05, 0.04, 0.06, "simulated"};
    for (std::size_t r = 0; r < scale.size(); ++r) {
      Entry entry;
      entry.renderer = "renderer-" + std::to_string(r);
      entry.input.in_trajectory = "measured";
      entry.input.hash = "hash of " + task.name;
      for (int i = 0; i < 300; ++i) {
        const double error = scale[r] * (1.0 + 0.1 * random.normal());
        entry.errors.squares_N2.push_back(6.0 * error * error);
        entry.errors.samples.push_back(6);
      }
      const auto more = static_cast<double>(r);
      entry.scores = {entry.errors.rms_N(), 10.0 * entry.errors.rms_N(), 1e-4, 100.0 + 10.0 * more, 200.0, 0.5, 1.0};
      task.entries.push_back(std::move(entry));
    }
    for (const EntryState state : {EntryState::does_not_enter, EntryState::failed}) {
      Entry entry;
      entry.renderer = state == EntryState::failed ? "crashed" : "pointed";
      entry.state = state;
      entry.why = "<b>of a reason</b>";
      task.entries.push_back(std::move(entry));
    }
    board.tasks.push_back(std::move(task));
  }
  rank_board(board, true);
  return board;
}

}  // namespace touchstone::pipeline
