// Recordings of a corner of a cube on a plane, whose wrench is known from quasi_static.h and not from a renderer; with
// noise, and with each effect of the instrument planted.
#include "tool_fitting/tool_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "contacts/exact_cases.h"
#include "harness/base/error.h"
#include "harness/base/random.h"
#include "tool_fitting/tool_fit_page.h"
#include "tool_renderers/tool_catalogue.h"

namespace touchstone::tool_fitting {
namespace {

using contacts::quasi_static_equilibrium;
using tool::Coupling;
using tool::Pose;

struct Planted {
  Vec3 force_bias_N = Vec3::Zero(), torque_bias_Nm = Vec3::Zero(), lever_m = Vec3::Zero();
  double compliance_m_per_N = 0.0, rotational_compliance_rad_per_Nm = 0.0;
  double mass_kg = 0.0;
  Vec3 center_m = Vec3::Zero();
};

constexpr double force_noise_N = 0.02;
constexpr double torque_noise_Nm = 0.5e-3;
const Vec3 corner_T_m(0.01, 0.01, -0.03);

// The cube's corner at corner_T_m is lowest all the way; the tool turns by 0.25 rad about all axes.
Pose pose_at(double t_s) {
  const Quat q =
      tool::rotation_by(Vec3(0.25 * std::sin(1.1 * t_s), 0.25 * std::sin(1.7 * t_s), 0.25 * std::sin(0.6 * t_s))) *
      tool::rotation_by(Vec3(-0.6, 0.0, 0.0)) * tool::rotation_by(Vec3(0.0, 0.6, 0.0));
  const double depth_m = 1.5e-3 * (0.6 - std::cos(2.3 * t_s));  // begins above it
  return {Vec3(3e-3 * std::sin(0.9 * t_s), 0.0, -(q * corner_T_m).z() - depth_m), q};
}

// `every`: of its samples that are taken.
recording::Recording recorded(const Planted& planted, std::uint64_t seed, int every = 1) {
  const Coupling declared;
  const Coupling real{
      1.0 / (1.0 / declared.stiffness_N_per_m + planted.compliance_m_per_N),
      1.0 / (1.0 / declared.rotational_stiffness_Nm_per_rad + planted.rotational_compliance_rad_per_Nm)};
  const std::vector<contacts::GapOfPose> gaps{contacts::ball_on_plane(corner_T_m, 0.0, Vec3::UnitZ(), 0.0)};
  Random random(seed);
  recording::Recording recording;
  recording.source = "corner";
  for (int i = 0; i < 2000; i += every) {
    const double t_s = 0.01 * i;
    const Pose pose = pose_at(t_s);
    const Wrench truth = quasi_static_equilibrium(gaps, pose, real).wrench_W;
    const auto noise = [&](double sigma) -> Vec3 {
      return sigma * Vec3(random.normal(), random.normal(), random.normal());
    };
    // As pose.h has it: a sensor whose origin lies at p + R r.
    const Wrench at_sensor = wrench_about(truth, pose.q_WT * planted.lever_m);
    recording.motion.t_s.push_back(t_s);
    recording.motion.p_W_m.push_back(pose.p_W_m);
    recording.motion.q_WS.push_back(pose.q_WT);
    const Vec3 weight(0.0, 0.0, -9.80665 * planted.mass_kg);
    recording.f_W_N.push_back(at_sensor.f_N + weight + pose.q_WT * (planted.force_bias_N + noise(force_noise_N)));
    recording.torque_W_Nm.push_back(at_sensor.torque_Nm + (pose.q_WT * planted.center_m).cross(weight) +
                                    pose.q_WT * (planted.torque_bias_Nm + noise(torque_noise_Nm)));
  }
  return recording;
}

ToolFit fitted(const recording::Recording& recording) {
  const auto made = contacts::box_mesh(Vec3(-0.01, -0.01, -0.03), Vec3(0.01, 0.01, -0.01));
  const tool::Tool solid{made, tool::solid_mass_frame(made, 1000.0)};
  const auto plane = contacts::box_mesh(Vec3(-0.1, -0.1, -0.05), Vec3(0.1, 0.1, 0.0));
  const MakeTool make = [&](const Coupling& coupling) {
    return tool_renderers::make_tool_renderer("god-object-tool", solid, plane, {coupling, {}});
  };
  return fit_tool(recording, make, {});
}

std::vector<std::string> named(const ToolFit& fit) {
  std::vector<std::string> names;
  for (const ToolEffect& effect : fit.effects) {
    if (effect.named) names.push_back(effect.name);
  }
  return names;
}

const ToolEffect& effect_of(const ToolFit& fit, const std::string& name) {
  return *std::ranges::find(fit.effects, name, &ToolEffect::name);
}

void expect_values(const ToolFit& fit, const std::string& name, const Vec3& expected) {
  const ToolEffect& effect = effect_of(fit, name);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(effect.values[k], expected[static_cast<Eigen::Index>(k)], 4.0 * effect.standard_errors[k]) << name;
}

TEST(ToolFit, NamesWhatWasPlantedAndLeavesTheNoise) {
  const Vec3 lever(2e-3, -3e-3, 5e-3), force(0.1, -0.05, 0.2), torque(4e-3, 0.0, -3e-3);
  const struct {
    Planted planted;
    std::vector<std::string> names;
  } cases[] = {
      {{.force_bias_N = force}, {"force-bias"}},
      {{.torque_bias_Nm = torque}, {"torque-bias"}},
      {{.lever_m = lever}, {"lever-arm"}},
      {{.compliance_m_per_N = 0.25e-3}, {"stiffness"}},
      {{.rotational_compliance_rad_per_Nm = 0.3}, {"rotational-stiffness"}},
      {{force, torque, lever, 0.25e-3, 0.3},
       {"force-bias", "torque-bias", "lever-arm", "stiffness", "rotational-stiffness"}},
      {{.mass_kg = 0.03, .center_m = Vec3(4e-3, -2e-3, -20e-3)}, {"tool-weight"}},
      {{.force_bias_N = force, .mass_kg = 0.03, .center_m = Vec3(4e-3, -2e-3, -20e-3)}, {"force-bias", "tool-weight"}},
  };
  std::uint64_t seed = 400;
  for (const auto& one : cases) {
    const Planted& planted = one.planted;
    const ToolFit fit = fitted(recorded(planted, seed++));
    EXPECT_EQ(named(fit), one.names) << tool_fit_text(fit);
    EXPECT_EQ(to_string(fit.verdict), "explained") << tool_fit_text(fit);
    EXPECT_NEAR(fit.after.force_N, std::sqrt(3.0) * force_noise_N, 0.1 * force_noise_N) << one.names.front();
    EXPECT_NEAR(fit.after.torque_Nm, std::sqrt(3.0) * torque_noise_Nm, 0.1 * torque_noise_Nm) << one.names.front();
    if (!planted.force_bias_N.isZero()) expect_values(fit, "force-bias", planted.force_bias_N);
    if (!planted.torque_bias_Nm.isZero()) expect_values(fit, "torque-bias", planted.torque_bias_Nm);
    if (!planted.lever_m.isZero()) expect_values(fit, "lever-arm", planted.lever_m);
    if (planted.mass_kg > 0.0) {
      const ToolEffect& weight = effect_of(fit, "tool-weight");
      EXPECT_NEAR(weight.values[0], planted.mass_kg, 4.0 * weight.standard_errors[0]);
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(weight.values[k + 1], planted.mass_kg * planted.center_m[static_cast<Eigen::Index>(k)],
                    4.0 * weight.standard_errors[k + 1]);
      }
    }
    if (planted.compliance_m_per_N > 0.0) {
      EXPECT_NEAR(fit.coupling.stiffness_N_per_m, 800.0, 4.0 * effect_of(fit, "stiffness").standard_errors[0]);
    }
    if (planted.rotational_compliance_rad_per_Nm > 0.0) {
      EXPECT_NEAR(fit.coupling.rotational_stiffness_Nm_per_rad, 1.25,
                  4.0 * effect_of(fit, "rotational-stiffness").standard_errors[0]);
    }
  }
}

TEST(ToolFit, NothingIsNamedWhereNothingWasPlanted) {
  int wrong = 0;
  for (std::uint64_t seed = 500; seed < 510; ++seed) wrong += named(fitted(recorded({}, seed))).empty() ? 0 : 1;
  // 5 % of the runs may name something; four of ten would at a rate of 0.1 %.
  EXPECT_LE(wrong, 3);
}

// Pressed and let go without turning.
recording::Recording recorded_without_turning(std::uint64_t seed) {
  recording::Recording recording = recorded({}, seed);
  const Pose still = pose_at(0.0);
  Random random(seed + 1);
  const std::vector<contacts::GapOfPose> gaps{contacts::ball_on_plane(corner_T_m, 0.0, Vec3::UnitZ(), 0.0)};
  for (std::size_t i = 0; i < recording.size(); ++i) {
    const Pose pose{still.p_W_m - Vec3(0, 0, 1.5e-3 * (1.0 - std::cos(0.02 * double(i)))), still.q_WT};
    const Wrench truth = quasi_static_equilibrium(gaps, pose, {}).wrench_W;
    recording.motion.p_W_m[i] = pose.p_W_m;
    recording.motion.q_WS[i] = pose.q_WT;
    recording.f_W_N[i] = truth.f_N + force_noise_N * Vec3(random.normal(), random.normal(), random.normal());
    recording.torque_W_Nm[i] =
        truth.torque_Nm + torque_noise_Nm * Vec3(random.normal(), random.normal(), random.normal());
  }
  return recording;
}

// The lever arm along the force shifts nothing.
TEST(ToolFit, SaysWhatTheMotionDoesNotTell) {
  EXPECT_THAT(tool_fit_text(fitted(recorded_without_turning(600))),
              ::testing::HasSubstr("is not determined by this motion"));
}

// A weight and a bias differ only by how they turn with the tool: neither is claimed where it does not turn.
TEST(ToolFit, SaysWhichEffectsTheMotionCannotTellApart) {
  recording::Recording recording = recorded_without_turning(610);
  for (Vec3& f : recording.f_W_N) f.z() -= 0.3;
  const ToolFit fit = fitted(recording);
  EXPECT_EQ(to_string(fit.verdict), "not-identifiable") << tool_fit_text(fit);
  std::vector<std::string> both = named(fit);
  ASSERT_EQ(both.size(), 1U) << tool_fit_text(fit);
  for (const std::string& rival : effect_of(fit, both[0]).rivals) both.push_back(rival);
  EXPECT_THAT(both, ::testing::UnorderedElementsAre("force-bias", "tool-weight"));
  EXPECT_THAT(tool_fit_text(fit), ::testing::HasSubstr("this motion cannot tell them apart"));
  // The same where the tool turns: one of them, by name.
  EXPECT_TRUE(effect_of(fitted(recorded({.force_bias_N = Vec3(0, 0, -0.3)}, 611)), "force-bias").rivals.empty());
}

// On blocks that were not fitted, with what was planted over without it; and nothing of what was not.
TEST(ToolFit, GivesTheEvidenceOfEachName) {
  const ToolFit fit = fitted(recorded({.lever_m = Vec3(2e-3, -3e-3, 5e-3), .mass_kg = 0.03}, 620));
  EXPECT_THAT(named(fit), ::testing::ElementsAre("lever-arm", "tool-weight"));
  for (const ToolEffect& effect : fit.effects) {
    if (effect.named) {
      EXPECT_GT(effect.gain.per_sample, 0.1) << effect.name;
      EXPECT_LT(effect.gain.p, 1e-3) << effect.name;
      EXPECT_TRUE(effect.rivals.empty()) << effect.name;
    } else {
      EXPECT_LT(effect.gain.per_sample, 0.01) << effect.name;
    }
  }
}

TEST(ToolFit, SaysThatARecordingIsMisread) {
  const Planted planted{.force_bias_N = Vec3(0.1, -0.05, 0.2), .compliance_m_per_N = 0.1e-3, .mass_kg = 0.03};
  for (const std::string reading : {"torque-sign", "wrench-sign", "torque-frame", "wrench-frame", "none"}) {
    recording::Recording wrong = recorded(planted, 630, 2);
    for (std::size_t i = 0; i < wrong.size(); ++i) {
      const Quat to_T = wrong.motion.q_WS[i].conjugate();
      Vec3& f = wrong.f_W_N[i];
      Vec3& torque = wrong.torque_W_Nm[i];
      if (reading.ends_with("sign")) torque = -torque;
      if (reading == "wrench-sign") f = -f;
      if (reading.ends_with("frame")) torque = to_T * torque;
      if (reading == "wrench-frame") f = to_T * f;
    }
    const ToolFit fit = fitted(wrong);
    EXPECT_EQ(fit.misreading ? fit.misreading->name : "none", reading) << tool_fit_text(fit);
    EXPECT_EQ(to_string(fit.verdict), reading == "none" ? "explained" : "unexplained") << tool_fit_text(fit);
  }
}

// Dry friction of the contact, which no instrument has.
TEST(ToolFit, SaysThatSomethingIsLeft) {
  recording::Recording recording = recorded({}, 640);
  for (std::size_t i = 0; i < recording.size(); ++i) {
    const double v = std::cos(0.9 * recording.motion.t_s[i]);
    const double pull = 0.4 * std::max(0.0, recording.f_W_N[i].z()) * (v > 0.0 ? -1.0 : 1.0);
    recording.f_W_N[i].x() += pull;
    recording.torque_W_Nm[i] += (recording.motion.q_WS[i] * corner_T_m).cross(Vec3(pull, 0, 0));
  }
  const ToolFit fit = fitted(recording);
  EXPECT_EQ(to_string(fit.verdict), "unexplained") << tool_fit_text(fit);
  EXPECT_FALSE(fit.misreading.has_value());
  EXPECT_THAT(tool_fit_text(fit), ::testing::HasSubstr("of which the samples' own noise is"));
}

TEST(ToolFit, WarnsOfARecordingThatBeginsInContact) {
  recording::Recording late = recorded({}, 650);
  const auto cut = [](auto& column) { column.erase(column.begin(), column.begin() + 137); };  // at its deepest
  cut(late.motion.t_s);
  cut(late.motion.p_W_m);
  cut(late.motion.q_WS);
  cut(late.f_W_N);
  cut(late.torque_W_Nm);
  EXPECT_THAT(tool_fit_text(fitted(late)), ::testing::HasSubstr("begins in contact"));
  EXPECT_THAT(tool_fit_text(fitted(recorded({}, 650))), ::testing::Not(::testing::HasSubstr("begins in contact")));
}

TEST(ToolFit, RefusesWhatCannotBeFitted) {
  const recording::Recording good = recorded({}, 700);
  recording::Recording bad = good;
  bad.torque_W_Nm.clear();
  EXPECT_THROW(fitted(bad), BadData);
  bad = good;
  bad.motion.q_WS.clear();
  EXPECT_THROW(fitted(bad), BadData);
  bad = good;
  for (Vec3& p : bad.motion.p_W_m) p.z() += 0.1;
  EXPECT_THROW(fitted(bad), BadData);
  // A sensor of forces whose file has columns of zeros for the torque.
  bad = good;
  std::ranges::fill(bad.torque_W_Nm, Vec3::Zero());
  EXPECT_THROW(fitted(bad), BadData);
}

TEST(ToolFit, PageAndJsonHoldTheSame) {
  const recording::Recording recording = recorded({Vec3::Zero(), Vec3::Zero(), Vec3(2e-3, 0, 4e-3), 0.0, 0.0}, 800);
  const ToolFit fit = fitted(recording);
  const auto json = nlohmann::json::parse(tool_fit_json(fit));
  EXPECT_EQ(json["effects"][2]["values"][2].get<double>(), effect_of(fit, "lever-arm").values[2]);
  const report::Page page = tool_fit_page(recording, fit, {});
  EXPECT_THAT(page.subtitle, ::testing::HasSubstr("lever-arm"));
  ASSERT_EQ(page.sections[1].blocks.size(), 6U);
}

}  // namespace
}  // namespace touchstone::tool_fitting
