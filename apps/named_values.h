// NAME=VALUE options, as in --param radius_m=0.03.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone::apps {

// Throws UsageError, naming the option, for a text that is not NAME=number and for a name that is given twice.
std::map<std::string, double, std::less<>> named_values(std::string_view option, const std::vector<std::string>& texts);

}  // namespace touchstone::apps
