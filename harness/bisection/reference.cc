#include "harness/bisection/reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/bisection/logged_program.h"

namespace touchstone::bisection {

namespace fs = std::filesystem;

void export_reference(const GoldenReference& reference, const fs::path& to, const fs::path& log,
                      const std::atomic<bool>& stopped) {
  OtherProgram command = logged_program(log, stopped);
  command.words = {reference.program.string(), "golden", "export", reference.golden_case, "--to", to.string()};
  if (!reference.golden_folder.empty())
    command.words.insert(command.words.end(), {"--golden", reference.golden_folder});
  fs::remove(log);
  if (!succeeds(command))
    throw UsageError(fmt::format("--case {}: cannot be exported: {}", reference.golden_case, read_file(log)));
}

std::string model_in(const fs::path& reference) {
  std::set<std::string> models;
  for (const auto& entry : fs::directory_iterator(reference)) {
    if (entry.path().extension() == ".json") models.insert(entry.path().stem().string());
  }
  if (models.empty()) throw UsageError(fmt::format("{}: holds no model file (MODEL.json)", reference.string()));
  const auto has_golden = [&](const std::string& name) {
    return fs::exists(reference / (name + ".h5")) || fs::exists(reference / (name + ".golden.csv"));
  };
  const auto golden = std::ranges::find_if(models, has_golden);
  return golden == models.end() ? *models.begin() : *golden;
}

}  // namespace touchstone::bisection
