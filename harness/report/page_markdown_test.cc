#include "harness/report/page_markdown.h"

#include <gtest/gtest.h>

namespace touchstone::report {
namespace {

TEST(PageMarkdown, EveryTableUnderItsHeadingWithNothingThatEndsACell) {
  Table table;
  table.columns = {"what", "value [N]"};
  table.rows = {{{{"a|b\nc*", false, Tone::neutral}, {"1.5", true, Tone::good}}, "detail", {}},
                {{{"short", false, Tone::neutral}}, "", {}}};
  Page page;
  page.sections.push_back({"Results", "", {TextBlock{"no table", Tone::neutral}, table, table}, false});
  table.caption = "Named";
  page.sections.push_back({"More", "", {table}, true});
  const std::string body =
      "| what | value [N] |\n|---|---:|\n"
      "| a\\|b c\\* | 1.5 |\n| short |  |\n";
  EXPECT_EQ(tables_to_markdown(page),
            "### Results\n\n" + body + "\n### Results (2)\n\n" + body + "\n### Named\n\n" + body);
}

TEST(PageMarkdown, NoTableIsNoText) { EXPECT_EQ(tables_to_markdown({}), ""); }

}  // namespace
}  // namespace touchstone::report
