#include "harness/golden/golden_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>

#include "harness/base/atomic_file.h"
#include "harness/base/bundled_files.h"
#include "harness/base/error.h"
#include "harness/golden/case_runner.h"
#include "harness/golden/golden_file.h"
#include "harness/golden/golden_summary.h"
#include "harness/recording/recording_file.h"
#include "harness/rendering/model.h"
#include "harness/surface/mesh_file.h"

namespace touchstone::golden {

namespace {

bool holds_cases(const std::filesystem::path& folder) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (std::filesystem::exists(entry.path() / "case.json", error)) return true;
  }
  return false;
}

// `changed` has other operations than the summary knows so far; the other models keep theirs.
void write_summary(const GoldenCase& golden, const std::string& changed, std::optional<RunOperations> operations) {
  std::map<std::string, GoldenSummary> summaries;
  const auto known = load_operations(golden.summary_file());
  for (const auto& [model, text] : golden.models) {
    if (!std::filesystem::exists(golden.expected(model))) continue;
    GoldenSummary& summary = summaries[model] = summarise(recording::load_rendered(golden.expected(model)));
    const auto found = known.find(model);
    if (model == changed) {
      summary.operations = operations;
    } else if (found != known.end()) {
      summary.operations = found->second;
    }
  }
  write_file(golden.summary_file(), summaries_to_json(golden.name, summaries), Replace::inputs_too);
}

std::optional<RunOperations> operations_of(const Provenance& provenance) {
  RunOperations operations;
  const auto read = [&](const char* name, std::uint64_t& value) {
    const auto found = provenance.find(name);
    if (found == provenance.end()) return false;
    const std::string& text = found->second;
    return std::from_chars(text.data(), text.data() + text.size(), value).ec == std::errc();
  };
  if (!read("operations", operations.total) || !read("operations_max_step", operations.max_per_step))
    return std::nullopt;
  return operations;
}

bool same_bits(const std::filesystem::path& a, const std::filesystem::path& b) {
  return std::filesystem::exists(a) && std::filesystem::exists(b) &&
         summarise(recording::load_rendered(a)).sha256 == summarise(recording::load_rendered(b)).sha256;
}

}  // namespace

std::filesystem::path usual_golden_folder(const std::filesystem::path& own) {
  if (!holds_cases(own)) {
    // Upwards, as git finds its folder, to the top of the repository.
    std::error_code error;
    for (auto here = std::filesystem::current_path(error); !error && here.has_relative_path();
         here = here.parent_path()) {
      if (holds_cases(here / own)) return here / own;
      if (std::filesystem::exists(here / ".git")) break;
    }
    if (const auto bundled = find_bundled("golden")) return *bundled;
  }
  return own;
}

std::vector<GoldenCase> choose_cases(const std::filesystem::path& own, const std::vector<std::string>& cases) {
  if (cases.empty()) return load_cases(own);
  std::vector<GoldenCase> chosen;
  for (const std::string& name : cases) {
    const bool is_folder = name.find('/') != std::string::npos;
    std::filesystem::path path = is_folder ? std::filesystem::path(name) : own / name;
    if (!path.has_filename()) path = path.parent_path();
    if (!std::filesystem::is_directory(path)) {
      std::string known;
      for (const GoldenCase& one : load_cases(own)) known += ' ' + one.name;
      throw UsageError(fmt::format("there is no golden case '{}' in {}; there are:{}", name, own.string(), known));
    }
    chosen.push_back(load_case(path));
  }
  return chosen;
}

std::vector<PendingResult> chosen_pending(const std::filesystem::path& out, const std::vector<std::string>& cases,
                                          const std::string& model) {
  auto pending = pending_results(out);
  std::erase_if(pending, [&](const PendingResult& p) {
    const bool named = cases.empty() || std::ranges::find(cases, p.case_name) != cases.end();
    return !named || (!model.empty() && p.model != model);
  });
  return pending;
}

std::string review_text(const std::vector<PendingResult>& pending, const std::string& golden_folder,
                        const std::string& out) {
  std::string text;
  for (const auto& p : pending) {
    text += read_file(p.folder / "table.txt");
    for (const char* const picture : {"golden.png", "obtained.png", "difference.png"}) {
      if (std::filesystem::exists(p.folder / picture)) text += fmt::format("  {}\n", (p.folder / picture).string());
    }
    text += fmt::format(
        "  to make it the golden: touchstone golden accept {} --model {} --golden {} --out {} --reason '...'\n\n",
        p.case_name, p.model, golden_folder, out);
  }
  return text + fmt::format("{} results wait for a decision in {}\n", pending.size(), out);
}

std::string accept_result(const PendingResult& pending, const std::filesystem::path& folder,
                          const std::filesystem::path& out, const std::string& reason) {
  const GoldenCase golden = load_case(folder / pending.case_name);
  if (!golden.models.contains(pending.model))
    throw UsageError(fmt::format("the case {} has no model {}", pending.case_name, pending.model));
  Provenance run = read_provenance(pending.obtained());
  if (const auto refused = run_refused(run))
    throw UsageError(fmt::format("{} {}: not accepted: {}", pending.case_name, pending.model, *refused));
  Provenance changes{{"reason", reason}};
  // Which file it was says its hash; where it lay is of this machine.
  if (const auto library = run.find("plugin_library"); library != run.end())
    changes["plugin_library"] = std::filesystem::path(library->second).filename().string();
  const bool before = std::filesystem::exists(golden.expected(pending.model));
  // Where only the operations are other ones, the trajectory stays as it is, with what is known of its origin.
  const bool same = before && same_bits(pending.obtained(), golden.expected(pending.model));
  if (!same) copy_golden(pending.obtained(), golden.expected(pending.model), changes);
  write_summary(golden, pending.model, operations_of(run));
  clear_result_folder(result_folder(out, pending.case_name, pending.model));
  return same ? "operations" : before ? "replaced" : "new";
}

void export_case(const rendering::Generators& generators, const GoldenCase& golden,
                 const std::vector<std::string>& models, const std::filesystem::path& to) {
  if (!golden.scene.empty())
    throw UsageError(
        fmt::format("{}: a scene has no one mesh to write; its file goes to touchstone replay --scene", golden.name));
  if (golden.loop)
    throw UsageError(
        fmt::format("{}: closes a loop, which is no replay; for bisect: --measure with touchstone check "
                    "--ctest",
                    golden.name));
  ensure_writable_folder(to);
  save_mesh(case_mesh(generators, golden), to / "mesh.obj");
  save_trajectory(to / "trajectory.csv", case_trajectory(generators, golden));
  for (const std::string& model : models) {
    rendering::Model exported = case_model(golden, model);
    take_pictures_along(exported, to);
    write_file(to / (model + ".json"), model_to_json(exported, to));
    if (std::filesystem::exists(golden.expected(model))) copy_golden(golden.expected(model), to / (model + ".h5"), {});
  }
}

}  // namespace touchstone::golden
