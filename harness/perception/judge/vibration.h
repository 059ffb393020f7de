// The fast part of the force: what the smooth response leaves, as power in third-octave bands from 20 to 1000 Hz,
// while in contact, in the air, and within 64 ms after contact begins. Within a band each frequency counts as its
// threshold says: the power is that of an equally noticeable vibration at the band's centre.
//
// Power of the three axes is summed: vibration is felt equally in every direction (Landin, Romano, McMahan and
// Kuchenbecker 2010).
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "harness/perception/judge/felt_series.h"
#include "harness/perception/judge/response.h"
#include "harness/perception/judge/thresholds.h"

namespace touchstone::perception {

// Third-octave band from c / 2^(1/6) to c 2^(1/6).
inline const double half_band_ratio = std::exp2(1.0 / 6.0);
inline constexpr double onset_s = 0.064;

struct BandPower {
  std::vector<double> power_N2;     // mean square of the force in the band, mean over the segments
  std::vector<double> variance_N4;  // of that mean, from its spread over the segments
  std::vector<double> octaves;      // from the band's centre to where its power lies on average
  // Of that mean, if it were Gaussian noise: variance over the square, by how many bins, axes and segments it has.
  std::vector<double> gaussian_share;
  std::vector<std::vector<double>> windows_N2;       // by segment and band
  std::vector<std::vector<double>> windows_octaves;  // power times its octaves from the band's centre, likewise
  std::vector<double> since_contact_s;               // by segment, when it begins; infinite where no air was before
  std::vector<double> slide_m_per_s;                 // mean over each segment
  std::vector<double> load_N;
  std::size_t segments = 0;  // 0: nothing was seen, the vectors are empty
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

// What a frequency's power counts as at the centre of its band.
double band_weight(double f_Hz, double centre_Hz, const Thresholds& thresholds);

FastForce fast_force(const FeltSeries& felt, const Response& response, const Thresholds& thresholds);

// Two vibrations of about one strength and their frequencies.
struct VibrationPitch {
  double real_Hz = 0.0;
  double real_N = 0.0;  // root mean square
  double rendered_Hz = 0.0;
  double rendered_N = 0.0;
};

// What a person would tell between two processes by their fast force.
struct VibrationDifference {
  bool known = false;   // both were seen
  bool in_air = false;  // what differs most is felt in free air
  double jnd = 0.0;  // d' without what noise adds on average; 0 unless it exceeds all that noise alone reaches in 95 %
  double measured_jnd = 0.0;    // as measured; by noise alone it is not 0
  double standard_error = 0.0;  // of what is measured
  double frequency_Hz = 0.0;    // centre of the band that differs most
  double real_N = 0.0;          // root mean square in that band
  double rendered_N = 0.0;
  bool by_hand = false;     // most of the error is that of the speeds of contact
  bool by_sliding = false;  // the two hardly slid at one speed under one load
  // Where the strongest band of each has its power, if what differs is how the power is spread; else nothing.
  std::optional<VibrationPitch> pitch;
  double threshold_N = 0.0;  // of that band, root mean square
  double allowed_N = 0.0;    // this much more than real_N in that band is noticed with d' = 1
};
// Steady vibration, in contact and in free air, of which the stronger counts. Noise of the sensor is taken out of both,
// for nobody feels it: what is seen in the air as far as it is even over neighbouring bands (a tone is no noise), of
// the other recording where one has no air, else what is declared (`noise_N2_per_Hz`, density of power of all axes). No
// power is below nothing. A band's power counts in units of that of its threshold. Two cues, of which the stronger
// counts: the power of all bands together (Bensmaia, Hollins and Yau 2005), and how it is spread over frequency, as the
// distance of the two spectra after the observer's own blur (VibrationScale::likeness), which has no edges: a band's
// power counts where in the band it lies. The observer's noise is that of the power of all bands (vibration_scale.h),
// so that what vibrates already masks.
//
// What rings after contact and dies away goes with the hand: its power grows with the square of the speed of contact
// (as the burst below), and is the larger a part of the contact the shorter that is. It is compared as at the real
// process's speed and time of contact, as far as its growth is known (growth.h): it takes contacts at like speeds to
// tell.
//
// What a sliding tip meets is compared where both slid alike (like_windows.h). Where they did not, all that differs may
// be the hand's.
//
// What noise alone reaches: the error of each power is the larger of its spread over the windows and that of Gaussian
// noise of the mean power of both recordings before any correction; from few windows it is itself uncertain (Welch
// 1947, Satterthwaite 1946), and the looks at one pair share 5 %.
VibrationDifference vibration_difference(const FastForce& real, const FastForce& rendered, double noise_N2_per_Hz,
                                         const Thresholds& thresholds);
// The burst after contact, at the real process's speed of contact (a transient grows in proportion to it: Okamura,
// Cutkosky and Dennerlein 2001; the error is as above), above the vibration that goes on; the threshold of a short
// burst is higher by the root of the integration time over its duration. Bands from 40 Hz on.
VibrationDifference transient_difference(const FastForce& real, const FastForce& rendered,
                                         const Thresholds& thresholds);

}  // namespace touchstone::perception
