#include "harness/bisection/reference.h"

#include <fmt/format.h>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/bisection/child_process.h"

namespace touchstone::bisection {

namespace fs = std::filesystem;

void export_reference(const GoldenReference& reference, const fs::path& to, const fs::path& log,
                      const std::atomic<bool>& stopped) {
  ChildCommand command;
  command.words = {reference.program.string(), "golden", "export", reference.golden_case, "--to", to.string()};
  if (!reference.golden_folder.empty())
    command.words.insert(command.words.end(), {"--golden", reference.golden_folder});
  command.log = log;
  fs::remove(log);
  if (run_child(command, stopped) != 0)
    throw UsageError(fmt::format("--case {}: cannot be exported: {}", reference.golden_case, read_file(log)));
}

std::string model_in(const fs::path& reference) {
  std::string model;
  for (const auto& entry : fs::directory_iterator(reference)) {
    if (entry.path().extension() != ".json") continue;
    const std::string name = entry.path().stem().string();
    const bool golden = fs::exists(reference / (name + ".h5")) || fs::exists(reference / (name + ".golden.csv"));
    const bool first_golden = model.empty() || fs::exists(reference / (model + ".h5"));
    if (model.empty() || (golden && (!first_golden || name < model))) model = name;
  }
  if (model.empty()) throw UsageError(fmt::format("{}: holds no model file (MODEL.json)", reference.string()));
  return model;
}

}  // namespace touchstone::bisection
