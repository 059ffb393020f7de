// Whole runs of the program, as a user or ctest starts it: the start alone, of its small and of its full part, one
// golden case, an evaluation with its report, and a search for missing effects on the bundled plane (where there is
// none to find: every candidate is tried once).
#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "harness/base/atomic_file.h"

namespace touchstone::bench {
namespace {

// A folder of this process, removed at its end.
struct Scratch {
  std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("touchstone-bench-" + std::to_string(::getpid()));
  Scratch() { std::filesystem::create_directories(folder); }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }
};

int run(const std::vector<std::string>& arguments) {
  std::vector<std::string> words{TOUCHSTONE_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int error = ::posix_spawn(&child, pointers[0], &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  if (error != 0 || ::waitpid(child, &status, 0) != child || !WIFEXITED(status)) return -1;
  return WEXITSTATUS(status);
}

double children_cpu_s() {
  rusage usage{};
  ::getrusage(RUSAGE_CHILDREN, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// The time is the processor time of the program that is run: what else the machine does is not in it.
void whole_run(benchmark::State& state, const std::vector<std::string>& arguments) {
  for (auto _ : state) {
    const double before_s = children_cpu_s();
    const int status = run(arguments);
    state.SetIterationTime(children_cpu_s() - before_s);
    if (status != 0) {
      state.SkipWithError(("exit status " + std::to_string(status)).c_str());
      break;
    }
  }
}

const bool registered = [] {
  static const Scratch scratch;
  const std::string source = TOUCHSTONE_SOURCE_DIR;
  const std::string plane = source + "/synthetic/bundled/plane/";
  const std::string model = scratch.folder / "model.json";
  write_file(
      model,
      R"({"schema": "touchstone-model/1", "renderer": "god-object", "parameters": {"stiffness_N_per_m": 1000}})");
  const std::vector<std::string> on_plane{"--model",           model,         "--mesh",
                                          plane + "plane.obj", "--recording", plane + "scan.csv"};
  const auto with = [&](std::vector<std::string> words, const std::vector<std::string>& more) {
    words.insert(words.end(), on_plane.begin(), on_plane.end());
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  const auto add = [](const char* name, const std::vector<std::string>& words) {
    return benchmark::RegisterBenchmark(name, [words](benchmark::State& state) { whole_run(state, words); })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
  };
  add("start", {"version"});
  add("start_full", {"list", "renderers"});
  add("check_one_case",
      {"check", "plane-stroke", "--golden", source + "/golden", "--out", scratch.folder / "failures"});
  add("evaluate_plane", with({"evaluate"}, {"--out", scratch.folder / "report"}));
  add("discrepancy_plane",
      with({"discrepancy"}, {"--instrument", plane + "instrument.json", "--out", scratch.folder / "found"}))
      ->Iterations(1);
  return true;
}();

}  // namespace
}  // namespace touchstone::bench
