#include "harness/plugin/plugin.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "harness/base/error.h"
#include "harness/rendering/renderer_failed.h"
#include "harness/rendering/replay.h"
#include "harness/surface/embree_surface.h"
#include "harness/testing/tiny_meshes.h"

namespace touchstone::plugin {
using rendering::Ability;
using rendering::RendererEntry;
using rendering::RendererFailed;
using rendering::StepStatus;

namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::filesystem::path plugin(const std::string& name) {
  return std::filesystem::path(std::getenv("TOUCHSTONE_TEST_PLUGINS")) / (name + ".so");
}

PluginOptions options(bool in_process = false) {
  PluginOptions out;
  out.in_process = in_process;
  // Hangs are waited for in full; everything else answers long before.
  out.limits = {std::chrono::milliseconds(400), std::chrono::milliseconds(20'000)};
  return out;
}

std::unique_ptr<rendering::Renderer> make(const std::string& name, const PluginOptions& chosen,
                                          const std::map<std::string, double>& parameters = {}) {
  const auto entries = load_plugin(plugin(name), chosen);
  const RendererEntry& entry = *entries.at(0);
  return entry.make(rendering::Parameters(entry.parameters, parameters, "renderer " + entry.name, "test", ""),
                    make_embree_surface(testing::grid(0.02, 4)));
}

rendering::TipState tip(int i, double z) { return {1e-3 * (i + 1), {0.001, 0.002, z}, Quat::Identity()}; }

// Taps the plane; the error of the run, or "none".
std::string error_of_a_run(const std::string& name, const PluginOptions& chosen) {
  try {
    const auto renderer = make(name, chosen);
    recording::InTrajectory taps;
    for (int i = 0; i < 20; ++i) {
      taps.motion.t_s.push_back(1e-3 * i);
      taps.motion.p_W_m.emplace_back(0.0, 0.0, 1e-4 * (5 - i));
    }
    replay(*renderer, taps);
    return "none";
  } catch (const RendererFailed& error) {
    return std::string("failed: ") + error.what();
  } catch (const BadData& error) {
    return std::string("bad data: ") + error.what();
  }
}

TEST(Plugin, TellsWhatItDescribes) {
  for (const bool in_process : {false, true}) {
    const auto entries = load_plugin(plugin("NOTHING"), options(in_process));
    ASSERT_EQ(entries.size(), 1U);
    const RendererEntry& entry = *entries[0];
    EXPECT_EQ(entry.name, "plane");
    EXPECT_EQ(entry.summary, "the plane z = 0, F = k dx");
    EXPECT_EQ(entry.source, "Hooke's law");
    ASSERT_EQ(entry.parameters.size(), 1U);
    EXPECT_EQ(entry.parameters[0].name, "stiffness_N_per_m");
    EXPECT_EQ(entry.parameters[0].unit, "N/m");
    EXPECT_EQ(entry.parameters[0].maximum, 1e6);
    EXPECT_EQ(entry.parameters[0].initial, 500.0);
    ASSERT_NE(find_limitation(entry.cannot, Ability::thin_shells), nullptr);
    EXPECT_EQ(find_limitation(entry.cannot, Ability::thin_shells)->reason, "it knows one plane only");
    EXPECT_NE(find_limitation(entry.cannot, Ability::analytic_surface), nullptr);
  }
}

TEST(Plugin, RendersTheSameInItsChildAsHere) {
  const auto here = make("NOTHING", options(true), {{"stiffness_N_per_m", 321.0}});
  const auto child = make("NOTHING", options(false), {{"stiffness_N_per_m", 321.0}});
  for (int run = 0; run < 2; ++run) {
    here->reset();
    child->reset();
    for (int i = 0; i < 2000; ++i) {
      const rendering::TipState at = tip(i, 1e-3 * std::sin(0.01 * i));
      const rendering::StepResult expected = here->step(at);
      const rendering::StepResult obtained = child->step(at);
      ASSERT_EQ(obtained.status, StepStatus::ok) << child->failure();
      ASSERT_EQ(obtained.f_W_N, expected.f_W_N);
      ASSERT_EQ(obtained.contact_W_m, expected.contact_W_m);
      ASSERT_EQ(obtained.n_W, expected.n_W);
      ASSERT_EQ(obtained.depth_m, expected.depth_m);
      ASSERT_EQ(obtained.contact, expected.contact);
      if (at.p_W_m.z() < 0.0) {
        ASSERT_EQ(obtained.f_W_N.z(), 321.0 * -at.p_W_m.z());
      }
    }
  }
  EXPECT_EQ(child->failure(), "");
}

// What each misbehaviour must be reported as. "failed" ends the program with status 1, "bad data" with 3.
struct Reported {
  std::string plugin;
  std::vector<std::string> words;
  bool in_process_too = true;  // crashes and hangs are not caught there
};

void PrintTo(const Reported& reported, std::ostream* out) { *out << reported.plugin; }

class Misbehaving : public ::testing::TestWithParam<Reported> {};

TEST_P(Misbehaving, IsReportedAsWhatItIs) {
  std::vector<bool> modes{false};
  if (GetParam().in_process_too) modes.push_back(true);
  for (const bool in_process : modes) {
    SCOPED_TRACE(in_process ? "in process" : "in a child");
    const std::string error = error_of_a_run(GetParam().plugin, options(in_process));
    EXPECT_THAT(error, HasSubstr(GetParam().plugin + ".so"));
    for (const std::string& word : GetParam().words) EXPECT_THAT(error, HasSubstr(word));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Plugin, Misbehaving,
    ::testing::Values(
        Reported{"CRASHES_IN_STEP", {"failed: sample 4", "crashed (SIGABRT", "touchstone_step", "at step 5"}, false},
        Reported{"HANGS_IN_STEP", {"failed: ", "did not come back from touchstone_step within 0.4 s"}, false},
        Reported{"RETURNS_NAN", {"failed: ", "answered f_W_N[1] = nan", "no finite number", "at step 5"}},
        Reported{"CRASHES_IN_CREATE", {"failed: ", "crashed (SIGABRT", "touchstone_create"}, false},
        Reported{"FOLLOWS_ANOTHER_VERSION", {"bad data: ", "version 99", "this program versions 1 and 2"}},
        Reported{"LIES_ABOUT_ITS_VERSION",
                 {"bad data: ", "says that it follows version 1", "touchstone_result has 24 bytes"}},
        Reported{"LACKS_A_FUNCTION", {"bad data: ", "exports no touchstone_step"}},
        Reported{"CRASHES_WHEN_LOADED", {"failed: ", "crashed (SIGABRT", "while it was loaded"}, false},
        Reported{"FAILS_WITH_A_REASON", {"failed: ", "touchstone_step failed: the solver did not converge"}},
        Reported{"THROWS_WHAT_IT_LIKES",
                 {"failed: sample 2", "touchstone_step failed: the engine threw something that is no std::exception"}},
        Reported{"WRITES_TO_THE_MESH", {"failed: ", "crashed (SIGSEGV", "touchstone_step"}, false},
        Reported{"EXITS", {"failed: ", "ended its process with exit status 7", "touchstone_step"}, false},
        Reported{"REFUSES_TO_BE_MADE", {"failed: ", "it does not want to be made"}},
        Reported{"DESCRIBES_NONSENSE", {"bad data: ", "stiffness_N_per_m", "minimum"}},
        Reported{"IS_NO_PLUGIN", {"bad data: ", "no plug-in of Touchstone", "touchstone_plugin_version"}},
        Reported{"IS_NOT_THERE", {"bad data: ", "there is no such plug-in"}}),
    [](const auto& tested) { return tested.param.plugin; });

TEST(Plugin, AnEnginesOwnExceptionWhileItIsMadeIsAnError) {
  for (const bool in_process : {false, true}) {
    const auto entries = load_plugin(plugin("THROWS_WHAT_IT_LIKES"), options(in_process));
    ASSERT_EQ(entries.size(), 2U);
    const RendererEntry& entry = *entries[1];
    try {
      entry.make(rendering::Parameters(entry.parameters, {}, "", "", ""), make_embree_surface(testing::grid(0.02, 4)));
      ADD_FAILURE() << "made";
    } catch (const RendererFailed& error) {
      EXPECT_THAT(error.what(), HasSubstr("no std::exception"));
    }
  }
}

TEST(Plugin, HangsWhenDescribed) {
  PluginOptions short_patience = options();
  short_patience.limits.create = std::chrono::milliseconds(300);
  EXPECT_THAT(error_of_a_run("HANGS_WHEN_DESCRIBED", short_patience),
              AllOf(HasSubstr("failed: "), HasSubstr("did not come back from being loaded")));
}

TEST(Plugin, AFileThatIsNoLibraryIsSaidToBeNone) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "not_a_library.so";
  std::ofstream(file) << "just words\n";
  for (const bool in_process : {false, true}) {
    try {
      load_plugin(file, options(in_process));
      FAIL() << "loaded";
    } catch (const BadData& error) {
      EXPECT_THAT(error.what(),
                  AllOf(HasSubstr("not_a_library.so"), HasSubstr("cannot be loaded as a shared library")));
    }
  }
  EXPECT_THROW(load_plugin(::testing::TempDir(), options()), BadData);
  std::filesystem::remove(file);
}

TEST(Plugin, AfterACrashTheProgramGoesOnAndTheRendererStaysFailed) {
  const auto broken = make("CRASHES_IN_STEP", options());
  const auto healthy = make("NOTHING", options());
  broken->reset();
  healthy->reset();
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(broken->step(tip(i, -1e-3)).status, i < 4 ? StepStatus::ok : StepStatus::failed);
    EXPECT_EQ(broken->step(tip(i, -1e-3)).f_W_N, Vec3::Zero());
    EXPECT_EQ(healthy->step(tip(i, -1e-3)).f_W_N.z(), 0.5);
    if (i == 3) break;
  }
  EXPECT_EQ(broken->step(tip(20, -1e-3)).status, StepStatus::failed);
  EXPECT_EQ(broken->step(tip(21, -1e-3)).status, StepStatus::failed);
  EXPECT_THROW(broken->reset(), RendererFailed);
  EXPECT_THAT(broken->failure(), HasSubstr("SIGABRT"));
}

TEST(Plugin, WhatItPrintsIsNoResult) {
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  {
    const auto renderer = make("PRINTS", options());
    renderer->reset();
    renderer->step(tip(0, -1e-3));
  }
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  ::testing::internal::GetCapturedStderr();
}

TEST(Plugin, ManyAtOnceAndOneAfterTheOther) {
  std::vector<std::unique_ptr<rendering::Renderer>> renderers;
  for (int i = 0; i < 20; ++i) renderers.push_back(make("NOTHING", options()));
  for (const auto& renderer : renderers) renderer->reset();
  for (int i = 0; i < 50; ++i) {
    for (const auto& renderer : renderers) ASSERT_EQ(renderer->step(tip(i, -1e-3)).f_W_N.z(), 0.5);
  }
}

TEST(Plugin, ANameThatIsTakenIsRefused) {
  Plugins plugins;
  const std::vector<std::string> known{"god-object"};
  plugins.load(plugin("NOTHING"), options(), known);
  try {
    plugins.load(plugin("PRINTS"), options(), known);
    FAIL() << "loaded";
  } catch (const BadData& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("NOTHING.so"), HasSubstr("PRINTS.so"), HasSubstr("plane")));
  }
  Plugins other;
  EXPECT_THROW(other.load(plugin("NOTHING"), options(), std::vector<std::string>{"plane"}), BadData);

  rendering::Model model;
  model.renderer = "plane";
  plugins.provide(model);
  ASSERT_NE(model.provided, nullptr);
  EXPECT_EQ(model.provided->name, "plane");
  model = {};
  model.renderer = "god-object";
  plugins.provide(model);
  EXPECT_EQ(model.provided, nullptr);
}

TEST(Plugin, WithoutItsHostProgramItSaysSo) {
  PluginOptions lost = options();
  lost.host = "/nowhere/touchstone-plugin-host";
  EXPECT_THROW(load_plugin(plugin("NOTHING"), lost), RendererFailed);
}

}  // namespace
}  // namespace touchstone::plugin
