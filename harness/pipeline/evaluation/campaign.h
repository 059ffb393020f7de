// Several evaluations at once: data sets times renderers. Each gets its own folder with its report.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "harness/metrics/metric.h"
#include "harness/pipeline/board.h"
#include "harness/pipeline/evaluation/request.h"
#include "harness/plugin/plugin.h"
#include "harness/rendering/catalogue.h"

namespace touchstone::pipeline {

// What stays in memory of an evaluation when its report is written.
struct Evaluated {
  // Why there is nothing else: the renderer crashed, hung, or answered with no number. Empty where it ran.
  std::string failure;
  std::string group;   // evaluations of one recording, which a table may put side by side
  std::string column;  // what tells it from the others of the group
  std::filesystem::path folder;
  std::vector<metrics::MetricResult> metrics;
  std::vector<std::string> messages;  // to the person who runs it
  // Why the renderer was not run: it cannot have this tip. Else empty.
  std::string does_not_enter = {};
  std::string about = {};  // the object, and what the recording shows
  report::RenderedInput input = {};
  pipeline::BinnedErrors errors = {};
};

// The data sets that come with the program: share/touchstone/datasets beside an installed program, synthetic/bundled
// of the source tree above one that was built there. Throws BadData when there are none.
std::vector<std::filesystem::path> bundled_datasets();

// A model and the file that it was read from.
using ModelOfFile = std::pair<rendering::Model, std::filesystem::path>;

struct FloorBasis {
  std::filesystem::path instrument;  // "" where none is declared
  std::optional<double> friction;
};

// One request per recording of the data set and model. Without models: every renderer of the catalogue and of the
// plug-ins at the data set's stiffness. `base` holds what the command line chose. If the probe was a ball, no tip was
// chosen, and a renderer knows point tips only, all renderers are planned twice: with the ball, where those do not
// enter, and as points where the ball touched.
struct PlannedEvaluation {
  EvaluationRequest request;
  std::string group;
  std::string column;
  std::filesystem::path folder;  // below the output folder
  std::string about;             // the object, and what the recording shows
  // Of the data set, for the floor of its recordings (input_floor.h); without one there is no floor.
  std::optional<FloorBasis> floor = {};
};
std::vector<PlannedEvaluation> plan_dataset(const rendering::Catalogue& catalogue, const std::filesystem::path& place,
                                            const std::vector<ModelOfFile>& given, const plugin::Plugins& plugins,
                                            const EvaluationRequest& base, bool in_trajectory_chosen);

// One request for each model, on the recording and the mesh of `base`. Throws UsageError if two models would share a
// folder.
std::vector<PlannedEvaluation> plan_recording(const EvaluationRequest& base, const std::vector<ModelOfFile>& models);

// One evaluation with its report; `folder` "" writes none. A renderer that breaks down or does not enter is said, not
// thrown.
Evaluated evaluate_planned(const rendering::Catalogue& catalogue, const PlannedEvaluation& planned,
                           const std::filesystem::path& folder);

// Runs the plan; what its evaluations have to say goes to stderr when a group has ended. A renderer that breaks down
// spoils its own evaluation only.
std::vector<Evaluated> run_plan(const rendering::Catalogue& catalogue, const std::vector<PlannedEvaluation>& plan,
                                const std::filesystem::path& out);

// A line for each thing that evaluations of one group have to say: what several of them say is said once, with the
// columns it is about unless it is about all.
std::string group_messages(std::span<const Evaluated> group);
// A task of the board for each group and input; reports are linked relative to `out`. Not ranked yet.
pipeline::Board board_of(const std::vector<Evaluated>& evaluated, const std::filesystem::path& out);
// Simulates the floor of every task that has none and whose plan has a basis for one. `law`: see FloorWorld. A floor
// that cannot be simulated is left out.
void add_floors(const rendering::Catalogue& catalogue, const std::string& law,
                const std::vector<PlannedEvaluation>& plan, pipeline::Board& board);
pipeline::Floor floor_of_plan(const rendering::Catalogue& catalogue, const std::string& law, EvaluationRequest request,
                              const FloorBasis& basis);
pipeline::Entry entry_of(const Evaluated& evaluated, const std::filesystem::path& out);

// Every metric: one table per group and input, as wide as it gets.
std::string summary_table(const std::vector<Evaluated>& evaluated);
// Writes FOLDER/tables.txt (summary_table()) and FOLDER/index.html, the overview of all reports. Returns what a person
// reads first: the verdict on each group in words, and tables that fit a terminal.
// `plan`: what was evaluated, for the floors.
std::string write_overview(const rendering::Catalogue& catalogue, const std::vector<PlannedEvaluation>& plan,
                           const std::vector<Evaluated>& evaluated, const std::vector<std::string>& command_line,
                           const std::filesystem::path& folder);

// It broke down, or one of its numbers is none: neither may look like a pass.
bool is_invalid(const Evaluated& evaluated);

// Schema "touchstone-evaluations/1".
std::string summary_json(const std::vector<Evaluated>& evaluated);

}  // namespace touchstone::pipeline
