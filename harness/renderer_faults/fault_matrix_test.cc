// Faults planted in five engines: each must be named, alone and by its own name, with all else that is found as what
// follows from it. Nothing may be named for right engines of any rate, unit, damping and declared lag.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "harness/base/random.h"
#include "harness/renderer_faults/diagnosis.h"
#include "harness/renderer_faults/planted_fault_for_test.h"
#include "harness/renderer_faults/probe.h"

namespace touchstone::renderer_faults {
using rendering::Ability;
using rendering::Renderer;
using rendering::StepResult;
using rendering::TipState;
using surface::Surface;

namespace {

using Names = std::set<std::string>;

// Those of memory and cost take their seconds whatever the fault (diagnosis_test.cc).
std::vector<std::string> names_of_force_detectors() {
  std::vector<std::string> names;
  for (const Detector& detector : detectors()) {
    if (detector.kind != DetectorKind::running) names.push_back(detector.name);
  }
  return names;
}

Names causes_of(const Engine& engine) {
  const Diagnosis found = diagnose(engine, names_of_force_detectors());
  Names names;
  for (const Finding& one : found.findings) {
    if (one.follows_from.empty()) names.insert(one.name);
  }
  for (const auto& [name, why] : found.failed) names.insert(fmt::format("{} could not run: {}", name, why));
  return names;
}

std::string sentences_of(const Engine& engine) {
  std::string text;
  for (const Finding& one : diagnose(engine, names_of_force_detectors()).findings)
    text +=
        fmt::format("    {}{}: {}\n", one.name, one.follows_from.empty() ? "" : " <- " + one.follows_from, one.what);
  return text;
}

constexpr double kMillimetre_m = 1e-3;

Engine right(const std::string& renderer, double rate_Hz = 1000.0) {
  Fault none{"right", ""};
  none.renderer = renderer == "ball" ? "god-object" : renderer;
  if (renderer == "friction-cone") none.parameters = R"(, "mu_static": 0.4, "mu_dynamic": 0.3)";
  Engine engine = engine_of(none);
  engine.rate_Hz = rate_Hz;
  if (renderer == "penalty") {
    for (const Ability lacks : {Ability::thin_shells, Ability::large_jumps, Ability::continuous_force})
      engine.cannot.push_back({lacks, "it has no memory"});
  }
  if (renderer != "ball") return engine;
  engine.tip_radius_m = kMillimetre_m;
  engine.make = [](std::shared_ptr<const Surface> surface, double unit) {
    const rendering::Model model = rendering::parse_model(
        fmt::format(
            R"({{"schema": "touchstone-model/1", "renderer": "god-object", "parameters": {{"stiffness_N_per_m": {},
                       "tip_radius_m": {}}}}})",
            500.0 / unit, kMillimetre_m * unit),
        "ball");
    return renderers::make_renderer(model, std::move(surface));
  };
  return engine;
}

// A step's answer is free again where it was not in contact then.
void at_this_tip(StepResult& result, const TipState& tip) {
  if (!result.contact) result.contact_W_m = tip.p_W_m;
}

Fault held(double period) {
  return {fmt::format("held for {:g}", period), "held-answer", {}, [period](auto& r, auto& tip, auto& m) {
            const auto now = static_cast<double>(m.since_reset);
            const bool update = std::floor(now / period) != std::floor((now - 1.0) / period);
            if (update || m.since_reset == 0) m.kept = r;
            r = m.kept;
            at_this_tip(r, tip);
          }};
}

Fault late(std::size_t lag) {
  return {fmt::format("late by {}", lag), "delay", {}, [lag](auto& r, auto& tip, auto& m) {
            m.past.push_back(r);
            r = m.past.size() > lag ? m.past[m.past.size() - 1 - lag] : StepResult{};
            if (m.past.size() > 2 * lag + 2) m.past.pop_front();
            at_this_tip(r, tip);
          }};
}

// One in every so many answers is that of the sample before.
Fault alternate(std::size_t period) {
  return {fmt::format("one in {} late", period), "alternate-lag", {}, [period](auto& r, auto& tip, auto& m) {
            const StepResult now = r;
            if (m.since_reset % period == 1) r = m.kept;
            at_this_tip(r, tip);
            m.kept = now;
          }};
}

// The contact point of the sample before, the spring to the tip of now.
Fault alternate_contact() {
  return {"contact point late in turns", "alternate-lag", {}, [](auto& r, auto& tip, auto& m) {
            const StepResult now = r;
            if (m.since_reset % 2 == 1) {
              r = m.kept;
              if (r.contact) r.f_W_N = 500.0 / m.unit * (r.contact_W_m - tip.p_W_m);
              at_this_tip(r, tip);
            }
            m.kept = now;
          }};
}

// One in so many answers, at random, is that of the sample before.
Fault now_and_then(std::uint64_t one_in) {
  return {fmt::format("one in {} late at random", one_in), "jitter", {}, [one_in](auto& r, auto& tip, auto& m) {
            const StepResult now = r;
            if (Random(5 + m.since_reset).below(one_in) == 0 && m.since_reset > 0) r = m.kept;
            at_this_tip(r, tip);
            m.kept = now;
          }};
}

Fault irregular() {
  return {"late at random", "jitter", {}, [](auto& r, auto& tip, auto& m) {
            m.past.push_back(r);
            if (m.past.size() > 6) m.past.pop_front();
            const std::size_t lag = Random(m.since_reset).below(4);
            r = m.past[m.past.size() - 1 - std::min(lag, m.past.size() - 1)];
            at_this_tip(r, tip);
          }};
}

Fault filtered(double time_constant_s) {
  return {fmt::format("filtered by {:g} s", time_constant_s), "filter", {}, [=](auto& r, auto& tip, auto& m) {
            const double share = -std::expm1(-(tip.t_s - m.last_t_s) / time_constant_s);
            m.kept.f_W_N += (m.since_reset == 0 ? 1.0 : share) * (r.f_W_N - m.kept.f_W_N);
            if (!r.contact) m.kept.f_W_N.setZero();
            r.f_W_N = m.kept.f_W_N;
          }};
}

Fault slow_rise(double per_sample_N) {
  return {fmt::format("changes by {:g} N at most", per_sample_N), "clipped-rate", {}, [=](auto& r, auto&, auto& m) {
            const Vec3 change = r.f_W_N - m.kept.f_W_N;
            if (change.norm() > per_sample_N) r.f_W_N = m.kept.f_W_N + per_sample_N * change.normalized();
            m.kept.f_W_N = r.f_W_N;
          }};
}

Fault mapped(const std::string& name, const std::string& caught_by, const std::function<Vec3(const Vec3&)>& map) {
  return {name, caught_by, {}, [map](auto& r, auto&, auto&) { r.f_W_N = map(r.f_W_N); }};
}

Fault clipped_by_axis(double limit_N) {
  return mapped(fmt::format("clipped at {:g} N by axis", limit_N), "saturation",
                [=](const Vec3& f) { return Vec3(f.cwiseMax(-limit_N).cwiseMin(limit_N)); });
}

Fault in_steps(double step_N) {
  return mapped(fmt::format("in steps of {:g} N", step_N), "quantised",
                [=](const Vec3& f) { return Vec3(step_N * (f / step_N).array().round().matrix()); });
}

Fault less_on_release(double share, bool also_at_rest) {
  return {fmt::format("{:g} less on release{}", share, also_at_rest ? ", and at rest" : ""),
          "hysteresis",
          {},
          [=](auto& r, auto&, auto& m) {
            constexpr double same_m = 1e-13;
            const double before_m = m.kept.depth_m;
            m.kept.depth_m = r.depth_m;
            if (r.depth_m > before_m + same_m * m.unit || !r.contact) m.figure = 0.0;
            if (r.depth_m < before_m - same_m * m.unit) m.figure = share;
            if (!also_at_rest && std::abs(r.depth_m - before_m) <= same_m * m.unit) m.figure = 0.0;
            r.f_W_N *= 1.0 - m.figure;
          }};
}

Fault drops_out(std::uint64_t one_in) {
  return {fmt::format("1 of {} dropped", one_in), "dropout", {}, [=](auto& r, auto& tip, auto& m) {
            if (Random(77 + m.steps).below(one_in) == 0) nothing_there(r, tip);
          }};
}

// Of one face of a ball of 2048, as many as its index says; no other body has as many.
Fault bad_face(std::int32_t face, double factor) {
  return {fmt::format("face {} times {:g}", face, factor), "one-bad-face", {}, [=](auto& r, auto&, auto& m) {
            if (r.contact && m.surface->closest(r.contact_W_m).triangle == face) r.f_W_N *= factor;
          }};
}

double damped_N(const StepResult& r, const TipState& tip, const Memory& m, double coefficient) {
  if (!r.contact || m.since_reset == 0) return 0.0;
  return -coefficient * r.n_W.dot(tip.p_W_m - m.last_tip) / m.unit / (tip.t_s - m.last_t_s);
}

Fault damper(double coefficient_N_s_per_m) {
  return {fmt::format("damped by {:g} N s/m", coefficient_N_s_per_m), "", {}, [=](auto& r, auto& tip, auto& m) {
            const double all_N = r.f_W_N.dot(r.n_W);
            if (r.contact) r.f_W_N += std::max(-all_N, damped_N(r, tip, m, coefficient_N_s_per_m)) * r.n_W;
          }};
}

std::vector<Fault> of_the_force() {
  std::vector<Fault> list{
      late(1),
      late(3),
      late(8),
      held(16),
      held(1000.0 / 60.0),
      held(4),
      alternate(5),
      alternate(50),
      alternate(3),
      irregular(),
      now_and_then(80),
      filtered(1e-3),
      filtered(5e-3),
      slow_rise(0.05),
      slow_rise(0.4),
      mapped("x mirrored", "mirrored-axis", [](const Vec3& f) { return Vec3(-f.x(), f.y(), f.z()); }),
      mapped("positive y mirrored", "mirrored-axis",
             [](const Vec3& f) { return Vec3(f.x(), -std::abs(f.y()), f.z()); }),
      mapped("inverted", "mirrored-axis", [](const Vec3& f) { return Vec3(-f); }),
      mapped("y and z exchanged", "exchanged-axes", [](const Vec3& f) { return Vec3(f.x(), f.z(), f.y()); }),
      mapped("x, y and z in turn", "exchanged-axes", [](const Vec3& f) { return Vec3(f.z(), f.x(), f.y()); }),
      mapped("y lost", "lost-axis", [](const Vec3& f) { return Vec3(f.x(), 0.0, f.z()); }),
      clipped_by_axis(3.0),
      clipped_by_axis(0.7),
      mapped("clipped at 4 N", "saturation", [](const Vec3& f) { return Vec3(f * std::min(1.0, 4.0 / f.norm())); }),
      in_steps(0.02),
      in_steps(0.005),
      less_on_release(0.05, true),
      less_on_release(0.03, false),
      drops_out(4000),
      drops_out(300),
      bad_face(1234, -1.0),
      bad_face(777, 0.0),
      bad_face(499, 1.5)};
  list.push_back({"stiffer to the right", "place-dependent", {}, [](auto& r, auto& tip, auto& m) {
                    r.f_W_N *= std::exp(10.0 * tip.p_W_m.x() / m.unit);
                  }});
  list.push_back({"softer above", "place-dependent", {}, [](auto& r, auto& tip, auto& m) {
                    r.f_W_N *= 1.0 - 2.0 * tip.p_W_m.z() / m.unit;
                  }});
  list.push_back({"scaled by the time of a sample", "rate-dependent", {}, [](auto& r, auto& tip, auto& m) {
                    if (m.since_reset > 0) r.f_W_N *= std::pow((tip.t_s - m.last_t_s) / 1e-3, 0.25);
                  }});
  list.push_back({"damped by the sample", "rate-dependent", {}, [](auto& r, auto& tip, auto& m) {
                    r.f_W_N += damped_N(r, tip, m, 50.0) * (tip.t_s - m.last_t_s) * r.n_W;
                  }});
  list.push_back({"lingers for a sample", "gap-at-contact", {}, [](auto& r, auto&, auto& m) {
                    const StepResult now = r;
                    if (!r.contact && m.kept.contact) r.f_W_N = 0.2 * m.kept.f_W_N;
                    m.kept = now;
                  }});
  list.push_back({"doubles the depth it gives", "standoff", {}, [](auto& r, auto&, auto&) { r.depth_m *= 2.0; }});
  list.push_back({"constant force", "gap-at-contact", {}, [](auto& r, auto&, auto&) {
                    if (r.contact) r.f_W_N = 5.0 * r.n_W;
                  }});
  list.push_back({"lost 2.5 mm deep", "falls-through-block", {}, [](auto& r, auto& tip, auto& m) {
                    if (r.depth_m > 2.5e-3 * m.unit) nothing_there(r, tip);
                  }});
  return list;
}

// Where its normal turns by more than 0.2 rad from sample to sample, it does so 12 samples later.
Fault hangs_behind() {
  return {"hangs behind at edges", "ball-at-edge", {}, [](auto& r, auto& tip, auto& m) {
            constexpr double wait = 12.0;
            const bool turned = r.contact && m.kept.contact && r.n_W.dot(m.kept.n_W) < 0.98;
            m.figure = turned ? m.figure + 1.0 : 0.0;
            if (!turned || m.figure > wait) {
              m.kept = r;
              m.figure = 0.0;
              return;
            }
            r = m.kept;
            r.f_W_N = 500.0 / m.unit * (r.contact_W_m - tip.p_W_m);
          }};
}

std::vector<std::string> engine_names() { return {"penalty", "god-object", "ball", "friction-cone"}; }

class FaultMatrix : public ::testing::TestWithParam<std::string> {};

// At least 95 % by their names, and none that is not there.
TEST_P(FaultMatrix, FaultsAreNamed) {
  const Engine engine = right(GetParam());
  std::vector<Fault> list = of_the_force();
  list.push_back(alternate_contact());
  if (engine.tip_radius_m > 0.0) list.push_back(hangs_behind());
  // A step of a ball takes long: every third will do.
  const std::size_t stride = engine.tip_radius_m > 0.0 ? 3 : 1;
  std::size_t named = 0;
  std::size_t tried = 0;
  for (std::size_t i = (list.size() - 1) % stride; i < list.size(); i += stride, ++tried) {
    const Fault& fault = list[i];
    const Engine faulty = planted(engine, fault);
    const Names found = causes_of(faulty);
    if (found == Names{fault.caught_by}) {
      ++named;
      continue;
    }
    fmt::print("{}: {}: {} named, {} expected\n{}", GetParam(), fault.name, found, fault.caught_by,
               sentences_of(faulty));
  }
  fmt::print("{}: {} of {} named\n", GetParam(), named, tried);
  EXPECT_GE(20 * named, 19 * tried);
}

// The commonest engine of all: its physics runs at 60 Hz. That is named, and the other fault too.
TEST(FaultPairs, OfTwoFaultsBothAreNamed) {
  std::vector<std::pair<Fault, Fault>> pairs{{less_on_release(0.05, true), late(2)},
                                             {bad_face(777, -1.0), held(8)},
                                             {clipped_by_axis(2.0), drops_out(2000)},
                                             {in_steps(0.01), late(1)},
                                             {bad_face(777, -1.0), clipped_by_axis(3.0)}};
  const Names slower{"delay", "held-answer", "alternate-lag", "jitter", "filter", "clipped-rate", "dropout"};
  // What shows in motion or at contact alone is hidden by an answer that is held.
  const Names moving{less_on_release(0.03, false).name, "damped by the sample", "lingers for a sample",
                     "constant force"};
  for (const Fault& fault : of_the_force()) {
    if (!slower.contains(fault.caught_by) && !moving.contains(fault.name))
      pairs.emplace_back(fault, held(1000.0 / 60.0));
  }
  std::size_t named = 0;
  for (const auto& [inner, outer] : pairs) {
    const Engine faulty = planted(planted(right("god-object"), inner), outer);
    const Names found = causes_of(faulty);
    if (found == Names{inner.caught_by, outer.caught_by}) {
      ++named;
      continue;
    }
    fmt::print("{} and {}: {} named\n{}", inner.name, outer.name, found, sentences_of(faulty));
  }
  fmt::print("{} of {} pairs named\n", named, pairs.size());
  EXPECT_GE(20 * named, 19 * pairs.size());
}

TEST(FaultPairs, EveryDetectorOfTimingAndOfTheSettledForceHasItsFault) {
  Names caught;
  for (const Fault& fault : of_the_force()) caught.insert(fault.caught_by);
  for (const Detector& detector : detectors()) {
    if (detector.kind == DetectorKind::timing || detector.kind == DetectorKind::settled ||
        detector.kind == DetectorKind::events) {
      EXPECT_TRUE(caught.contains(detector.name)) << detector.name;
    }
  }
}

// Contact begins 0.08 mm late, a length that the engine declares, also on plates that are thinner: said, and no fault.
// Undeclared it is one, and still no pop through a plate.
TEST(FaultPairs, LateContactWithinTheDeclaredEpsilonIsSaid) {
  const Fault begins_late{"begins late", "", {}, [](auto& r, auto& tip, auto& m) {
                            if (r.contact && r.depth_m < 8e-5 * m.unit) nothing_there(r, tip);
                          }};
  Engine engine = planted(right("god-object"), begins_late);
  engine.epsilon_m = 8e-5;
  const Diagnosis declared = diagnose(engine, names_of_force_detectors());
  EXPECT_TRUE(declared.findings.empty()) << sentences_of(engine);
  ASSERT_EQ(declared.said.size(), 1U);
  EXPECT_EQ(declared.said.front().name, "late-contact");
  EXPECT_NEAR(declared.said.front().value, 8e-5, 1e-6);
  engine.epsilon_m = 0.0;
  EXPECT_EQ(causes_of(engine), Names{"gap-at-contact"}) << sentences_of(engine);
}

// Lengths of its own world are millimetres.
class InMillimetres final : public Renderer {
 public:
  InMillimetres(const Engine& inner, const Surface& surface, double unit) {
    surface::TriangleMesh mesh = *surface.mesh();
    for (Vec3& v : mesh.vertices_W_m) v *= 1e3;
    inner_ = inner.make(make_embree_surface(mesh), 1e3 * unit);
  }

 private:
  void do_reset() override { inner_->reset(); }
  StepResult do_step(const TipState& tip) noexcept override {
    StepResult result = inner_->step({tip.t_s, 1e3 * tip.p_W_m, tip.q_WS});
    result.contact_W_m *= 1e-3;
    result.depth_m *= 1e-3;
    return result;
  }
  std::unique_ptr<Renderer> inner_;
};

TEST_P(FaultMatrix, NothingIsNamedInARightEngine) {
  for (const double rate_Hz : {100.0, 1000.0, 10'000.0}) {
    const Engine engine = right(GetParam(), rate_Hz);
    EXPECT_THAT(causes_of(engine), ::testing::IsEmpty()) << rate_Hz << " Hz\n" << sentences_of(engine);
    for (const double coefficient_N_s_per_m : {0.02, 0.2, 1.0}) {
      const Engine damped = planted(engine, damper(coefficient_N_s_per_m));
      EXPECT_THAT(causes_of(damped), ::testing::IsEmpty())
          << coefficient_N_s_per_m << " N s/m at " << rate_Hz << " Hz\n"
          << sentences_of(damped);
    }
    Engine one_late = planted(engine, late(1));
    one_late.lag_samples = 1;
    EXPECT_THAT(causes_of(one_late), ::testing::IsEmpty()) << "declared, at " << rate_Hz << " Hz\n"
                                                           << sentences_of(one_late);
  }
  Engine millimetres = right(GetParam());
  millimetres.make = [inner = millimetres](const std::shared_ptr<const Surface>& surface, double unit) {
    return std::unique_ptr<Renderer>(std::make_unique<InMillimetres>(inner, *surface, unit));
  };
  EXPECT_THAT(causes_of(millimetres), ::testing::IsEmpty()) << sentences_of(millimetres);
}

// What is declared is said and not accused; what is later than that is.
TEST_P(FaultMatrix, ADeclaredLagIsNoFaultAndALongerOneIs) {
  Engine engine = planted(right(GetParam()), late(2));
  engine.lag_samples = 3;
  const Diagnosis declared = diagnose(engine, names_of_force_detectors());
  EXPECT_TRUE(declared.findings.empty()) << sentences_of(engine);
  EXPECT_THAT(declared.declared, ::testing::Contains(::testing::Pair("delay", ::testing::HasSubstr("late"))));
  engine.lag_samples = 1;
  EXPECT_EQ(causes_of(engine), Names{"delay"}) << sentences_of(engine);
}

INSTANTIATE_TEST_SUITE_P(Diagnosis, FaultMatrix, ::testing::ValuesIn(engine_names()), [](const auto& tested) {
  std::string name = tested.param;
  std::ranges::replace(name, '-', '_');
  return name;
});

}  // namespace
}  // namespace touchstone::renderer_faults
