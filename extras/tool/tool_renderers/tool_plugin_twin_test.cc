// A renderer of tools behind the plug-in interface gives the same bits as in the program, in process and in a child:
// wrench, pose of the proxy, contacts.
#include <gtest/gtest.h>

#include <cstdlib>

#include "contacts/exact_cases.h"
#include "contacts/scripted_path.h"
#include "harness/plugin/plugin_tool.h"
#include "harness/tool/tool_checks.h"
#include "harness/tool/tool_path.h"
#include "tool_renderers/tool_catalogue.h"

namespace touchstone::tool_renderers {
namespace {

class ToolPluginTwin : public ::testing::TestWithParam<const char*> {};

TEST_P(ToolPluginTwin, GivesTheSameBits) {
  const contacts::ExactCase c = contacts::make_exact_case("peg-0.2mm");
  const tool::Tool tool{c.tool_T, tool::solid_mass_frame(c.tool_T, 1000.0)};
  tool::ToolSettings settings;
  settings.coupling = {731.5, 1.25};
  for (const bool in_process : {true, false}) {
    SCOPED_TRACE(in_process ? "in process" : "in a child");
    plugin::PluginOptions options;
    options.in_process = in_process;
    const auto plugged_entries = plugin::load_tool_plugin(std::getenv("TOUCHSTONE_TOOL_TWIN_PLUGIN"), options);
    ASSERT_EQ(plugged_entries.size(), 2U);
    const auto own = make_tool_renderer(GetParam(), tool, c.object_W, settings);
    const auto plugged = tool::make_tool_renderer(
        find_tool_renderer(plugged_entries, std::string(GetParam()) + "-twin"), tool, c.object_W, settings);
    std::size_t contacts = 0;
    for (int run = 0; run < 2; ++run) {
      own->reset();
      plugged->reset();
      for (int i = 0; i < 1500; ++i) {
        const double t_s = 1e-3 * i;
        const tool::ToolState state{t_s, contacts::scripted_pose(c, t_s, 3.0)};
        const tool::ToolResult expected = own->step(state);
        const tool::ToolResult obtained = plugged->step(state);
        ASSERT_EQ(obtained.status, tool::ToolStatus::ok) << plugged->failure();
        ASSERT_EQ(obtained.f_W_N, expected.f_W_N) << t_s;
        ASSERT_EQ(obtained.torque_W_Nm, expected.torque_W_Nm) << t_s;
        ASSERT_EQ(obtained.proxy.p_W_m, expected.proxy.p_W_m) << t_s;
        ASSERT_EQ(obtained.proxy.q_WT.coeffs(), expected.proxy.q_WT.coeffs()) << t_s;
        ASSERT_EQ(obtained.contact, expected.contact) << t_s;
        ASSERT_EQ(obtained.contacts.size(), expected.contacts.size()) << t_s;
        for (std::size_t k = 0; k < expected.contacts.size(); ++k) {
          ASSERT_EQ(obtained.contacts[k].p_W_m, expected.contacts[k].p_W_m) << t_s;
          ASSERT_EQ(obtained.contacts[k].n_W, expected.contacts[k].n_W) << t_s;
          ASSERT_EQ(obtained.contacts[k].f_W_N, expected.contacts[k].f_W_N) << t_s;
        }
        contacts += expected.contacts.size();
      }
    }
    EXPECT_GT(contacts, 1000U);
  }
}

INSTANTIATE_TEST_SUITE_P(Tools, ToolPluginTwin, ::testing::Values("god-object-tool", "penalty-coupling"),
                         [](const auto& tested) {
                           std::string name = tested.param;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

TEST(ToolPlugin, IsHeldToTheChecks) {
  const auto entries = plugin::load_tool_plugin(std::getenv("TOUCHSTONE_TOOL_TWIN_PLUGIN"), {});
  for (const tool::ToolFinding& finding :
       check_tool_renderer(subject_of(find_tool_renderer(entries, "god-object-tool-twin"), {}))) {
    EXPECT_TRUE(finding.passed) << finding.check;
  }
}

}  // namespace
}  // namespace touchstone::tool_renderers
