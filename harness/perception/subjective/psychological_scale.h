// From paired comparisons to a psychological scale, larger being more like the real process.
//
// Thurstone's law of comparative judgment, case V (Thurstone 1927; least squares and test of Mosteller 1951), and the
// Bradley-Terry model (1952) with a term for the order of presentation (Davidson and Beaver 1977):
//   logit P(first chosen) = b_first - b_second + g.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "harness/perception/subjective/paired_comparisons.h"

namespace touchstone::perception {

enum class ScaleModel { thurstone_case_v, bradley_terry };
std::string_view name_of(ScaleModel model);

struct PsychologicalScale {
  ScaleModel model = ScaleModel::bradley_terry;
  std::vector<double> value;           // per condition, mean 0
  std::vector<double> standard_error;  // by leaving out one subject at a time; empty where that leaves too little
  double order_effect = 0.0;           // g, in the scale's unit: > 0 favours what came first (0 in Thurstone's model)
  double order_effect_error = 0.0;     // by the jackknife; 0 where it is not estimated
  double misfit = 0.0;                 // chi-squared
  double degrees_of_freedom = 0.0;
  double misfit_p = 1.0;  // small: the model does not describe the answers
  std::string remark;     // fallbacks that were taken
};

// Proportions of 0 and 1 have no normal deviate; every proportion is taken as (wins + 1/2) / (n + 1), as the remark
// says where it mattered. Every pair must have been compared: throws BadData naming one that was not.
PsychologicalScale thurstone_case_v(const PairedComparisons& comparisons);

// Maximum likelihood by Newton's method. Where no finite maximum exists (a condition or group that always won: Ford
// 1957), Firth's (1993) reduction of bias gives finite values, and the remark says so. Throws BadData when the
// conditions fall into groups that were never compared.
PsychologicalScale bradley_terry(const PairedComparisons& comparisons);

// The chance that the model gives a condition to be chosen over another which lies `difference` lower, order balanced.
double expected_preference(const PsychologicalScale& scale, double difference);
// The fraction that the model expects a condition of scale value `v` to be preferred against all others but itself,
// order balanced: the curve of figure 12.
double expected_fraction(const PsychologicalScale& scale, double v);
double expected_fraction_of(const PsychologicalScale& scale, std::size_t condition);

}  // namespace touchstone::perception
