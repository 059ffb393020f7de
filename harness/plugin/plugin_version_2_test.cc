// Version 2 of the plug-in interface: points through every command's path, tools with torque, proxy and contacts, and
// what goes wrong, in process and in a child.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "harness/base/error.h"
#include "harness/plugin/plugin.h"
#include "harness/plugin/plugin_tool.h"
#include "harness/rendering/renderer_failed.h"
#include "harness/surface/box_mesh.h"
#include "harness/surface/embree_surface.h"
#include "harness/testing/tiny_meshes.h"

namespace touchstone::plugin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::filesystem::path library(const std::string& name) {
  return std::filesystem::path(std::getenv("TOUCHSTONE_TEST_PLUGINS")) / (name + ".so");
}

PluginOptions how(bool in_process) {
  PluginOptions out;
  out.in_process = in_process;
  return out;
}

TEST(PluginVersion2, SaysWhatItCannotTellApartAndItsUnit) {
  for (const bool in_process : {false, true}) {
    const auto points = load_plugin(library("NOTHING_2"), how(in_process));
    ASSERT_EQ(points.size(), 1U);  // the tool's renderer is not one of points
    EXPECT_EQ(points[0]->name, "plane-2");
    EXPECT_EQ(points[0]->epsilon_m, 1e-9);
    EXPECT_EQ(points[0]->world_unit_m, 1e-3);
    EXPECT_NE(find_limitation(points[0]->cannot, rendering::Ability::thin_shells), nullptr);
    const auto tools = load_tool_plugin(library("NOTHING_2"), how(in_process));
    ASSERT_EQ(tools.size(), 1U);
    EXPECT_EQ(tools[0].name, "plane-tool-2");
    EXPECT_EQ(tools[0].parameters.at(0).name, "stiffness_N_per_m");
  }
}

// The same plane in both versions of the interface.
TEST(PluginVersion2, RendersAPointToTheBitAsVersion1) {
  const auto make = [](const std::string& name, bool in_process) {
    const auto entries = load_plugin(library(name), how(in_process));
    return entries.at(0)->make(
        rendering::Parameters(entries[0]->parameters, {{"stiffness_N_per_m", 321.0}}, "", "", ""),
        make_embree_surface(testing::grid(0.02, 4)));
  };
  for (const bool in_process : {false, true}) {
    const auto first = make("NOTHING", in_process);
    const auto second = make("NOTHING_2", in_process);
    first->reset();
    second->reset();
    for (int i = 0; i < 1000; ++i) {
      const rendering::TipState tip{
          1e-3 * (i + 1), {0.001, 0.002, 1e-3 * std::sin(0.01 * i)}, Quat(0.6, 0.0, 0.8, 0.0)};
      const rendering::StepResult expected = first->step(tip);
      const rendering::StepResult obtained = second->step(tip);
      ASSERT_EQ(obtained.status, rendering::StepStatus::ok) << second->failure();
      ASSERT_EQ(obtained.f_W_N, expected.f_W_N);
      ASSERT_EQ(obtained.contact_W_m, expected.contact_W_m);
      ASSERT_EQ(obtained.n_W, expected.n_W);
      ASSERT_EQ(obtained.depth_m, expected.depth_m);
      ASSERT_EQ(obtained.contact, expected.contact);
    }
  }
}

tool::Tool cube() { return tool::solid_tool(surface::box_mesh({-0.01, -0.01, -0.01}, {0.01, 0.01, 0.01})); }

std::unique_ptr<tool::ToolRenderer> make_tool(const std::string& name, bool in_process) {
  const auto entries = load_tool_plugin(library(name), how(in_process));
  return tool::make_tool_renderer(entries.at(0), cube(), surface::box_mesh({-1, -1, -1}, {1, 1, 0}), {});
}

// Four springs of 500 N/m at the corners below a cube of 20 mm whose centre is held 9 mm high: 4 x 0.5 N. Turned by a
// small angle a about y, a corner at (x, y, -h) moves to x - h a and sinks by x a: the torque is
// sum -(x - h a) k (d + x a) = -4 k a (x^2 - h d).
TEST(PluginVersion2, RendersAToolWithTorqueAndContacts) {
  for (const bool in_process : {false, true}) {
    const auto renderer = make_tool("NOTHING_2", in_process);
    renderer->reset();
    const tool::ToolResult flat = renderer->step({0.0, {{0.1, 0.2, 0.009}, Quat::Identity()}});
    ASSERT_EQ(flat.status, tool::ToolStatus::ok) << renderer->failure();
    EXPECT_NEAR(flat.f_W_N.z(), 2.0, 1e-12);
    EXPECT_NEAR(flat.torque_W_Nm.norm(), 0.0, 1e-12);
    ASSERT_EQ(flat.contacts.size(), 4U);
    EXPECT_NEAR(flat.contacts[0].f_W_N.z(), 0.5, 1e-12);
    EXPECT_NEAR(flat.contacts[0].p_W_m.z(), -0.001, 1e-15);
    EXPECT_EQ(flat.proxy.p_W_m, Vec3(0.1, 0.2, 0.009));
    const double angle = 1e-3;
    const tool::ToolResult turned = renderer->step({1e-3, {{0.1, 0.2, 0.009}, tool::rotation_by({0, angle, 0})}});
    EXPECT_NEAR(turned.torque_W_Nm.y(), -4.0 * 500.0 * angle * (0.01 * 0.01 - 0.01 * 0.001), 1e-7);
    const tool::ToolResult away = renderer->step({2e-3, {{0.1, 0.2, 0.02}, Quat::Identity()}});
    EXPECT_FALSE(away.contact);
    EXPECT_TRUE(away.contacts.empty());
    EXPECT_EQ(away.f_W_N, Vec3::Zero());
  }
}

std::string failure_of(const std::string& name, bool in_process) {
  try {
    const auto renderer = make_tool(name, in_process);
    renderer->reset();
    for (int i = 0; i < 10; ++i) {
      const tool::ToolResult result = renderer->step({1e-3 * i, {{0.0, 0.0, 0.009}, Quat::Identity()}});
      if (result.status == tool::ToolStatus::failed) {
        EXPECT_EQ(result.f_W_N, Vec3::Zero());
        EXPECT_EQ(renderer->step({1.0, {}}).status, tool::ToolStatus::failed) << "it stays failed";
        return "failed: " + renderer->failure();
      }
    }
  } catch (const BadData& error) {
    return std::string("bad data: ") + error.what();
  } catch (const rendering::RendererFailed& error) {
    return std::string("failed: ") + error.what();
  }
  return "none";
}

TEST(PluginVersion2, WhatGoesWrongIsSaid) {
  const std::map<std::string, std::vector<std::string>> cases{
      {"HAS_A_SHORT_DESCRIPTION", {"bad data: ", "version 2", "touchstone2_description is 40"}},
      {"HAS_AN_UNKNOWN_TIP", {"bad data: ", "plane-2", "tip_kind is 7"}},
      {"HAS_A_NEGATIVE_EPSILON", {"bad data: ", "epsilon_m is -1"}},
      {"WRITES_TOO_MANY_CONTACTS", {"failed: ", "wrote 1000000 contacts, where there is room for 512", "at step 5"}},
      {"RETURNS_NAN_TORQUE", {"failed: ", "answered torque_W_Nm[1] = nan", "at step 5"}},
      {"RETURNS_A_NAN_CONTACT", {"failed: ", "a contact with a number that is not finite", "at step 5"}},
      {"FAILS_WITH_A_REASON_2", {"failed: ", "touchstone2_step failed: the solver did not converge"}},
  };
  for (const auto& [name, words] : cases) {
    for (const bool in_process : {false, true}) {
      SCOPED_TRACE(name + (in_process ? " in process" : " in a child"));
      const std::string said = failure_of(name, in_process);
      EXPECT_THAT(said, HasSubstr(name + ".so"));
      for (const std::string& word : words) EXPECT_THAT(said, HasSubstr(word));
    }
  }
  EXPECT_THAT(failure_of("CRASHES_IN_STEP_2", false),
              AllOf(HasSubstr("crashed (SIGABRT"), HasSubstr("touchstone2_step"), HasSubstr("at step 5")));
}

TEST(PluginVersion2, ALibraryOfVersion1HasNoTools) {
  EXPECT_TRUE(load_tool_plugin(library("NOTHING"), how(true)).empty());
}

}  // namespace
}  // namespace touchstone::plugin
