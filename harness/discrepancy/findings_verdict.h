// What a search for missing effects says of a model, in one word.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace touchstone::discrepancy {

enum class FindingsVerdict : std::uint8_t {
  consistent,       // nothing is missing: the model leaves what the noise does
  explained,        // with the effects named, the model leaves what the noise does
  unexplained,      // something is missing that the named effects, if any, do not explain
  not_identifiable  // several effects fit the recording equally well
};

// As findings.json spells it: "consistent", "explained", "unexplained", "not-identifiable".
std::string to_string(FindingsVerdict verdict);
// Throws BadData for any other word.
FindingsVerdict findings_verdict(std::string_view word);

}  // namespace touchstone::discrepancy
