// Forces that no effect of the catalogue makes, written here: the law that is found must predict a second recording,
// say what the force follows, and run from its text.
#include "harness/discrepancy/law_search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>

#include "harness/discrepancy/catalogue_for_test.h"
#include "harness/discrepancy/findings.h"
#include "harness/discrepancy/two_recordings_for_test.h"
#include "harness/rendering/model.h"
#include "harness/surface/embree_surface.h"
#include "renderers/model_predictor.h"

namespace touchstone::discrepancy {
using rendering::Candidate;
using rendering::Model;
using rendering::Prediction;

namespace {

constexpr double stiffness_N_per_m = 900.0;

// A plate with a wave along x, of this amplitude over 40 mm.
struct Plate {
  double wave_m = 0.0;

  [[nodiscard]] double height_m(double x_m) const { return wave_m * std::sin(2.0 * std::numbers::pi * x_m / 0.04); }
  [[nodiscard]] std::shared_ptr<const surface::Surface> surface() const {
    surface::TriangleMesh mesh;
    mesh.source = "plate";
    const std::int32_t strips = wave_m > 0.0 ? 400 : 1;
    for (int i = 0; i <= strips; ++i) {
      const double x_m = -0.1 + 0.2 * i / strips;
      mesh.vertices_W_m.emplace_back(x_m, -0.1, height_m(x_m));
      mesh.vertices_W_m.emplace_back(x_m, 0.1, height_m(x_m));
      if (i == 0) continue;
      const auto at = static_cast<std::int32_t>(2 * i);
      mesh.triangles.push_back({at - 2, at, at + 1});
      mesh.triangles.push_back({at - 2, at + 1, at - 1});
    }
    return make_embree_surface(mesh);
  }
};

// What the forces below might be mistaken for.
std::vector<Candidate> likely_mistaken() {
  const std::vector<std::string> names{"coulomb-friction", "viscous-friction", "power-law-stiffness", "force-bias",
                                       "force-drift"};
  std::vector<Candidate> all = whole_catalogue();
  std::erase_if(all, [&](const Candidate& c) { return std::ranges::find(names, c.name) == names.end(); });
  return all;
}

// Presses while it slides, off the surface now and then; 20 s at 250 Hz.
MotionColumns strokes(double phase) {
  MotionColumns motion;
  for (int i = 0; i < 5000; ++i) {
    const double t = 0.004 * i;
    motion.t_s.push_back(t);
    motion.p_W_m.emplace_back(0.03 * std::sin(1.1 * t + phase), 0.025 * std::cos(1.7 * t + 2.0 * phase),
                              -0.0015 + 0.0028 * std::sin(2.3 * t + phase));
  }
  return motion;
}

// What acts beside the spring of the plate, at a sample of the true path, where the spring presses like this.
using Force = std::function<Vec3(const MotionColumns& path, std::size_t i, const Prediction& spring)>;

Model spring_of(double stiffness) {
  Model model;
  model.renderer = "god-object";
  model.parameters["stiffness_N_per_m"] = stiffness;
  return model;
}

recording::Recording record(const Plate& plate, const Force& hidden, double phase, std::uint64_t seed) {
  MotionColumns path = strokes(phase);
  for (Vec3& p : path.p_W_m) p.z() += plate.height_m(p.x());
  const Prediction spring =
      renderers::make_model_predictor(plate.surface(), path)->predict(spring_of(stiffness_N_per_m));
  std::vector<Vec3> f_W_N = spring.f_W_N;
  for (std::size_t i = 0; i < path.size(); ++i) f_W_N[i] += hidden(path, i, spring);
  return measured(path, std::move(f_W_N), small_noise(1.0), seed);
}

struct Answer {
  Findings findings;
  double without_N = 0.0;
  double with_N = 0.0;
  double read_back_N = 0.0;  // by the model's text
  [[nodiscard]] double closed() const {
    const double noise = findings.search.noise_rms_N;
    return 1.0 - (with_N * with_N - noise * noise) / (without_N * without_N - noise * noise);
  }
  [[nodiscard]] std::string follows() const { return law_follows(findings.search.law); }
};

Answer search(const Force& hidden, const Plate& plate = {}) {
  const auto surface = plate.surface();
  const Model start = spring_of(1.05 * stiffness_N_per_m);
  const rendering::MakePredictor make = [&](const MotionColumns& motion) {
    return renderers::make_model_predictor(surface, motion);
  };
  const TwoRecordings two(record(plate, hidden, 0.0, 31), record(plate, hidden, 1.3, 32), small_noise(1.0), start,
                          make);
  Answer answer;
  answer.findings.search = search_effects(two.data, start, likely_mistaken(), {}, [](const std::string&) {});
  conclude(answer.findings, likely_mistaken());
  const auto rms_N = [&](const Model& model) {
    return rms_force_error_N(two.data.holdout, two.data.holdout.predictor->predict(model));
  };
  const SearchResult& found = answer.findings.search;
  answer.without_N = rms_N(found.base);
  if (!found.law.found()) return answer;
  answer.with_N = rms_N(found.law.model);
  answer.read_back_N = rms_N(rendering::parse_model(rendering::model_to_json(found.law.model), "again"));
  return answer;
}

void expect_law(const Answer& answer, const std::string& follows) {
  ASSERT_TRUE(answer.findings.search.law.found());
  EXPECT_EQ(answer.findings.verdict, FindingsVerdict::unexplained);
  EXPECT_THAT(answer.follows(), ::testing::HasSubstr(follows));
  EXPECT_GT(answer.closed(), 0.7);
  EXPECT_DOUBLE_EQ(answer.read_back_N, answer.with_N);
}

TEST(LawSearch, FindsTheLayerUnderASkin) {
  // Hertz: the power 3/2 of what is beyond.
  const Answer answer = search([](const MotionColumns& path, std::size_t i, const Prediction&) {
    const double beyond = std::max(0.0, -path.p_W_m[i].z() - 0.0022);
    return Vec3(0.0, 0.0, 2.0e4 * std::pow(beyond, 1.5));
  });
  expect_law(answer, "depth");
}

TEST(LawSearch, FindsForcesThatRepeatAlongASlantedAxis) {
  const Vec3 axis = Vec3(0.8, 0.5, 0.33).normalized();
  const Answer answer = search([&](const MotionColumns& path, std::size_t i, const Prediction&) {
    const double turn = 2.0 * std::numbers::pi * axis.dot(path.p_W_m[i]) / 0.017;
    return Vec3(0.3 * (std::sin(turn + 0.4) + 0.15 * std::sin(2.0 * turn)) * axis);
  });
  expect_law(answer, "place");
}

TEST(LawSearch, FindsAZeroThatWarmsUp) {
  const Answer answer = search([](const MotionColumns& path, std::size_t i, const Prediction&) {
    return Vec3((1.0 - 0.6 * std::exp(-path.t_s[i] / 2.0) - 0.4 * std::exp(-path.t_s[i] / 8.0)) * Vec3(0.5, -0.3, 0.9));
  });
  expect_law(answer, "time");
}

// A cantilever along z, `softness` times as soft across as the plate is: on a slope the load moves the tip downhill
// until it presses with the spring's force less what the way down the slope takes.
Force bending(double softness) {
  return [=](const MotionColumns&, std::size_t i, const Prediction& spring) {
    const Vec3& n = spring.n_W[i];
    const double square = n.head<2>().squaredNorm();
    return Vec3(-spring.normal_N[i] * softness * square / (1.0 + softness * square) * n);
  };
}

TEST(LawSearch, FindsAToolThatBends) { expect_law(search(bending(6.0), Plate{0.002}), "slope of the surface"); }

// Too little for measures of the whole residual: the law itself shows it, by holding on the second recording.
TEST(LawSearch, WhatDrownsInTheWholeIsShownByTheLawThatHolds) {
  const Answer answer = search(bending(0.35), Plate{0.002});
  const SearchResult& found = answer.findings.search;
  EXPECT_FALSE(found.leaves_too_much());
  EXPECT_FALSE(found.leaves_structure());
  EXPECT_TRUE(found.law_holds());
  EXPECT_EQ(answer.findings.verdict, FindingsVerdict::unexplained);
  EXPECT_THAT(answer.follows(), ::testing::HasSubstr("slope of the surface"));
}

TEST(LawSearch, ALawHoldsByItsGainOnHeldOutDataAlone) {
  SearchResult found;
  found.law.pieces.resize(1);
  found.law_gain = 41.0;
  found.law_error = 20.0;
  found.law_share = 0.5;
  EXPECT_TRUE(found.law_holds());
  for (const auto spoil : {+[](SearchResult& r) { r.law_gain = 39.0; }, +[](SearchResult& r) { r.law_share = 0.2; },
                           +[](SearchResult& r) { r.law_gain = std::numeric_limits<double>::quiet_NaN(); },
                           +[](SearchResult& r) { r.law_error = std::numeric_limits<double>::quiet_NaN(); },
                           +[](SearchResult& r) { r.law_share = std::numeric_limits<double>::quiet_NaN(); },
                           +[](SearchResult& r) { r.law.pieces.clear(); }}) {
    SearchResult spoiled = found;
    spoil(spoiled);
    EXPECT_FALSE(spoiled.law_holds());
  }
  // What could not be judged calls for one.
  found.goodness = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(found.calls_for_law());
}

TEST(LawSearch, AddsNothingWhereTheCatalogueSuffices) {
  // Nothing, and plain friction as the sign of the velocity (Coulomb 1785).
  for (const double mu : {0.0, 0.3}) {
    const Answer answer = search([=](const MotionColumns& path, std::size_t i, const Prediction&) {
      const double depth = std::max(0.0, -path.p_W_m[i].z());
      const std::size_t j = std::max<std::size_t>(1, i);
      Vec3 way = path.p_W_m[j] - path.p_W_m[j - 1];
      way.z() = 0.0;
      return Vec3(-mu * stiffness_N_per_m * depth * way.normalized());
    });
    EXPECT_FALSE(answer.findings.search.law.found()) << mu;
    EXPECT_NE(answer.findings.verdict, FindingsVerdict::unexplained) << mu;
  }
}

}  // namespace
}  // namespace touchstone::discrepancy
