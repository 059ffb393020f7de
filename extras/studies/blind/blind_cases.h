// The search of blind cases as cases for the engine (extras/runs/case_engine.h): in shards, on Slurm, by job lists of
// any farm. What the score and the next motion need of a search, findings.json and next.csv, stands in its row, so that
// a task whose folder is its own node's brings it home.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "case_engine.h"

namespace touchstone::blind {

// The folders of cases in `cases` (those with a model.json), by their names. Throws BadData where there is no such
// folder.
std::vector<std::filesystem::path> blind_case_folders(const std::filesystem::path& cases);

// Names the cases by the hashes of their files: rows are of these recordings and of no others.
runs::CaseTable blind_case_table(const std::vector<std::filesystem::path>& folders);

// Searches a case and writes its findings into the folder `out`; throws Error where it cannot be searched.
using SearchCase = std::function<void(const std::filesystem::path& folder, const std::filesystem::path& out)>;

// A case whose findings are in `results` already is not searched again.
runs::CaseJob blind_job(const std::vector<std::filesystem::path>& folders, const std::filesystem::path& results,
                        const SearchCase& search);

// Writes the findings of rows that other machines made into `results`, where they are not there.
void write_findings(const std::vector<std::filesystem::path>& folders, const runs::CaseStore& store,
                    const std::filesystem::path& results);

}  // namespace touchstone::blind
