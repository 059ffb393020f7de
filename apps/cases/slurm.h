// Many cases on a Slurm cluster: a job array whose tasks run shards, each into a result file of its own, merged and
// checked for completeness at the end. Shards that are lost are sent again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace touchstone::apps {

struct SlurmRequest {
  std::filesystem::path program;   // the touchstone that the tasks run
  std::vector<std::string> words;  // of the command: {"sweep", "spec.json"}
  std::string file_option;         // with which the command is told its result file
  std::filesystem::path out;       // the merged result; shards go to <out>.parts/<n>.sqlite
  std::uint64_t shards = 1;
  unsigned cores_per_task = 1;
  std::string options;  // further #SBATCH options, for instance "--partition=short --time=01:00:00"
};

std::filesystem::path shard_file(const SlurmRequest& request, std::uint64_t shard);
// The script of the job array for these shards (1 to request.shards). A task that Slurm starts again goes on where it
// stopped.
std::string slurm_script(const SlurmRequest& request, const std::vector<std::uint64_t>& shards);
// Writes the script beside the shards, hands it to `sbatch --wait` and comes back when the array has ended; false when
// some task failed. Throws BadData when sbatch is not there or refuses.
bool run_on_slurm(const SlurmRequest& request, const std::vector<std::uint64_t>& shards);

}  // namespace touchstone::apps
