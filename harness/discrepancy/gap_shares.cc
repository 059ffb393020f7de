#include "harness/discrepancy/gap_shares.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace touchstone::discrepancy {
using rendering::Model;

namespace {

// The effects of `end` that `start` has not, by name.
std::vector<std::string> new_effects(const Model& start, const Model& end) {
  std::vector<std::string> names;
  for (const auto* entries : {&end.effects, &end.instrument}) {
    for (const rendering::NamedParameters& entry : *entries) {
      if (find_entry(start, entry.name) == nullptr) names.push_back(entry.name);
    }
  }
  return names;
}

// `start` with the parts whose bits are set: bit 0 the parameters, then the new effects in their order.
Model with_parts(const Model& start, const Model& end, const std::vector<std::string>& effects, unsigned parts) {
  Model model = end;
  if ((parts & 1U) == 0U) model.parameters = start.parameters;
  for (auto* entries : {&model.effects, &model.instrument}) {
    std::erase_if(*entries, [&](const rendering::NamedParameters& entry) {
      const auto place = std::find(effects.begin(), effects.end(), entry.name) - effects.begin();
      return static_cast<std::size_t>(place) < effects.size() && (parts & (2U << place)) == 0U;
    });
  }
  return model;
}

double factorial(std::size_t n) { return std::tgamma(static_cast<double>(n) + 1.0); }

}  // namespace

std::vector<GapShare> share_gap(const Evidence& evidence, const Model& start, const Model& end) {
  const auto effects = new_effects(start, end);
  const std::size_t count = effects.size() + 1;
  std::vector<double> square(std::size_t{1} << count);
  for (unsigned parts = 0; parts < square.size(); ++parts) {
    const Model model = with_parts(start, end, effects, parts);
    const double rms_N = rms_force_error_N(evidence, evidence.predictor->predict(model));
    square[parts] = rms_N * rms_N;
  }
  const double before = std::max(square.front(), std::numeric_limits<double>::min());
  std::vector<GapShare> shares(count);
  for (std::size_t i = 0; i < count; ++i) {
    shares[i].name = i == 0 ? "stiffness" : effects[i - 1];
    const unsigned own = 1U << i;
    for (unsigned others = 0; others < square.size(); ++others) {
      if ((others & own) != 0U) continue;
      const auto size = static_cast<std::size_t>(std::popcount(others));
      const double weight = factorial(size) * factorial(count - size - 1) / factorial(count);
      shares[i].share += weight * (square[others] - square[others | own]) / before;
    }
  }
  std::stable_sort(shares.begin(), shares.end(), [](const auto& a, const auto& b) { return a.share > b.share; });
  double left = 1.0;
  for (GapShare& share : shares) {
    left -= share.share;
    share.left_N = std::sqrt(std::max(0.0, left) * square.front());
  }
  return shares;
}

std::vector<GapShare> merge_inseparable(std::vector<GapShare> shares) {
  constexpr double most = 2.0, least = -1.0;
  if (std::ranges::all_of(shares, [](const GapShare& s) { return s.share >= least && s.share <= most; })) return shares;
  GapShare all{"", 0.0, shares.back().left_N};
  for (std::size_t i = 0; i < shares.size(); ++i) {
    all.name += (i == 0 ? "" : i + 1 == shares.size() ? " and " : ", ") + shares[i].name;
    all.share += shares[i].share;
  }
  all.name += " together";
  return {all};
}

}  // namespace touchstone::discrepancy
