// On recordings that this project does not ship: two recordings of the same thing lie nearer to each other than a
// rendering without the right effect does.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "apps/experiments/palpation_rows.h"
#include "harness/perception/statistics.h"
#include "harness/recording/recording_file.h"
#include "harness/testing/shared_data.h"

namespace touchstone::experiments {
namespace {

namespace pc = perception;

TEST(RealData, NeighbouringRowsOfARasterAreNearerThanASpringOnAPlane) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(file, "palpation/ContPalpRAL18T1.csv");
  const Recording recording = load_recording(file);
  const auto comparisons = compare_rows(recording, 10, raster_options());
  ASSERT_GE(comparisons.size(), 10u);
  std::size_t nearer = 0;
  std::vector<double> same;
  std::vector<double> rendered;
  for (const auto& own : comparisons) {
    nearer += own.same() < own.rendered() ? 1 : 0;
    same.push_back(own.same());
    rendered.push_back(own.rendered());
  }
  std::cout << "rows compared " << comparisons.size() << ", the same object nearer in " << nearer
            << "; median distance " << pc::median(same) << " against " << pc::median(rendered) << "\n";
  RecordProperty("compared", static_cast<int>(comparisons.size()));
  RecordProperty("nearer", static_cast<int>(nearer));
  // Far beyond chance: a fair coin stays below two thirds plus three standard deviations.
  const auto n = static_cast<double>(comparisons.size());
  EXPECT_GT(static_cast<double>(nearer), 0.5 * n + 3.0 * std::sqrt(0.25 * n));
  EXPECT_LT(pc::median(same), pc::median(rendered));
}

struct Curve {
  std::vector<double> force_N;
  std::vector<double> tip_m;
};

// The approach of an AFM curve: force, height (measured), ..., segment, time; tip = height + force / k.
Curve read_approach(const std::filesystem::path& file, double cantilever_N_per_m) {
  std::ifstream in(file);
  Curve curve;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream cells(line);
    double force = 0.0;
    double height = 0.0;
    double piezo = 0.0;
    std::string segment;
    if (!(cells >> force >> height >> piezo >> segment) || segment != "False") continue;
    curve.force_N.push_back(force);
    curve.tip_m.push_back(height + force / cantilever_N_per_m);
  }
  return curve;
}

TEST(RealData, HalvesOfAnIndentationAreNearerThanALinearSpring) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(file, "afm-indentation/fmt-tab-fd_version_0.13.3.tab");
  const Curve curve = read_approach(file, 0.02230065831827453);
  ASSERT_GT(curve.force_N.size(), 1000u);
  // The free part gives the force's zero and its noise; contact is where it leaves them for good.
  const std::size_t free = curve.force_N.size() / 5;
  const std::vector<double> quiet(curve.force_N.begin(), curve.force_N.begin() + static_cast<std::ptrdiff_t>(free));
  const double zero = pc::mean(quiet);
  const double noise = pc::standard_deviation(quiet);
  std::size_t contact = curve.force_N.size() - 1;
  while (contact > 0 && curve.force_N[contact] - zero > 3.0 * noise) --contact;
  // As a haptic AFM shows it: 1 nN as 1 N, 1 um as 1 mm.
  const auto presses = [&](std::size_t parity, double exponent) {
    double both = 0.0;
    double squares = 0.0;
    for (std::size_t i = contact; i < curve.force_N.size(); ++i) {
      const double depth = std::pow(std::max(0.0, curve.tip_m[contact] - curve.tip_m[i]), exponent);
      both += depth * (curve.force_N[i] - zero);
      squares += depth * depth;
    }
    pc::PressSignal signal;
    signal.name = exponent == 0.0 ? "measured" : "rendered";
    for (std::size_t i = contact - free / 4 + parity; i < curve.force_N.size(); i += 2) {
      const double depth = curve.tip_m[contact] - curve.tip_m[i];
      signal.t_s.push_back(static_cast<double>(signal.t_s.size()) / 1000.0);
      const double rendered = both / squares * std::pow(std::max(0.0, depth), exponent);
      signal.force_N.push_back(1e9 * (exponent == 0.0 ? curve.force_N[i] - zero : rendered));
      signal.displacement_m.push_back(1e3 * depth);
    }
    return std::vector<pc::PressSignal>{signal};
  };
  pc::EvaluationOptions options;
  options.image.rate_hardness_window = 40;
  const auto result = pc::evaluate(presses(0, 0.0),
                                   {{"the other half of the samples", [&] { return presses(1, 0.0); }},
                                    {"Hertz, F = k d^1.5", [&] { return presses(1, 1.5); }},
                                    {"linear, F = k d", [&] { return presses(1, 1.0); }}},
                                   options);
  std::cout << "the same " << result.conditions[0].distance << ", Hertz " << result.conditions[1].distance
            << ", linear " << result.conditions[2].distance << "\n";
  EXPECT_LT(result.conditions[0].distance, result.conditions[1].distance);
  EXPECT_LT(result.conditions[0].distance, result.conditions[2].distance);
  EXPECT_LT(result.conditions[1].distance, result.conditions[2].distance);
}

}  // namespace
}  // namespace touchstone::experiments
