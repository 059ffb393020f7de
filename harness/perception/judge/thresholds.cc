#include "harness/perception/judge/thresholds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "harness/base/json_reader.h"
#include "harness/stats/distributions.h"

namespace touchstone::perception {

const std::vector<ThresholdEntry>& threshold_entries() {
  constexpr std::string_view shao = "Shao, Wu and Ouyang (2019), section 3.2";
  constexpr std::string_view abstract = "its abstract";
  constexpr std::string_view no_published_source = "none: no difference that is noticed";
  constexpr std::string_view one_interval =
      "one interval, two alternatives, with feedback (its abstract); d' = 1 is assumed";
  static const std::vector<ThresholdEntry> entries{
      {"force_absolute_N", "N", "Jones (2000), fingertip", shao,
       [](Thresholds& t) -> double& { return t.force.absolute_threshold; }},
      {"force_breakpoint_N", "N",
       "Shao, Wu and Ouyang (2019): where the range of Pang, Tan and Durlach (1991), 2.5 to 10 N, begins", shao,
       [](Thresholds& t) -> double& { return t.force.breakpoint; }},
      {"force_fraction_below", "1",
       "Shao, Wu and Ouyang (2019), of the 15 to 27 % that they find in Nadjarbashi (2015)", shao,
       [](Thresholds& t) -> double& { return t.force.fraction_below; }},
      {"force_fraction_above", "1",
       "Pang, Tan and Durlach (1991): 7 % between 2.5 and 10 N; agrees with the 8 % for compliance that Tan, Pang and "
       "Durlach (1992) found if force and work could be felt",
       abstract, [](Thresholds& t) -> double& { return t.force.fraction_above; }, one_interval},
      {"stiffness_fraction", "1",
       "Tan, Durlach, Beauregard and Srinivasan (1995): 22 % for compliance if the depth is varied, so that the force "
       "does not give it away",
       abstract, [](Thresholds& t) -> double& { return t.stiffness_fraction; }},
      {"depth_fraction", "1", "derived: the 22 % for compliance without the 7 % for force, both as above",
       "the two abstracts", [](Thresholds& t) -> double& { return t.depth_fraction; }, "that of the two", true},
      {"direction_rad", "rad", "Barbagli, Salisbury, Ho, Spence and Tan (2006): 25.6 degrees by touch alone", abstract,
       [](Thresholds& t) -> double& { return t.direction_rad; }},
      {"friction_fraction", "1",
       "Fehlberg, Kim, Drewing, Hensel and Bennewitz (2022): fingertips noticed relative differences of friction of "
       "0.2. Of friction that is itself noticed as a force; less counts as force does",
       abstract, [](Thresholds& t) -> double& { return t.friction_fraction; },
       "forced choice (its abstract); the share of right answers is not stated there, d' = 1 is assumed"},
      {"position_m", "m",
       "derived: van Beers, Sittig and Denier van der Gon (1998): hands are localised without sight as if the angles "
       "of "
       "elbow and shoulder were known to 0.6 to 1.1 degrees (standard deviation); 0.6 degrees over 0.3 m, a short "
       "reach "
       "(ours), the finest that a hand tells of a place in space. Coarser by a distance moved: 11 % of 25 or 35 cm "
       "(van "
       "Beek, Bergmann Tiest and Kappers 2014). Finer between finger and thumb: 0.4 +- 0.1 mm of the thickness of a "
       "plate (Ho and Srinivasan 1996), for which a file has position_m 0.0004",
       "the three abstracts", [](Thresholds& t) -> double& { return t.position_m; },
       "matching of places without sight (its abstract): one standard deviation is d' = 1"},
      {"delay_s", "s",
       "Rank, Shi, Mueller and Hirche (2010), The influence of different haptic environments on time delay "
       "discrimination "
       "in force feedback: a delay of force behind motion is told from 36 ms on in a spring; from 15 ms in a damper, "
       "from "
       "72 ms in a damped inertia, whose thresholds this constant does not have. Their other paper (2010, Presence "
       "19): it "
       "depends on how fast and far the hand moves, not on the force",
       "both abstracts", [](Thresholds& t) -> double& { return t.delay_s; },
       "the share of right answers is not stated there, d' = 1 is assumed, and d' grows in proportion to the delay"},
      {"vibration_fraction", "1",
       "Forta, Griffin and Morioka (2012): median difference threshold 0.20 on the thenar eminence at 125 Hz, 10 dB "
       "above threshold; up to 0.58 at 10 Hz",
       abstract, [](Thresholds& t) -> double& { return t.vibration_fraction; },
       "three down and one up (its abstract): 79 % right of two alternatives, d' = 1.16"},
      {"frequency_fraction", "1",
       "Israr, Tan and Reed (2006): without a masker, Weber fractions of the frequency average 0.25 at 20 dB and 0.18 "
       "at "
       "35 dB above threshold (0.13 to 0.38 for the single frequencies, 2 to 300 Hz); their geometric mean. With a "
       "masker "
       "0.46 to 0.60",
       "its abstract, and the averages in its text", [](Thresholds& t) -> double& { return t.frequency_fraction; },
       "staircase (its text); the share of right answers was not read there, d' = 1 is assumed"},
      {"vibration_integration_s", "s",
       "Verrillo (1965): the threshold of the Pacinian channel falls up to some 200 ms of duration (that it does, at "
       "high "
       "frequencies only, says the abstract of Gescheider 1976; the time is not in it)",
       "", [](Thresholds& t) -> double& { return t.vibration_integration_s; }, no_published_source},
      {"hand_mass_kg", "kg", "fingertip, middle of the range of Hajian and Howe (1997)", "",
       [](Thresholds& t) -> double& { return t.hand_mass_kg; }, no_published_source},
      {"hand_damping_N_s_per_m", "N s/m", "fingertip, middle of the range of Hajian and Howe (1997)", "",
       [](Thresholds& t) -> double& { return t.hand_damping_N_s_per_m; }, no_published_source},
      {"hand_stiffness_N_per_m", "N/m", "fingertip, middle of the range of Hajian and Howe (1997)", "",
       [](Thresholds& t) -> double& { return t.hand_stiffness_N_per_m; }, no_published_source},
  };
  return entries;
}

std::string source_of(const ThresholdEntry& entry) {
  const std::string checked =
      entry.read_in.empty() ? "not checked against its source" : fmt::format("read in: {}", entry.read_in);
  return fmt::format("{}; {}; procedure: {}", entry.source, checked, entry.procedure);
}

std::string_view vibration_threshold_source() {
  return "displacement that is just felt on the hand: flat to 40 Hz, -12 dB per octave to 250 Hz (Verrillo 1963; read "
         "in: Gescheider and Verrillo 1979, abstract), 0.1 um at 250 Hz and +12 dB per octave from 300 Hz (Bolanowski, "
         "Gescheider, Verrillo and Checkosky 1988; not checked against its source), times the impedance of a "
         "fingertip, "
         "which relates the two (Hatzfeld and Werthschuetzky 2012; read in: its abstract); good to a factor of 2 to 3 "
         "for a fingertip. A grasped rod is felt better: thresholds are 9.8 dB lower at 40 Hz and 18.5 dB at 300 Hz "
         "than "
         "by a small probe, below 0.01 um for some (Brisben, Hsiao and Johnson 1999; read in: its abstract)";
}

double Thresholds::vibration_displacement_m(double frequency_Hz) {
  constexpr double best_m = 1e-7;
  constexpr double flat_below_Hz = 40.0;
  // 12 dB per octave is the square of the frequency.
  if (frequency_Hz < 250.0) return best_m * std::pow(250.0 / std::max(frequency_Hz, flat_below_Hz), 2);
  if (frequency_Hz > 300.0) return best_m * std::pow(frequency_Hz / 300.0, 2);
  return best_m;
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
    if (!(*value > 0.0) && !(entry.may_be_zero && *value == 0.0))
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
    sources[std::string(entry.name)] = fmt::format("[{}] {}", entry.unit, source_of(entry));
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

double forced_choice_probability(double d_prime) { return stats::normal_cdf(d_prime / std::numbers::sqrt2); }

}  // namespace touchstone::perception
