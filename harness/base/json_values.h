// Values of JSON files that people write which JsonObject itself does not read: lists of texts and whole numbers.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "harness/base/json_reader.h"

namespace touchstone {

// The required list of texts at `key`, as it stands. Throws BadData with file and place for anything else.
std::vector<std::string> texts_of(JsonObject& object, std::string_view key);

// The required whole number from 0 to `most` at `key`; 2 and 2.0 are the same. `most` is at most 2^53, beyond which
// JSON's numbers are not whole any more. Throws BadData with file, place and value for anything else.
std::uint64_t count_of(JsonObject& object, std::string_view key, std::uint64_t most);

}  // namespace touchstone
