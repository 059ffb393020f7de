#include "foreign_unit.h"

#include <fmt/format.h>
#include <udunits2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "harness/base/error.h"

namespace touchstone::importing {
namespace {

struct UnitFree {
  void operator()(ut_unit* unit) const { ut_free(unit); }
};
using Unit = std::unique_ptr<ut_unit, UnitFree>;
struct SystemFree {
  void operator()(ut_system* system) const { ut_free_system(system); }
};

ut_system* units() {
  static const std::unique_ptr<ut_system, SystemFree> system = [] {
    ut_set_error_message_handler(ut_ignore);
    return std::unique_ptr<ut_system, SystemFree>(ut_read_xml(nullptr));
  }();
  if (!system) throw BadData("the units of UDUNITS-2 cannot be read: is the package libudunits2-data installed?");
  return system.get();
}

constexpr auto spellings = std::to_array<std::pair<std::string_view, std::string_view>>(
    {{"secs", "s"},        {"millis", "ms"},     {"millisec", "ms"},     {"micros", "us"},    {"nanosec", "ns"},
     {"nsecs", "ns"},      {"kp", "kgf"},        {"KN", "kN"},           {"Grad", "degree"},  {"ozf", "lbf/16"},
     {"kilopond", "kgf"},  {"dyn", "dyne"},      {"thou", "mil"},        {"thous", "mil"},    {"mils", "mil"},
     {"deg", "degree"},    {"degs", "degree"},   {"\xc2\xba", "degree"}, {"lbfin", "lbf.in"}, {"inlbf", "lbf.in"},
     {"lbfft", "lbf.ft"},  {"ftlbf", "lbf.ft"},  {"ozfin", "lbf.in/16"}, {"lbsf", "lbf"},     {"lbsf-in", "lbf.in"},
     {"lbf*in", "lbf.in"}, {"in lbf", "lbf.in"}, {"\xc2\xb5sec", "us"},  {"micron", "um"}});

// A mass times a length is a torque and nothing else: "in-lb", "oz-in", "kg-cm" leave the f of the force out.
constexpr auto torques = std::to_array<std::pair<std::string_view, std::string_view>>(
    {{"lb-in", "lbf.in"},    {"in-lb", "lbf.in"},   {"in-lbs", "lbf.in"},   {"lbs-in", "lbf.in"},
     {"lb.in", "lbf.in"},    {"in.lb", "lbf.in"},   {"inlb", "lbf.in"},     {"inlbs", "lbf.in"},
     {"lbin", "lbf.in"},     {"lb-ft", "lbf.ft"},   {"ft-lb", "lbf.ft"},    {"ft-lbs", "lbf.ft"},
     {"ft.lb", "lbf.ft"},    {"ftlb", "lbf.ft"},    {"oz-in", "lbf.in/16"}, {"in-oz", "lbf.in/16"},
     {"oz.in", "lbf.in/16"}, {"ozin", "lbf.in/16"}, {"kg-cm", "kgf.cm"},    {"kg.cm", "kgf.cm"},
     {"kgcm", "kgf.cm"},     {"kgfcm", "kgf.cm"},   {"kgfm", "kgf.m"},      {"g-cm", "gf.cm"},
     {"g.cm", "gf.cm"}});

template <class Table>
std::string_view looked_up(const Table& table, std::string_view written) {
  const auto found = std::ranges::find(table, written, [](const auto& pair) { return pair.first; });
  return found == table.end() ? std::string_view{} : found->second;
}

// "Nm", "mNm", "N mm": newton metres without a sign between them.
std::string with_dot(const std::string& text) {
  const auto newton = text.find('N');
  if (newton == std::string::npos) return text;
  const std::string length = text.substr(newton + 1);
  if (length != "m" && length != "mm" && length != "cm") return text;
  return text.substr(0, newton) + "N." + length;
}

Unit parsed(std::string_view written) {
  std::string text = as_utf8(written);
  const auto from = text.find_first_not_of(" \t"), to = text.find_last_not_of(" \t.");
  if (from == std::string::npos || to == std::string::npos || to < from) return nullptr;
  text = text.substr(from, to - from + 1);
  // A number alone is no unit, nor is a date, which UDUNITS would read as a product; and whether "N*1000" is a thousand
  // newtons or what was multiplied by it nobody knows.
  if (text.find_first_of("0123456789") == 0 || text.front() == '-' || text.front() == '+') return nullptr;
  if (text.find_first_of("*x/") != std::string::npos && text.find("10") != std::string::npos) return nullptr;
  if (const auto known = looked_up(spellings, text); !known.empty()) text = known;
  Unit unit(ut_parse(units(), with_dot(text).c_str(), UT_UTF8));
  if (unit) return unit;
  // "Newtons" and "Millimeters" are known in small letters only.
  constexpr std::size_t word = 4;
  if (text.size() < word) return nullptr;
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return c < 0x80 ? std::tolower(c) : c; });
  return Unit(ut_parse(units(), text.c_str(), UT_UTF8));
}

std::optional<double> factor_of(const ut_unit* unit, std::string_view si) {
  const Unit base(ut_parse(units(), std::string(si).c_str(), UT_UTF8));
  // As a ratio, for UDUNITS converts a time to a rate.
  const Unit ratio(ut_divide(unit, base.get()));
  const Unit one(ut_get_dimensionless_unit_one(units()));
  if (!ratio || ut_is_dimensionless(ratio.get()) == 0 || ut_are_convertible(ratio.get(), one.get()) == 0) {
    return std::nullopt;
  }
  const std::unique_ptr<cv_converter, void (*)(cv_converter*)> converter(ut_get_converter(ratio.get(), one.get()),
                                                                         cv_free);
  if (!converter || cv_convert_double(converter.get(), 0.0) != 0.0) return std::nullopt;
  const double factor = cv_convert_double(converter.get(), 1.0);
  // The database's products leave a rounding: 0.0254 for the inch, and not 0.025400000000000002.
  return std::stod(fmt::format("{:.15g}", factor));
}

}  // namespace

std::optional<double> foreign_unit_factor(std::string_view written, std::string_view si) {
  const Unit unit = parsed(written);
  if (si == "rad") {
    // To UDUNITS counts and per cent are angles too, for both have no dimension.
    const std::string text = as_utf8(written);
    const bool angle = text.find("rad") != std::string::npos || text.find("deg") != std::string::npos ||
                       text.find("Deg") != std::string::npos || text == "\xc2\xb0" || text == "\xc2\xba";
    if (!angle) return std::nullopt;
  }
  // A joule is no torque to anybody: "tau_J" is of joints.
  if (unit && !(si == "N.m" && written == "J")) {
    if (const auto factor = factor_of(unit.get(), si)) return factor;
  }
  if (si != "N.m") return std::nullopt;
  const auto torque = looked_up(torques, written);
  return torque.empty() ? std::nullopt : factor_of(parsed(torque).get(), si);
}

bool is_foreign_unit(std::string_view written) {
  return parsed(written) != nullptr || !looked_up(torques, written).empty();
}

std::string as_utf8(std::string_view text) {
  try {
    static_cast<void>(nlohmann::json(text).dump());
    return std::string(text);
  } catch (const nlohmann::json::type_error&) {
    std::string result;
    for (const char c : text) {
      const auto byte = static_cast<unsigned char>(c);
      if (byte < 0x80) {
        result += c;
      } else {
        result += static_cast<char>(0xc0U | (byte >> 6U));
        result += static_cast<char>(0x80U | (byte & 0x3fU));
      }
    }
    return result;
  }
}

}  // namespace touchstone::importing
