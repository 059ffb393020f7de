// How long the blocks of a block bootstrap must be for a series that is correlated in time.
// Source: Politis and White, "Automatic block-length selection for the dependent bootstrap", Econometric Reviews 23,
// 2004, with the correction of Patton, Politis and White, Econometric Reviews 28, 2009: the circular block bootstrap.
#pragma once

#include <cstddef>
#include <span>

namespace touchstone::pipeline {

// In elements of the series, at least 1 and at most a quarter of it. 1 for a series that does not vary.
std::size_t automatic_block_length(std::span<const double> series);

}  // namespace touchstone::pipeline
