// The noise of a tracker whose positions were low-passed and interpolated to a higher rate, from their spectrum.
//
// Such noise hardly differs between neighbouring samples, so that differences of the file (estimate_instrument()) see
// next to nothing of it: 0.3 um of 50 um. In the spectrum it is a shelf between two others: the motion, which falls
// steeply from some hertz on, and the floor of what is white at the file's rate (rounding). The median periodogram
// (Welch 1967; the median over segments because taps fill some of them with all frequencies: Allen, Anderson and
// others, FINDCHIRP, Physical Review D 85, 122006, 2012, appendix B) is fitted by least squares of its logarithm
// (Geweke and Porter-Hudak 1983) with
//
//   S(f) = A f^-p exp(-f / f_m)  +  N / (1 + (f / f_h)^(2 m))  +  w      [m^2/Hz, one-sided]
//          motion                   shelf                         floor
//
// with one or two shelves (an interpolation's images are a second one) and with none; the F test says how many are
// there. From 20 s of motion the noise is found within a factor of 1.7 (tests). A tip that trembles or a stand that
// rings between the same frequencies has the same spectrum: the shelf is a suggestion and no measurement of the
// tracker.
#pragma once

#include <optional>

#include "harness/recording/trajectory.h"

namespace touchstone::discrepancy {

struct TrackerNoise {
  double position_noise_m = 0.0;  // of one tracker sample, per axis, before the low-pass: as an instrument declares it
  double position_rate_Hz = 0.0;  // of the tracker that instrument_description.h low-passes at f_h
  double corner_Hz = 0.0;         // f_h, where the shelf has fallen to a half
};

// Nothing if the motion is shorter than ten segments of a second, or if no shelf stands out at a level of 0.001.
std::optional<TrackerNoise> tracker_noise(const MotionColumns& motion);

}  // namespace touchstone::discrepancy
