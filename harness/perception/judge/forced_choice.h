// Simulated observers of a two-alternative forced choice: one interval holds the real thing twice over, the other the
// rendering; the observer feels every channel with unit noise, weighs it by what the channel tells, and names the
// interval with more. They check that stated probabilities are what the model means; they are no evidence about people.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace touchstone::perception {

// Share of right answers in `trials`, where channel i differs by evidence_jnd[i]. Its expectation is
// forced_choice_probability() of the root of the sum of squares.
double simulated_forced_choice(std::span<const double> evidence_jnd, std::size_t trials, std::uint64_t seed);

}  // namespace touchstone::perception
