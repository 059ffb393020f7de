#include "harness/base/json_values.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace touchstone {

std::vector<std::string> texts_of(JsonObject& object, std::string_view key) {
  const nlohmann::json& list = object.raw(key);
  if (!list.is_array()) object.fail_at(key, fmt::format("a list of texts was expected, got {}", list.dump()));
  std::vector<std::string> texts;
  for (const nlohmann::json& one : list) {
    if (!one.is_string()) object.fail_at(key, fmt::format("a list of texts was expected, got {} in it", one.dump()));
    texts.push_back(one.get<std::string>());
  }
  return texts;
}

std::uint64_t count_of(JsonObject& object, std::string_view key, std::uint64_t most) {
  const double value = object.number(key);
  if (!(value >= 0.0 && value <= static_cast<double>(most) && value == std::floor(value)))
    object.fail_at(key, fmt::format("a whole number from 0 to {} was expected, got {}", most, value));
  return static_cast<std::uint64_t>(value);
}

}  // namespace touchstone
