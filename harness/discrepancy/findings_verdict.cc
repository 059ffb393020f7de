#include "harness/discrepancy/findings_verdict.h"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "harness/base/error.h"

namespace touchstone::discrepancy {
namespace {

constexpr std::array<std::pair<FindingsVerdict, std::string_view>, 4> words{
    {{FindingsVerdict::consistent, "consistent"},
     {FindingsVerdict::explained, "explained"},
     {FindingsVerdict::unexplained, "unexplained"},
     {FindingsVerdict::not_identifiable, "not-identifiable"}}};

}  // namespace

std::string to_string(FindingsVerdict verdict) {
  for (const auto& [value, word] : words) {
    if (value == verdict) return std::string(word);
  }
  return std::string(words[2].second);
}

FindingsVerdict findings_verdict(std::string_view word) {
  for (const auto& [value, spelled] : words) {
    if (spelled == word) return value;
  }
  throw BadData(
      fmt::format("the verdict is \"{}\"; consistent, explained, unexplained or not-identifiable was expected", word));
}

}  // namespace touchstone::discrepancy
