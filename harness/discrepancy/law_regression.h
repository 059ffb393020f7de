// Terms of a law (law_library.h) regressed on what a model leaves: every term at every start on the training blocks,
// beside all that is free in the model, scored on the validation blocks, in the recording and in the simulated ones in
// which nothing is missing.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "harness/discrepancy/law_library.h"
#include "harness/discrepancy/search_state.h"

namespace touchstone::discrepancy {

// A term with its constants at one start.
struct LawStart {
  const LawTerm* term = nullptr;
  rendering::NamedParameters entry;  // sizes zero
};

rendering::Side side_of(const LawTerm& term);
// Of an effect that declares it.
const rendering::ParameterDeclaration& declaration(const rendering::DeclaredEffect& effect, const std::string& name);
LawStart law_start(const LawTerm& term, const std::shared_ptr<const rendering::DeclaredEffect>& law,
                   const std::map<std::string, double>& constants);

// What a start's regression says of the recording and of the simulated ones.
struct RegressedLaw {
  std::size_t start = 0;
  double train_gain = 0.0;
  double gain = 0.0;               // validation
  std::vector<double> null_gains;  // in each simulated recording
  std::vector<double> sizes;       // of the linear parameters
};

// Of every start that the model's renderer can run.
std::vector<RegressedLaw> regress_laws(const SearchState& state, const std::vector<LawStart>& starts);

// What a gain must exceed: the most that any start gains in each simulated recording, and more.
double law_bar(const std::vector<RegressedLaw>& all, const SearchSettings& settings);

}  // namespace touchstone::discrepancy
