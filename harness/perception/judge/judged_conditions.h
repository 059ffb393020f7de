// A list of conditions against one real process: each pair judged by itself, then ranked as far as the data can tell.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "harness/perception/features/rate_hardness.h"
#include "harness/perception/judge/judge.h"
#include "harness/perception/perceptual_evaluation.h"

namespace touchstone::perception {

// A metric of other authors on the same pair; nothing where it is undefined, and why.
struct OtherMetric {
  std::string name;
  std::string unit;
  bool larger_is_better = false;
  std::optional<double> value;
  std::string why;
};

struct JudgedCondition {
  std::string name;
  Judgement judgement;
  std::vector<OtherMetric> others;  // empty for many conditions
  std::optional<RateHardnessEstimate> rate_hardness;
  std::size_t rank = 0;             // 1 is the hardest to tell from the real process
  std::size_t group = 0;            // conditions of one group are not told apart by these data
  double behind_probability = 0.5;  // that it is easier to tell than the condition ranked before it; 0.5 for the first
  Vec3 strongest_W_m = Vec3::Zero();  // place and time of the strongest moment, if there are any
  double strongest_s = 0.0;
};

struct RecordingSource {
  std::string name;
  std::function<recording::Recording()> load;  // called once, from any thread
  std::size_t replayed_samples = 0;            // of a model along replay_path() of the real process; 0: measured
};

struct JudgedConditions {
  double rate_Hz = 0.0;
  std::size_t samples = 0;
  Vec3 outward = Vec3::UnitZ();
  NoiseFloor floor;
  std::optional<RateHardnessEstimate> real_rate_hardness;
  std::vector<JudgedCondition> conditions;  // in the order given
};

// The metrics beside are computed for up to keep_series_up_to conditions. Throws BadData, naming the condition, for
// recordings that cannot be judged, no condition, or two of one name.
JudgedConditions judge_conditions(const recording::Recording& real, const std::vector<RecordingSource>& repeats,
                                  const std::vector<RecordingSource>& conditions, const Vec3& outward,
                                  const JudgeOptions& options, const std::function<void(std::size_t)>& progress = {});

// Distance in perception space (all components), the statistics beside it, ST-SIM, SPQI and Stevens' felt intensity, of
// one pair: other conditions do not enter. Series are compared from their beginning on, as their authors do.
std::vector<OtherMetric> other_metrics(const recording::Recording& real, const recording::Recording& rendered,
                                       const Vec3& outward);

// {"schema": "touchstone-perception/2", "method": "judge", "conditions": [...]}.
std::string judged_to_json(const JudgedConditions& judged, const JudgeOptions& options);

}  // namespace touchstone::perception
