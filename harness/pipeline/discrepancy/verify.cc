#include "harness/pipeline/discrepancy/verify.h"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "harness/base/error.h"

namespace touchstone::pipeline {

double rms_of_files_N(const rendering::Catalogue& catalogue, const DiscrepancyFiles& files,
                      const std::function<void(const std::string&)>& report) {
  const DiscrepancyInputs inputs = load_inputs(catalogue, files);
  if (report) {
    for (const std::string& remark : inputs.remarks) report(remark);
  }
  const recording::Recording& measured = inputs.train;
  const rendering::Prediction prediction =
      catalogue.make_predictor(inputs.surface, measured.motion)->predict(inputs.model);
  double sum = 0.0;
  for (std::size_t i = 0; i < measured.size(); ++i) sum += (measured.f_W_N[i] - prediction.f_W_N[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(measured.size()));
}

std::optional<double> rms_in_fresh_process_N(const DiscrepancyFiles& files) {
  // Kept until the run has ended: what is wrong with mesh and recording was said before the search.
  const std::unique_ptr<std::FILE, decltype(&std::fclose)> said(std::tmpfile(), &std::fclose);
  std::array<int, 2> ends{};
  if (!said || pipe(ends.data()) != 0) return std::nullopt;
  std::vector<std::string> words{files.program.string(),
                                 "discrepancy",
                                 "--verify",
                                 "--model=" + files.model.string(),
                                 "--recording=" + files.recording.string(),
                                 "--mesh-unit=" + files.mesh_unit};
  if (!files.mesh.empty()) words.push_back("--mesh=" + files.mesh.string());
  if (files.repair) words.emplace_back("--repair");
  if (files.flip_force) words.emplace_back("--flip-force");
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, fileno(said.get()), STDERR_FILENO);
  posix_spawn_file_actions_addclose(&actions, ends[0]);
  pid_t child = 0;
  const int failed = posix_spawn(&child, words[0].c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  std::string text;
  std::array<char, 256> buffer{};
  while (failed == 0) {
    const ssize_t got = read(ends[0], buffer.data(), buffer.size());
    if (got <= 0) break;
    text.append(buffer.data(), static_cast<std::size_t>(got));
  }
  close(ends[0]);
  if (failed != 0) return std::nullopt;
  int status = 0;
  waitpid(child, &status, 0);
  char* end = nullptr;
  const double rms = std::strtod(text.c_str(), &end);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || end == text.c_str()) {
    std::rewind(said.get());
    std::string words_of_the_run;
    while (const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), said.get()))
      words_of_the_run.append(buffer.data(), got);
    throw BadData(fmt::format("{}: a fresh process could not run the written model:\n{}", files.model.string(),
                              words_of_the_run));
  }
  return rms;
}

}  // namespace touchstone::pipeline
