// Many renderers on many recordings: what each scored with which input, and what the data can tell of it. Commands fill
// the entries; rank_board() says who is better.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "harness/pipeline/binned_errors.h"
#include "harness/pipeline/ranking.h"
#include "harness/report/rendered_input.h"

namespace touchstone::pipeline {

enum class EntryState : std::uint8_t {
  ran,
  does_not_enter,  // it cannot represent the tip, or cannot take the object
  failed,          // it crashed, hung, or answered with what is no number
};
const char* state_name(EntryState state);  // "ran", "does-not-enter", "failed"

// What one renderer scored. A number that is not there is NaN.
struct Scores {
  double rms_force_error_N = 0.0;
  double rms_force_error_jnd = 0.0;  // in just noticeable differences: what a person feels of it
  double rms_position_error_m = 0.0;
  double mean_operations = 0.0;  // floating-point operations of a step
  double max_operations = 0.0;
  double median_us = 0.0;  // time of a step: another in each run
  double p99_us = 0.0;
};

struct Entry {
  std::string renderer;
  EntryState state = EntryState::ran;
  std::string why;  // where it did not run
  report::RenderedInput input;
  Scores scores;
  BinnedErrors errors;
  std::string fitted;  // the parameters that were fitted, in words; empty where all were given
  std::string report;  // relative to the site; empty: none
};

// The harness's own floor on a recording: what the law that is right scores (input_floor.h).
struct Floor {
  double rms_N = 0.0;
  double low95_N = 0.0;
  double high95_N = 0.0;
  std::string how;  // what was simulated
};

// What two recordings of one motion leave between them (recording_checks/repeat_floor.h).
struct RepeatOfTask {
  double rms_N = 0.0;
  std::string how;  // which recording it is, and how well the two fit
};

// One recording with one input: its entries may be held against each other.
struct Task {
  std::string name;   // "duck / scan"
  std::string about;  // what object, and what the recording shows
  std::string input;  // input_text() of what all entries were given
  std::string licence;
  std::string measured;  // how
  double measured_rms_N = 0.0;
  std::optional<Floor> floor;
  std::optional<RepeatOfTask> repeat;
  std::vector<Entry> entries;
  // Of the entries that ran; Ranking's numbers are places in `ranked`, whose numbers are places in `entries`.
  std::vector<std::size_t> ranked;
  std::optional<Ranking> ranking;  // without any entry that ran: none
};

struct Overall {
  std::vector<std::string> renderers;  // that ran on every task
  Ranking ranking;                     // its numbers are places in `renderers`
  std::vector<Scores> scores;          // root mean squares, resp. means, over tasks
  std::vector<bool> pareto;            // in error, felt error and operations
  std::vector<bool> pareto_timed;      // and microseconds
  std::vector<std::string> left_out;   // "voxel: does not enter duck / scan"
  double floor_N = 0.0;                // geometric mean of the tasks' floors; 0 where one of them has none
};

struct Board {
  std::string title;
  std::vector<Task> tasks;
  std::optional<Overall> overall;  // where asked for, and two or more renderers ran on all tasks
  RankingOptions options;
};

// Ranks every task, and all of them together if `overall`. Throws UsageError where entries of one task that ran had
// different inputs: they are not compared.
void rank_board(Board& board, bool overall);

// The entries of a task that ran, best first; then the others.
std::vector<std::size_t> in_order(const Task& task);
// The entries that lie within one just noticeable difference of one another by the size of the force, at least two, or
// none: by the triangle inequality of the root mean square two renderers differ by at most the sum of what each differs
// from the measured force, in differences that are just noticeable on that force. A bound: others may be so too.
std::vector<std::size_t> within_one_jnd(const Task& task);
// "1", "2-4": the interval of ranks of an entry of the task; "" where it has none.
std::string rank_text(const Task& task, std::size_t entry);
std::string rank_text(const RankedRenderer& ranked);

}  // namespace touchstone::pipeline
