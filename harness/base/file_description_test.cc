#include "harness/base/file_description.h"

#include <gmock/gmock.h>

#include <array>
#include <nlohmann/json.hpp>

namespace touchstone {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr auto inner_fields = std::to_array<FormatField>({{"size", "number", "m", "length"}});
constexpr FileFormat inner{"touchstone-inner/1", "inner.json", "an inner file", "", "`read`", inner_fields};
constexpr auto part_fields = std::to_array<FormatField>({
    {"name", "text", "", "which"},
    {"value?", "number or null", "N", "how much"},
});
constexpr FormatPart part{part_fields};
constexpr auto fields = std::to_array<FormatField>({
    {"count", "whole number", "", "how many"},
    {"entries", "list of objects", "", "each", &part},
    {"by_name?", "object", "", "the same by name"},
    {"by_name.*", "object", "", "one"},
    {"by_name.*.flags", "list of texts", "", "what holds"},
    {"places?", "list of lists of numbers", "m", "where"},
    {"start?", "number or list of numbers", "s", "when"},
    {"inside?", "touchstone-inner/1", "", "another file"},
});
constexpr FileFormat outer{"touchstone-outer/1", "outer.json", "a file", "`write`", "", fields};
constexpr std::array<const FileFormat*, 2> known{&inner, &outer};

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

}  // namespace
}  // namespace touchstone
