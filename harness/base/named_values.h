// Options of the form NAME=VALUE, as in --param radius_m=0.03 (units are in the names), and NAME=FILE.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace touchstone {

// Throws UsageError, naming the option, for a text that is not NAME=number and for a name that is given twice.
std::map<std::string, double, std::less<>> named_values(std::string_view option, const std::vector<std::string>& texts);

// NAME=FILE in its two parts. Throws UsageError, naming the option, for another text.
std::pair<std::string, std::string> named_file(std::string_view option, const std::string& text);

}  // namespace touchstone
