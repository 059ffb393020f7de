// The recording that a search asks for, made of a blind case's object.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>

namespace touchstone::blind {

// How many cases the full blind test has of each set.
const std::map<std::string, std::size_t>& blind_full_count();

// Writes OUT/train.csv and OUT/holdout.csv: the object of the case named `id` among `answers`, with the tip led along
// `trajectory`, twice with other noise. Throws BadData for a case that the answers' seed does not make.
void record_along_proposal(const std::filesystem::path& answers, const std::string& id,
                           const std::filesystem::path& trajectory, const std::filesystem::path& out);

// The same for every case of `results` that asked for a motion: a folder of cases below `out`, each with the model,
// mesh and instrument of the first. How many.
std::size_t follow_proposals(const std::filesystem::path& answers, const std::filesystem::path& cases,
                             const std::filesystem::path& results, const std::filesystem::path& out);

}  // namespace touchstone::blind
