#include "harness/report/page_html.h"

#include "harness/report/evaluation_page.h"
#include "harness/report/page_json.h"
#include "harness/report/sample_result_for_test.h"

namespace touchstone::report {
namespace {

TEST(EscapeJson, NothingCanEndTheScriptElement) {
  const std::string json = R"({"a":"</script><script>alert(1)</script><!--&amp;"})"
                           "\xE2\x80\xA8\xE2\x80\xA9";
  const std::string escaped = escape_json_for_script(json);
  for (const char c : {'<', '>', '&'}) EXPECT_EQ(escaped.find(c), std::string::npos);
  EXPECT_EQ(escaped.find("\xE2\x80"), std::string::npos);
  const std::string inside = R"({"a":"</script>&"})";
  EXPECT_EQ(nlohmann::json::parse(escape_json_for_script(inside)), nlohmann::json::parse(inside));
}

TEST(PageHtml, HostileTextStaysData) {
  const std::string hostile = "</script><script>window.stolen=1</script>\"'<img src=x onerror=window.stolen=1>";
  const std::string html = page_to_html(evaluation_page(sample_result(hostile)));
  EXPECT_EQ(html.find("window.stolen=1</script>"), std::string::npos);
  EXPECT_EQ(html.find("<img src=x"), std::string::npos);
}

TEST(PageHtml, FetchesNothing) {
  const std::string html = page_to_html(evaluation_page(sample_result("plain")));
  EXPECT_NE(html.find("default-src 'none'"), std::string::npos);
  for (const char* const tag : {"<link", "src=\"http", "@import"}) EXPECT_EQ(html.find(tag), std::string::npos) << tag;
  // The rest is one file of bounded size.
  EXPECT_LT(html.size(), 6'000'000u);
}

TEST(PageJson, NumbersThatAreNoneAreNull) {
  Page page;
  page.sections.push_back({"s",
                           "",
                           {LinePlot{"p",
                                     "",
                                     "",
                                     {Line{"l", {0, 1}, {std::nan(""), 1.0 / 3.0}, Tone::error, false, false}},
                                     {},
                                     {},
                                     "",
                                     "",
                                     100,
                                     false}},
                           false});
  const auto json = nlohmann::json::parse(page_to_json(page));
  const auto& y = json["sections"][0]["blocks"][0]["lines"][0]["y"];
  EXPECT_TRUE(y[0].is_null());
  EXPECT_EQ(y[1].get<double>(), 0.333333333);
}

TEST(EvaluationPage, ShowsEveryMetricOfTheResult) {
  const EvaluationResult result = sample_result("plain");
  const std::string json = page_to_json(evaluation_page(result));
  for (const metrics::MetricResult& metric : result.metrics)
    EXPECT_NE(json.find("\"" + metric.name + "\""), std::string::npos) << metric.name;
}

}  // namespace
}  // namespace touchstone::report
