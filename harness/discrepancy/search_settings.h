// What a search for missing effects asks of an effect before it is named.
#pragma once

#include <chrono>
#include <cstddef>
#include <limits>

namespace touchstone::discrepancy {

struct SearchSettings {
  // Of chi-squared, on the training and on the validation blocks: far beyond what noise gives a handful of parameters.
  double minimum_gain = 30.0;
  double minimum_share = 0.08;  // of the validation mean-square error that must go, and of the validation chi-squared
  // The same while the model leaves more than `clear_noises` times what noise leaves: there no law is so idealized that
  // its details are most of the error.
  double clear_share = 0.03;
  double clear_noises = 3.0;
  double noise_share = 0.5;   // or, in the place of the latter, in square of what noise leaves
  double gain_errors = 1.64;  // the validation gain exceeds this many of its standard errors by runs of blocks
  // or the gains on both kinds of blocks together this many of theirs: 3 over a whole recording
  double both_gain_errors = 2.12;
  double just_noticeable_share = 0.07;  // of the force: what removes more error than a hand can notice matters always
                                        // (Weber fraction of force, Jones 1989)
  double mesh_margin = 1.25;            // a displaced surface must exceed the mesh's declared error by this factor
  double null_deviations = 5.0;         // above what the case's own nulls gain, in their standard deviations
  double worsening = 0.15;              // of the squared error that goes, no regime's may grow by more than this share
  double alike_gain = 0.1;    // two explanations whose validation gains differ by less than this share of the gain, or
  double rival_gain = 0.5;    // a rival with half of the gain may fit equally well once noise is out of the motion
  double alike_errors = 2.5;  // by less than this many standard errors: indistinguishable
  double apart_share = 0.5;   // and so are two whose forces differ by less than this share of what noise leaves
  double likely_share = 0.5;  // of its gain that an effect must have on the smoothed trajectory
  double pair_share = 0.5;    // of the validation squared error beyond noise that two effects tried at once must remove
  double law_gain = 15.0;     // of -2 ln likelihood that a law with more parameters must gain over its special case
  double law_change = 0.14;   // and must change of the latter's force: laws are idealized (the blind test's friction
                              // approaches its limit smoothly), which alone made up to 0.105
  double cone_excess = 0.2;   // by which forces leave the cone of fast sliding, as a share of its coefficient, before
                              // friction is said to fall with speed
  double within_cone = 1.15;  // the widest ratio over a fitted static coefficient: beyond, the fit is not believed
  double read_share = 0.5;    // of what the fit gains on the start, on the validation blocks, that values read in its
                              // place may give back
  // From `begun` to the answer. Infinite: no limit, and so the same answer on every machine.
  double time_limit_s = std::numeric_limits<double>::infinity();
  std::chrono::steady_clock::time_point begun = std::chrono::steady_clock::now();
  double checks_s = 0.0;  // of the limit, what the answer needs at the end (time_budget.h)
  std::size_t most_effects = 6;
  int iterations = 12;
  int field_iterations = 4;
};

}  // namespace touchstone::discrepancy
