#include "slurm.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <utility>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"

namespace touchstone::runs {
namespace {

std::filesystem::path parts_folder(const SlurmRequest& request) {
  return std::filesystem::absolute(request.out.string() + ".parts");
}

// As --array takes them: 1-4,7
std::string ranges(const std::vector<std::uint64_t>& shards) {
  std::string text;
  for (std::size_t i = 0; i < shards.size();) {
    std::size_t end = i;
    while (end + 1 < shards.size() && shards[end + 1] == shards[end] + 1) ++end;
    text += fmt::format("{}{}", text.empty() ? "" : ",", shards[i]);
    if (end > i) text += fmt::format("-{}", shards[end]);
    i = end + 1;
  }
  return text;
}

}  // namespace

std::string shell_quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

std::string shell_word(const std::string& text) {
  constexpr const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./=,:+-";
  return text.empty() || text.find_first_not_of(plain) != std::string::npos ? shell_quoted(text) : text;
}

std::filesystem::path shard_file(const SlurmRequest& request, std::uint64_t shard) {
  return parts_folder(request) / fmt::format("{}.sqlite", shard);
}

std::vector<SlurmArray> slurm_arrays(const std::vector<std::uint64_t>& shards, std::uint64_t max_array_size) {
  std::vector<SlurmArray> arrays;
  for (const std::uint64_t shard : shards) {
    if (arrays.empty() || shard - arrays.back().offset >= max_array_size) {
      // While the indices serve as they are, a task's index is its shard.
      const bool plain = arrays.empty() && shard < max_array_size;
      arrays.push_back({plain ? 0 : shard, {}});
    }
    arrays.back().shards.push_back(shard);
  }
  return arrays;
}

std::uint64_t slurm_max_array_size() {
  constexpr std::uint64_t default_of_slurm = 1001;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> answer(::popen("scontrol show config 2>/dev/null", "r"),
                                                               &::pclose);
  std::array<char, 512> line{};
  while (answer && std::fgets(line.data(), line.size(), answer.get()) != nullptr) {
    unsigned long long size = 0;
    if (std::sscanf(line.data(), "MaxArraySize = %llu", &size) == 1 && size > 1) return size;
  }
  return default_of_slurm;
}

std::string slurm_script(const SlurmRequest& request, const SlurmArray& array) {
  const std::string folder = parts_folder(request).string();
  std::vector<std::uint64_t> indices;
  for (const std::uint64_t shard : array.shards) indices.push_back(shard - array.offset);
  // Slurm has no sums in names: the log of shard 1002 is 1000+2.log.
  const std::string log = array.offset == 0 ? "%a" : fmt::format("{}+%a", array.offset);
  std::string script = fmt::format(
      "#!/bin/sh\n"
      "#SBATCH --job-name=touchstone-{}\n"
      "#SBATCH --array={}\n"
      "#SBATCH --ntasks=1 --cpus-per-task={}\n"
      "#SBATCH --requeue --open-mode=append\n"
      "#SBATCH --output={}/{}.log\n",
      request.words.front(), ranges(indices), request.cores_per_task, folder, log);
  if (!request.options.empty()) script += fmt::format("#SBATCH {}\n", request.options);
  std::string words;
  for (const std::string& word : request.words) words += ' ' + shell_word(word);
  std::string shard = "$SLURM_ARRAY_TASK_ID";
  if (array.offset > 0) {
    script += fmt::format("shard=$(({} + SLURM_ARRAY_TASK_ID))\n", array.offset);
    shard = "$shard";
  }
  if (!request.task.empty()) return script + fmt::format("exec /bin/sh {} \"{}\"\n", shell_quoted(request.task), shard);
  script += fmt::format("exec {}{} --shard \"{}/{}\" --threads {} {} {}/\"{}\".sqlite\n",
                        shell_quoted(std::filesystem::absolute(request.program).string()), words, shard, request.shards,
                        request.cores_per_task, request.file_option, shell_quoted(folder), shard);
  return script;
}

namespace {

// sbatch --wait with its output in a file: what it says once it has taken a job is the only sign that it did.
pid_t start_sbatch(const std::string& script, const std::string& log) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  std::array<std::string, 3> words{"sbatch", "--wait", script};
  std::array<char*, 4> arguments{words[0].data(), words[1].data(), words[2].data(), nullptr};
  pid_t child = 0;
  const int error = ::posix_spawnp(&child, "sbatch", &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0)
    throw BadData(fmt::format("sbatch cannot be run: {}; is Slurm installed here?", std::strerror(error)));
  return child;
}

SlurmEnd end_of_sbatch(pid_t child, const std::string& log) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const std::string said = read_file(log);
  fmt::print(stderr, "{}", said);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return SlurmEnd::all_done;
  return said.find("Submitted batch job") == std::string::npos ? SlurmEnd::refused : SlurmEnd::some_failed;
}

}  // namespace

SlurmEnd run_on_slurm(const SlurmRequest& request, const std::vector<SlurmArray>& arrays) {
  constexpr std::size_t most_at_once = 16;  // sites limit the jobs of a user, too
  const auto folder = parts_folder(request);
  ensure_writable_folder(folder);
  SlurmEnd worst = SlurmEnd::all_done;
  for (std::size_t first = 0; first < arrays.size() && worst != SlurmEnd::refused; first += most_at_once) {
    const std::size_t last = std::min(arrays.size(), first + most_at_once);
    std::vector<std::pair<pid_t, std::string>> running;
    for (std::size_t i = first; i < last; ++i) {
      const auto script = folder / (arrays[i].offset == 0 ? "array.sh" : fmt::format("array-{}.sh", arrays[i].offset));
      write_file(script, slurm_script(request, arrays[i]));
      const std::string log = script.string() + ".txt";
      running.emplace_back(start_sbatch(script.string(), log), log);
    }
    for (const auto& [child, log] : running) worst = std::max(worst, end_of_sbatch(child, log));
  }
  return worst;
}

}  // namespace touchstone::runs
