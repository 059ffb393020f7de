#include "experiments/published_cases.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "harness/perception/judge/thresholds.h"

namespace touchstone::experiments {
namespace {

// A staircase of three down and one up ends where 0.5^(1/3) = 79.4 % are right: d' = sqrt(2) * 0.8193.
constexpr double three_down_one_up_d = 1.159;

constexpr std::string_view one_interval = "one interval, with feedback; d' = 1 is assumed";
constexpr std::string_view not_stated = "not stated; d' = 1 is assumed";

// Weber's law: each just noticeable difference multiplies.
double weaker(double fraction, double times) { return 1.0 - std::pow(1.0 + fraction, -times); }
double stronger(double fraction, double times) { return std::pow(1.0 + fraction, times); }

PlantedCase plain() { return {}; }
PlantedCase constant() {
  PlantedCase real;
  real.plateau_N = 5.0;
  return real;
}
PlantedCase rough() {
  PlantedCase real;
  real.friction = 0.5;
  return real;
}
PlantedCase buzzing() {
  PlantedCase real;
  real.buzz_Hz = 125.0;
  // 10 dB above threshold. The level alone comes from the judge's curve; the difference to be felt does not.
  real.buzz_N = std::sqrt(10.0) * perception::Thresholds{}.vibration_force_N(125.0);
  return real;
}

}  // namespace

const std::vector<PublishedExperiment>& published_experiments() {
  static const std::vector<PublishedExperiment> experiments{
      {"force", "7 % of a constant force between 2.5 and 10 N", "Pang, Tan and Durlach (1991)", one_interval, 1.0,
       constant(),
       [](const PlantedCase& real, double times) {
         PlantedCase c = real;
         c.softer = weaker(0.07, times);
         return c;
       }},
      {"compliance, equal depth", "8 % if force and work could be felt",
       "Tan, Pang and Durlach (1992), as quoted in 'Manual "
       "resolution of compliance when work and force cues are minimized'",
       not_stated, 1.0, plain(),
       [](const PlantedCase& real, double times) {
         PlantedCase c = real;
         c.softer = weaker(0.08, times);
         return c;
       },
       // The hand was led to the same depth, so that forces could be compared.
       [](perception::Thresholds& t) { t.depth_fraction = 0.0; }},
      {"compliance, any depth", "22 % if the depth is varied so that force and work say nothing",
       "Tan, Durlach, Beauregard and Srinivasan (1995)", not_stated, 1.0, plain(),
       [](const PlantedCase& real, double times) {
         PlantedCase c = real;
         c.softer = weaker(0.22, times);
         c.deeper = 1.3;
         return c;
       }},
      {"direction of force", "25.6 degrees by touch alone", "Barbagli, Salisbury, Ho, Spence and Tan (2006)",
       not_stated, 1.0, plain(),
       [](const PlantedCase& real, double times) {
         PlantedCase c = real;
         c.tilt_rad = times * 25.6 / 180.0 * std::numbers::pi;
         return c;
       }},
      {"friction", "relative differences of 0.2", "Fehlberg, Kim, Drewing, Hensel and Bennewitz (2022)",
       "forced choice; the share right is not stated", 1.0, rough(),
       [](const PlantedCase& real, double times) {
         PlantedCase c = real;
         c.friction *= stronger(0.2, times);
         return c;
       }},
      {"strength of vibration", "0.20 at 125 Hz, 10 dB above threshold", "Forta, Griffin and Morioka (2012)",
       "three down and one up: 79 % right", three_down_one_up_d, buzzing(),
       [](const PlantedCase& real, double times) {
         PlantedCase c = real;
         c.buzz_N *= stronger(0.20, times);
         return c;
       }},
      {"delay of a spring", "36 ms of delay in a spring, moved to and fro", "Rank, Shi, Mueller and Hirche (2010)",
       not_stated, 1.0, plain(),
       [](const PlantedCase& real, double times) {
         PlantedCase c = real;
         c.delay_s = times * 0.036;
         return c;
       }},
      {"place of the surface", "0.4 mm, thickness of a plate between finger and thumb", "Ho and Srinivasan (1996)",
       "two intervals, two alternatives; the share right is not stated", 1.0, plain(),
       [](const PlantedCase& real, double times) {
         PlantedCase c = real;
         c.late_m = times * 4e-4;
         return c;
       },
       // What counts there is the distance of finger and thumb, not where the hand is.
       [](perception::Thresholds& t) { t.position_m = 4e-4; }},
  };
  return experiments;
}

std::vector<PublishedCase> published_cases() {
  std::vector<PublishedCase> cases;
  const auto& experiments = published_experiments();
  for (std::size_t e = 0; e < experiments.size(); ++e) {
    for (const double times : {0.0, 0.25, 1.0, 3.0}) {
      PublishedCase own{e, times, experiments[e].changed(experiments[e].real, times),
                        times * experiments[e].criterion_d};
      own.rendered.family = times == 0.0 ? "repeat" : std::string(experiments[e].name);
      own.rendered.name = times == 0.0 ? fmt::format("{}: repeat", experiments[e].name)
                                       : fmt::format("{}: {:.2g} of the difference", experiments[e].name, times);
      cases.push_back(std::move(own));
    }
  }
  return cases;
}

}  // namespace touchstone::experiments
