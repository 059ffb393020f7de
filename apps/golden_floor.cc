#include "apps/golden_floor.h"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <filesystem>

#include "harness/baseline/column_file.h"
#include "harness/baseline/compare.h"

extern char** environ;

namespace touchstone::apps {
namespace {

constexpr double most_of_tolerance = 0.1;

class ScratchFolder {
 public:
  ScratchFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "touchstone-floor-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw BadData("no folder can be made for temporary files");
    path_ = pattern;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

void run_render(const std::string& program, const std::string& golden, const std::string& one,
                const std::filesystem::path& to) {
  std::array<std::string, 8> words{program, "golden", "render", one, "--golden", golden, "--to", to.string()};
  std::array<char*, 9> arguments{};
  for (std::size_t i = 0; i < words.size(); ++i) arguments[i] = words[i].data();
  pid_t child = 0;
  int status = 1;
  if (posix_spawnp(&child, program.c_str(), nullptr, nullptr, arguments.data(), environ) != 0) {
    throw UsageError(fmt::format("--program {}: cannot be run", program));
  }
  ::waitpid(child, &status, 0);
  if (status != 0) throw BadData(fmt::format("{} golden render {}: failed", program, one));
}

}  // namespace

ExitStatus golden_floor(const std::vector<GoldenCase>& cases, const std::string& golden,
                        const std::vector<std::string>& programs) {
  const ScratchFolder scratch;
  bool good = true;
  fmt::print("{:<32} {:<24} {:>12} {:>14} {:>10}\n", "case", "model", "force [N]", "of tolerance", "");
  for (const GoldenCase& one : cases) {
    for (std::size_t p = 0; p < programs.size(); ++p)
      run_render(programs[p], golden, one.name, scratch.path() / std::to_string(p));
    for (const auto& [model, text] : one.models) {
      const TrajectoryColumns expected = load_columns(one.expected(model));
      double floor_N = 0.0;
      double share = 0.0;
      for (std::size_t p = 0; p < programs.size(); ++p) {
        const auto obtained = load_columns(scratch.path() / std::to_string(p) / one.name / (model + ".h5"));
        const Comparison comparison = compare(expected, obtained, one.tolerance);
        share = std::max(share, comparison.tolerance_used());
        if (const auto* const force = comparison.find("force")) floor_N = std::max(floor_N, force->max);
      }
      const bool wide_enough = share <= most_of_tolerance;
      good = good && wide_enough;
      fmt::print("{:<32} {:<24} {:>12.3g} {:>13.3g}% {:>10}\n", one.name, model, floor_N, 100.0 * share,
                 wide_enough ? "ok" : "TOO TIGHT");
    }
  }
  return good ? ExitStatus::passed : ExitStatus::failed;
}

}  // namespace touchstone::apps
