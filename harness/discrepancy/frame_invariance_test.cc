// Where a measurement's origin lies and how its axes are turned is nobody's finding: an object that was misplaced, and
// one that is softer at a place, are found alike wherever the measurement was written down.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "harness/discrepancy/catalogue_for_test.h"
#include "harness/discrepancy/findings.h"
#include "harness/discrepancy/plane_for_test.h"
#include "harness/discrepancy/two_recordings_for_test.h"
#include "harness/surface/embree_surface.h"
#include "renderers/catalogue.h"
#include "renderers/instrument/catalogue.h"
#include "renderers/model_predictor.h"

namespace touchstone::discrepancy {
namespace {

using recording::Recording;
using rendering::Candidate;
using rendering::Model;
using rendering::NamedParameters;
using rendering::Prediction;
using surface::Surface;
using surface::TriangleMesh;

struct Frame {
  std::string name;
  Quat turn = Quat::Identity();
  Vec3 shift_m = Vec3::Zero();
  [[nodiscard]] Vec3 place(const Vec3& p_m) const { return turn * p_m + shift_m; }
};

Quat turned(double angle_rad, const Vec3& axis) { return Quat(Eigen::AngleAxisd(angle_rad, axis.normalized())); }

// Of an object that looks different from every side, so that no shift or turn of it goes unseen.
double height_m(double x_m, double y_m) {
  return 0.004 * std::sin(70.0 * x_m + 0.4) + 0.003 * std::sin(90.0 * y_m) + 0.002 * std::sin(60.0 * (x_m + y_m));
}

std::shared_ptr<const Surface> object(const Frame& frame) {
  constexpr int side = 60;
  TriangleMesh mesh;
  for (int row = 0; row <= side; ++row) {
    for (int column = 0; column <= side; ++column) {
      const double x_m = 0.04 * (2.0 * column / side - 1.0);
      const double y_m = 0.04 * (2.0 * row / side - 1.0);
      mesh.vertices_W_m.push_back(frame.place(Vec3(x_m, y_m, height_m(x_m, y_m))));
    }
  }
  const auto at = [](int row, int column) { return row * (side + 1) + column; };
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      mesh.triangles.push_back({at(row, column), at(row, column + 1), at(row + 1, column + 1)});
      mesh.triangles.push_back({at(row, column), at(row + 1, column + 1), at(row + 1, column)});
    }
  }
  mesh.source = "object";
  return surface::make_embree_surface(mesh);
}

// hand() over the object instead of over a plane.
MotionColumns over_object(double phase) {
  MotionColumns motion = hand(phase, 1.0);
  for (Vec3& p : motion.p_W_m) p.z() += height_m(p.x(), p.y());
  return motion;
}

struct HiddenIn {
  std::string missing;
  Vec3 shift_m = Vec3::Zero();  // measured = true + shift + turn x true, in the object's own frame
  Vec3 turn_rad = Vec3::Zero();
  double softer = 0.0;  // share of the stiffness that is gone at (5, -4) mm
};

const HiddenIn misplaced{"registration", Vec3(8e-4, -6e-4, 3e-4), Vec3(0.012, -0.018, 0.015)};
const HiddenIn soft_place{"stiffness-map", Vec3::Zero(), Vec3::Zero(), 0.5};

// Written down in a frame: noise in the object's own, so that it is the same noise in all.
Recording measure(const HiddenIn& truth, const Frame& frame, double phase, std::uint64_t seed) {
  const MotionColumns path = over_object(phase);
  Model model;
  model.renderer = "god-object";
  model.parameters["stiffness_N_per_m"] = 900.0;
  model.source = "test";
  auto f_W_N = renderers::make_model_predictor(object({"own"}), path)->predict(model).f_W_N;
  MotionColumns seen = path;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Vec3& p = path.p_W_m[i];
    const Vec3 foot = p;  // nearly: the tip is never deeper than 3 mm
    f_W_N[i] *=
        1.0 - truth.softer * std::exp(-0.5 * (std::pow(foot.x() - 5e-3, 2) + std::pow(foot.y() + 4e-3, 2)) / 36e-6);
    seen.p_W_m[i] = p + truth.shift_m + truth.turn_rad.cross(p);
  }
  Recording recording = measured(seen, std::move(f_W_N), small_noise(1.0), seed);
  for (Vec3& p : recording.motion.p_W_m) p = frame.place(p);
  for (Vec3& f : recording.f_W_N) f = frame.turn * f;
  return recording;
}

struct FoundIn {
  FindingsVerdict verdict;
  std::vector<std::string> names;
  double closed = 0.0;    // of the held-out gap beside the model with its stiffness refitted
  NamedParameters entry;  // the first found
  std::vector<FoundParameter> values;
};

FoundIn search_in(const HiddenIn& truth, const Frame& frame) {
  const auto surface = object(frame);
  Model start;
  start.renderer = "god-object";
  start.parameters["stiffness_N_per_m"] = 850.0;
  start.source = "test";
  const TwoRecordings recordings(
      measure(truth, frame, 0.0, 1), measure(truth, frame, 1.1, 2), small_noise(1.0), start,
      [&](const MotionColumns& motion) { return renderers::make_model_predictor(surface, motion); });
  std::vector<Candidate> library = whole_catalogue();
  std::erase_if(library, [](const Candidate& c) {
    return c.name != "registration" && c.name != "stiffness-map" && c.name != "surface-geometry" &&
           c.name != "coulomb-friction" && c.name != "force-crosstalk" && c.name != "stiffness-field";
  });
  Findings findings;
  findings.search = search_effects(recordings.data, start, library, {}, [](const std::string&) {});
  conclude(findings, library);
  FoundIn answer;
  answer.verdict = findings.verdict;
  for (const FoundEffect& effect : findings.search.found) answer.names.push_back(effect.name);
  const Evidence& holdout = recordings.data.holdout;
  const auto left_N = [&](const Model& model) { return rms_force_error_N(holdout, holdout.predictor->predict(model)); };
  answer.closed = 1.0 - left_N(findings.search.model) / left_N(findings.search.base);
  if (answer.names.empty()) return answer;
  answer.entry = *find_entry(findings.search.model, answer.names.front());
  answer.values = findings.parameters.front();
  return answer;
}

double value(const FoundIn& answer, const std::string& name) {
  const auto given = answer.entry.parameters.find(name);
  return given == answer.entry.parameters.end() ? 0.0 : given->second;
}

double half_width(const FoundIn& answer, const std::string& name) {
  for (const FoundParameter& one : answer.values) {
    if (one.name == name) return 0.5 * (one.high95 - one.low95);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

constexpr double same_gap = 0.005;

class FrameInvariance : public ::testing::TestWithParam<Frame> {};

// The shift that the answer gives to a place of the object, in the object's own frame.
Vec3 shift_m(const FoundIn& answer, const Frame& frame, const Vec3& place_m) {
  const Vec3 d(value(answer, "dx_m"), value(answer, "dy_m"), value(answer, "dz_m"));
  const Vec3 r(value(answer, "rx_rad"), value(answer, "ry_rad"), value(answer, "rz_rad"));
  const Vec3 pivot(value(answer, "pivot_x_m"), value(answer, "pivot_y_m"), value(answer, "pivot_z_m"));
  return frame.turn.conjugate() * (d + r.cross(frame.place(place_m) - pivot));
}

TEST_P(FrameInvariance, OfAMisplacedObject) {
  static const FoundIn own = search_in(misplaced, {"own"});
  ASSERT_EQ(own.verdict, FindingsVerdict::explained);
  ASSERT_EQ(own.names, std::vector<std::string>{"registration"});
  const FoundIn answer = search_in(misplaced, GetParam());
  EXPECT_EQ(answer.verdict, own.verdict);
  ASSERT_EQ(answer.names, own.names);
  EXPECT_NEAR(answer.closed, own.closed, same_gap);
  for (const Vec3& place : {Vec3(0, 0, 0), Vec3(0.02, 0, 0), Vec3(0, 0.02, 0), Vec3(0, 0, 0.01)}) {
    const Vec3 apart_m = shift_m(answer, GetParam(), place) - shift_m(own, {"own"}, place);
    for (const int axis : {0, 1, 2}) {
      constexpr std::array shifts{"dx_m", "dy_m", "dz_m"};
      constexpr std::array turns{"rx_rad", "ry_rad", "rz_rad"};
      Vec3 turn_rad;
      for (const int k : {0, 1, 2}) turn_rad[k] = half_width(own, turns.at(std::size_t(k)));
      const Vec3 lever_m = Vec3::Unit(axis).cross(place).cwiseAbs();
      const double error_m =
          std::hypot(half_width(own, shifts.at(std::size_t(axis))), lever_m.cwiseProduct(turn_rad).norm());
      EXPECT_LT(std::abs(apart_m[axis]), error_m) << "axis " << axis << " at " << place.transpose();
    }
  }
}

TEST_P(FrameInvariance, OfASoftPlace) {
  static const FoundIn own = search_in(soft_place, {"own"});
  ASSERT_EQ(own.names, std::vector<std::string>{"stiffness-map"});
  const FoundIn answer = search_in(soft_place, GetParam());
  EXPECT_EQ(answer.verdict, own.verdict);
  ASSERT_EQ(answer.names, own.names);
  EXPECT_NEAR(answer.closed, own.closed, same_gap);
  for (const char* const name : {"amplitude", "width_m"})
    EXPECT_LT(std::abs(value(answer, name) - value(own, name)), half_width(own, name)) << name;
}

INSTANTIATE_TEST_SUITE_P(Search, FrameInvariance,
                         ::testing::Values(Frame{"turned", turned(1.1, Vec3(0.3, -0.5, 0.8))},
                                           Frame{"on_its_side", turned(1.5707963267948966, Vec3::UnitX())},
                                           Frame{"upside_down", turned(3.0, Vec3(0.2, 1.0, 0.1))},
                                           Frame{"far_away", Quat::Identity(), Vec3(10.0, -7.0, 5.0)},
                                           Frame{"turned_far_away", turned(2.0, Vec3(1.0, 0.7, -0.4)),
                                                 Vec3(-3.0, 10.0, 4.0)}),
                         [](const auto& of_case) { return of_case.param.name; });

}  // namespace
}  // namespace touchstone::discrepancy
