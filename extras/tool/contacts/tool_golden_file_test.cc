// What a golden of tools says is what is held: tolerances per axis, errors with their place, acceptance with a reason.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "contacts/tool_golden.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/recording/recording_file.h"
#include "harness/testing/temporary_folder.h"
#include "tool_metrics.h"

namespace touchstone::contacts {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

// Half of the handle's depth as a force, and a torque about z that grows with `more`.
class Simple : public tool::ToolRenderer {
 public:
  explicit Simple(double more) : more_(more) {}

 protected:
  void do_reset() override {}
  tool::ToolResult do_step(const tool::ToolState& state, double /*dt_s*/) noexcept override {
    tool::ToolResult result;
    result.f_W_N = Vec3(0, 0, -500.0 * state.handle.p_W_m.z());
    result.torque_W_Nm = Vec3(0.01, 0.0, more_ * state.t_s);
    result.contact = true;
    return result;
  }

 private:
  double more_;
};

tool::ToolRendererEntry simple(double more) {
  tool::ToolRendererEntry entry;
  entry.name = "simple";
  entry.make = [more](const rendering::Parameters&, const tool::Tool&, const surface::TriangleMesh&,
                      const tool::Coupling&) { return std::make_unique<Simple>(more); };
  return entry;
}

json described() {
  return json::parse(R"({"schema": "touchstone-tool-golden/1", "case": "box-corner", "seconds": 0.5, "keep_every": 10,
    "stiffness_N_per_m": 1000, "rotational_stiffness_Nm_per_rad": 2, "renderers": ["simple"],
    "tolerance": {"force_N": [1e-6, 1e-6, 1e-6], "torque_Nm": [1e-7, 1e-7, 1e-3], "reason": "a test"},
    "accepted": []})");
}

std::filesystem::path written(const testing::TemporaryFolder& folder, const json& document) {
  write_file(folder.path() / "golden.json", document.dump());
  return folder.path() / "golden.json";
}

TEST(ToolGoldenFile, EachAxisHasItsTolerance) {
  const testing::TemporaryFolder folder;
  const ToolGolden golden = read_tool_golden(written(folder, described()));
  accept_tool_golden(golden, simple(0.0), "the first", "abc");
  const recording::Recording expected = recording::load_recording(golden.answer("simple"));
  ASSERT_EQ(expected.size(), 51U);
  const auto passes = [&](double more) {
    return tool::within(tool::compare_tools(expected, answer_now(golden, simple(more))), golden.force_tolerance_N,
                        golden.torque_tolerance_Nm);
  };
  EXPECT_TRUE(passes(0.0));
  EXPECT_TRUE(passes(1.9e-3)) << "0.95 mNm about z at the end";
  EXPECT_FALSE(passes(2.1e-3));
  const json after = json::parse(read_file(golden.file));
  ASSERT_EQ(after["accepted"].size(), 1U);
  EXPECT_EQ(after["accepted"][0]["reason"], "the first");
  EXPECT_EQ(after["accepted"][0]["commit"], "abc");
  EXPECT_NO_THROW(read_tool_golden(golden.file));
}

TEST(ToolGoldenFile, SaysWhatIsWrong) {
  const testing::TemporaryFolder folder;
  const auto message = [&](const json& document) -> std::string {
    try {
      read_tool_golden(written(folder, document));
    } catch (const BadData& error) {
      return error.what();
    }
    return "";
  };
  json bad = described();
  bad["tolerance"]["torque_Nm"] = {1e-7};
  EXPECT_THAT(message(bad), HasSubstr("/tolerance/torque_Nm"));
  bad = described();
  bad["tolerance"].erase("reason");
  EXPECT_THAT(message(bad), HasSubstr("reason"));
  bad = described();
  bad["keep_every"] = 0;
  EXPECT_THAT(message(bad), HasSubstr("/keep_every"));
  bad = described();
  bad["renderers"] = json::array();
  EXPECT_THAT(message(bad), HasSubstr("/renderers"));
  const ToolGolden golden = read_tool_golden(written(folder, described()));
  EXPECT_THROW(accept_tool_golden(golden, simple(0.0), "", "abc"), UsageError);
  tool::ToolRendererEntry other = simple(0.0);
  other.name = "other";
  EXPECT_THROW(accept_tool_golden(golden, other, "why", "abc"), UsageError);
}

}  // namespace
}  // namespace touchstone::contacts
