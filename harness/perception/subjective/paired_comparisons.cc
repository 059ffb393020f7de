#include "harness/perception/subjective/paired_comparisons.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/input_files.h"

namespace touchstone::perception {
namespace {

std::vector<std::string> cells_of(std::string line) {
  if (!line.empty() && line.back() == '\r') line.pop_back();
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) {
    const auto first = cell.find_first_not_of(" \t");
    const auto last = cell.find_last_not_of(" \t");
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
  }
  if (!line.empty() && line.back() == ',') cells.emplace_back();
  return cells;
}

std::size_t index_of(std::vector<std::string>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  names.push_back(name);
  return names.size() - 1;
}

}  // namespace

Eigen::MatrixXd PairedComparisons::wins_as_first() const {
  const auto n = static_cast<Eigen::Index>(conditions.size());
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(n, n);
  for (const auto& a : answers) {
    if (a.first_chosen) result(static_cast<Eigen::Index>(a.first), static_cast<Eigen::Index>(a.second)) += 1.0;
  }
  return result;
}

Eigen::MatrixXd PairedComparisons::wins() const {
  const auto n = static_cast<Eigen::Index>(conditions.size());
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(n, n);
  for (const auto& a : answers) {
    const auto chosen = static_cast<Eigen::Index>(a.first_chosen ? a.first : a.second);
    const auto other = static_cast<Eigen::Index>(a.first_chosen ? a.second : a.first);
    result(chosen, other) += 1.0;
  }
  return result;
}

std::vector<double> PairedComparisons::fraction_preferred() const {
  const Eigen::MatrixXd w = wins();
  std::vector<double> result;
  for (Eigen::Index i = 0; i < w.rows(); ++i) {
    result.push_back(w.row(i).sum() / (w.row(i).sum() + w.col(i).sum()));  // 0 / 0 is NaN
  }
  return result;
}

PairedComparisons PairedComparisons::without_subject(std::size_t subject) const {
  PairedComparisons result{conditions, subjects, {}};
  std::copy_if(answers.begin(), answers.end(), std::back_inserter(result.answers),
               [subject](const Answer& a) { return a.subject != subject; });
  return result;
}

PairedComparisons read_answers(const std::filesystem::path& file, const std::vector<std::string>& conditions) {
  note_input_file(file);
  std::istringstream in(read_file(file));
  PairedComparisons result;
  result.conditions = conditions;
  std::string line;
  std::size_t number = 0;
  const auto fail = [&](const std::string& message) {
    throw BadData(fmt::format("{}:{}: {}", file.string(), number, message));
  };
  while (std::getline(in, line)) {
    ++number;
    const auto cells = cells_of(line);
    if (cells.empty()) continue;
    if (number == 1) {
      if (cells != std::vector<std::string>{"subject", "first", "second", "chosen"}) {
        fail(fmt::format("the header is '{}'; subject,first,second,chosen was expected", line));
      }
      continue;
    }
    if (cells.size() != 4) fail(fmt::format("{} cells; subject,first,second,chosen are 4", cells.size()));
    for (std::size_t c = 0; c < cells.size(); ++c) {
      if (cells[c].empty()) fail(fmt::format("column {} is empty", c + 1));
    }
    const bool first_chosen = cells[3] == cells[1];
    if (!first_chosen && cells[3] != cells[2]) {
      fail(fmt::format("'{}' was chosen, which is neither '{}' nor '{}'", cells[3], cells[1], cells[2]));
    }
    if (cells[1] == cells[2]) fail(fmt::format("'{}' is compared with itself", cells[1]));
    const std::size_t subject = index_of(result.subjects, cells[0]);
    const std::size_t first = index_of(result.conditions, cells[1]);
    const std::size_t second = index_of(result.conditions, cells[2]);
    if (!conditions.empty() && result.conditions.size() > conditions.size()) {
      fail(fmt::format("'{}' is no condition of this evaluation", result.conditions[conditions.size()]));
    }
    result.answers.push_back({subject, first, second, first_chosen});
  }
  if (result.answers.empty()) {
    throw BadData(fmt::format(
        "{}: no answers; a header subject,first,second,chosen and one line per answer were expected", file.string()));
  }
  return result;
}

std::string format_answers(const PairedComparisons& comparisons) {
  std::string text = "subject,first,second,chosen\n";
  for (const auto& a : comparisons.answers) {
    text += fmt::format("{},{},{},{}\n", comparisons.subjects[a.subject], comparisons.conditions[a.first],
                        comparisons.conditions[a.second], comparisons.conditions[a.first_chosen ? a.first : a.second]);
  }
  return text;
}

std::vector<CircularTriads> circular_triads(const PairedComparisons& comparisons) {
  const std::size_t n = comparisons.conditions.size();
  std::vector<CircularTriads> result;
  for (std::size_t subject = 0; subject < comparisons.subjects.size(); ++subject) {
    // rounds[r](i, j) is 1 where i beat j in the r-th answer to that pair.
    std::vector<Eigen::MatrixXi> rounds;
    Eigen::MatrixXi seen = Eigen::MatrixXi::Zero(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
    for (const auto& a : comparisons.answers) {
      if (a.subject != subject) continue;
      const auto low = static_cast<Eigen::Index>(std::min(a.first, a.second));
      const auto high = static_cast<Eigen::Index>(std::max(a.first, a.second));
      const auto round = static_cast<std::size_t>(seen(low, high)++);
      if (rounds.size() <= round) rounds.resize(round + 1, Eigen::MatrixXi::Zero(seen.rows(), seen.cols()));
      const auto winner = static_cast<Eigen::Index>(a.first_chosen ? a.first : a.second);
      rounds[round](winner, winner == low ? high : low) = 1;
    }
    const double m = static_cast<double>(n);
    const double most = n % 2 == 1 ? (m * m * m - m) / 24.0 : (m * m * m - 4.0 * m) / 24.0;
    CircularTriads own{subject, 0, 0.0, std::numeric_limits<double>::quiet_NaN()};
    for (const auto& round : rounds) {
      if (round.sum() != static_cast<int>(n * (n - 1) / 2)) continue;
      ++own.complete_rounds;
      double squares = 0.0;
      for (Eigen::Index i = 0; i < round.rows(); ++i) squares += std::pow(static_cast<double>(round.row(i).sum()), 2);
      own.triads += m * (m - 1.0) * (2.0 * m - 1.0) / 12.0 - 0.5 * squares;
    }
    if (own.complete_rounds > 0 && most > 0.0) {
      own.triads /= static_cast<double>(own.complete_rounds);
      own.consistence = 1.0 - own.triads / most;
    }
    result.push_back(own);
  }
  return result;
}

}  // namespace touchstone::perception
