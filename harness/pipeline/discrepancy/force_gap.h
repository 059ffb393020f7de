// The held-out error of force before and after a search, beside what noise leaves of it.
//
// The search sees means over a few samples (thinning.h), the error is that of the single samples. A model that follows
// the rate of the motion (a damper) passes the tracker's noise on the more, the shorter the step that it is divided by:
// of white noise the rate over n samples has 1 / n of the deviation. So at single samples the true model can leave more
// than one that lacks the damper. Where the error of single samples rises, by no more than what simulated noise makes
// of the model there, while that of the means falls, the means are what is told.
#pragma once

#include "harness/discrepancy/evidence.h"
#include "harness/discrepancy/findings.h"

namespace touchstone::pipeline {

struct HeldOutSamples {
  discrepancy::Evidence samples;        // at the sensor's own rate
  std::size_t count = 1;                // of them in each of the means that the search saw
  double square_beyond_means_N2 = 0.0;  // by the sensor's noise alone (thinning.h)
};

struct MeasuredGap {
  discrepancy::ForceGap gap;
  discrepancy::Evidence on;  // the means or the samples that it tells of
};

// `search.spectrum` is that of the single samples, `search.noise_rms_N` what noise leaves of the means.
MeasuredGap measure_gap(const discrepancy::SearchResult& search, const discrepancy::SearchData& data,
                        const HeldOutSamples& held_out);

// What `prediction` leaves of the measured force, RMS over the held-out samples in which a fingertip would feel one of
// the two, in just noticeable differences of the measured force (perception/filters/weber_law.h). NaN where nothing is
// felt.
double left_in_jnd(const discrepancy::Evidence& held_out, const rendering::Prediction& prediction);

}  // namespace touchstone::pipeline
