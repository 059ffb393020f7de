#include "lab/evidence_page.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <functional>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/report/page_html.h"

namespace touchstone::hil {
namespace {

using ::testing::HasSubstr;

class EvidencePageTest : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  void keep(const std::string& test, bool emulated, const std::string& more) const {
    write_file(
        folder_ / (test + ".json"),
        fmt::format(R"({{"schema": "touchstone-hil-evidence/1", "test": "{}", "emulated": {}, "device": "novint-falcon",
 "serial": "F1", "counters": {{"received": 5, "lost": 0}}, "measurements": {{"latency_s": 0.002}}{}}})",
                    test, emulated, more));
  }
  std::string complaint() const {
    try {
      evidence_page(folder_);
    } catch (const BadData& error) {
      return error.what();
    }
    return "none";
  }
  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / fmt::format("touchstone-hil-page-{}", ::getpid());
};

TEST_F(EvidencePageTest, ShowsMeasurementsLimitsAndPictures) {
  keep("latency", false,
       R"(, "limits": {"latency_s": {"least": 0, "most": 0.001}}, "failures": ["latency_s is too long"],
 "pictures": [{"title": "Gain <b>", "x_label": "frequency [Hz]", "y_label": "gain [1]", "curves": [{"name": "m", "points": false, "x": [1, 2], "y": [1, 0.5]}]}])");
  keep("noise", false, "");
  const auto made = evidence_page(folder_);
  EXPECT_FALSE(made.emulated);
  EXPECT_EQ(made.tests, 2);
  EXPECT_EQ(made.failed, 1);
  const auto html = report::page_to_html(made.page);
  EXPECT_THAT(html, HasSubstr("latency_s is too long"));
  EXPECT_THAT(html, HasSubstr("novint-falcon serial F1"));
  EXPECT_THAT(html, ::testing::Not(HasSubstr("Gain <b>")));
}

TEST_F(EvidencePageTest, EmulatedResultsSaySoAndNeverStandBesideHardwares) {
  keep("a", true, "");
  const auto made = evidence_page(folder_);
  EXPECT_TRUE(made.emulated);
  EXPECT_THAT(made.page.title, HasSubstr("EMULATED"));
  keep("b", false, "");
  EXPECT_THAT(complaint(), HasSubstr("never stand on one page"));
}

TEST_F(EvidencePageTest, SaysWhatIsNoEvidence) {
  EXPECT_THAT(complaint(), HasSubstr("no evidence there"));
  keep("a", true, "");
  write_file(folder_ / "b.json", R"({"schema": "touchstone-hil-evidence/1"})");
  EXPECT_THAT(complaint(), HasSubstr("b.json: not evidence"));
  write_file(folder_ / "b.json", R"({"schema": "another/1"})");
  EXPECT_THAT(complaint(), HasSubstr("touchstone-hil-evidence/1 was expected"));
}

}  // namespace
}  // namespace touchstone::hil
