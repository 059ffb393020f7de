#include "harness/report/test_summary.h"

#include <fmt/format.h>

#include <algorithm>

#include "harness/base/markup.h"

namespace touchstone::report {
namespace {

// XML 1.0 has no control characters but tab and the ends of lines.
std::string xml_text(std::string text) {
  std::erase_if(text, [](char c) { return static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t'; });
  return escape_xml(text);
}

// A cell of a Markdown table: one line, and no bar ends it.
std::string cell(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += c == '|' ? std::string("\\|") : c == '\n' ? std::string(" ") : std::string(1, c);
  return safe;
}

// As the documentation of GitHub's workflow commands has it: per cent and line ends are encoded, in properties colons
// and commas too.
std::string command_text(const std::string& text, bool property) {
  std::string safe;
  for (const char c : text) {
    const bool encoded = c == '%' || c == '\n' || c == '\r' || (property && (c == ':' || c == ','));
    safe += encoded ? fmt::format("%{:02X}", static_cast<unsigned>(c)) : std::string(1, c);
  }
  return safe;
}

std::size_t failures(const std::vector<CheckedTest>& tests) {
  return static_cast<std::size_t>(std::ranges::count_if(tests, &CheckedTest::failed));
}
std::size_t skips(const std::vector<CheckedTest>& tests) {
  return static_cast<std::size_t>(std::ranges::count_if(tests, [](const auto& test) { return !test.skipped.empty(); }));
}

}  // namespace

std::string tests_to_junit(const std::string& suite, const std::vector<CheckedTest>& tests) {
  double seconds = 0.0;
  for (const CheckedTest& test : tests) seconds += test.seconds;
  std::string xml = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n<testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" "
      "errors=\"0\" skipped=\"{}\" time=\"{:.3f}\">\n",
      xml_text(suite), tests.size(), failures(tests), skips(tests), seconds);
  for (const CheckedTest& test : tests) {
    xml += fmt::format("<testcase classname=\"{}.{}\" name=\"{}\" time=\"{:.3f}\"", xml_text(suite),
                       xml_text(test.group), xml_text(test.name), test.seconds);
    if (test.passed) {
      xml += "/>\n";
      continue;
    }
    if (!test.failed()) {
      xml += fmt::format(">\n<skipped message=\"{}\"/>\n</testcase>\n", xml_text(test.skipped));
      continue;
    }
    xml += fmt::format(">\n<failure message=\"{}\">{}</failure>\n", xml_text(test.verdict), xml_text(test.details));
    std::string attachments;
    for (const auto& picture : test.pictures)
      attachments += fmt::format("[[ATTACHMENT|{}]]\n", std::filesystem::absolute(picture).string());
    if (!attachments.empty()) xml += fmt::format("<system-out>{}</system-out>\n", xml_text(attachments));
    xml += "</testcase>\n";
  }
  return xml + "</testsuite>\n</testsuites>\n";
}

std::string tests_to_markdown(const std::string& title, const std::vector<CheckedTest>& tests,
                              const std::filesystem::path& base) {
  const std::size_t failed = failures(tests);
  const std::size_t skipped = skips(tests);
  std::string text = fmt::format("## {}\n\n{} passed, {} failed{}\n", title, tests.size() - failed - skipped, failed,
                                 skipped > 0 ? fmt::format(", {} skipped", skipped) : "");
  if (failed == 0) return text;
  text += "\n| case | model | verdict |\n|---|---|---|\n";
  for (const CheckedTest& test : tests) {
    if (test.failed()) text += fmt::format("| {} | {} | {} |\n", cell(test.group), cell(test.name), cell(test.verdict));
  }
  for (const CheckedTest& test : tests) {
    if (!test.failed()) continue;
    // Indented by four: no fence that the details could end.
    std::string block = "    ";
    for (const char c : test.details) block += c == '\n' ? std::string("\n    ") : std::string(1, c);
    text += fmt::format("\n### {} {}\n\n{}\n\n", test.group, test.name, block);
    for (const auto& picture : test.pictures) {
      text += fmt::format("![{}]({})\n", picture.stem().string(),
                          std::filesystem::absolute(picture).lexically_proximate(base).generic_string());
    }
  }
  return text;
}

std::string tests_to_github_annotations(const std::vector<CheckedTest>& tests) {
  std::string text;
  for (const CheckedTest& test : tests) {
    if (!test.failed()) continue;
    text += fmt::format("::error file={},title={}::{}\n", command_text(test.file.generic_string(), true),
                        command_text(test.group + " " + test.name, true),
                        command_text(test.verdict + "\n" + test.details, false));
  }
  return text;
}

}  // namespace touchstone::report
