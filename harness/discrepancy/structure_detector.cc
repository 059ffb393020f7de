#include "harness/discrepancy/structure_detector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "harness/discrepancy/model_edit.h"
#include "harness/discrepancy/residual_views.h"
#include "harness/discrepancy/whitened_regression.h"

namespace touchstone::discrepancy {
using rendering::Model;
using rendering::Prediction;

namespace {

constexpr double ridge = 3e-3;
// A share of chi-squared below this is not worth a finding, whatever its significance.
constexpr double least_share = 0.1;
constexpr double least_deviations = 5.0;
constexpr std::size_t worlds = NoiseModel::null_simulations;

std::vector<Vec3> difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  std::vector<Vec3> out(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) out[i] = a[i] - b[i];
  return out;
}

Eigen::VectorXd whitened_residual(const DetectorSide& side, const std::vector<Vec3>& measured,
                                  const std::vector<Vec3>& predicted) {
  return whiten_for_regression(*side.blocks, difference(measured, predicted), {}).residual;
}

struct ViewResponses {
  std::string name;
  Eigen::MatrixXd whitened;
};

// The views' responses on both sides, at the recorded positions or on the smoothed trajectory.
struct Responses {
  std::vector<ViewResponses> learn;
  std::vector<ViewResponses> judge;
  std::vector<RidgeRegression> regressions;  // of `learn`

  Responses(std::vector<ViewResponses> learnt, std::vector<ViewResponses> judged)
      : learn(std::move(learnt)), judge(std::move(judged)) {
    for (const ViewResponses& view : learn) regressions.emplace_back(view.whitened, ridge);
  }
  Responses(const Responses&) = delete;
  Responses& operator=(const Responses&) = delete;

  // Of chi-squared on the held-out side, by what the view learns on the other.
  [[nodiscard]] double gain(std::size_t view, const Eigen::VectorXd& left, const Eigen::VectorXd& held_out) const {
    const Eigen::VectorXd predicted = judge[view].whitened * regressions[view].coefficients(left);
    return held_out.squaredNorm() - (held_out - predicted).squaredNorm();
  }
};

std::vector<ViewResponses> responses_of(const DetectorSide& side, const MotionColumns& motion,
                                        const Prediction& prediction, const ViewScales& scales) {
  std::vector<ViewResponses> responses;
  for (ResidualView& view : residual_views(motion, prediction, scales, side.blocks->blocks)) {
    responses.push_back({std::move(view.name), whiten_responses(*side.blocks, view.means)});
  }
  return responses;
}

// Whitened residuals of both sides.
struct Left {
  Eigen::VectorXd train;
  Eigen::VectorXd holdout;
};

struct Moments {
  double mean = 0.0;
  double deviation = 0.0;
};

// Of all values but one; with `without` beyond the end, of all.
Moments moments(const std::array<double, worlds>& values, std::size_t without) {
  double count = 0.0;
  Moments of;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i == without) continue;
    of.mean += values[i];
    count += 1.0;
  }
  of.mean /= count;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i != without) of.deviation += (values[i] - of.mean) * (values[i] - of.mean) / (count - 1.0);
  }
  of.deviation = std::sqrt(of.deviation);
  return of;
}

}  // namespace

Structure detect_structure(const DetectorSide& train, const DetectorSide& holdout, const Model& model,
                           const std::vector<NullFit>& refits) {
  rendering::Predictor& train_predictor = *train.blocks->predictor;
  rendering::Predictor& holdout_predictor = *holdout.blocks->predictor;
  const Prediction train_nominal = train_predictor.predict(model);
  const Prediction holdout_nominal = holdout_predictor.predict(model);
  const ViewScales scales = measure_view_scales(train.recording->motion, train_nominal);
  const Responses recorded(responses_of(train, train.recording->motion, train_nominal, scales),
                           responses_of(holdout, holdout.recording->motion, holdout_nominal, scales));

  // What predicts the residual at noisy positions alone predicts the noise.
  const Prediction train_likely = train.noise->likely_predictor().predict(model);
  const Prediction holdout_likely = holdout.noise->likely_predictor().predict(model);
  const Responses likely(responses_of(train, train.noise->smoothed_motion(), train_likely, scales),
                         responses_of(holdout, holdout.noise->smoothed_motion(), holdout_likely, scales));

  const Eigen::VectorXd left = whitened_residual(train, train.recording->f_W_N, train_nominal.f_W_N);
  const Eigen::VectorXd held_out = whitened_residual(holdout, holdout.recording->f_W_N, holdout_nominal.f_W_N);
  std::vector<Left> smoothed_comparison{{whitened_residual(train, train.recording->f_W_N, train_likely.f_W_N),
                                         whitened_residual(holdout, holdout.recording->f_W_N, holdout_likely.f_W_N)}};
  // Nor is it structure that friction turns late over a path that the noise has made too long.
  for (const Model& shorter : with_shorter_paths(model)) {
    smoothed_comparison.push_back(
        {whitened_residual(train, train.recording->f_W_N, train.noise->likely_predictor().predict(shorter).f_W_N),
         whitened_residual(holdout, holdout.recording->f_W_N,
                           holdout.noise->likely_predictor().predict(shorter).f_W_N)});
  }

  std::array<const Model*, worlds> fitted{};
  fitted.fill(&model);
  for (const NullFit& refit : refits) fitted.at(refit.world) = &refit.model;
  std::vector<std::array<double, worlds>> null_shares(recorded.learn.size());
  for (std::size_t world = 0; world < worlds; ++world) {
    const Eigen::VectorXd null_left = whitened_residual(train, train.noise->null_forces(model, train_nominal, world),
                                                        train_predictor.predict(*fitted.at(world)).f_W_N);
    const Eigen::VectorXd null_held_out =
        whitened_residual(holdout, holdout.noise->null_forces(model, holdout_nominal, world),
                          holdout_predictor.predict(*fitted.at(world)).f_W_N);
    const double square = std::max(null_held_out.squaredNorm(), std::numeric_limits<double>::min());
    for (std::size_t v = 0; v < null_shares.size(); ++v) {
      null_shares[v].at(world) = recorded.gain(v, null_left, null_held_out) / square;
    }
  }
  double deviations = least_deviations;
  for (const auto& shares : null_shares) {
    for (std::size_t world = 0; world < worlds; ++world) {
      const Moments others = moments(shares, world);
      if (others.deviation > 0.0) {
        deviations = std::max(deviations, (shares.at(world) - others.mean) / others.deviation);
      }
    }
  }

  Structure most;
  double exceeds = -std::numeric_limits<double>::infinity();
  const double before = held_out.squaredNorm();
  for (std::size_t v = 0; v < recorded.learn.size() && before > 0.0; ++v) {
    Structure structure;
    structure.view = recorded.learn[v].name;
    structure.gain = recorded.gain(v, left, held_out);
    for (const Left& here : smoothed_comparison) {
      structure.gain = std::min(structure.gain, likely.gain(v, here.train, here.holdout));
    }
    structure.share = structure.gain / before;
    const Moments null = moments(null_shares[v], worlds);
    structure.bar = least_share + std::max(0.0, null.mean) + deviations * null.deviation;
    if (structure.share - structure.bar <= exceeds) continue;
    exceeds = structure.share - structure.bar;
    most = structure;
  }
  return most;
}

}  // namespace touchstone::discrepancy
