#include "harness/perception/subjective/simulated_observer.h"

#include <fmt/format.h>

#include <cmath>

#include "harness/base/error.h"
#include "harness/base/random.h"

namespace touchstone::perception {

PairedComparisons simulate_answers(const std::vector<std::string>& conditions, std::span<const double> distance_to_real,
                                   std::size_t subjects, const SimulatedObserver& observer, std::uint64_t seed) {
  if (conditions.size() != distance_to_real.size()) {
    throw UsageError(fmt::format("{} distances for {} conditions", distance_to_real.size(), conditions.size()));
  }
  PairedComparisons result;
  result.conditions = conditions;
  for (std::size_t subject = 0; subject < subjects; ++subject) {
    result.subjects.push_back(fmt::format("simulated-{}", subject + 1));
    Random random = Random(seed).stream(subject);
    std::vector<double> own(distance_to_real.begin(), distance_to_real.end());
    for (double& distance : own) distance += observer.subject_spread * random.normal();
    const auto compare = [&](std::size_t first, std::size_t second) {
      const double felt_first = own[first] + observer.noise * random.normal() - observer.order_bias;
      const double felt_second = own[second] + observer.noise * random.normal();
      const double advantage = felt_second - felt_first;
      const bool guess = std::abs(advantage) < observer.just_noticeable_difference;
      const bool first_chosen = guess ? random.uniform() < 0.5 : advantage > 0.0;
      result.answers.push_back({subject, first, second, first_chosen});
    };
    for (std::size_t i = 0; i < conditions.size(); ++i) {
      for (std::size_t j = i + 1; j < conditions.size(); ++j) compare(i, j);
    }
    for (std::size_t i = 0; i < conditions.size(); ++i) {
      for (std::size_t j = i + 1; j < conditions.size(); ++j) compare(j, i);
    }
  }
  return result;
}

}  // namespace touchstone::perception
