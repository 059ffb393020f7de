// Distances between two series of the same moments, the real one first: the statistics that the paper compares with
// (section 4) and those of its section 2.3 that work on series. All throw BadData for series of unequal length or none.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "harness/perception/filters/weber_law.h"

namespace touchstone::perception {

double euclidean_distance(std::span<const double> real, std::span<const double> rendered);
// Nothing where either series is constant: correlation is then undefined, not 0.
std::optional<double> pearson_correlation(std::span<const double> real, std::span<const double> rendered);
double mean_square_error(std::span<const double> real, std::span<const double> rendered);
double maximum_absolute_error(std::span<const double> real, std::span<const double> rendered);
// Largest magnitude of the rendered series less that of the real one.
double peak_difference(std::span<const double> real, std::span<const double> rendered);

// Eq 9 (Chaudhari, Steinbach and Hirche 2011): mean square error of what is felt. Im is the stimulus on the scale of
// just noticeable differences (WeberLaw::steps), so that the unit is JND squared.
std::vector<double> noticeable_steps(std::span<const double> stimulus, const WeberLaw& law);
double perceptual_mean_square_error(std::span<const double> real, std::span<const double> rendered,
                                    const WeberLaw& law);

}  // namespace touchstone::perception
