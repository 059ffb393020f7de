// Faults planted in five engines: each must be named, alone and by its own name, with all else that is found as what
// follows from it. Nothing may be named for right engines of any rate, unit, damping and declared lag.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "harness/renderer_faults/diagnosis.h"
#include "harness/renderer_faults/planted_faults_for_test.h"
#include "harness/renderer_faults/probe.h"

namespace touchstone::renderer_faults {
using rendering::Ability;
using rendering::Renderer;
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

constexpr double millimetre_m = 1e-3;

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
  engine.tip_radius_m = millimetre_m;
  engine.make = [](std::shared_ptr<const Surface> surface, double unit) {
    const rendering::Model model = rendering::parse_model(
        fmt::format(
            R"({{"schema": "touchstone-model/1", "renderer": "god-object", "parameters": {{"stiffness_N_per_m": {},
                       "tip_radius_m": {}}}}})",
            500.0 / unit, millimetre_m * unit),
        "ball");
    return renderers::make_renderer(model, std::move(surface));
  };
  return engine;
}

std::vector<std::string> engine_names() { return {"penalty", "god-object", "ball", "friction-cone"}; }

class FaultMatrix : public ::testing::TestWithParam<std::string> {};

// At least 95 % by their names, and none that is not there.
TEST_P(FaultMatrix, FaultsAreNamed) {
  const Engine engine = right(GetParam());
  std::vector<Fault> list = of_the_force();
  list.push_back(alternate_contact(2));
  // Friction hides what pulls sideways less than its cone.
  if (engine.friction == 0.0)
    list.insert(list.end(), {alternate_contact(3), held_contact(16), held_contact(1000.0 / 60.0)});
  if (engine.tip_radius_m > 0.0) list.insert(list.end(), {lost_on_the_surface(), hangs_behind()});
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

// One map of the axes has two names, as where z is up in one world and y in the other: both, and none follows.
TEST(FaultPairs, ATurnOfTheAxesIsAnExchangeAndAMirror) {
  const Fault up{"y up", "", {}, [](auto& r, auto&, auto&) { r.f_W_N = Vec3(r.f_W_N.x(), -r.f_W_N.z(), r.f_W_N.y()); }};
  for (const char* const renderer : {"god-object", "friction-cone"}) {
    const Engine engine = planted(right(renderer), up);
    EXPECT_EQ(causes_of(engine), (Names{"exchanged-axes", "mirrored-axis"})) << sentences_of(engine);
  }
}

// The other names of time and of the force's map stand beside the one that was found, and leave more.
TEST(FaultSentences, WhatElseWasConsideredStandsBesideTheName) {
  const auto considered = [](const Fault& fault, const std::string& other) -> std::string {
    const Diagnosis found = diagnose(planted(right("god-object"), fault), {fault.caught_by});
    if (found.findings.size() != 1) return "not found";
    for (const auto& [name, why] : found.findings.front().considered) {
      if (name == other) return why;
    }
    return "not considered";
  };
  EXPECT_THAT(considered(late(3), "held-answer"), ::testing::HasSubstr("0 % of the answers"));
  EXPECT_THAT(considered(filtered(0.004), "delay"), ::testing::HasSubstr("leaves"));
  EXPECT_EQ(considered(late(3), "delay"), "not considered") << "the name itself";
  EXPECT_EQ(considered(alternate_contact(2), "delay"), "not considered") << "the force over one place is not late";
  // The share that a filter leaves of one that is late is that of any white sequence of depths: nearly all.
  const std::string filter = considered(late(3), "filter");
  ASSERT_THAT(filter, ::testing::HasSubstr("first order leaves "));
  EXPECT_GT(std::stod(filter.substr(filter.find("leaves ") + 7)), 50.0) << filter;
}

// Which axis, how much, and what to do, in words; an axis whose sign means nothing has its largest part positive.
TEST(FaultSentences, ASaturationSaysWhereAndWhatToDo) {
  const auto said = [](const Fault& fault) {
    const Diagnosis found = diagnose(planted(right("god-object"), fault), {"saturation"});
    return found.findings.empty() ? "" : found.findings.front().what;
  };
  EXPECT_EQ(said(clipped_along(Vec3(-0.6, 0.0, -0.8), 2.5)),
            "the force is cut off at 2.5 N along (0.60, 0.00, 0.80), either way, and what is left points elsewhere: "
            "shorten all of the force, not a component of it");
  EXPECT_THAT(said(clipped_by_axis(3.0)), ::testing::StartsWith("each component of the force is cut off at 3 N, and"));
  const Fault upwards = mapped("clipped where positive", "saturation",
                               [](const Vec3& f) { return Vec3(f.x(), f.y(), std::min(f.z(), 1.7)); });
  EXPECT_THAT(said(upwards), ::testing::StartsWith("the force is cut off at 1.7 N along z, and what"));
}

// One place, one length, one sample, a contact point that comes late: none of these is a second fault.
TEST_P(FaultMatrix, AFaultOfOnePlaceOrLengthHasOneName) {
  const Engine engine = right(GetParam());
  std::vector<Fault> list = of_the_force();
  std::erase_if(list, [](const Fault& fault) {
    return fault.name != fades(4e-3).name && fault.name != in_steps(0.02).name && fault.name != late(31).name &&
           fault.name != "nothing in the middle between two faces" &&
           fault.name != "begins 40 um late, whatever the unit";
  });
  ASSERT_EQ(list.size(), 5U);
  if (engine.tip_radius_m > 0.0) list.push_back(lost_on_the_surface());
  if (engine.friction == 0.0) list.insert(list.end(), {alternate_contact(7), held_contact(11)});
  for (const Fault& fault : list) {
    const Engine faulty = planted(engine, fault);
    EXPECT_EQ(causes_of(faulty), Names{fault.caught_by}) << fault.name << '\n' << sentences_of(faulty);
  }
}

// The commonest engine of all: its physics runs at 60 Hz. That is named, and the other fault too.
TEST(FaultPairs, OfTwoFaultsBothAreNamed) {
  std::vector<std::pair<Fault, Fault>> pairs{
      {less_on_release(0.05, true), late(2)},
      {bad_face(777, -1.0), held(8)},
      {clipped_by_axis(2.0), drops_out(2000)},
      {in_steps(0.01), late(1)},
      {bad_face(777, -1.0), clipped_by_axis(3.0)},
      {mapped("z lost", "lost-axis", [](const Vec3& f) { return Vec3(f.x(), f.y(), 0.0); }), held(16)}};
  const Names slower{"delay", "held-answer", "alternate-lag", "jitter", "filter", "clipped-rate", "dropout"};
  // What shows in motion or at contact alone is hidden by an answer that is held.
  const Names moving{less_on_release(0.03, false).name,
                     "damped by the sample",
                     "lingers for a sample",
                     "constant force",
                     "white noise",
                     "a hum"};
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

// Laws of contact that are no faults: damping that grows with the depth (Hunt and Crossley 1975), Hertz, relaxation.
std::vector<Fault> other_laws() {
  return {{"Hunt-Crossley",
           "",
           {},
           [](auto& r, auto& tip, auto& m) {
             if (!r.contact || m.since_reset == 0) return;
             const double in_m_per_s = -r.n_W.dot(tip.p_W_m - m.last_tip) / m.unit / (tip.t_s - m.last_t_s);
             r.f_W_N *= std::max(0.0, 1.0 + 0.6 * in_m_per_s);
           }},
          {"Hertz", "", {}, [](auto& r, auto&, auto& m) { r.f_W_N *= std::sqrt(r.depth_m / m.unit / 0.02); }},
          {"relaxing", "", {}, [](auto& r, auto& tip, auto& m) {
             const double depth_m = r.contact ? r.depth_m / m.unit : 0.0;
             constexpr double k_N_per_m = 150.0;
             constexpr double time_constant_s = 0.03;
             m.figure += k_N_per_m * (depth_m - m.kept.depth_m);
             m.figure = m.since_reset == 0 ? 0.0 : m.figure * std::exp(-(tip.t_s - m.last_t_s) / time_constant_s);
             m.kept.depth_m = depth_m;
             if (r.contact) r.f_W_N += std::max(m.figure, -r.f_W_N.dot(r.n_W)) * r.n_W;
           }}};
}

// Lengths below its epsilon are nothing to an engine that says so: moves, and where the contact point lies.
TEST_P(FaultMatrix, NothingIsNamedThatIsBelowTheDeclaredEpsilon) {
  for (const double epsilon_m : {2e-6, 8e-5}) {
    Fault moves{"small moves are none", ""};
    moves.before = [epsilon_m](TipState& tip, Memory& m) {
      Vec3& last = m.kept.contact_W_m;
      if (m.since_reset == 0 || (tip.p_W_m - last).norm() >= epsilon_m * m.unit) last = tip.p_W_m;
      tip.p_W_m = last;
    };
    const Fault off{"contact points are off", "", {}, [epsilon_m](auto& r, auto&, auto& m) {
                      if (!r.contact) return;
                      const Vec3 by_m = 0.5 * epsilon_m * Random(m.steps).direction();
                      r.f_W_N += 500.0 * by_m;
                      r.contact_W_m += m.unit * (by_m - 2.0 * std::min(0.0, by_m.dot(r.n_W)) * r.n_W);
                    }};
    for (const Fault& fault : {moves, off}) {
      Engine engine = planted(right(GetParam()), fault);
      engine.epsilon_m = epsilon_m;
      EXPECT_THAT(causes_of(engine), ::testing::IsEmpty()) << fault.name << ", " << epsilon_m << " m\n"
                                                           << sentences_of(engine);
    }
  }
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
    for (const Engine& inner : {engine, planted(engine, damper(0.05))}) {
      Engine one_late = planted(inner, late(1));
      one_late.lag_samples = 1;
      EXPECT_THAT(causes_of(one_late), ::testing::IsEmpty()) << "declared, at " << rate_Hz << " Hz\n"
                                                             << sentences_of(one_late);
    }
    for (const Fault& law : other_laws()) {
      const Engine other = planted(engine, law);
      EXPECT_THAT(causes_of(other), ::testing::IsEmpty()) << law.name << " at " << rate_Hz << " Hz\n"
                                                          << sentences_of(other);
    }
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
