#include "harness/report/test_summary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "harness/base/atomic_file.h"

namespace touchstone::report {
namespace {

using ::testing::HasSubstr;

std::vector<CheckedTest> example() {
  return {{"plane-taps", "penalty", true, 0.25, "equal", "", "golden/plane-taps/case.json", {}},
          {"sphere, scan",
           "god|object",
           false,
           1.5,
           "worse",
           "force <rms> 0.1 & \"more\"\x01\n100 % beyond",
           "golden/sphere-scan/case.json",
           {"out/golden.png", "out/obtained.png"}},
          {"bowl-push", "penalty", false, 0.0, "", "", "golden/bowl-push/case.json", {}, "starts <inside>"}};
}

// Read by another's parser (python's ElementTree), as a CI server would.
TEST(TestSummary, JUnitIsReadByAnotherProgram) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "touchstone-junit";
  ensure_writable_folder(folder);
  write_file(folder / "junit.xml", tests_to_junit("golden", example()));
  const std::string program =
      "import sys, xml.etree.ElementTree as e\n"
      "s = e.parse(sys.argv[1]).getroot()[0]\n"
      "c = s.findall('testcase')\n"
      "assert (s.get('tests'), s.get('failures'), s.get('time')) == ('3', '1', '1.750'), s.attrib\n"
      "assert s.get('skipped') == '1' and c[2].find('skipped').get('message') == 'starts <inside>'\n"
      "assert c[2].find('failure') is None\n"
      "assert c[0].get('classname') == 'golden.plane-taps' and len(c[0]) == 0\n"
      "assert c[1].get('name') == 'god|object' and c[1].find('failure').get('message') == 'worse'\n"
      "assert c[1].find('failure').text == 'force <rms> 0.1 & \"more\"\\n100 % beyond'\n"
      "assert c[1].find('system-out').text.count('[[ATTACHMENT|/') == 2\n";
  write_file(folder / "read.py", program);
  const std::string command =
      "python3 '" + (folder / "read.py").string() + "' '" + (folder / "junit.xml").string() + "'";
  if (std::system("python3 -c 1") != 0) GTEST_SKIP() << "needs python3";
  EXPECT_EQ(std::system(command.c_str()), 0) << read_file(folder / "junit.xml");
  std::filesystem::remove_all(folder);
}

TEST(TestSummary, MarkdownNamesFailuresWithTheirPictures) {
  const std::string text = tests_to_markdown("Golden cases", example(), std::filesystem::current_path());
  EXPECT_THAT(text, HasSubstr("1 passed, 1 failed, 1 skipped"));
  EXPECT_THAT(text, HasSubstr("| sphere, scan | god\\|object | worse |"));
  EXPECT_THAT(text, HasSubstr("\n    100 % beyond"));
  EXPECT_THAT(text, HasSubstr("![golden](out/golden.png)"));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("plane-taps")));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("bowl-push")));
}

TEST(TestSummary, AnnotationsMarkTheFile) {
  const std::string text = tests_to_github_annotations(example());
  EXPECT_THAT(text,
              ::testing::StartsWith("::error file=golden/sphere-scan/case.json,title=sphere%2C scan god|object::"));
  EXPECT_THAT(text, HasSubstr("%0A100 %25 beyond"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
}

}  // namespace
}  // namespace touchstone::report
