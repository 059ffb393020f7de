// Force and displacement changing features (eq 13, 14): the slope from one kept sample of the dead band to the next,
// F_v = (F(n+1) - F(n)) / dT with dT the time between them.
#pragma once

#include <vector>

#include "harness/perception/filters/dead_band.h"

namespace touchstone::perception {

// One value per sample, constant from a kept sample to the next, in the series's unit per second; 0 after the last kept
// sample, where nothing more is felt to change.
std::vector<double> change_rate(const SparseSeries& series, double rate_Hz);

}  // namespace touchstone::perception
