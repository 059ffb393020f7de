// Reports opened in headless Chromium as a reader would open them. Skips where Chromium or node is missing.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "harness/report/evaluation_page.h"
#include "harness/report/judgement_page.h"
#include "harness/report/page_html.h"
#include "harness/report/sample_judgement_for_test.h"
#include "harness/report/sample_result_for_test.h"

namespace touchstone::report {
namespace {

struct Opened {
  int status = 0;
  nlohmann::json seen;
};

Opened open_in_browser(const std::filesystem::path& report) {
  const char* const source = std::getenv("TOUCHSTONE_SOURCE_DIR");
  const std::string command =
      fmt::format("command -v node >/dev/null || exit 77; exec node '{}/harness/report/web/check_report.mjs' '{}' 2>&1",
                  source == nullptr ? "." : source, report.string());
  std::string output;
  std::FILE* const pipe = ::popen(command.c_str(), "r");
  char buffer[4096];
  for (std::size_t n = 0; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) output.append(buffer, n);
  const int status = ::pclose(pipe);
  Opened out{WIFEXITED(status) ? WEXITSTATUS(status) : -1, {}};
  if (out.status == 0) {
    out.seen = nlohmann::json::parse(output);
  } else if (out.status != 77) {
    ADD_FAILURE() << output;
  }
  return out;
}

class Browser : public ::testing::Test {
 protected:
  Browser() { std::filesystem::create_directories(folder_); }
  ~Browser() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  std::filesystem::path fresh_report(const std::string& name, const Page& page) const {
    write_html(folder_ / name, page);
    return folder_ / name;
  }

 private:
  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / fmt::format("touchstone-browser-{}", ::getpid());
};

void expect_whole(const nlohmann::json& seen, const std::string& file) {
  EXPECT_TRUE(seen["console"].empty()) << seen["console"];
  EXPECT_TRUE(seen["dialogs"].empty());
  EXPECT_TRUE(seen["status"]["failures"].empty()) << seen["status"]["failures"];
  EXPECT_EQ(seen["status"]["plots"], seen["status"]["drawn"]);
  // The file itself, and images that the page makes of its own data; nothing from anywhere else.
  for (const auto& request : seen["requests"]) {
    const std::string url = request;
    EXPECT_TRUE(url.ends_with(file) || url.starts_with("data:") || url.starts_with("blob:")) << url;
  }
  EXPECT_GE(seen["plots"].size(), 8u);
  for (const auto& plot : seen["plots"]) {
    EXPECT_GT(plot["width"].get<double>(), 100.0) << plot;
    if (plot["kind"] != "scene") {
      EXPECT_EQ(plot["paths"], plot["traces"]) << plot;
    }
  }
  ASSERT_EQ(seen["scenes"].size(), 1u);
  EXPECT_GT(seen["scenes"][0]["coloured"].get<double>(), 0.03) << "the 3-D view is blank";
  EXPECT_GT(seen["scenes"][0]["colours"].get<int>(), 30) << "the 3-D view shows no error";
}

TEST_F(Browser, DrawsEverythingOfflineWithoutAnError) {
  const auto report = fresh_report("plain.html", evaluation_page(sample_result("A sphere, stroked")));
  const Opened opened = open_in_browser(report);
  if (opened.status == 77) GTEST_SKIP() << "needs node and chromium";
  ASSERT_EQ(opened.status, 0);
  EXPECT_EQ(opened.seen["title"], "A sphere, stroked");
  expect_whole(opened.seen, "plain.html");
}

// Of a map of places all that is drawn is counted, and nothing runs off a page of 1,100 px or of a telephone.
TEST_F(Browser, AMapOfPlacesIsDrawnAndThePageFitsATelephone) {
  const auto page = judgement_page("What a person would notice", sample_judgement(), {}, {}, {});
  const Opened opened = open_in_browser(fresh_report("judged.html", page));
  if (opened.status == 77) GTEST_SKIP() << "needs node and chromium";
  ASSERT_EQ(opened.status, 0);
  EXPECT_TRUE(opened.seen["console"].empty()) << opened.seen["console"];
  EXPECT_EQ(opened.seen["status"]["plots"], opened.seen["status"]["drawn"]);
  ASSERT_EQ(opened.seen["maps"].size(), 1u);
  const auto& map = opened.seen["maps"][0];
  EXPECT_EQ(map["known"], 15);
  EXPECT_EQ(map["figures"], 15);
  EXPECT_EQ(map["unknown"], 5);
  EXPECT_EQ(map["titles"], 20);
  EXPECT_EQ(map["colours"], 3) << "stiffer, nearly alike, not known";
  EXPECT_EQ(map["outside"], 0);
  EXPECT_NE(std::string(map["label"]).find("20 places"), std::string::npos);
  for (const auto& [width, wider] : opened.seen["wider_than_page"].items())
    EXPECT_TRUE(wider.empty()) << width << wider;
}

TEST_F(Browser, HostileNamesAreShownNotRun) {
  const std::string hostile =
      "</script><script>window.stolen=1</script><img src=x onerror=\"window.stolen=1\">' \" & <a "
      "href='javascript:window.stolen=1'>x</a> "
      "${window.stolen=1} \xE2\x80\xA8 <iframe srcdoc='<script>parent.stolen=1</script>'>";
  const auto report = fresh_report("hostile.html", evaluation_page(sample_result(hostile)));
  const Opened opened = open_in_browser(report);
  if (opened.status == 77) GTEST_SKIP() << "needs node and chromium";
  ASSERT_EQ(opened.status, 0);
  EXPECT_EQ(opened.seen["title"], hostile);
  EXPECT_EQ(opened.seen["stolen"], "undefined");
  EXPECT_EQ(opened.seen["injected"], 0);
  expect_whole(opened.seen, "hostile.html");
}

}  // namespace
}  // namespace touchstone::report
