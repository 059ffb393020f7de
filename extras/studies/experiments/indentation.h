// The perceptual evaluation on a real indentation (atomic force microscopy): do two interleaved records of one approach
// lie nearer to each other than to what renderers make of it, and is the renderer with the right effect the nearest?
// The right effect is the power law of the depth: 1.5 for a ball (Hertz 1881), 2 for a cone (Sneddon 1965), and not 1.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "harness/perception/perceptual_evaluation.h"

namespace touchstone::experiments {

// The approach of a force-distance curve, towards the sample.
struct Approach {
  std::string source;
  double rate_Hz = 0.0;
  double cantilever_N_per_m = 0.0;
  std::vector<double> force_N;  // free of contact: about 0
  std::vector<double> depth_m;  // of the tip below the point of contact, negative before
  std::size_t contact = 0;      // first sample whose force, and every later one's, is above three times the noise
  double noise_N = 0.0;         // standard deviation in the first fifth, which is free
};

// Reads the text format of afmformats ("export to .tab"): a JSON header in comments, then force [N], measured height
// [m], piezo height [m], segment (False: approach), time [s]. The tip is at height + force / cantilever. Throws
// BadData.
Approach read_approach(const std::filesystem::path& file);

// F = c d^exponent, fitted by least squares to every `of`-th sample from `phase` on.
struct PowerLaw {
  double exponent;
  double coefficient;  // N/m^exponent
  [[nodiscard]] double force_N(double depth_m) const;
};
PowerLaw fit_power_law(const Approach& approach, double exponent, std::size_t phase, std::size_t of);
// The exponent fitted too, between 0.5 and 4 (golden section on the sum of squares).
PowerLaw fit_power_law(const Approach& approach, std::size_t phase, std::size_t of);

struct IndentationComparison {
  std::size_t real = 0;  // which of the interleaved records
  std::size_t other = 0;
  double fitted_exponent = 0.0;
  // Real: one record. Conditions: the other as measured, then rendered at the other's depths by laws fitted to the real
  // one: exponent 1, 1.5, 2, and the fitted one.
  perception::PerceptualEvaluation evaluation;
};
inline constexpr std::size_t interleaved = 4;
inline constexpr std::size_t indentation_conditions = 5;

// Every ordered pair of the interleaved records (sample n belongs to record n mod interleaved). Shown as a haptic
// interface would: 1 nN as 1 N and 1 um as 1 mm.
std::vector<IndentationComparison> compare_indentation(const Approach& approach);

}  // namespace touchstone::experiments
