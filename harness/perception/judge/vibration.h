// The fast part of the force: what the smooth response leaves, as power in third-octave bands from 20 to 1000 Hz,
// while in contact, in the air, and within 64 ms after contact begins. Within a band each frequency counts as its
// threshold says: the power is that of an equally noticeable vibration at the band's centre.
//
// Power of the three axes is summed: vibration is felt equally in every direction (Landin, Romano, McMahan and
// Kuchenbecker 2010).
#pragma once

#include <cstddef>
#include <vector>

#include "harness/base/rooms.h"
#include "harness/perception/judge/felt_series.h"
#include "harness/perception/judge/response.h"
#include "harness/perception/judge/thresholds.h"

namespace touchstone::perception {

struct BandPower {
  std::vector<double> power_N2;     // mean square of the force in the band, mean over the segments
  std::vector<double> variance_N4;  // of that mean, from its spread over the segments
  std::size_t segments = 0;         // 0: nothing was seen, the vectors are empty
  double segment_s = 0.0;
};

struct FastForce {
  double nyquist_Hz = 0.0;
  BandPower contact;
  BandPower air;
  // What the tracker's noise brings into the residual in contact, by band: the response's slope times the noise that
  // smoothing leaves in the depth, of a replayed model times the difference of that and the noise of its own path.
  // Nobody feels it.
  std::vector<double> tracker_N2;
  BandPower onset;
  BandPower between;                 // in contact, later, in windows like those of onset
  double onset_speed_m_per_s = 0.0;  // median rate of depth at contact
  std::size_t onsets = 0;
};

// Centres of the bands (IEC 61260 nominal), 20 to 1000 Hz.
const std::vector<double>& band_centres_Hz();

FastForce fast_force(const FeltSeries& felt, const Response& response, const Thresholds& thresholds);

// What a person would tell between two processes by their fast force.
struct VibrationDifference {
  bool known = false;           // both were seen
  double jnd = 0.0;             // d', as far as it exceeds all that noise alone reaches in 95 %
  double measured_jnd = 0.0;    // as measured; by noise alone it is not 0
  double standard_error = 0.0;  // of what is measured
  double frequency_Hz = 0.0;    // centre of the band that differs most
  double real_N = 0.0;          // root mean square in that band
  double rendered_N = 0.0;
  double threshold_N = 0.0;  // of that band, root mean square
  double allowed_N = 0.0;    // this much more than real_N in that band is noticed with d' = 1
};
// Steady vibration in contact. Noise of the sensor is taken out of both, for nobody feels it: what is seen in the air,
// of the other recording where one has no air, else what is declared (`noise_N2_per_Hz`, density of power of all axes).
// A band's power counts in units of that of its threshold. Two cues, of which the stronger counts: the power of all
// bands together (Bensmaia, Hollins and Yau 2005), and how it is spread over them, root of the sum of squares. The
// observer's noise is that of the power of all bands (vibration_scale.h), so that what vibrates already masks.
VibrationDifference vibration_difference(const FastForce& real, const FastForce& rendered, double noise_N2_per_Hz,
                                         const Thresholds& thresholds);
// The burst after contact, at the real process's speed of contact (a transient grows in proportion to it: Okamura,
// Cutkosky and Dennerlein 2001), above the vibration that goes on; the threshold of a short burst is higher by the root
// of the integration time over its duration. Bands from 40 Hz on.
VibrationDifference transient_difference(const FastForce& real, const FastForce& rendered,
                                         const Thresholds& thresholds);

}  // namespace touchstone::perception
