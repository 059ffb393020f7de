#include "harness/base/file_description.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "harness/base/error.h"

namespace touchstone {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const FileFormat inner{
    "touchstone-inner/1", "inner.json", "an inner file", "", "`read`", {{"size", "number", "m", "length"}}};
const FileFormat outer{"touchstone-outer/1",
                       "outer.json",
                       "a file",
                       "`write`",
                       "",
                       {
                           {"count", "whole number", "", "how many"},
                           {"entries",
                            "list of objects",
                            "",
                            "each",
                            {{"name", "text", "", "which"}, {"value?", "number or null", "N", "how much"}}},
                           {"by_name?", "object", "", "the same by name"},
                           {"by_name.*", "object", "", "one"},
                           {"by_name.*.flags", "list of texts", "", "what holds"},
                           {"places?", "list of lists of numbers", "m", "where"},
                           {"start?", "number or list of numbers", "s", "when"},
                           {"inside?", "touchstone-inner/1", "", "another file"},
                       }};
const std::array known{inner, outer};

std::vector<std::string> differences(const char* text) { return differences_from(outer, json::parse(text), known); }

TEST(FileDescription, WhatTheTableSaysPasses) {
  EXPECT_THAT(differences(R"({"schema": "touchstone-outer/1", "count": 2, "entries": []})"), IsEmpty());
  EXPECT_THAT(differences(R"({"count": 2, "entries": [{"name": "a"}, {"name": "b", "value": null}],
    "by_name": {"a": {"flags": ["x"]}}, "places": [[1, null]], "start": [0, 1],
    "inside": {"schema": "touchstone-inner/1", "size": 3}})"),
              IsEmpty());
}

TEST(FileDescription, EachDifferenceIsNamedWithItsPlace) {
  EXPECT_THAT(differences(R"({"count": 2, "entries": [{"value": 1}]})"),
              ElementsAre(HasSubstr("/entries/0/name is not there")));
  EXPECT_THAT(differences(R"({"count": 2, "entries": [{"name": "a", "more": 1}]})"),
              ElementsAre(HasSubstr("/entries/0/more is not described")));
  EXPECT_THAT(differences(R"({"count": 2.5, "entries": []})"),
              ElementsAre(HasSubstr("/count is number; the format says whole number")));
  EXPECT_THAT(differences(R"({"count": 2, "entries": [], "by_name": {"a": {}}})"),
              ElementsAre(HasSubstr("/by_name/a/flags is not there")));
  EXPECT_THAT(differences(R"({"count": 2, "entries": [], "places": [["x"]]})"),
              ElementsAre(HasSubstr("/places is array")));
  EXPECT_THAT(differences(R"({"count": 2, "entries": [], "inside": {"length": 3}})"),
              ElementsAre(HasSubstr("touchstone-inner/1: /size is not there"), HasSubstr("/length is not described")));
  EXPECT_THAT(differences("[]"), ElementsAre(HasSubstr("is no object")));
}

TEST(FileDescription, KeysByPathWithThoseOfParts) {
  EXPECT_THAT(keys_of(outer), ElementsAre("count", "entries", "entries[].name", "entries[].value", "by_name",
                                          "by_name.*.flags", "places", "start", "inside"));
  EXPECT_THAT(keys_seen(outer, json::parse(R"({"count": 1, "entries": [{"name": "a"}]})")),
              ElementsAre("count", "entries", "entries[].name"));
}

TEST(FileDescription, OneRowForEachKey) {
  const std::string page = format_markdown(outer);
  EXPECT_THAT(page, HasSubstr("## `touchstone-outer/1`"));
  EXPECT_THAT(page, HasSubstr("| `entries[].value` (optional) | number or null | N | how much |"));
  const json document = json::parse(R"({"count": 1, "entries": []})");
  EXPECT_THAT(format_text(outer, &document), HasSubstr("  count: whole number, how many"));
  EXPECT_EQ(format_text(outer, &document).find("places"), std::string::npos);
}

class FormatTables : public ::testing::Test {
 protected:
  ~FormatTables() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path table(const std::string& name, const std::string& text) {
    std::filesystem::create_directories(folder_);
    std::ofstream(folder_ / name) << R"({"schema": "touchstone-formats/1", )" << text << "}";
    return folder_ / name;
  }
  std::filesystem::path folder_ = std::filesystem::path(::testing::TempDir()) / fmt::format("tables-{}", ::getpid());
};

constexpr const char* inside =
    R"("formats": [{"schema": "touchstone-z/1", "file": "z.json", "summary": "last", "fields": [
  {"path": "size", "type": "number", "unit": "m", "meaning": "length"},
  {"path": "more?", "type": "object", "meaning": "shared", "part": "shared"}]},
  {"schema": "touchstone-a/1", "file": "a.json", "summary": "first by name, last by stability", "internal": true}])";

TEST_F(FormatTables, PartsOfAnyTableServeAll) {
  const auto formats =
      load_formats({table("one.json", inside),
                    table("two.json",
                          R"("parts": {"shared": [{"path": "of", "type": "list of objects", "meaning": "each",
                                      "part": [{"path": "name", "type": "text", "meaning": "which"}]}]}, "formats": [])")});
  ASSERT_EQ(formats.size(), 2U);
  EXPECT_EQ(formats[0].schema, "touchstone-z/1");
  EXPECT_THAT(keys_of(formats[0]), ElementsAre("size", "more", "more.of", "more.of[].name"));
  EXPECT_EQ(formats[0].fields[0].unit, "m");
  EXPECT_TRUE(formats[1].internal);
}

TEST_F(FormatTables, WhatIsWrongIsNamedWithItsPlace) {
  const auto refusal = [](const std::vector<std::filesystem::path>& tables) -> std::string {
    try {
      load_formats(tables);
    } catch (const BadData& error) {
      return error.what();
    }
    return "";
  };
  const auto one = table("one.json", inside);
  EXPECT_THAT(refusal({one}), HasSubstr("/formats/0/fields/1/part: no table describes a part 'shared'"));
  const char* const itself =
      R"("parts": {"shared": [{"path": "a", "type": "object", "meaning": "b", "part": "shared"}]}, "formats": [])";
  EXPECT_THAT(refusal({one, table("itself.json", itself)}), HasSubstr("the part 'shared' holds itself"));
  const char* const plain = R"("parts": {"shared": []}, "formats": [])";
  EXPECT_THAT(refusal({table("a.json", plain), table("b.json", plain)}), HasSubstr("b.json"));
  EXPECT_THAT(refusal({table("a.json", plain), one, one}),
              HasSubstr("touchstone-z/1: two tables describe this format"));
  EXPECT_THAT(refusal({table("c.json", R"("formats": [], "form": 1)")}), HasSubstr("form"));
}

}  // namespace
}  // namespace touchstone
