// Workbooks with the parts that ECMA-376 asks for (part 1, chapters 12.3 and 18): shared and inline strings, pieces of
// text in several fonts, styles of dates, a sheet without a table, errors in cells, cells that are left out.
#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <map>

#include "guess_map.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "import_table.h"

namespace touchstone::importing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::filesystem::path workbook_path(const std::map<std::string, std::string>& parts) {
  const auto folder =
      std::filesystem::path(::testing::TempDir()) / fmt::format("touchstone-import-excel-{}", ::getpid());
  ensure_writable_folder(folder);
  const auto path = folder / "test.xlsx";
  archive* const out = archive_write_new();
  archive_write_set_format_zip(out);
  archive_write_open_filename(out, path.c_str());
  for (const auto& [name, xml] : parts) {
    archive_entry* const entry = archive_entry_new();
    archive_entry_set_pathname(entry, name.c_str());
    archive_entry_set_size(entry, static_cast<la_int64_t>(xml.size()));
    archive_entry_set_filetype(entry, AE_IFREG);
    archive_write_header(out, entry);
    archive_write_data(out, xml.data(), xml.size());
    archive_entry_free(entry);
  }
  archive_write_close(out);
  archive_write_free(out);
  return path;
}

std::map<std::string, std::string> parts_of(const std::string& rows, const std::string& properties = "") {
  const std::string head = R"(<?xml version="1.0" encoding="UTF-8"?>)";
  return {
      {"[Content_Types].xml", head + "<Types/>"},
      {"xl/workbook.xml",
       head + "<workbook>" + properties +
           R"(<sheets><sheet name="Results" r:id="rId1"/><sheet name="Specimen 1" r:id="rId2"/></sheets></workbook>)"},
      {"xl/_rels/workbook.xml.rels", head + R"(<Relationships><Relationship Id="rId1" Target="worksheets/sheet1.xml"/>
               <Relationship Id="rId2" Target="/xl/worksheets/sheet2.xml"/></Relationships>)"},
      {"xl/styles.xml", head + R"(<styleSheet><numFmts><numFmt numFmtId="170" formatCode="hh:mm:ss.000"/>
               <numFmt numFmtId="171" formatCode="0.0&quot; mm s&quot;"/></numFmts>
               <cellXfs><xf numFmtId="0"/><xf numFmtId="170"/><xf numFmtId="22"/><xf numFmtId="171"/></cellXfs>
               </styleSheet>)"},
      {"xl/sharedStrings.xml",
       head + "<sst><si><t>Standard travel</t></si><si><r><t>Standard </t></r><r><t>force</t></r></si></sst>"},
      {"xl/worksheets/sheet1.xml", head + R"(<worksheet><sheetData><row r="1"><c r="A1" t="inlineStr"><is>
               <t>no table here</t></is></c></row></sheetData></worksheet>)"},
      {"xl/worksheets/sheet2.xml", head + "<worksheet><sheetData>" + rows + "</sheetData></worksheet>"}};
}

// Time (its style given), travel in mm, force in N, from row 3 on; columns from B.
std::string tester_rows(int style, const std::function<double(int)>& time) {
  std::string rows =
      R"(<row r="1"><c r="B1"><v>20</v></c><c r="H1"><v>1.5</v></c></row>
         <row r="3"><c r="B3" t="inlineStr"><is><t>Time</t></is></c><c r="C3" t="s"><v>0</v></c><c r="D3" t="s"><v>1</v></c></row>
         <row r="4"><c r="B4" t="inlineStr"><is><t>s</t></is></c><c r="C4" t="str"><v>mm</v></c><c r="D4" t="str"><v>N</v></c></row>)";
  for (int i = 0; i < 30; ++i) {
    rows += fmt::format(R"(<row r="{0}"><c r="B{0}" s="{1}"><v>{2:.17g}</v></c><c r="C{0}" s="3"><v>{3}</v></c>)",
                        i + 5, style, time(i), 0.5 * i);
    rows += i == 7 ? R"(<c t="e"><v>#N/A</v></c></row>)" : fmt::format("<c><v>{}</v></c></row>", 2.0 * (i % 5));
  }
  return rows;
}

TEST(ExcelFile, ATestersSheetIsReadAsItsCsvWouldBe) {
  const auto path = workbook_path(parts_of(tester_rows(0, [](int i) { return 0.02 * i; })));
  const auto tables = read_foreign(path, {});
  ASSERT_EQ(tables.size(), 1U);
  EXPECT_THAT(tables[0].names, ElementsAre("Time", "Standard travel", "Standard force"));
  ASSERT_EQ(tables[0].rows(), 30U);
  EXPECT_EQ(tables[0].columns[1][29], 14.5);
  EXPECT_TRUE(std::isnan(tables[0].columns[2][7]));
  const GuessedMap guess = guess_map(path);
  EXPECT_THAT(guess.decide, ElementsAre(::testing::HasSubstr("do not tell the signs")));
  ASSERT_TRUE(guess.read);
  EXPECT_THAT(guess.read->names, ElementsAre("t_s", "z_m", "fz_N"));
  EXPECT_NEAR(guess.read->columns[1].back(), 0.0145, 1e-15);
}

// A workbook counts days; a column of times is none of seconds.
TEST(ExcelFile, DatesAndTimesBecomeSeconds) {
  const double day = 86400;
  auto read = [&](int style, double start, const std::string& properties = "") {
    return read_foreign(
               workbook_path(parts_of(tester_rows(style, [&](int i) { return start + 0.02 * i / day; }), properties)),
               {})[0]
        .columns[0];
  };
  EXPECT_NEAR(read(1, 0.5)[29], day / 2 + 0.58, 1e-6);
  // 45292 is 1 January 2024, 1704067200 s after 1970; counted from 1904 the day has the number 43830.
  EXPECT_NEAR(read(2, 45292.25)[3], 1704067200 + day / 4 + 0.06, 2e-6);
  EXPECT_NEAR(read(2, 43830.25, R"(<workbookPr date1904="1"/>)")[3], 1704067200 + day / 4 + 0.06, 2e-6);
  EXPECT_NEAR(read(0, 0.5)[0], 0.5, 0) << "without such a style it is a number";
}

std::string workbook_refusal(const std::map<std::string, std::string>& parts, std::size_t cut = 0) {
  const auto path = workbook_path(parts);
  if (cut > 0) write_file(path, read_file(path).substr(0, read_file(path).size() - cut));
  try {
    read_foreign(path, {});
  } catch (const BadData& e) {
    return e.what();
  }
  return "no error";
}

TEST(ExcelFile, WhatIsWrongIsNamedWithItsPlace) {
  EXPECT_THAT(workbook_refusal(parts_of("")), HasSubstr("no sheet of this workbook holds a table of numbers"));
  EXPECT_THAT(workbook_refusal(parts_of(R"(<row r="1"><c r="A1" t="s"><v>2</v></c></row>)")),
              HasSubstr("cell A1 names the shared string '2' of 2"));
  EXPECT_THAT(workbook_refusal(parts_of(R"(<row r="1"><c r="ZZZZ1"><v>2</v></c></row>)")),
              HasSubstr("'ZZZZ1' is no cell of a sheet"));
  EXPECT_THAT(workbook_refusal(parts_of(R"(<row r="2000000"><c r="A2000000"><v>2</v></c></row>)")),
              HasSubstr("row 2000000 is none of a sheet"));
  EXPECT_THAT(workbook_refusal(parts_of("<row r=")), HasSubstr("damaged workbook: its XML ends at byte"));
  std::string text_in_row = tester_rows(0, [](int i) { return 0.02 * i; });
  text_in_row +=
      R"(<row r="35"><c r="B35" t="str"><v>lost</v></c><c r="C35"><v>1</v></c><c r="D35"><v>1</v></c></row>)";
  EXPECT_THAT(workbook_refusal(parts_of(text_in_row)),
              HasSubstr("(sheet Specimen 1): line 35, column 1 (Time): 'lost'"));
}

}  // namespace
}  // namespace touchstone::importing
