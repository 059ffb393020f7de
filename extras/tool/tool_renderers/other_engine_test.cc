// The exact contacts and the checks held against an engine that is not Touchstone's: the Open Dynamics Engine, a
// rigid-body simulator with its own collision and its own contact solver, behind examples/ode. Where both solve the
// same statics they must agree to what the facets of the meshes and the engine's give (0.5 um at 10 N) allow.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "contacts/exact_cases.h"
#include "contacts/known_contacts.h"
#include "harness/plugin/plugin_tool.h"
#include "harness/tool/tool_checks.h"
#include "tool_errors.h"
#include "tool_renderers/tool_catalogue.h"

namespace touchstone::tool_renderers {
namespace {

class OtherEngine : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* const library = std::getenv("TOUCHSTONE_ODE_PLUGIN");
    if (library == nullptr) GTEST_SKIP() << "ODE (Debian: libode-dev) was not found when the build was configured";
    plugin::PluginOptions options;
    options.in_process = true;
    entries = plugin::load_tool_plugin(library, options);
    ASSERT_EQ(entries.size(), 1U);
  }
  std::vector<tool::ToolRendererEntry> entries;
};

// ODE's contacts of two meshes fail in holes (several newtons, whatever the clearance), so that the pegs are left out.
TEST_F(OtherEngine, AgreesWithTheExactContacts) {
  std::size_t compared = 0;
  for (const std::string& name : contacts::exact_case_names()) {
    if (name.starts_with("peg")) continue;
    SCOPED_TRACE(name);
    const tool::KnownContacts known = contacts::known_contacts(name, tool::Coupling{});
    tool::ToolSettings settings;
    settings.coupling = tool::Coupling{};
    const auto renderer = make_tool_renderer(entries[0], known.tool, known.object_W, settings);
    const tool::ToolErrors errors = errors_of(*renderer, entries[0].name, known);
    EXPECT_GT(errors.largest_right_force_N, 1.5);
    EXPECT_LT(errors.max_force_jnd, 0.3);
    EXPECT_LT(errors.max_torque_jnd, 0.3);
    ++compared;
  }
  EXPECT_EQ(compared, 9U);
}

TEST_F(OtherEngine, PassesWhatEveryRendererOfAToolMustDo) {
  std::size_t asked = 0;
  for (const tool::ToolFinding& finding : check_tool_renderer(subject_of(entries[0], {}))) {
    if (!finding.applies) continue;
    EXPECT_TRUE(finding.passed) << finding.check << ": " << finding.measured << " of " << finding.limit;
    ++asked;
  }
  EXPECT_GE(asked, 10U);
}

}  // namespace
}  // namespace touchstone::tool_renderers
