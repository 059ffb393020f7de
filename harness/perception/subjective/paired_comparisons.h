// Answers of a paired-comparison experiment (section 4): a subject is given two conditions, one after the other, and
// says which felt more like the real process. 6 conditions make 15 pairs, each in both orders.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace touchstone::perception {

struct Answer {
  std::size_t subject;
  std::size_t first;  // condition given first
  std::size_t second;
  bool first_chosen;
};

struct PairedComparisons {
  std::vector<std::string> conditions;
  std::vector<std::string> subjects;
  std::vector<Answer> answers;

  // wins(i, j): how often i was chosen over j, in either order.
  [[nodiscard]] Eigen::MatrixXd wins() const;
  // wins(i, j) of those answers where i came first.
  [[nodiscard]] Eigen::MatrixXd wins_as_first() const;
  // Share of its comparisons in which each condition was chosen (figure 12); NaN for one that was never compared.
  [[nodiscard]] std::vector<double> fraction_preferred() const;
  [[nodiscard]] PairedComparisons without_subject(std::size_t subject) const;
};

// CSV with the header subject,first,second,chosen; `chosen` is the name of one of the two. Names are collected in the
// order of their appearance, unless `conditions` gives them: then any other name is an error. Throws BadData naming
// file, line, value and what was expected.
PairedComparisons read_answers(const std::filesystem::path& file, const std::vector<std::string>& conditions = {});
// The same format; read_answers() gives it back.
std::string format_answers(const PairedComparisons& comparisons);

// Circular triads of one subject's answers (Kendall and Babington Smith 1940): a over b, b over c, c over a.
struct CircularTriads {
  std::size_t subject;
  std::size_t complete_rounds;  // rounds with every pair once; only those are counted
  double triads;                // mean over the rounds
  double consistence;           // zeta: 1 without circular triads, 0 with as many as there can be
};
// A subject's answers make a first round (the first answer to each pair) and a second one (the second answer).
std::vector<CircularTriads> circular_triads(const PairedComparisons& comparisons);

}  // namespace touchstone::perception
