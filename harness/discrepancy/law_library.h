// The terms of which a law for an unknown effect is made: what a residual may follow of the things that a recording
// holds, each as an effect that a user might have declared (harness/rendering/declared_effect.h), so that whatever is
// found runs everywhere. A term is linear in some of its parameters and has a handful of starts for the others, as in
// the libraries of sparse regression for equations of motion (Brunton, Proctor and Kutz 2016, PNAS 113:3932); states
// are Dahl's bristle (Dahl 1968) and the first-order rise. Nothing here is physics: a term says what the force follows.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "harness/discrepancy/residual_views.h"
#include "harness/rendering/declared_effect.h"

namespace touchstone::discrepancy {

// What a term follows: where and when the unknown effect acts.
enum class Carrier : std::uint8_t { time, place, depth, speed, load, surface, past };
// "time", "place", ...
std::string to_string(Carrier carrier);

struct LawTerm {
  rendering::DeclaredEffect effect;  // parameters at their scales
  std::vector<std::string> linear;   // parameters that the force is proportional to
  std::vector<std::map<std::string, double>>
      constants;  // starts of the others; at least one, empty where there are none
  std::vector<Carrier> carriers;
};

// What an existing wave is looked for with: peaks of the residual's spectrum over time and over place.
struct WavePeaks {
  std::vector<double> frequency_Hz;
  std::vector<Vec3> wave_per_m;  // waves per metre along the object's axes
};

// Every term, at the scales of the recording. Names start with "empirical-".
std::vector<LawTerm> law_terms(const ViewScales& scales, const WavePeaks& waves);

}  // namespace touchstone::discrepancy
