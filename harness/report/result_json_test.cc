#include "harness/report/result_json.h"

#include "harness/base/error.h"
#include "harness/report/sample_result_for_test.h"

namespace touchstone::report {
namespace {

TEST(ResultJson, ReadsBackWhatItWrote) {
  const EvaluationResult before = sample_result("a \"name\" with \\ and \xE2\x80\xA8 and \x01");
  const std::string text = result_to_json(before);
  const EvaluationResult after = parse_result(text, "result.json");
  EXPECT_EQ(result_to_json(after), text);
  ASSERT_EQ(after.metrics.size(), before.metrics.size());
  for (std::size_t i = 0; i < before.metrics.size(); ++i) {
    EXPECT_EQ(after.metrics[i].name, before.metrics[i].name);
    EXPECT_EQ(after.metrics[i].status, before.metrics[i].status);
    // Every digit, so that a program comparing two runs compares what was computed.
    if (before.metrics[i].status == metrics::MetricStatus::ok) {
      EXPECT_EQ(after.metrics[i].value, before.metrics[i].value);
    }
  }
  EXPECT_EQ(after.episodes.size(), before.episodes.size());
  EXPECT_EQ(after.object.triangles, before.object.triangles);
  ASSERT_EQ(after.object.noticed_share.size(), before.object.noticed_share.size());
  EXPECT_EQ(after.provenance.inputs[0].sha256, before.provenance.inputs[0].sha256);
}

TEST(ResultJson, NotANumberIsNullWithItsStatus) {
  EvaluationResult result = sample_result("x");
  result.metrics = metrics::MetricSet({"force-error"}, {}, {}).results();
  const std::string text = result_to_json(result);
  EXPECT_NE(text.find("\"status\":\"missing\""), std::string::npos);
  for (const char* const bare : {":nan", ",nan", "[nan"}) EXPECT_EQ(text.find(bare), std::string::npos);
  EXPECT_TRUE(std::isnan(parse_result(text, "x").metrics[0].value));
}

TEST(ResultJson, BytesThatAreNotUtf8AreReplacedNotRefused) {
  const EvaluationResult result = sample_result("bad \xff\xfe name");
  EXPECT_NO_THROW(parse_result(result_to_json(result), "x"));
}

TEST(ResultJson, NamesThePlaceOfWhatIsWrong) {
  const std::string text = result_to_json(sample_result("x"));
  const auto refused = [&](const std::string& from, const std::string& to, const std::string& expected) {
    std::string broken = text;
    broken.replace(broken.find(from), from.size(), to);
    try {
      parse_result(broken, "result.json");
      ADD_FAILURE() << to;
    } catch (const BadData& error) {
      EXPECT_NE(std::string(error.what()).find("result.json"), std::string::npos);
      EXPECT_NE(std::string(error.what()).find(expected), std::string::npos) << error.what();
    }
  };
  refused("touchstone-result/1", "touchstone-result/9", "schema");
  refused("\"status\":\"ok\"", "\"status\":\"fine\"", "status");
  refused("\"triangles\":[[0,", "\"triangles\":[[999999,", "triangles");
  refused("\"settings\"", "\"setings\"", "settings");
}

}  // namespace
}  // namespace touchstone::report
