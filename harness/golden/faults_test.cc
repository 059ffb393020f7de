// Faults planted in renderers, each run on golden cases against their goldens: which gate catches which. A fault that
// no case catches, or that another gate catches than is stated here, fails.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <set>

#include "harness/base/error.h"
#include "harness/golden/case_runner.h"
#include "harness/golden/comparison/column_file.h"
#include "harness/rendering/replay.h"
#include "harness/surface/embree_surface.h"
#include "renderers/catalogue.h"
#include "synthetic/generators.h"

namespace touchstone::golden {
using recording::RenderedTrajectory;
using rendering::Model;
using rendering::Renderer;
using rendering::StepResult;
using rendering::TipState;

namespace {

// What a fault may remember from step to step.
struct Memory {
  StepResult last;
  TipState last_tip;
  Vec3 filtered_W_N = Vec3::Zero();
  std::size_t steps = 0;
};

// Changes what the tip is before the step, what the renderer answered after it.
struct Fault {
  std::string name;
  std::string case_name;
  std::string model;
  std::string gate;  // the quantity that must catch it; "drift": within tolerance, only bits tell; "invalid"
  std::function<void(StepResult&, const TipState&, Memory&)> after = {};
  std::function<void(TipState&)> before = {};
  std::function<void(Model&)> in_model = {};  // a fault in the parameters or the algorithm chosen
  std::function<void(RenderedTrajectory&)> in_run = {};
};

void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }

class FaultyRenderer final : public Renderer {
 public:
  FaultyRenderer(const Fault& fault, std::unique_ptr<Renderer> healthy)
      : fault_(&fault), healthy_(std::move(healthy)) {}

 private:
  void do_reset() override {
    healthy_->reset();
    memory_ = {};
  }
  StepResult do_step(const TipState& tip) noexcept override {
    TipState seen = tip;
    if (fault_->before) fault_->before(seen);
    const StepResult healthy = healthy_->step(seen);
    StepResult result = healthy;
    if (fault_->after) fault_->after(result, tip, memory_);
    memory_.last = healthy;
    memory_.last_tip = tip;
    ++memory_.steps;
    return result;
  }

  const Fault* fault_;
  std::unique_ptr<Renderer> healthy_;
  Memory memory_;
};

Vec3 tangential(const StepResult& r) { return r.f_W_N - r.f_W_N.dot(r.n_W) * r.n_W; }

// At the foot of the step the floor (along z) and the riser (along x) hold the proxy together.
bool at_corner(const StepResult& r) {
  const Vec3 direction = r.f_W_N.normalized().cwiseAbs();
  return r.contact && std::min(direction.x(), direction.z()) > 0.05;
}

void set_parameter(Model& model, std::size_t effect, const char* name, double factor) {
  model.effects.at(effect).parameters.at(name) *= factor;
}

const std::vector<Fault>& faults() {
  static const std::vector<Fault> list{
      {"StiffnessOnePercentHigh", "sphere-scan", "god-object", "force", [](auto& r, auto&, auto&) { r.f_W_N *= 1.01; }},
      {"StiffnessOnePercentLow", "sphere-scan", "spring-linear", "force",
       [](auto& r, auto&, auto&) { r.f_W_N *= 0.99; }},
      {"StiffnessTenthOfAPercent", "duck-scan", "god-object", "force", [](auto& r, auto&, auto&) { r.f_W_N *= 1.001; }},
      {"StiffnessParameterOff",
       "sphere-scan-large-fast",
       "god-object",
       "force",
       {},
       {},
       [](Model& m) { m.parameters.at("stiffness_N_per_m") *= 1.01; }},
      {"SwappedAxes", "sphere-scan", "god-object", "force",
       [](auto& r, auto&, auto&) { std::swap(r.f_W_N.x(), r.f_W_N.y()); }},
      {"SignFlippedInZ", "plane-taps", "god-object", "force",
       [](auto& r, auto&, auto&) { r.f_W_N.z() = -r.f_W_N.z(); }},
      {"FrameTurnedByATenthOfADegree", "sphere-scan", "god-object", "force",
       [](auto& r, auto&, auto&) { r.f_W_N = Eigen::AngleAxisd(0.1 * M_PI / 180.0, Vec3::UnitX()) * r.f_W_N; }},
      {"FrictionOffByTwoPercent",
       "plane-stroke",
       "god-object-friction",
       "force",
       {},
       {},
       [](Model& m) { set_parameter(m, 0, "mu_dynamic", 1.02); }},
      {"StaticFrictionOffByTwoPercent",
       "plane-stroke",
       "god-object-friction",
       "force",
       {},
       {},
       [](Model& m) { set_parameter(m, 0, "mu_static", 1.02); }},
      {"StribeckVelocityOffByTwoPercent",
       "plane-stroke",
       "god-object-stribeck",
       "force",
       {},
       {},
       [](Model& m) { set_parameter(m, 0, "stribeck_velocity_m_per_s", 1.02); }},
      {"FrictionOutsideTheCone", "sphere-scan", "god-object-friction", "force",
       [](auto& r, auto&, auto&) { r.f_W_N += 0.05 * tangential(r); }},
      {"FrictionLost", "duck-scan", "god-object-friction", "force", {}, {}, [](Model& m) { m.effects.clear(); }},
      {"FrictionKeepsItsDirectionOnReversal", "plane-stroke", "god-object-friction", "force",
       [](auto& r, auto&, auto& m) {
         if (tangential(r).dot(tangential(m.last)) < 0.0) r.f_W_N -= 2.0 * tangential(r);
       }},
      {"DampingLost", "plane-taps", "god-object-damped", "force", {}, {}, [](Model& m) { m.effects.clear(); }},
      {"DampingOffByTwoPercent",
       "plane-taps",
       "god-object-damped",
       "force",
       {},
       {},
       [](Model& m) { set_parameter(m, 0, "coefficient_N_s_per_m", 1.02); }},
      {"RelaxationTimeOffByTwoPercent",
       "plane-taps",
       "god-object-relaxation",
       "force",
       {},
       {},
       [](Model& m) { set_parameter(m, 0, "time_constant_s", 1.02); }},
      {"ExponentOff",
       "plane-taps",
       "god-object-hertz",
       "force",
       {},
       {},
       [](Model& m) { set_parameter(m, 0, "exponent", 1.01); }},
      {"OneSampleDelay", "sphere-scan", "god-object", "force", [](auto& r, auto&, auto& m) { r.f_W_N = m.last.f_W_N; }},
      {"OneSampleDelayOfEverything", "plane-taps", "god-object", "contact",
       [](auto& r, auto& tip, auto& m) {
         const auto now = r;
         r = m.last;
         if (!r.contact) r.contact_W_m = tip.p_W_m;
         (void)now;
       }},
      {"SmoothedForce", "wedge-crossing", "god-object", "force",
       [](auto& r, auto&, auto& m) {
         m.filtered_W_N += 0.2 * (r.f_W_N - m.filtered_W_N);
         r.f_W_N = m.filtered_W_N;
       }},
      {"SecondConstraintLostInACorner", "step-crossing", "god-object", "force",
       [](auto& r, auto&, auto&) {
         if (at_corner(r)) r.f_W_N.x() = 0.0;
       }},
      {"NormalOfOneFaceInACorner", "step-crossing", "god-object", "force",
       [](auto& r, auto&, auto&) {
         if (at_corner(r)) r.f_W_N = r.f_W_N.norm() * Vec3::UnitZ();
       }},
      {"PopsThroughAThinShell",
       "shell-push",
       "god-object",
       "force",
       {},
       {},
       [](Model& m) { m.renderer = "spring-linear"; }},
      {"PopsThroughAThinnerShell",
       "shell-thin-push",
       "god-object",
       "contact_position",
       {},
       {},
       [](Model& m) { m.renderer = "spring-linear"; }},
      {"ForceGapAtFirstContact", "plane-taps", "god-object", "force",
       [](auto& r, auto&, auto&) {
         if (r.depth_m < 2e-5) r.f_W_N.setZero();
       }},
      {"PullInwardOnLeaving", "plane-taps", "god-object", "force",
       [](auto& r, auto&, auto& m) {
         if (!r.contact && m.last.contact) r.f_W_N = -0.01 * m.last.n_W;
       }},
      {"SawtoothAtConstantLoad", "plane-stroke", "god-object", "force",
       [](auto& r, auto&, auto& m) { r.f_W_N *= m.steps % 2 == 0 ? 1.005 : 0.995; }},
      {"AbsoluteEpsilonOfTenMicrometres", "duck-scan", "god-object", "contact",
       [](auto& r, auto& tip, auto&) {
         if (r.depth_m < 1e-5) {
           r.contact = false;
           r.f_W_N.setZero();
           r.contact_W_m = tip.p_W_m;
         }
       }},
      {"TipRoundedToAMicrometre",
       "duck-scan",
       "god-object",
       "force",
       {},
       [](TipState& tip) { tip.p_W_m = (tip.p_W_m * 1e6).array().round() * 1e-6; }},
      {"ClippedAtOneNewton", "plane-taps", "spring-quadratic", "force",
       [](auto& r, auto&, auto&) {
         if (r.f_W_N.norm() > 1.0) r.f_W_N.normalize();
       }},
      {"ForceInFreeSpace", "plane-taps", "god-object", "force",
       [](auto& r, auto&, auto&) {
         if (!r.contact) r.f_W_N.z() += 1e-3;
       }},
      {"NoiseOfTenMicronewton", "sphere-scan", "god-object", "force",
       [](auto& r, auto&, auto& m) { r.f_W_N.x() += 1e-5 * std::sin(12.9898 * static_cast<double>(m.steps)); }},
      {"OneSampleWrong", "sphere-scan", "god-object", "force",
       [](auto& r, auto&, auto& m) {
         if (m.steps == 700) r.f_W_N.z() += 1e-3;
       }},
      {"ProxyOffByAMicrometre", "sphere-scan", "god-object", "contact_position",
       [](auto& r, auto&, auto&) {
         if (r.contact) r.contact_W_m.x() += 1e-6;
       }},
      {"ContactFlagLost", "sphere-scan", "god-object", "contact",
       [](auto& r, auto&, auto& m) {
         if (m.steps == 700) r.contact = !r.contact;
       }},
      {"MillinewtonTakenAsNewton", "sphere-scan", "god-object", "force", [](auto& r, auto&, auto&) { r.f_W_N *= 1e3; }},
      {"NotANumber", "sphere-scan", "god-object", "invalid",
       [](auto& r, auto&, auto& m) {
         if (m.steps == 700) r.f_W_N.x() = std::numeric_limits<double>::quiet_NaN();
       }},
      {"LastSampleLost",
       "sphere-scan",
       "god-object",
       "invalid",
       {},
       {},
       {},
       [](RenderedTrajectory& run) {
         run.t_s.pop_back();
         run.tip_W_m.pop_back();
         run.contact_W_m.pop_back();
         run.f_W_N.pop_back();
         run.contact.pop_back();
       }},
      {"ConeOfDynamicFrictionOffByTwoPercent",
       "plane-stroke",
       "friction-cone",
       "force",
       {},
       {},
       [](Model& m) { m.parameters.at("mu_dynamic") *= 1.02; }},
      {"ConeOfStaticFrictionOffByTwoPercent",
       "sphere-scan",
       "friction-cone",
       "force",
       {},
       {},
       [](Model& m) { m.parameters.at("mu_static") *= 1.02; }},
      {"ShadingLost", "torus-spiral", "force-shading", "force", {}, {}, [](Model& m) { m.renderer = "god-object"; }},
      {"ShadingBeyondACrease",
       "extrusion-sharp",
       "force-shading",
       "force",
       {},
       {},
       [](Model& m) { m.parameters["crease_angle_rad"] = 3.0; }},
      {"OneVoxelMore",
       "saddle-raster-small-fast",
       "voxel-96",
       "force",
       {},
       {},
       [](Model& m) { m.parameters.at("resolution") += 1.0; }},
      {"PenaltyOfTheWrongTip",
       "duck-scan-large-fast",
       "penalty",
       "force",
       {},
       {},
       [](Model& m) { m.parameters["tip_radius_m"] = 1e-3; }},
      {"ImplicitFieldOneSampleCoarser",
       "sphere-scan",
       "implicit",
       "force",
       {},
       {},
       [](Model& m) { m.parameters.at("resolution") -= 1.0; }},
      {"SinglePrecision", "sphere-scan", "god-object", "drift",
       [](auto& r, auto&, auto&) { r.f_W_N = r.f_W_N.template cast<float>().template cast<double>(); }},
  };
  return list;
}

std::filesystem::path golden_folder() { return std::filesystem::path(std::getenv("TOUCHSTONE_SOURCE_DIR")) / "golden"; }

Comparison run_with(const Fault& fault) {
  const GoldenCase golden = load_case(golden_folder() / fault.case_name);
  Model model = rendering::parse_model(golden.models.at(fault.model), golden.name);
  if (fault.in_model) fault.in_model(model);
  FaultyRenderer renderer(
      fault, renderers::make_renderer(model, make_embree_surface(case_mesh(synthetic::built_in_generators(), golden))));
  const TrajectoryColumns expected = load_columns(golden.expected(fault.model));
  try {
    RenderedTrajectory run = replay(renderer, case_trajectory(synthetic::built_in_generators(), golden));
    if (fault.in_run) fault.in_run(run);
    return compare(expected, columns_of(run, fault.name), golden.tolerance);
  } catch (const BadData& error) {
    Comparison refused;
    refused.verdict = Verdict::invalid;
    refused.problems.push_back(error.what());
    return refused;
  }
}

std::vector<std::string> gates_that_caught(const Comparison& comparison) {
  std::vector<std::string> caught;
  if (comparison.verdict >= Verdict::missing) caught.emplace_back("invalid");
  for (const GroupResult& group : comparison.groups) {
    if (!passes(group.verdict)) caught.push_back(group.group);
  }
  if (comparison.drift > 0) caught.emplace_back("drift");
  return caught;
}

class PlantedFault : public ::testing::TestWithParam<Fault> {};

TEST_P(PlantedFault, IsCaughtByTheGateThatIsStated) {
  const Fault& fault = GetParam();
  const Comparison comparison = run_with(fault);
  const auto caught = gates_that_caught(comparison);
  fmt::print("| {} | {} | {} | {} |\n", fault.name, fault.case_name, fault.model, fmt::join(caught, ", "));
  EXPECT_NE(std::ranges::find(caught, fault.gate), caught.end()) << "the gate " << fault.gate << " did not see it";
  EXPECT_EQ(passes(comparison.verdict), fault.gate == "drift");
}

INSTANTIATE_TEST_SUITE_P(Golden, PlantedFault, ::testing::ValuesIn(faults()),
                         [](const auto& planted) { return planted.param.name; });

// The same path without a fault passes on every case that the faults use: it is the fault that is caught.
TEST(PlantedFaults, WithoutOneEveryCasePasses) {
  std::set<std::pair<std::string, std::string>> runs;
  for (const Fault& fault : faults()) runs.emplace(fault.case_name, fault.model);
  for (const auto& [case_name, model] : runs) {
    const Comparison comparison = run_with({.name = "none", .case_name = case_name, .model = model, .gate = ""});
    EXPECT_EQ(comparison.verdict, Verdict::equal) << case_name << " " << model;
  }
}

}  // namespace
}  // namespace touchstone::golden
