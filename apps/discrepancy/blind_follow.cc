#include "apps/discrepancy/blind_follow.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "harness/base/error.h"
#include "harness/base/json_reader.h"
#include "harness/recording/recording_file.h"
#include "synthetic/blind/blind_case.h"

namespace touchstone::apps {

const std::map<std::string, std::size_t>& blind_full_count() {
  static const std::map<std::string, std::size_t> count{{"one", 200},        {"one-noisy", 100}, {"two", 60},
                                                        {"three", 15},       {"none", 200},      {"unknown", 60},
                                                        {"cannot-tell", 40}, {"corrupted", 30}};
  return count;
}

void record_along_proposal(const std::filesystem::path& answers, const std::string& id,
                           const std::filesystem::path& trajectory, const std::filesystem::path& out) {
  const auto root = load_json(answers);
  if (!root.contains("seed") || !root.at("seed").is_number_unsigned()) {
    throw BadData(fmt::format("{}: /seed: the seed that the cases were made with was expected", answers.string()));
  }
  const auto seed = root.at("seed").get<std::uint64_t>();
  const InTrajectory motion = load_trajectory(trajectory);
  for (const auto& [set, count] : blind_full_count()) {
    for (std::size_t i = 0; i < count; ++i) {
      const synthetic::BlindCase plan = synthetic::plan_case(set, i, seed);
      if (plan.id != id) continue;
      save_recording(out / "train.csv", synthetic::record_along(plan, motion.motion, 0));
      save_recording(out / "holdout.csv", synthetic::record_along(plan, motion.motion, 1));
      return;
    }
  }
  throw BadData(fmt::format("{}: seed {} makes no case named {}", answers.string(), seed, id));
}

}  // namespace touchstone::apps
