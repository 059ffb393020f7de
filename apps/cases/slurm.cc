#include "apps/cases/slurm.h"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"

namespace touchstone::apps {
namespace {

std::filesystem::path parts_folder(const SlurmRequest& request) {
  return std::filesystem::absolute(request.out.string() + ".parts");
}

// For a POSIX shell.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

// Only where a shell would take it apart.
std::string word_of(const std::string& text) {
  constexpr const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./=,:+-";
  return text.empty() || text.find_first_not_of(plain) != std::string::npos ? quoted(text) : text;
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

std::filesystem::path shard_file(const SlurmRequest& request, std::uint64_t shard) {
  return parts_folder(request) / fmt::format("{}.sqlite", shard);
}

std::string slurm_script(const SlurmRequest& request, const std::vector<std::uint64_t>& shards) {
  const std::string folder = parts_folder(request).string();
  std::string script = fmt::format(
      "#!/bin/sh\n"
      "#SBATCH --job-name=touchstone-{}\n"
      "#SBATCH --array={}\n"
      "#SBATCH --ntasks=1 --cpus-per-task={}\n"
      "#SBATCH --requeue --open-mode=append\n"
      "#SBATCH --output={}/%a.log\n",
      request.words.front(), ranges(shards), request.cores_per_task, folder);
  if (!request.options.empty()) script += fmt::format("#SBATCH {}\n", request.options);
  std::string words;
  for (const std::string& word : request.words) words += ' ' + word_of(word);
  script +=
      fmt::format("exec {}{} --shard \"$SLURM_ARRAY_TASK_ID/{}\" --threads {} {} {}/\"$SLURM_ARRAY_TASK_ID\".sqlite\n",
                  quoted(std::filesystem::absolute(request.program).string()), words, request.shards,
                  request.cores_per_task, request.file_option, quoted(folder));
  return script;
}

bool run_on_slurm(const SlurmRequest& request, const std::vector<std::uint64_t>& shards) {
  const auto folder = parts_folder(request);
  ensure_writable_folder(folder);
  const auto script = folder / "array.sh";
  write_file(script, slurm_script(request, shards));
  std::array<std::string, 3> words{"sbatch", "--wait", script.string()};
  std::array<char*, 4> arguments{words[0].data(), words[1].data(), words[2].data(), nullptr};
  pid_t child = 0;
  const int error = ::posix_spawnp(&child, "sbatch", nullptr, nullptr, arguments.data(), environ);
  if (error != 0)
    throw BadData(fmt::format("sbatch cannot be run: {}; is Slurm installed here?", std::strerror(error)));
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace touchstone::apps
