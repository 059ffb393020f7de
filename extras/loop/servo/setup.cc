#include "servo/setup.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>

#include "harness/base/error.h"
#include "harness/base/known_names.h"

namespace touchstone::servo {
namespace {

constexpr std::string_view hand_prefix = "hand_";
constexpr std::string_view virtual_damping = "virtual_damping_N_s_per_m";
// Of devices whose mass is not published: from that of the lightest published one on, in doublings.
constexpr std::array tried_masses_kg{0.05, 0.1, 0.2, 0.4, 0.8};
constexpr double customary_period_s = 1e-3;

using Values = std::map<std::string, double, std::less<>>;

double set_or(const Values& set, std::string_view prefix, const DataSheet& sheet, std::string_view name,
              double otherwise) {
  const auto found = set.find(std::string(prefix) + std::string(name));
  return found != set.end() ? found->second : sheet.value(name).value_or(otherwise);
}

bool has(const Values& set, std::string_view prefix, const DataSheet& sheet, std::string_view name) {
  return set.contains(std::string(prefix) + std::string(name)) || sheet.value(name).has_value();
}

void check_names(const Values& set) {
  const auto known = names_to_set();
  for (const auto& given : set) {
    const std::string& name = given.first;
    const double value = given.second;
    if (std::ranges::find(known, name) == known.end())
      throw UsageError("--set: " + unknown_name("figure", name, known));
    const bool above_zero = std::ranges::any_of(
        device_entries(), [&name](const FigureEntry& entry) { return entry.name == name && entry.above_zero; });
    if (!(above_zero ? value > 0.0 : value >= 0.0)) {
      throw UsageError(fmt::format("--set {}={}: {} was expected", name, value, above_zero ? "above 0" : "0 or more"));
    }
  }
}

void check_grip(const Values& set, const DataSheet& grip) {
  for (const FigureEntry& entry : grip_entries()) {
    if (has(set, hand_prefix, grip, entry.name)) continue;
    const auto why = grip.not_published.find(entry.name);
    throw UsageError(fmt::format("grip {}: no {} [{}]{}; give it: --set {}{}=VALUE", grip.name, entry.name, entry.unit,
                                 why == grip.not_published.end() ? "" : " (" + why->second + ")", hand_prefix,
                                 entry.name));
  }
}

std::vector<std::string> assumptions(const Values& set, const DataSheet& device) {
  std::vector<std::string> out;
  const auto assume = [&](std::string_view name, const std::string& what) {
    if (!has(set, "", device, name)) out.push_back(fmt::format("{}: {}", name, what));
  };
  assume("mass_kg",
         fmt::format("not published; {} to {} kg are tried", tried_masses_kg.front(), tried_masses_kg.back()));
  assume("damping_N_s_per_m", "not published; none, which is the worst case");
  assume("friction_N", "not published; none, which is the worst case");
  assume("resolution_m", "not published; positions are exact");
  assume("force_limit_N", "not published; none");
  assume("actuator_bandwidth_Hz", "not published; the force follows at once");
  assume("period_s", "the program's that drives the device; 1 ms");
  assume("latency_s", "not published; none");
  assume("jitter_s", "not published; none");
  return out;
}

}  // namespace

std::vector<std::string> names_to_set() {
  std::vector<std::string> names;
  for (const FigureEntry& entry : device_entries()) names.emplace_back(entry.name);
  for (const FigureEntry& entry : grip_entries()) names.push_back(std::string(hand_prefix) + std::string(entry.name));
  names.emplace_back(virtual_damping);
  return names;
}

LoopParameters LoopSetup::with_mass(double device_mass_kg) const {
  LoopParameters own = parameters;
  own.axis.mass_kg = device_mass_kg + own.hand_mass_kg;
  return own;
}

LoopSetup make_setup(const std::string& device, const std::string& grip, const Values& set, std::uint64_t seed) {
  check_names(set);
  LoopSetup out;
  out.device = find_device(device);
  out.grip = find_grip(grip);
  check_grip(set, out.grip);
  const auto figure = [&](std::string_view name, double otherwise) {
    return set_or(set, "", out.device, name, otherwise);
  };
  const auto hand = [&](std::string_view name) { return set_or(set, hand_prefix, out.grip, name, 0.0); };
  constexpr double no_limit = std::numeric_limits<double>::infinity();

  LoopParameters& own = out.parameters;
  own.hand_mass_kg = hand("mass_kg");
  own.axis.hand_damping_N_s_per_m = hand("damping_N_s_per_m");
  own.axis.hand_stiffness_N_per_m = hand("stiffness_N_per_m");
  own.axis.damping_N_s_per_m = figure("damping_N_s_per_m", 0.0);
  own.axis.friction_N = figure("friction_N", 0.0);
  const double bandwidth_Hz = figure("actuator_bandwidth_Hz", no_limit);
  own.axis.actuator_time_constant_s = 1.0 / (2.0 * std::numbers::pi * bandwidth_Hz);
  own.resolution_m = figure("resolution_m", 0.0);
  own.force_limit_N = figure("force_limit_N", no_limit);
  own.period_s = figure("period_s", customary_period_s);
  own.latency_s = figure("latency_s", 0.0);
  own.jitter_s = figure("jitter_s", 0.0);
  own.velocity_cutoff_Hz = figure("velocity_cutoff_Hz", no_limit);
  if (const auto found = set.find(std::string(virtual_damping)); found != set.end())
    own.virtual_damping_N_s_per_m = found->second;
  own.seed = seed;

  if (has(set, "", out.device, "mass_kg")) {
    out.device_masses_kg = {figure("mass_kg", 0.0)};
  } else {
    out.device_masses_kg.assign(tried_masses_kg.begin(), tried_masses_kg.end());
  }
  own.axis.mass_kg = out.device_masses_kg.front() + own.hand_mass_kg;
  out.assumed = assumptions(set, out.device);
  return out;
}

Verdict agreed(const std::vector<Verdict>& verdicts) {
  const bool same =
      !verdicts.empty() && std::ranges::all_of(verdicts, [&](Verdict v) { return v == verdicts.front(); });
  return same ? verdicts.front() : Verdict::cannot_tell;
}

}  // namespace touchstone::servo
