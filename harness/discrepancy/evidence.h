// What a search judges by: recordings, or parts of them, seen through predictors, and their blocks as a fit takes them.
#pragma once

#include <utility>
#include <vector>

#include "harness/discrepancy/joint_fit.h"
#include "harness/discrepancy/noise_model.h"
#include "harness/rendering/predictor.h"

namespace touchstone::discrepancy {

// Alternating blocks of time, or everything.
struct Alternating {
  double block_s = 0.0;  // 0: everything
  bool odd = false;
  [[nodiscard]] bool contains(double t_s, double first_t_s) const {
    if (block_s <= 0.0) return true;
    const auto number = static_cast<long long>((t_s - first_t_s) / block_s);
    return (number % 2 == 1) == odd;
  }
};

// Part of a recording: alternating blocks, and within them alternating shorter ones.
struct Part {
  Alternating blocks;
  Alternating within;
  [[nodiscard]] bool contains(double t_s, double first_t_s) const {
    return blocks.contains(t_s, first_t_s) && within.contains(t_s, first_t_s);
  }
};

// A recording, or a part of it, seen through a predictor. What is pointed to must outlive it.
struct Evidence {
  const recording::Recording* recording = nullptr;
  rendering::Predictor* predictor = nullptr;
  NoiseModel* noise = nullptr;
  Part part;
};

// Three parts: train, validation, test (Hastie, Tibshirani and Friedman 2009, section 7.2). Candidates are fitted to
// `train` and compared on `validation`, which are alternating blocks of one recording. The values that are written, and
// their intervals, come from both together, `learning`. `holdout` is opened after that: it judges the answer and
// changes no name, value or interval.
struct SearchData {
  Evidence train;
  Evidence validation;
  Evidence learning;
  Evidence holdout;
  double window_s = 0.0;       // of the blocks
  double force_floor_N = 0.0;  // a measured force above it is contact
  double position_noise_m = 0.0;
  double geometry_error_m = 0.0;  // declared: the mesh is off by at most this
};

// `learning` divided into blocks to train on and blocks to validate on.
SearchData divide(const Evidence& learning, const Evidence& holdout, double window_s);

// The samples of the part: positions, orientations and forces. Across the blocks that are left out neighbours are
// further apart in time.
recording::Recording samples_of(const Part& part, const recording::Recording& recording);
// What is predicted at them. `motion`: of the whole recording.
rendering::Prediction samples_of(const Part& part, const MotionColumns& motion,
                                 const rendering::Prediction& prediction);

// Of the 3-D force error, over the samples of the part.
double rms_force_error_N(const Evidence& evidence, const rendering::Prediction& prediction);

// Between two predictions of the evidence's motion, over the samples of the part.
double rms_difference_N(const Evidence& evidence, const rendering::Prediction& a, const rendering::Prediction& b);

// RMS of the 3-D force error that noise leaves on the part's samples where `model` is the truth.
double expected_noise_N(const Evidence& evidence, const rendering::Model& model);

// The blocks that lie wholly in the part, with the noise that the instrument's makers declare if `model` were the
// truth.
FitData fit_data(const Evidence& evidence, const rendering::Model& model, double window_s);

// Each block's noise at least as large as the other's, of the same blocks under another model.
void widen_noise(FitData& data, const FitData& other);

// Sum and standard error of the difference a - b of two models' chi-squared over the blocks. Neighbouring blocks share
// what the model lacks, so that runs of them are summed before their spread is taken.
std::pair<double, double> paired_difference(const std::vector<double>& a, const std::vector<double>& b);

// The same by the trimmed mean over runs and its standard error (Tukey and McLaughlin 1963, Sankhya A 25:331; Yuen
// 1974, Biometrika 61:165), without the best and the worst of about thirty: one run in which noise turns the tip may
// lose what all others gain. That of all runs where these are fewer than eight.
std::pair<double, double> trimmed_difference(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace touchstone::discrepancy
