// Many cases on a Slurm cluster: job arrays whose tasks run shards, each into a result file of its own, merged and
// checked for completeness at the end. Shards that are lost are sent again. A site limits the indices of an array
// (MaxArraySize of slurm.conf(5): indices below it, 1001 where it is not set): more shards go in several arrays.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace touchstone::runs {

struct SlurmRequest {
  std::filesystem::path program;   // the touchstone that the tasks run
  std::vector<std::string> words;  // of the command: {"sweep", "spec.json"}
  std::string file_option;         // with which the command is told its result file
  std::filesystem::path out;       // the merged result; shards go to <out>.parts/<n>.sqlite
  std::uint64_t shards = 1;
  unsigned cores_per_task = 1;
  std::string options;  // further #SBATCH options, for instance "--partition=short --time=01:00:00"
  std::string task;     // a script that runs the shard of its argument (farm.h); empty: the program itself
};

// For a POSIX shell: in quotes; only where it would take the text apart.
std::string shell_quoted(const std::string& text);
std::string shell_word(const std::string& text);

std::filesystem::path shard_file(const SlurmRequest& request, std::uint64_t shard);

// Shards of one array: the task with index i runs the shard offset + i.
struct SlurmArray {
  std::uint64_t offset = 0;
  std::vector<std::uint64_t> shards;
};
// Ascending shards (1 to request.shards) in as few arrays as a site with this limit takes.
std::vector<SlurmArray> slurm_arrays(const std::vector<std::uint64_t>& shards, std::uint64_t max_array_size);
// What `scontrol show config` says of it; Slurm's own default where that cannot be asked.
std::uint64_t slurm_max_array_size();

// The script of one array. A task that Slurm starts again goes on where it stopped.
std::string slurm_script(const SlurmRequest& request, const SlurmArray& array);

enum class SlurmEnd : std::uint8_t {
  all_done,
  some_failed,  // sending those shards again may help
  refused,      // sbatch took an array not; the same request would be refused again
};
// Writes the scripts beside the shards, hands them to `sbatch --wait` and comes back when all arrays have ended. Throws
// BadData when sbatch is not there.
SlurmEnd run_on_slurm(const SlurmRequest& request, const std::vector<SlurmArray>& arrays);

}  // namespace touchstone::runs
