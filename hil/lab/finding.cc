#include "lab/finding.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "harness/base/error.h"

namespace touchstone::hil {

double Finding::value(const std::string& name) const {
  for (const auto& m : measurements) {
    if (m.name == name) return m.value;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

std::vector<std::string> Finding::failures() const {
  std::vector<std::string> list;
  for (const auto& m : measurements) {
    if (!std::isfinite(m.value)) list.push_back(fmt::format("{}: {} could not be measured", test, m.name));
  }
  for (const auto& limit : limits) {
    const double v = value(limit.measurement);
    if (v >= limit.least && v <= limit.most) continue;
    list.push_back(fmt::format("{}: {} is {:.4g}; {} {:.4g} was expected", test, limit.measurement, v,
                               v > limit.most ? "at most" : "at least", v > limit.most ? limit.most : limit.least));
  }
  if (limits.empty()) list.push_back(test + ": nothing was held against a limit");
  return list;
}

void LabLimits::set(const std::string& name, double value) {
  const std::array<std::pair<const char*, double*>, 8> known{{{"friction_N", &friction_N},
                                                              {"force_error", &force_error},
                                                              {"overshoot", &overshoot},
                                                              {"bandwidth_Hz", &bandwidth_Hz},
                                                              {"latency_s", &latency_s},
                                                              {"z_width_N_per_m", &z_width_N_per_m},
                                                              {"late_p99_s", &late_p99_s},
                                                              {"golden_error", &golden_error}}};
  std::string names;
  for (const auto& [key, place] : known) {
    if (name == key) {
      if (!(value > 0.0 && std::isfinite(value)))
        throw UsageError(fmt::format("limit {}: {} is not a positive number", name, value));
      *place = value;
      return;
    }
    names += (names.empty() ? "" : ", ") + std::string(key);
  }
  throw UsageError(fmt::format("there is no limit \"{}\"; known: {}", name, names));
}

LabLimits lab_limits(const std::map<std::string, double>& stated) {
  LabLimits limits;
  for (const auto& [name, value] : stated) limits.set(name, value);
  return limits;
}

}  // namespace touchstone::hil
