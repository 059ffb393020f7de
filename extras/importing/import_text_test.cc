// Text as instruments and their programs write it. The heads of the samples are captured: LabVIEW's from a public
// recording (its decimal commas, blank X column and comment column), JPK's from a public curve of a CellHesion 200, the
// Net F/T's from the sources of ATI's demo program (NetFTDiscoveryGUI, which prints these lines).
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "import_table.h"

namespace touchstone::importing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::filesystem::path text_folder() {
  auto path = std::filesystem::path(::testing::TempDir()) / fmt::format("touchstone-import-text-{}", ::getpid());
  ensure_writable_folder(path);
  return path;
}

ImportTable text_table(const std::string& bytes, const TextLayout& layout = {}) {
  const auto file = text_folder() / "t.txt";
  write_file(file, bytes);
  return read_text_table(file, layout);
}

std::string text_refusal(const std::string& bytes, const TextLayout& layout = {}) {
  try {
    text_table(bytes, layout);
  } catch (const BadData& e) {
    return e.what();
  }
  return "no error";
}

TEST(TextTable, LabViewMeasurementWithDecimalCommas) {
  const ImportTable t = text_table(
      "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t,\n"
      "Multi_Headings\tNo\nX_Columns\tNo\nTime_Pref\tRelative\nDate\t2019/07/22\nTime\t17:18:18,938945770263671875\n"
      "***End_of_Header***\t\n\t\nChannels\t2\t\t\nSamples\t100\t100\t\nDate\t2019/07/22\t2019/07/22\t\n"
      "X_Dimension\tTime\tTime\t\nX0\t0,0000000000000000E+0\t0,0000000000000000E+0\t\nDelta_X\t1,000000\t1,000000\t\n"
      "***End_of_Header***\t\t\t\nX_Value\tUntitled\tUntitled "
      "1\tComment\n\t0,000000\t0,055544\t\n\t0,000001\t-0,055544\t\n"
      "\t0,000002\t1,5\t\n");
  EXPECT_THAT(t.names, ElementsAre("X_Value", "Untitled", "Untitled 1"));
  ASSERT_EQ(t.rows(), 3U);
  EXPECT_EQ(t.columns[2], (std::vector<double>{0.055544, -0.055544, 1.5}));
  // The file has no X column: X0 + i Delta_X.
  EXPECT_THAT(t.columns[0], ElementsAre(0.0, 1.0, 2.0));
}

const std::string lvm_head =
    "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\nX_Columns\tOne\n"
    "***End_of_Header***\t\n\t\n";
const std::string lvm_segment =
    "Channels\t2\t\t\nSamples\t3\t3\t\nX0\t0.0\t0.0\t\nDelta_X\t0.5\t0.5\t\n***End_of_Header***\t\t\t\n"
    "X_Value\tForce\tHeight\tComment\n";

// A comment stands in any row, and its field may be missing: rows with one are rows.
TEST(TextTable, LabViewCommentsAndSegmentsLoseNoRow) {
  const ImportTable t = text_table(lvm_head + lvm_segment + "0.0\t1.5\t7\tbegun at noon\n0.5\t2.5\t8\n1.0\t3.5\t9\t\n" +
                                   "\n" + lvm_segment + "0.0\t4.5\t7\n0.5\t5.5\t8\ta stroke, 2 mm\n");
  EXPECT_THAT(t.names, ElementsAre("X_Value", "Force", "Height", "segment"));
  EXPECT_THAT(t.columns[1], ElementsAre(1.5, 2.5, 3.5, 4.5, 5.5));
  EXPECT_THAT(t.columns[3], ElementsAre(0, 0, 0, 1, 1));
}

TEST(TextTable, LabViewRowsThatAreNoneAreRefused) {
  const std::string rows = "0.0\t1.5\t7\n0.5\t2.5\t8\n";
  EXPECT_THAT(text_refusal(lvm_head + lvm_segment + rows + "1.0\t3.x5\t9\n"), HasSubstr("line 16, column 2 (Force)"));
  EXPECT_THAT(text_refusal(lvm_head + lvm_segment + rows + "1.0\t3.5"), HasSubstr("line 16 has 2 values"));
  EXPECT_THAT(text_refusal(lvm_head + lvm_segment + rows + "Channels\t2\nSamples\t3\n"),
              HasSubstr("line 16: the header of a segment begins here and does not end"));
}

TEST(TextTable, JpkTextWithTwoSegments) {
  const std::string segment =
      "# columns: verticalTipPosition vDeflection strainGaugeHeight height smoothedStrainGaugeHeight seriesTime time\n"
      "# fancyNames: \"Vertical Tip Position\" \"Vertical Deflection\" \"Head Height (measured)\" \"Height\" \"Head "
      "Height "
      "(measured & smoothed)\" \"Series Time\" \"Segment Time\"\n# sensitivity: 7.363581843930989E-8\n"
      "# springConstant: 0.012233132341672661\n# units: m N m m m s s\n#\n"
      "6.97844E-5 -2.1227542E-11 6.9782254E-5 6.0452272E-5 6.978614E-5 2.5E-4 2.5E-4\n"
      "6.9781156E-5 -3.0425995E-11 6.977914E-5 6.0452272E-5 6.978364E-5 7.5E-4 7.5E-4\n";
  const ImportTable t =
      text_table("# segmentIndex: 0\n# segment: extend\n" + segment + "\n# segmentIndex: 1\n" + segment);
  EXPECT_THAT(t.names, ElementsAre("verticalTipPosition", "vDeflection", "strainGaugeHeight", "height",
                                   "smoothedStrainGaugeHeight", "seriesTime", "time", "segment"));
  EXPECT_THAT(t.columns[1], ElementsAre(-2.1227542e-11, -3.0425995e-11, -2.1227542e-11, -3.0425995e-11));
  EXPECT_THAT(t.columns[7], ElementsAre(0, 0, 1, 1));
}

TEST(TextTable, NetFtDemoLog) {
  const ImportTable t = text_table(
      "Start Time: 6/1/10 2:32 PM\nRDT Sample Rate: 7000\n\"PLEASE NOTE: The sample rate is read from the Net F/T when "
      "the program starts.  If you have changed the sample rate since the program started, this will be "
      "incorrect.\"\nForce Units: N\nCounts per Unit Force: 1000000.0\nTorque Units: Nm\nCounts per Unit Torque: "
      "1000000.0\nStatus (hex), RDT Sequence, F/T Sequence, Fx, Fy, Fz, Tx, Ty, Tz, Time\n"
      "0x0, 1, 4711, 1000, -2000, 3000000, 10, -20, 30, 0\n0x80010000, 2, 4712, 1001, -2001, 3000001, 11, -21, 31, "
      "0\n");
  EXPECT_EQ(t.names[0], "Status (hex)");
  EXPECT_EQ(t.names[3], "Fx");
  EXPECT_THAT(t.columns[0], ElementsAre(0.0, 2147549184.0));
  EXPECT_THAT(t.columns[5], ElementsAre(3000000.0, 3000001.0));
}

const std::string net_ft_head =
    "Start Time: 6/1/10 2:32 PM\nRDT Sample Rate: 7000\nForce Units: N\nCounts per Unit Force: 1000000.0\n"
    "Status (hex), RDT Sequence, F/T Sequence, Fx, Fy, Fz, Tx, Ty, Tz, Time\n"
    "0x0, 1, 4711, 1000, -2000, 3000000, 10, -20, 30, 0\n";

TEST(TextTable, AShortNetFtDemoLogIsRefusedWithItsPlace) {
  EXPECT_THAT(text_refusal(net_ft_head), HasSubstr("line 6 has 10 (separator comma), and is the last"));
  EXPECT_THAT(text_refusal(net_ft_head + "0x80010000, 2, 4712, 1001, -2001, 3000001, 11, -21, 31"),
              HasSubstr("line 6 has 10 (separator comma), line 7 has 9 values: was the file cut short?"));
}

TEST(TextTable, WithoutHeaderWithCommentsBlankLinesAndEverySeparator) {
  for (const auto& [separator, decimal] : {std::pair<std::string, char>{"\t", '.'},
                                           {"\t", ','},
                                           {";", '.'},
                                           {";", ','},
                                           {",", '.'},
                                           {", ", '.'},
                                           {"  ", '.'},
                                           {" ", ','}}) {
    std::string text = "\n% a remark, with 3 numbers 1 2 3\n\n";
    for (int i = 0; i < 5; ++i) {
      text += fmt::format("{0}{2}25{1}-{0}{2}5e-3{1}7\r\n", i, separator, decimal);
    }
    const ImportTable t = text_table(text + "\r\n\r\n");
    ASSERT_EQ(t.names.size(), 3U) << separator << decimal;
    EXPECT_EQ(t.names[0], "c1");
    EXPECT_EQ(t.columns[0][3], 3.25);
    EXPECT_EQ(t.columns[1][3], -3.5e-3);
    EXPECT_EQ(t.columns[2][4], 7.0);
  }
}

// The rows behind the word are more than those before it.
TEST(TextTable, AWordAmongTheFirstRowsIsRefusedAndNotTakenForAHead) {
  std::string text = "a,b\n0,1\n1,2\n2,word\n";
  for (int i = 3; i < 30; ++i) text += fmt::format("{},{}\n", i, i + 1);
  EXPECT_THAT(text_refusal(text), HasSubstr("line 4, column 2 (b): 'word' is not a number"));
}

// As afmformats 0.13.3 writes its tab-separated curves.
TEST(TextTable, NamesThatRunIntoTheFirstRowAreRead) {
  const ImportTable t = text_table(
      "# force\theight (measured)\ttime-6.5e-10\t5.5e-05\t1.0\r\n-6.8e-10\t5.4e-05\t1.5\r\n"
      "-6.9e-10\t5.3e-05\t2.0\r\n");
  EXPECT_THAT(t.names, ElementsAre("force", "height (measured)", "time"));
  EXPECT_THAT(t.columns[2], ElementsAre(1.5, 2.0));
  EXPECT_THAT(t.notes, ::testing::Contains(HasSubstr("without a break")));
}

TEST(TextTable, ALastLineWithoutEndIsNoted) {
  EXPECT_THAT(text_table("1,2\n3,4.25\n").notes, ElementsAre(HasSubstr("no line names the columns")));
  EXPECT_THAT(text_refusal("1,2\n3,4\n5,"), HasSubstr("line 3, the last, ends before column 2 (c2)"));
  EXPECT_THAT(text_table("1,2\n3,4.2").notes, ::testing::Contains(HasSubstr("line 2, the last, has no end")));
}

TEST(TextTable, QuotesAreNoPartOfANameOrNumber) {
  const ImportTable t = text_table("\"\",\"t\",\"a, b\"\n\"1\",0.5,\"7\"\n\"2\",1.5,\"8\"\n");
  EXPECT_THAT(t.names, ElementsAre("c1", "t", "a, b"));
  EXPECT_THAT(t.columns[2], ElementsAre(7, 8));
  // R's write.table leaves the name of the row numbers out.
  const ImportTable r = text_table("\"t\" \"fx\"\n\"1\" 0.5 7\n\"2\" 1.5 8\n");
  EXPECT_THAT(r.names, ElementsAre("row", "t", "fx"));
  EXPECT_THAT(text_table("t,x,\n1,2,\n3,4,\n").names, ElementsAre("t", "x"));
  EXPECT_THAT(text_table("t,x\n1,2,\n3,4,\n").names, ElementsAre("t", "x"));
}

TEST(TextTable, ARowOfUnitsBelowTheNames) {
  for (const char* const text :
       {"Time;Weg;Kraft\ns;mm;N\n0;1,5;2\n0,1;1,6;3\n",
        "\"Time\",\"Weg\",\"Kraft\"\n\"(s)\",\"(mm)\",\"(N)\"\n\"0\",\"1.5\",\"2\"\n\"0.1\",\"1.6\",\"3\"\n"}) {
    const ImportTable t = text_table(text);
    EXPECT_THAT(t.names, ElementsAre("Time", "Weg", "Kraft"));
    EXPECT_THAT(t.described, ElementsAre("Time (s)", "Weg (mm)", "Kraft (N)"));
    EXPECT_THAT(t.columns[1], ElementsAre(1.5, 1.6));
  }
}

TEST(TextTable, ColumnsOfTextAreLeftOutWithTheirName) {
  const ImportTable t = text_table("t,phase,fx,note\n0,load,1,\n1,load,2,ok\n2,hold,3,ok\n");
  EXPECT_THAT(t.names, ElementsAre("t", "phase", "fx", "note"));
  EXPECT_THAT(t.columns[2], ElementsAre(1, 2, 3));
  EXPECT_TRUE(t.is_text(1) && t.is_text(3) && !t.is_text(2));
  EXPECT_THAT(t.notes, ::testing::Contains(HasSubstr("text, left out: phase (column 2), note (column 4)")));
  EXPECT_THAT(text_refusal("t,phase,fx\n0,load,1\n1,load,2\n2,hold,x3\n3,hold,4\n"),
              HasSubstr("line 4, column 3 (fx): 'x3' is not a number"));
}

TEST(TextTable, WordsForAMissingValue) {
  for (const char* const word : {"NaN", "NA", "N/A", "#N/A", "null", "--", "1.#QNAN", "-1.#IND", ""}) {
    const ImportTable t = text_table(fmt::format("t,f\n0,1\n1,{}\n2,3\n", word));
    EXPECT_TRUE(std::isnan(t.columns[1][1])) << word;
    EXPECT_EQ(t.columns[1][2], 3) << word;
  }
}

TEST(TextTable, NumbersAsOtherProgramsWriteThem) {
  EXPECT_THAT(text_table("a,b\r1,2\r3,4\r").columns[1], ElementsAre(2, 4));  // CR alone
  EXPECT_THAT(text_table("a b\n1.5D-02 -2D+1\n0.5d0 3\n").columns[0], ElementsAre(0.015, 0.5));
  EXPECT_THAT(text_table("a;b\n1.234,56;2\n-12.345.678,5;3\n").columns[0], ElementsAre(1234.56, -12345678.5));
  EXPECT_THAT(text_table("a;b\n1,234.56;2\n999.5;3\n").columns[0], ElementsAre(1234.56, 999.5));
  // With a comma as decimal sign, 1.234 is one number or another.
  EXPECT_THAT(text_refusal("a;b\n1,5;2,5\n1,6;2,5\n1.234;3,5\n2,5;1,5\n3,5;1,5\n"),
              HasSubstr("'1.234' is not a number"));
  EXPECT_THAT(text_refusal("t,x\n0,0,1,5\n0,5,1,75\n"), HasSubstr("are its decimal signs commas"));
  // pandas numbers columns without names.
  EXPECT_THAT(text_table("0,1,2,3\n0.5,6,7,8\n0.6,6,7,9\n").columns[3], ElementsAre(8, 9));
}

// Nobody can tell 1.234 from 1,234 by itself; beside 998 it is a thousand, beside 0.5 it is not.
TEST(TextTable, GroupedThousandsAreSeenByTheirColumn) {
  const ImportTable points = text_table("x [um];f [N]\n998;0,25\n1.001;0,5\n-12.345.678;0,75\n");
  EXPECT_THAT(points.columns[0], ElementsAre(998, 1001, -12345678));
  EXPECT_THAT(points.columns[1], ElementsAre(0.25, 0.5, 0.75));
  const ImportTable commas = text_table("t,x\n0.25,\"998\"\n0.5,\"1,001\"\n0.75,\"12,003\"\n");
  EXPECT_THAT(commas.columns[0], ElementsAre(0.25, 0.5, 0.75));
  EXPECT_THAT(commas.columns[1], ElementsAre(998, 1001, 12003));
  // Three decimals throughout, or now and then fewer, are decimals.
  EXPECT_THAT(text_table("a;b\n1.001;2.500\n7.250;3.750\n").columns[0], ElementsAre(1.001, 7.25));
  EXPECT_THAT(text_table("a;b\n998;1\n1.001;2\n1.25;3\n").columns[0], ElementsAre(998, 1.001, 1.25));
  EXPECT_THAT(text_refusal("t;x\n0.5;998\n1.5;1.001\n2.25;1.002\n"),
              HasSubstr("column 2 holds '998' and '1.002', as where '.' groups thousands, but in column 1"));
  TextLayout layout;
  layout.decimal = "point";
  EXPECT_THAT(read_text_lines("f.csv", "t;x\n0.5;998\n1.5;1.001\n2.25;1,002\n", layout).columns[1],
              ElementsAre(998, 1.001, 1002));
}

TEST(TextTable, ATypesetMinusIsAMinus) {
  EXPECT_THAT(text_table("a;b\n\xe2\x88\x92"
                         "1,5;2\n3,5;\xe2\x88\x92"
                         "4\n")
                  .columns[0],
              ElementsAre(-1.5, 3.5));
}

TEST(TextTable, Utf16IsReadInBothOrders) {
  for (const bool big : {false, true}) {
    std::string bytes = big ? "\xfe\xff" : "\xff\xfe";
    for (const char16_t c : std::u16string(u"t;x [\u00b5m]\r\n0,5;1,5\r\n0,6;2,5\r\n")) {
      const char high = static_cast<char>(c >> 8), low = static_cast<char>(c & 0xff);
      bytes += big ? std::string{high, low} : std::string{low, high};
    }
    const ImportTable table = text_table(bytes);
    EXPECT_THAT(table.names, ElementsAre("t", "x [\xc2\xb5m]"));
    EXPECT_THAT(table.columns[1], ElementsAre(1.5, 2.5));
  }
  EXPECT_THAT(text_refusal("\xff\xfe\x01\xd8"), HasSubstr("UTF-16 text that is damaged at byte 2"));
}

TEST(TextTable, TimesOfTheDayAndOfTheCalendarAreSeconds) {
  const ImportTable twelve = text_table(
      "Date/Time,Clock (hh:mm:ss),Fx (N)\n3/5/2024 12:59:59.5 AM,12:59:59 PM,1\n"
      "3/5/2024 1:00:00.5 PM,1:00:00 PM,2\n");
  EXPECT_THAT(twelve.columns[0], ElementsAre(3599.5, 46800.5));
  EXPECT_THAT(twelve.columns[1], ElementsAre(46799, 46800));
  EXPECT_EQ(twelve.description(0), "time (s)");
  EXPECT_EQ(twelve.description(1), "Clock (s)");
  EXPECT_TRUE(text_table("a,f\n13:00:00 PM,1\n14:00:00 PM,2\n").is_text(0));
  const ImportTable day = text_table("Date,Time,Fx (N)\n2024-03-05,9:59:59.750,1\n2024-03-05,10:00:00.250,2\n");
  EXPECT_THAT(day.columns[1], ElementsAre(35999.75, 36000.25));
  EXPECT_EQ(day.description(1), "Time (s)");
  EXPECT_TRUE(day.is_text(0));
  // 2001-09-09 01:46:40 UTC is 10^9 seconds after the beginning of 1970.
  const ImportTable iso = text_table("when;f\n2001-09-09T01:46:40Z;1\n2001-09-09 03:46:41,5+02:00;2\n");
  EXPECT_THAT(iso.columns[0], ElementsAre(1e9, 1e9 + 1.5));
  EXPECT_TRUE(text_table("a,f\n25:00:00,1\n26:00:00,2\n").is_text(0));
}

TEST(TextTable, WhatStandsBehindTheTableIsNoRow) {
  const ImportTable t = text_table("t,f\n0,1\n1,2\nend of data\n\nno more\n");
  EXPECT_THAT(t.columns[1], ElementsAre(1, 2));
  EXPECT_THAT(t.notes, ::testing::Contains(HasSubstr("the table ends before line 4")));
  EXPECT_THAT(text_refusal("t,f\n0,1\n1,2\nend of data\n2,3\n"), HasSubstr("line 4 has 1 values"));
  const ImportTable units = text_table("# t x f\n# s mm N\n0 1 2\n1 1 2\n");
  EXPECT_THAT(units.described, ElementsAre("t (s)", "x (mm)", "f (N)"));
}

// Hysitron's export has a row and a mark between the names and the numbers.
TEST(TextTable, NamesStandFurtherUpWhereTheyAreNamesOfColumns) {
  const ImportTable t = text_table("Depth (nm)\tLoad (uN)\tTime (s)\n1.5\t2.5\t0\neoh\n2.0\t3.5\t0\n2.5\t4.5\t0.1\n");
  EXPECT_THAT(t.names, ElementsAre("Depth (nm)", "Load (uN)", "Time (s)"));
  EXPECT_EQ(t.rows(), 2U);
  EXPECT_THAT(text_table("red\tgreen\n---\n2.0\t3.5\n2.5\t4.5\n").names, ElementsAre("c1", "c2"));
}

TEST(TextTable, NamesThatComeAgainBeginASegment) {
  const ImportTable t = text_table("t,f\n0,1\n1,2\nt,f\n0,3\n1,4\n");
  EXPECT_THAT(t.names, ElementsAre("t", "f", "segment"));
  EXPECT_THAT(t.columns[2], ElementsAre(0, 0, 1, 1));
}

TEST(TextTable, BadFilesAreRefusedWithTheirPlace) {
  EXPECT_THAT(text_refusal(""), HasSubstr("is empty"));
  EXPECT_THAT(text_refusal("nothing but words\nand more of them\n"), HasSubstr("holds no table of numbers"));
  EXPECT_THAT(text_refusal("1,2,3\n4,5,6\n7,8\n"), HasSubstr("line 3 has 2 values where the lines before have 3"));
  EXPECT_THAT(text_refusal("a,b\n1,2\n3,4\n5,six\n"), HasSubstr("line 4, column 2 (b): 'six' is not a number"));
  EXPECT_THAT(text_refusal("\xff\xfe"
                           "1"),
              HasSubstr("UTF-16"));
  EXPECT_THAT(text_refusal(std::string("\x7f"
                                       "ELF\0\0\0",
                                       7)),
              HasSubstr("binary file"));
  TextLayout named;
  named.names = {"a", "b"};
  EXPECT_THAT(text_refusal("1,2,3\n4,5,6\n", named), HasSubstr("has 3 columns where the map names 2"));
  EXPECT_THROW(read_foreign(text_folder() / "no-such.txt", {}), BadData);
  write_file(text_folder() / "z.csv", "\x1f\x8b...");
  EXPECT_THROW(read_foreign(text_folder() / "z.csv", {}), BadData);
}

}  // namespace
}  // namespace touchstone::importing
