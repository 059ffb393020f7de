// Rate-hardness over the whole stroke (eq 15, after Lawrence et al. 2000) and extended rate-hardness (eq 5, Han and
// Choi 2010), both from force and displacement of one press.
//
// Eq 15 divides by the change of displacement within the window, which vanishes where the motion turns. Where it is
// smaller than `guard` times its own root mean square over the recording, nothing is divided: the last value before it
// is held (the first one after it at the start), and the share of such samples is reported.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace touchstone::perception {

struct RateHardness {
  std::vector<double> values_N_per_m;  // for n = 0 .. N - window - 1
  std::vector<unsigned char> guarded;  // 1 where the guard held a value
  double guarded_share = 0.0;          // 1: the motion never changed, every value is 0
};

inline constexpr std::size_t default_rate_hardness_window = 10;  // samples; the paper's choice from 5, 10, 20 and 40
inline constexpr double rate_hardness_guard = 0.1;

// Throws BadData for series of unequal length or not longer than the window, UsageError for a window of 0.
RateHardness rate_hardness(std::span<const double> force_N, std::span<const double> displacement_m, std::size_t window,
                           double guard = rate_hardness_guard);

// What a window costs and gives (figure 8).
struct WindowTradeOff {
  std::size_t window;
  double duration_s;
  double resolution_m;   // median change of displacement within the window: detail below this is averaged
  double level_N_per_m;  // median rate-hardness
  double noise_N_per_m;  // robust standard deviation of what a straight line through neighbouring windows leaves
  double guarded_share;
};
std::vector<WindowTradeOff> window_trade_off(std::span<const double> force_N, std::span<const double> displacement_m,
                                             double rate_Hz, std::span<const std::size_t> windows);

// max(dF/dt) / v0 in N/m, v0 the penetration velocity where the force first exceeds `contact_force_N`. Nothing where
// there is no contact, or no approach to speak of: v0 below a thousandth of the highest speed.
std::optional<double> extended_rate_hardness(std::span<const double> force_N,
                                             std::span<const double> force_rate_N_per_s,
                                             std::span<const double> velocity_m_per_s, double contact_force_N);

// Extended rate-hardness of measured data: a straight line through the force of the first 20 ms after contact over one
// through the displacement, contact by contact; median and a 95 % interval over the contacts (Student's t with the
// spread about the median). Raw differences of noisy samples, as eq 5 has them, say nothing: twelve recordings of one
// spring give values that differ by a factor of ten.
struct RateHardnessEstimate {
  double value_N_per_m = 0.0;
  double low95_N_per_m = 0.0;
  double high95_N_per_m = 0.0;
  std::size_t contacts = 0;
};
// Contacts of `force_N` above the absolute threshold after at least 20 ms below it. Nothing for fewer than three
// contacts, or where the interval is wider than the value.
std::optional<RateHardnessEstimate> estimated_rate_hardness(std::span<const double> force_N,
                                                            std::span<const double> displacement_m, double rate_Hz,
                                                            double contact_force_N);

}  // namespace touchstone::perception
