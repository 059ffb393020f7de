#include "harness/base/named_values.h"

#include <fmt/format.h>

#include <charconv>

#include "harness/base/error.h"

namespace touchstone {

std::map<std::string, double, std::less<>> named_values(std::string_view option,
                                                        const std::vector<std::string>& texts) {
  std::map<std::string, double, std::less<>> values;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    const std::string name = text.substr(0, equals);
    const char* const begin = text.data() + (equals == std::string::npos ? text.size() : equals + 1);
    const char* const end = text.data() + text.size();
    double value = 0.0;
    const auto [stop, error] = std::from_chars(begin, end, value);
    if (name.empty() || error != std::errc{} || stop != end) {
      throw UsageError(fmt::format("{} '{}' is not name=number, as in radius_m=0.03", option, text));
    }
    if (!values.emplace(name, value).second) throw UsageError(fmt::format("{} {} is given twice", option, name));
  }
  return values;
}

std::pair<std::string, std::string> named_file(std::string_view option, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    throw UsageError(fmt::format("{} {}: NAME=FILE was expected", option, text));
  return {text.substr(0, equals), text.substr(equals + 1)};
}

}  // namespace touchstone
