// Differences planted in terms of published experiments: the process, the change in units of the difference that the
// experiment found just noticeable, and the d' that follows from its criterion. None of it reads the judge's
// thresholds, so that the judge (its thresholds, channels and combination) can be wrong here.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "experiments/planted_cases.h"

namespace touchstone::experiments {

// What an experiment on people found.
struct PublishedExperiment {
  std::string_view name;
  std::string_view found;      // the just noticeable difference, in the words of its abstract
  std::string_view source;     // whose abstract was read
  std::string_view procedure;  // in the words of its abstract, and what it leaves open
  double criterion_d = 1.0;    // d' at that difference, from the procedure; 1 where the text does not say
  PlantedCase real;            // what the difference was found on
  // That process, changed by `times` just noticeable differences.
  PlantedCase (*changed)(const PlantedCase& real, double times);
  // What its procedure lets people use that a free hand does not have; null: nothing.
  void (*setting)(perception::Thresholds&) = nullptr;
};
const std::vector<PublishedExperiment>& published_experiments();

struct PublishedCase {
  std::size_t experiment = 0;  // in published_experiments()
  double times = 0.0;          // just noticeable differences planted; 0: a repeat
  PlantedCase rendered;
  double d_prime = 0.0;
};
// Every experiment at 0, 1/4, 1 and 3 just noticeable differences.
std::vector<PublishedCase> published_cases();

}  // namespace touchstone::experiments
