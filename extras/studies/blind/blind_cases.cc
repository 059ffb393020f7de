#include "blind/blind_cases.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <nlohmann/json.hpp>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/hash.h"
#include "harness/base/json_reader.h"

namespace touchstone::blind {
namespace {

// Of the columns below.
constexpr std::size_t findings_column = 5;
constexpr std::size_t next_column = 6;

std::string text_or_nothing(const std::filesystem::path& file) {
  return std::filesystem::exists(file) ? read_file(file) : std::string();
}

}  // namespace

std::vector<std::filesystem::path> blind_case_folders(const std::filesystem::path& cases) {
  if (!std::filesystem::is_directory(cases))
    throw BadData(fmt::format("{}: no such folder; make cases with: touchstone blind make", cases.string()));
  std::vector<std::filesystem::path> folders;
  for (const auto& entry : std::filesystem::directory_iterator(cases)) {
    if (std::filesystem::exists(entry.path() / "model.json")) folders.push_back(entry.path());
  }
  if (folders.empty()) {
    throw BadData(fmt::format("{}: no folder with a model.json is in it; make cases with: touchstone blind make",
                              cases.string()));
  }
  std::ranges::sort(folders);
  return folders;
}

runs::CaseTable blind_case_table(const std::vector<std::filesystem::path>& folders) {
  nlohmann::ordered_json specification{{"schema", "touchstone-blind-cases/1"}};
  for (const auto& folder : folders) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
    std::ranges::sort(files);
    auto& own = specification["cases"][folder.filename().string()];
    for (const auto& file : files) own[file.filename().string()] = sha256_file(file);
  }
  using enum runs::CaseColumn::Type;
  return {specification.dump(),
          folders.size(),
          {{"case_id", text},
           {"verdict", text},
           {"effects", text},
           {"holdout_after_N", real},
           {"search_s", real, true},
           {"findings", text, true},
           {"next_csv", text, true}},
          "cases",
          "--rows"};
}

runs::CaseJob blind_job(const std::vector<std::filesystem::path>& folders, const std::filesystem::path& results,
                        const SearchCase& search) {
  runs::CaseJob job;
  job.what = "cases searched";
  job.cases = folders.size();
  job.alone = true;  // a search uses the cores itself
  job.run = [folders, results, search](runs::CaseRow& row, const runs::PartDone&) {
    const std::string id = folders[row.number].filename().string();
    const auto out = results / id;
    row.values = {id};
    const auto start = std::chrono::steady_clock::now();
    const bool searched = !std::filesystem::exists(out / "findings.json");
    if (searched) search(folders[row.number], out);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const auto findings = load_json(out / "findings.json");
    std::string effects;
    for (const auto& effect : findings.at("effects"))
      effects += (effects.empty() ? "" : " ") + effect.at("name").get<std::string>();
    row.values.emplace_back(findings.at("verdict").get<std::string>());
    row.values.emplace_back(effects);
    row.values.emplace_back(findings.at("gap").at("holdout").at("after").get<double>());
    row.values.push_back(searched ? runs::CaseValue(seconds) : runs::CaseValue());
    row.values.emplace_back(read_file(out / "findings.json"));
    row.values.emplace_back(text_or_nothing(out / "next.csv"));
  };
  return job;
}

void write_findings(const std::vector<std::filesystem::path>& folders, const runs::CaseStore& store,
                    const std::filesystem::path& results) {
  for (const runs::CaseRow& row : store.rows(0, folders.size())) {
    const auto out = results / folders[row.number].filename();
    if (!row.error.empty() || std::filesystem::exists(out / "findings.json")) continue;
    ensure_writable_folder(out);
    const std::string& next = runs::as_text(row.values[next_column]);
    if (!next.empty()) write_file(out / "next.csv", next);
    write_file(out / "findings.json", runs::as_text(row.values[findings_column]));
  }
}

}  // namespace touchstone::blind
