// The whole evaluation (figure 1, right half): conditions against the real process, in the perception space and by
// plain statistics, with their rankings and where they disagree.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "harness/perception/distances/structural_similarity.h"
#include "harness/perception/haptic_data_matrix.h"
#include "harness/perception/haptic_image.h"
#include "harness/perception/perception_space.h"

namespace touchstone::perception {

// A way to compare a condition with the real process: a line of the table and a line of figure 13.
struct Method {
  std::string_view name;   // machine-readable
  std::string_view title;  // for people, with the equation
  std::string_view unit;
  bool larger_is_better = false;
};

// The series of one comparison, on the same grid.
struct ComparedSeries {
  const std::vector<double>& real_N;
  const std::vector<double>& rendered_N;
  const std::vector<double>& real_felt_N;  // after the perceptual filters
  const std::vector<double>& rendered_felt_N;
  const std::vector<double>& real_steps;  // real_N in just noticeable differences
  double rate_Hz = 0.0;
  const WeberLaw& law;
};

struct StatisticalMethod {
  Method method{};
  std::optional<double> (*value)(const ComparedSeries& series) = nullptr;  // nothing where it is undefined
};
// The explicit catalogue of statistics; the perception space itself is perception_space_method.
const std::vector<StatisticalMethod>& statistical_methods();
inline constexpr Method perception_space_method{"perception-space", "distance in perception space (eq 21)", "1", false};

struct EvaluationOptions {
  HapticImageOptions image;
  FeatureScaling scaling = FeatureScaling::reference_norm;
  double explained_share = 0.9;
  HapticDataMatrixOptions matrix;
  // Durations that differ by a larger share than this are refused; what is longer is cut otherwise, with a remark.
  double duration_tolerance = 0.2;
  unsigned threads = 0;  // 0: as many as there are processors
  std::function<void(std::size_t done)> progress;
};

struct ConditionResult {
  std::string name;
  std::vector<std::optional<double>> statistics;  // as statistical_methods()
  double distance = 0.0;                          // eq 21
  std::vector<double> block_distance;             // by feature, scaled, all components: what the distance is made of
  std::optional<double> extended_rate_hardness_N_per_m;
  double harmonic_share = 0.0;
  double guarded_share = 0.0;
  double force_reduction = 0.0;  // of the dead band
  double displacement_reduction = 0.0;
  std::size_t rank_perception = 0;   // 1 is the nearest
  std::vector<std::string> remarks;  // what of it is not compared
};

struct PerceptualEvaluation {
  FeatureScaling scaling = FeatureScaling::reference_norm;
  double explained_share_wanted = 0.9;
  double rate_Hz = 0.0;
  std::size_t samples = 0;
  std::vector<std::string> features;  // names of the blocks
  ConditionResult real;               // distance 0; its statistics against itself
  std::vector<ConditionResult> conditions;
  PerceptionSpace space;            // row 0 is the real process, row i + 1 condition i
  std::vector<HapticImage> images;  // the same order; without the felt series when there are many (keep_series)
  std::vector<std::vector<double>> rendered_N;  // for pictures: row 0 the real force; empty for many conditions
  std::vector<std::vector<double>> rendered_displacement_m;
  std::vector<WindowTradeOff> windows;  // figure 8, of the real process
  std::vector<std::string> remarks;

  // Value of every condition by a method (perception-space too); NaN where undefined.
  [[nodiscard]] std::vector<double> values(std::string_view method) const;
};

// One condition, loaded when its turn comes: many need not be in memory together. Called from several threads, each
// once.
struct ConditionSource {
  std::string name;
  std::function<std::vector<PressSignal>()> load;
};

// Series are kept for pictures up to this many conditions.
inline constexpr std::size_t keep_series_up_to = 24;

// Throws BadData, naming the condition, for input that cannot be compared (see make_haptic_data_matrix), no condition,
// or two conditions of one name; UsageError for options that are below zero or not finite.
PerceptualEvaluation evaluate(const std::vector<PressSignal>& real, const std::vector<ConditionSource>& conditions,
                              const EvaluationOptions& options);

// The distances again under another rule of scaling, from the images at hand: how the ranking depends on it.
std::vector<double> distances_with_scaling(const PerceptualEvaluation& evaluation, FeatureScaling scaling,
                                           double explained_share);

// The same under every rule, in the order of feature_scalings.
std::vector<std::vector<double>> distances_by_scaling(const PerceptualEvaluation& evaluation);

// Pairs of conditions that perception space and a statistic order differently, with the feature that decides in the
// space.
struct Disagreement {
  std::size_t nearer_in_space;
  std::size_t nearer_by_statistic;
  std::string feature;
  std::string why;
};
struct Disagreements {
  std::size_t pairs = 0;  // how many are ordered differently
  std::size_t of = 0;
  std::vector<Disagreement> most;  // those whose ranks differ most, that first
};
inline constexpr std::size_t disagreements_told = 100;
Disagreements disagreements(const PerceptualEvaluation& evaluation, std::string_view statistic,
                            std::size_t told = disagreements_told);

}  // namespace touchstone::perception
