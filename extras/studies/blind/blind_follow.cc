#include "blind/blind_follow.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/json_reader.h"
#include "harness/recording/recording_file.h"
#include "hidden_physics/blind_case.h"

namespace touchstone::blind {

const std::map<std::string, std::size_t>& blind_full_count() {
  static const std::map<std::string, std::size_t> count{
      {"one", 200},    {"one-noisy", 100},  {"two", 60},       {"three", 15},     {"none", 200},
      {"unknown", 60}, {"cannot-tell", 40}, {"corrupted", 30}, {"full-band", 45}, {"outside", 70}};
  return count;
}

void record_along_proposal(const std::filesystem::path& answers, const std::string& id,
                           const std::filesystem::path& trajectory, const std::filesystem::path& out) {
  const auto root = load_json(answers);
  if (!root.contains("seed") || !root.at("seed").is_number_unsigned()) {
    throw BadData(fmt::format("{}: /seed: the seed that the cases were made with was expected", answers.string()));
  }
  const auto seed = root.at("seed").get<std::uint64_t>();
  const recording::InTrajectory motion = recording::load_trajectory(trajectory);
  for (const auto& [set, count] : blind_full_count()) {
    for (std::size_t i = 0; i < count; ++i) {
      const hidden_physics::BlindCase plan = hidden_physics::plan_case(set, i, seed);
      if (plan.id != id) continue;
      save_recording(out / "train.csv", hidden_physics::record_along(plan, motion.motion, 0));
      save_recording(out / "holdout.csv", hidden_physics::record_along(plan, motion.motion, 1));
      return;
    }
  }
  throw BadData(fmt::format("{}: seed {} makes no case named {}", answers.string(), seed, id));
}

std::size_t follow_proposals(const std::filesystem::path& answers, const std::filesystem::path& cases,
                             const std::filesystem::path& results, const std::filesystem::path& out) {
  std::size_t count = 0;
  if (!std::filesystem::is_directory(results)) {
    throw BadData(fmt::format("{}: no such folder; search the cases with: touchstone blind run", results.string()));
  }
  for (const auto& entry : std::filesystem::directory_iterator(results)) {
    const auto trajectory = entry.path() / "next.csv";
    if (!std::filesystem::exists(trajectory)) continue;
    const std::string id = entry.path().filename().string();
    ensure_writable_folder(out / id);
    for (const char* const name : {"mesh.obj", "instrument.json", "model.json"}) {
      write_file(out / id / name, read_file(cases / id / name));
    }
    record_along_proposal(answers, id, trajectory, out / id);
    ++count;
  }
  return count;
}

}  // namespace touchstone::blind
