// Blind cases as folders with opaque names, and their answers in one file apart.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "hidden_physics/blind_case.h"

namespace touchstone::hidden_physics {

// DIR/<id>/{mesh.obj, model.json, instrument.json, train.csv, holdout.csv}: what the search may see.
void write_case(const BlindCase& plan, const std::filesystem::path& folder);

// "touchstone-blind-answers/1": what each case hides.
std::string answers_to_json(const std::vector<BlindCase>& plans, std::uint64_t seed);

}  // namespace touchstone::hidden_physics
