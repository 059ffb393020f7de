// Two effects of which neither helps alone: forces A and A + B/8 whose difference is what is missing. The first lacks
// B, the second brings eight times as much that is not there.
#include "harness/discrepancy/pair_move.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "harness/discrepancy/catalogue_for_test.h"
#include "harness/discrepancy/model_edit.h"
#include "harness/discrepancy/plane_for_test.h"
#include "harness/discrepancy/two_recordings_for_test.h"

namespace touchstone::discrepancy {
using rendering::Candidate;

namespace {

double wave_a(double t_s) { return std::sin(5.0 * t_s); }
double wave_b(double t_s) { return std::cos(3.1 * t_s); }
constexpr double share_of_b = 0.125;

// The plane of the other tests, and forces along y that are switched on by amplitude.
class WavesPredictor final : public rendering::Predictor {
 public:
  explicit WavesPredictor(const MotionColumns& motion) : plane_(motion), t_s_(motion.t_s) {}
  rendering::Prediction predict(const rendering::Model& model) override {
    rendering::Prediction prediction = plane_.predict(model);
    for (const rendering::NamedParameters& entry : model.instrument) {
      const auto amplitude = entry.parameters.find("amplitude_N");
      if (amplitude == entry.parameters.end()) continue;
      for (std::size_t i = 0; i < t_s_.size(); ++i) {
        const double t = t_s_[i];
        const double wave = entry.name == "carrier"  ? wave_a(t)
                            : entry.name == "marked" ? wave_a(t) + share_of_b * wave_b(t)
                                                     : std::sin(11.0 * t);
        prediction.f_W_N[i].y() += amplitude->second * wave;
      }
    }
    return prediction;
  }

 private:
  PlanePredictor plane_;
  std::vector<double> t_s_;
};

Candidate wave(const std::string& name) {
  return {name, rendering::Side::instrument, {{"amplitude_N", "N", -100, 100, 0.0, ""}}};
}

struct TwoWaves {
  std::vector<Candidate> library{wave("idle"), wave("carrier"), wave("marked")};
  rendering::Model start;
  std::optional<TwoRecordings> recordings;

  // `size_N` of the force that is missing, `stray_N` of one that no candidate makes.
  TwoWaves(double size_N, double stray_N) {
    start.renderer = "plane";
    start.parameters["stiffness_N_per_m"] = 900.0;
    const InstrumentDescription instrument = small_noise(1.0);
    const auto measure = [&](double phase, std::uint64_t seed) {
      const MotionColumns path = hand(phase, 1.0);
      std::vector<Vec3> f_W_N = WavesPredictor(path).predict(start).f_W_N;
      for (std::size_t i = 0; i < f_W_N.size(); ++i) {
        f_W_N[i].y() += size_N * wave_b(path.t_s[i]) + stray_N * std::sin(23.0 * path.t_s[i] + 1.0);
      }
      return measured(path, std::move(f_W_N), instrument, seed);
    };
    recordings.emplace(measure(0.0, 21), measure(1.1, 22), instrument, start,
                       [](const MotionColumns& motion) { return std::make_unique<WavesPredictor>(motion); });
  }

  [[nodiscard]] SearchResult search() const {
    return search_effects(recordings->data, start, library, {}, [](const std::string&) {});
  }
};

TEST(PairMove, FindsTwoEffectsOfWhichNeitherPassesAlone) {
  const SearchResult result = TwoWaves(0.2, 0.0).search();
  ASSERT_FALSE(result.steps.empty());
  for (const Trial& trial : result.steps.front().trials) {
    EXPECT_TRUE(!trial.partner.empty() || trial.verdict.kind != TrialVerdict::Kind::added)
        << trial.name << " alone was thought enough";
  }
  std::vector<std::string> names;
  for (const FoundEffect& effect : result.found) names.push_back(effect.name);
  EXPECT_THAT(names, ::testing::UnorderedElementsAre("carrier", "marked"));
  const double marked = find_entry(result.model, "marked")->parameters.at("amplitude_N");
  EXPECT_NEAR(marked, 0.2 / share_of_b, 0.1 * 0.2 / share_of_b);
  EXPECT_NEAR(find_entry(result.model, "carrier")->parameters.at("amplitude_N"), -marked, 0.05 * marked);
}

TEST(PairMove, NamesNoPairWhereWhatIsMissingIsNoneOfTheirs) {
  const SearchResult result = TwoWaves(0.0, 0.3).search();
  EXPECT_TRUE(result.found.empty());
  EXPECT_GT(result.goodness, 2.0);
}

TEST(PairMove, APairOfWhichOneIsIdleIsRefusedForThatOne) {
  const TwoWaves world(0.2, 0.0);
  const SearchSettings settings;
  SearchState state(world.recordings->data, world.library, settings, world.start);
  state.refit();
  state.renew_noise(state.current.model);
  const BaselineScore baseline = baseline_score(state);
  std::vector<Trial> singles;
  for (const Candidate& candidate : world.library) {
    if (auto trial = try_candidate(state, baseline, candidate)) singles.push_back(*trial);
  }
  ASSERT_EQ(singles.size(), 3U);
  const auto pairs = try_pairs(state, baseline, singles);
  EXPECT_FALSE(pairs.empty());
  for (const Trial& pair : pairs) {
    const bool idle = pair.name == "idle" || pair.partner == "idle";
    EXPECT_EQ(pair.verdict.passed(), !idle) << pair.title() << ": " << pair.verdict.words;
  }
}

TEST(PairMove, LawsOfDryFrictionAreOfOneKind) {
  const auto catalogue = whole_catalogue();
  const EffectLibrary library(catalogue);
  EXPECT_TRUE(library.of_one_kind("stribeck-friction", "anisotropic-friction"));
  EXPECT_TRUE(library.of_one_kind("coulomb-friction", "stribeck-friction"));
  EXPECT_FALSE(library.of_one_kind("stribeck-friction", "viscous-friction"));
}

}  // namespace
}  // namespace touchstone::discrepancy
