#include "harness/perception/judge/thresholds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "harness/base/json_reader.h"
#include "harness/perception/statistics.h"

namespace touchstone::perception {

const std::vector<ThresholdEntry>& threshold_entries() {
  static const std::vector<ThresholdEntry> entries{
      {"force_absolute_N", "N", "Jones (2000), fingertip",
       [](Thresholds& t) -> double& { return t.force.absolute_threshold; }},
      {"force_breakpoint_N", "N", "Shao, Wu and Ouyang, section 3.2",
       [](Thresholds& t) -> double& { return t.force.breakpoint; }},
      {"force_fraction_below", "1", "Nadjarbashi, Abdi and Nahavandi (2015): 15 to 27 %",
       [](Thresholds& t) -> double& { return t.force.fraction_below; }},
      {"force_fraction_above", "1",
       "Pang, Tan and Durlach (1991): 7 %; agrees with 8 % for the stiffness of springs pressed equally deep (Tan, "
       "Durlach, Beauregard and Srinivasan 1995)",
       [](Thresholds& t) -> double& { return t.force.fraction_above; }},
      {"stiffness_fraction", "1",
       "Tan, Durlach, Beauregard and Srinivasan (1995): 22 % where the depth varies; Jones and Hunter (1990): 23 %",
       [](Thresholds& t) -> double& { return t.stiffness_fraction; }},
      {"direction_rad", "rad", "Barbagli, Salisbury, Ho, Spence and Tan (2006): 25.6 degrees by touch alone",
       [](Thresholds& t) -> double& { return t.direction_rad; }},
      {"friction_fraction", "1",
       "of the total force: that of force below its breakpoint, for want of a figure for tools; Samur, Colgate and "
       "Peshkin (2009) give 18 % for the friction of a fingertip",
       [](Thresholds& t) -> double& { return t.friction_fraction; }},
      {"position_m", "m", "Durlach et al. (1989), length by finger span: 1 mm at 10 to 20 mm",
       [](Thresholds& t) -> double& { return t.position_m; }},
      {"vibration_fraction", "1",
       "Forta, Griffin and Morioka (2012): median difference threshold 0.20 at 125 Hz, 10 dB above threshold",
       [](Thresholds& t) -> double& { return t.vibration_fraction; }},
      {"vibration_integration_s", "s",
       "Verrillo (1965): the threshold of the Pacinian channel falls up to some 200 ms of duration",
       [](Thresholds& t) -> double& { return t.vibration_integration_s; }},
      {"hand_mass_kg", "kg", "fingertip, middle of the range of Hajian and Howe (1997)",
       [](Thresholds& t) -> double& { return t.hand_mass_kg; }},
      {"hand_damping_N_s_per_m", "N s/m", "fingertip, middle of the range of Hajian and Howe (1997)",
       [](Thresholds& t) -> double& { return t.hand_damping_N_s_per_m; }},
      {"hand_stiffness_N_per_m", "N/m", "fingertip, middle of the range of Hajian and Howe (1997)",
       [](Thresholds& t) -> double& { return t.hand_stiffness_N_per_m; }},
  };
  return entries;
}

std::string_view vibration_threshold_source() {
  return "displacement that is just felt (Bolanowski, Gescheider, Verrillo and Checkosky 1988: Pacinian channel -12 dB "
         "per octave to 0.1 um at 250 Hz, above +12 dB per octave from 300 Hz; non-Pacinian channel about 10 um at 20 "
         "Hz, -5 dB per octave), times the impedance of the hand at the tip, as Israr, Choi and Tan (2006) relate the "
         "two; straight lines, good to a factor of 2 to 3";
}

double Thresholds::vibration_displacement_m(double frequency_Hz) {
  constexpr double kBest_m = 1e-7;
  // 12 dB per octave is the square of the frequency.
  double pacinian_m = kBest_m;
  if (frequency_Hz < 250.0) pacinian_m *= std::pow(250.0 / frequency_Hz, 2);
  if (frequency_Hz > 300.0) pacinian_m *= std::pow(frequency_Hz / 300.0, 2);
  constexpr double kExponent = 5.0 / 6.0206;  // 5 dB per octave
  const double other_m = 1e-5 * std::pow(20.0 / frequency_Hz, kExponent);
  return std::min(pacinian_m, other_m);
}

double Thresholds::vibration_force_N(double frequency_Hz) const {
  if (!vibration_frequency_Hz.empty()) {
    // Straight lines between the points of the double-logarithmic curve, held beyond its ends.
    const auto& f = vibration_frequency_Hz;
    const auto above = std::upper_bound(f.begin(), f.end(), frequency_Hz);
    if (above == f.begin()) return vibration_amplitude_N.front();
    if (above == f.end()) return vibration_amplitude_N.back();
    const auto i = static_cast<std::size_t>(above - f.begin());
    const double share = std::log(frequency_Hz / f[i - 1]) / std::log(f[i] / f[i - 1]);
    return vibration_amplitude_N[i - 1] * std::pow(vibration_amplitude_N[i] / vibration_amplitude_N[i - 1], share);
  }
  const double omega = 2.0 * std::numbers::pi * frequency_Hz;
  const double impedance = std::hypot(hand_damping_N_s_per_m, omega * hand_mass_kg - hand_stiffness_N_per_m / omega);
  return omega * vibration_displacement_m(frequency_Hz) * impedance;
}

Thresholds read_thresholds(const std::filesystem::path& file) {
  const auto document = load_json(file);
  JsonObject root(document, file.string(), "");
  root.schema("touchstone-thresholds/1");
  Thresholds result;
  for (const auto& entry : threshold_entries()) {
    const auto value = root.optional_number(entry.name);
    if (!value) continue;
    if (!(*value > 0.0))
      root.fail_at(entry.name, fmt::format("{} {}: a value above 0 was expected", *value, entry.unit));
    entry.place(result) = *value;
  }
  if (root.has("vibration_threshold")) {
    JsonObject curve = root.object("vibration_threshold");
    result.vibration_frequency_Hz = curve.numbers("frequency_Hz");
    result.vibration_amplitude_N = curve.numbers("amplitude_N");
    curve.finish();
    const auto& f = result.vibration_frequency_Hz;
    if (f.size() < 2 || f.size() != result.vibration_amplitude_N.size())
      curve.fail("at least two frequencies and an amplitude for each were expected");
    for (std::size_t i = 0; i < f.size(); ++i) {
      if (!(f[i] > (i == 0 ? 0.0 : f[i - 1])))
        curve.fail_at("frequency_Hz", fmt::format("{} Hz: ascending frequencies above 0 were expected", f[i]));
      if (!(result.vibration_amplitude_N[i] > 0.0))
        curve.fail_at("amplitude_N",
                      fmt::format("{} N: a value above 0 was expected", result.vibration_amplitude_N[i]));
    }
  }
  if (root.has("sources")) root.raw("sources");
  root.finish();
  return result;
}

std::string thresholds_to_json(const Thresholds& thresholds) {
  nlohmann::ordered_json document{{"schema", "touchstone-thresholds/1"}};
  nlohmann::ordered_json sources = nlohmann::ordered_json::object();
  Thresholds copy = thresholds;
  for (const auto& entry : threshold_entries()) {
    document[std::string(entry.name)] = entry.place(copy);
    sources[std::string(entry.name)] = fmt::format("[{}] {}", entry.unit, entry.source);
  }
  std::vector<double> f = thresholds.vibration_frequency_Hz;
  if (f.empty()) f = {20, 25, 31.5, 40, 50, 63, 80, 100, 125, 160, 200, 250, 315, 400, 500, 630, 800, 1000};
  std::vector<double> amplitude_N;
  for (const double frequency : f) amplitude_N.push_back(thresholds.vibration_force_N(frequency));
  document["vibration_threshold"] = {{"frequency_Hz", f}, {"amplitude_N", amplitude_N}};
  sources["vibration_threshold"] = vibration_threshold_source();
  document["sources"] = sources;
  return document.dump(2) + "\n";
}

double forced_choice_probability(double d_prime) { return normal_cdf(d_prime / std::numbers::sqrt2); }

}  // namespace touchstone::perception
