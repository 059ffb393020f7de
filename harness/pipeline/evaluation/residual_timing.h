// Repairs of when a renderer's force comes: nothing where one does not gain enough, or not in both halves.
#pragma once

#include <optional>

#include "harness/pipeline/evaluation/residual_series.h"

namespace touchstone::pipeline {

// As a whole later or earlier, by up to 50 ms.
std::optional<Found> find_lag(const ResidualSeries& r);
// A low-pass filter of first order.
std::optional<Found> find_filter(const ResidualSeries& r);
// Of every so many samples some later than the others: seen of the rendered force alone.
std::optional<Found> find_alternate_lag(const ResidualSeries& r);
// The same for as many samples every time, or without a period, though the tip moves: seen of the rendered force alone.
std::optional<Found> find_hold(const ResidualSeries& r);
// The surface contact point stays for as many samples every time, though the tip slides on: a proxy that is moved at
// some steps only. Friction holds it, too, and follows no period.
std::optional<Found> find_held_contact(const ResidualSeries& r);

}  // namespace touchstone::pipeline
