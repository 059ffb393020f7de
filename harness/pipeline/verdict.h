// What a board says, in words and in a table that a terminal of 80 columns holds.
#pragma once

#include <string>

#include "harness/pipeline/board.h"

namespace touchstone::pipeline {

// Two or three sentences: who is best by how much, who cannot be told apart, who did not run.
std::string verdict(const Task& task);
std::string verdict(const Overall& overall, std::size_t tasks);

// Rank, renderer, error, floor of the input, how many times the floor the error is, felt error, operations and time of
// a step; best first.
std::string short_table(const Task& task);

// "1.3", "14": an error over a floor; "-" where it is no number.
std::string times_floor(double error_N, double floor_N);

// The text in lines of at most `width` columns, broken at spaces; lines after the first are indented by `indent`.
std::string wrapped(std::string_view text, std::size_t width, std::size_t indent = 0);

// Of the terminal that standard output is, COLUMNS where it is none, else 80; at least 40.
std::size_t terminal_width();

}  // namespace touchstone::pipeline
