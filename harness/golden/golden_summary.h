// A golden in a few numbers that read well in a diff: golden/<case>/expected.summary.json.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "harness/golden/comparison/verdict.h"
#include "harness/recording/trajectory.h"

namespace touchstone::golden {

// Floating-point operations of a run, where the renderer's are counted (harness/rendering/operations.h).
struct RunOperations {
  std::uint64_t total = 0;
  std::uint64_t max_per_step = 0;
  bool operator==(const RunOperations&) const = default;
};

struct GoldenSummary {
  std::size_t samples = 0;
  std::size_t contact_samples = 0;
  std::size_t contact_events = 0;
  double peak_force_N = 0.0;
  double rms_force_N = 0.0;
  Vec3 mean_force_W_N = Vec3::Zero();
  double contact_path_m = 0.0;                             // length of the surface contact point's path
  std::string sha256;                                      // of every number, to the bit
  std::optional<RunOperations> operations = std::nullopt;  // not from the trajectory: who makes the golden fills it
};

GoldenSummary summarise(const recording::RenderedTrajectory& rendered);
// The file's text: models by name, nine digits, one number to a line.
std::string summaries_to_json(const std::string& case_name, const std::map<std::string, GoldenSummary>& models);
// The operations that a summary file states, by model; none where there is no file. Throws BadData with the place.
std::map<std::string, RunOperations> load_operations(const std::filesystem::path& summary_file);

// What is to be said about operations that are not exactly the golden's.
struct OperationsChange {
  Verdict verdict = Verdict::worse;  // better: fewer; missing: only one side has any
  std::string message;
  bool operator==(const OperationsChange&) const = default;
};
std::optional<OperationsChange> operations_change(const std::optional<RunOperations>& golden,
                                                  const std::optional<RunOperations>& obtained);

}  // namespace touchstone::golden
