// A metric along a line of commits, as far as it has been measured: position 0 is the good end, the last the bad one. A
// commit may be broken (it does not build or run), and each may be measured several times, since metrics are noisy.
#pragma once

#include <cstddef>
#include <vector>

namespace touchstone::bisection {

class CommitCurve {
 public:
  // `commits`: with both ends, so at least 2.
  explicit CommitCurve(std::size_t commits) : commits_(commits) {}

  void add_run(std::size_t position, double value) { commits_.at(position).runs.push_back(value); }
  void set_broken(std::size_t position) { commits_.at(position).broken = true; }

  [[nodiscard]] std::size_t size() const noexcept { return commits_.size(); }
  [[nodiscard]] bool broken(std::size_t position) const { return commits_.at(position).broken; }
  [[nodiscard]] bool measured(std::size_t position) const {
    return !broken(position) && !commits_.at(position).runs.empty();
  }
  [[nodiscard]] std::size_t runs(std::size_t position) const { return commits_.at(position).runs.size(); }
  // Of those that are measured, ascending.
  [[nodiscard]] std::vector<std::size_t> measured_positions() const;

  // Median of the runs: a run that something else slowed down does not move it.
  [[nodiscard]] double level(std::size_t position) const;
  // Standard deviation of one run, pooled over all commits from the deviations from their levels, and its degrees of
  // freedom. 0 with none: each commit gave the same value each time.
  [[nodiscard]] double noise() const;
  [[nodiscard]] std::size_t degrees_of_freedom() const;
  // Of level(to) - level(from).
  [[nodiscard]] double change(std::size_t from, std::size_t to) const { return level(to) - level(from); }
  [[nodiscard]] double change_error(std::size_t from, std::size_t to) const;

 private:
  struct Commit {
    std::vector<double> runs;
    bool broken = false;
  };
  // Variance of a median of n Gaussian values over that of one.
  [[nodiscard]] static double variance_of_median(std::size_t n);
  std::vector<Commit> commits_;
};

}  // namespace touchstone::bisection
