#include "harness/discrepancy/data_faults.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "harness/base/error.h"
#include "harness/discrepancy/effect_library.h"
#include "harness/discrepancy/friction_cone.h"
#include "harness/discrepancy/model_edit.h"
#include "harness/discrepancy/whitened_regression.h"
#include "harness/recording_checks/block_order.h"

namespace touchstone::discrepancy {
using rendering::Candidate;
using rendering::Model;
using rendering::Prediction;

namespace {

// Of the validation chi-squared that a coefficient of the wrong sign must explain.
constexpr double least_share = 0.3;
constexpr double least_gain = 50.0;

// Of the force to a unit of the candidate's one-sided coefficient.
std::vector<Vec3> response(rendering::Predictor& predictor, const Model& base, const Candidate& candidate,
                           const Prediction& nominal) {
  const rendering::EffectTraits::OneSided& coefficient = *candidate.traits.one_sided;
  const Prediction moved =
      predictor.predict(with_entry(base, candidate.side, {candidate.name, coefficient.small, "/test"}));
  std::vector<Vec3> series(nominal.f_W_N.size());
  for (std::size_t i = 0; i < series.size(); ++i) {
    series[i] = (moved.f_W_N[i] - nominal.f_W_N[i]) / coefficient.size;
  }
  return series;
}

// The whitened squares that a model leaves on the smoothed trajectory.
double left_by_model(const DetectorSide& side, const FitData& blocks, const Model& model) {
  const Prediction prediction = side.noise->likely_predictor().predict(model);
  std::vector<Vec3> left(prediction.f_W_N.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = side.recording->f_W_N[i] - prediction.f_W_N[i];
  return whiten_for_regression(blocks, left, {}).residual.squaredNorm();
}

// The blocks with the noise that there is if the coefficient acts with this size, whatever its sign: where a tip rests,
// friction points to where the tracker's noise has it, and no coefficient can explain what it does there.
FitData blocks_under(const DetectorSide& side, const Model& base, const Candidate& candidate, double coefficient) {
  const rendering::EffectTraits::OneSided& one_sided = *candidate.traits.one_sided;
  std::map<std::string, double> sized = one_sided.small;
  for (auto& [name, value] : sized) value *= std::abs(coefficient) / one_sided.size;
  const Model acting = with_entry(base, candidate.side, {candidate.name, sized, "/test"});
  FitData blocks = *side.blocks;
  blocks.noise = side.noise->of(acting, blocks.predictor->predict(acting), blocks.blocks);
  return blocks;
}

// Along which the modelled force varies most. Along it, unlike in size, a weight that the model does not know adds a
// constant and turns no sign.
Vec3 widest_axis(const FitData& data, const std::vector<Vec3>& f_W_N) {
  Vec3 sum = Vec3::Zero();
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  double count = 0.0;
  for (const ResidualBlock& block : data.blocks) {
    for (std::size_t i = block.begin; i < block.end; ++i) {
      sum += f_W_N[i];
      products += f_W_N[i] * f_W_N[i].transpose();
      count += 1.0;
    }
  }
  const Vec3 mean = sum / std::max(1.0, count);
  const Eigen::Matrix3d covariance = products / std::max(1.0, count) - mean * mean.transpose();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors().col(2);
}

// A pull of little weight in the error, which rests leave: detected from its direction while the tip slides fast. It
// must be there beside what the search found, too: a bias of the sensor, which the base does not know, pulls along most
// of the strokes that go to its side.
std::optional<std::string> pulls_along_everywhere(const DetectorSide& train, const DetectorSide& holdout,
                                                  const Model& base, const Model& best,
                                                  const std::vector<Candidate>& candidates) {
  // Friction of one coefficient: what a law that falls with speed contains.
  const EffectLibrary library(candidates);
  const auto dry = std::ranges::find_if(candidates, [&](const Candidate& one) {
    return one.traits.one_sided && std::ranges::any_of(candidates, [&](const Candidate& other) {
             return other.traits.velocity_weakening && library.contains(other.name, one.name);
           });
  });
  if (dry == candidates.end()) return std::nullopt;
  const auto pull = [](const DetectorSide& side, const Model& model) {
    return pulls_along(cone_samples(cone_evidence(*side.blocks, *side.noise, model, 0.0), side.recording->f_W_N));
  };
  const auto learnt = pull(train, base);
  if (!learnt || !pull(holdout, base) || !pull(train, best) || !pull(holdout, best)) return std::nullopt;
  return fmt::format(fmt::runtime(dry->traits.one_sided->fault), -*learnt);
}

}  // namespace

std::optional<std::string> find_order_fault(const DetectorSide& side, const Model& model) {
  const Prediction prediction = side.blocks->predictor->predict(model);
  const Vec3 axis_W = widest_axis(*side.blocks, prediction.f_W_N);
  std::vector<double> t_s, measured, modelled;
  for (const ResidualBlock& block : side.blocks->blocks) {
    for (std::size_t i = block.begin; i < block.end; ++i) {
      t_s.push_back(side.recording->motion.t_s[i]);
      measured.push_back(axis_W.dot(side.recording->f_W_N[i]));
      modelled.push_back(axis_W.dot(prediction.f_W_N[i]));
    }
  }
  const auto order = recording_checks::find_wrong_order(t_s, measured, modelled);
  if (!order) return std::nullopt;
  // A force that runs the other way in the file's own order is another fault.
  const auto left = [](double correlation) { return 1.0 - correlation * correlation; };
  if (!(left(order->reordered) < 0.5 * left(order->correlation))) return std::nullopt;
  return fmt::format(
      "the force does not follow the position: the measured and the modelled load have a correlation of {:.2f}, but of "
      "{:.2f} {}. Were pieces of the log joined in a wrong order?",
      order->correlation, order->reordered, order->remedy());
}

std::optional<std::string> find_coefficient_fault(const DetectorSide& train, const DetectorSide& holdout,
                                                  const Model& base, const Model& best,
                                                  const std::vector<Candidate>& candidates) {
  // Coefficients are sought on the smoothed trajectory: where the tip rests, friction at noisy positions turns with the
  // noise, and a rate is mostly noise.
  const Prediction train_likely = train.noise->likely_predictor().predict(base);
  const Prediction holdout_likely = holdout.noise->likely_predictor().predict(base);
  for (const Candidate& test : candidates) {
    if (!test.traits.one_sided) continue;
    try {
      // The stiffness may take up a part of it, and a bias of the sensor a part of a weight.
      const auto series = [&](const DetectorSide& side, const Prediction& nominal) {
        std::vector<std::vector<Vec3>> columns{response(side.noise->likely_predictor(), base, test, nominal),
                                               nominal.f_W_N};
        for (int axis = 0; axis < 3 && test.side == rendering::Side::instrument; ++axis) {
          const auto& q = side.recording->motion.q_WS;
          std::vector<Vec3> constant(nominal.f_W_N.size(), Vec3::Unit(axis));
          for (std::size_t i = 0; i < q.size(); ++i) constant[i] = q[i] * Vec3::Unit(axis);
          columns.push_back(std::move(constant));
        }
        return columns;
      };
      const auto regression = [&](const DetectorSide& side, const FitData& blocks, const Prediction& nominal) {
        std::vector<Vec3> left(nominal.f_W_N.size());
        for (std::size_t i = 0; i < left.size(); ++i) left[i] = side.recording->f_W_N[i] - nominal.f_W_N[i];
        return whiten_for_regression(blocks, left, series(side, nominal));
      };
      const Eigen::VectorXd first = ridge_coefficients(regression(train, *train.blocks, train_likely), 1e-9);
      if (!(first[0] < 0.0)) continue;
      const FitData judged = blocks_under(holdout, base, test, first[0]);
      const RegressionData learn = regression(train, blocks_under(train, base, test, first[0]), train_likely);
      const RegressionData judge = regression(holdout, judged, holdout_likely);
      const Eigen::VectorXd with = ridge_coefficients(learn, 1e-9);
      if (!(with[0] < 0.0)) continue;
      RegressionData learn_without = learn;
      learn_without.responses.col(0).setZero();
      const Eigen::VectorXd without = ridge_coefficients(learn_without, 1e-9);
      const double train_gain = left_by(learn_without, without) - left_by(learn, with);
      const double bare = left_by(judge, without);
      const double gain = bare - left_by(judge, with);
      // What the search found explains it better, or it explains little: no fault of the data.
      const bool clear = train_gain >= least_gain && gain >= std::max(least_gain, least_share * bare);
      if (!clear || !(bare - gain <= left_by_model(holdout, judged, best))) continue;
      return fmt::format(fmt::runtime(test.traits.one_sided->fault), with[0]);
    } catch (const BadData&) {
      continue;  // a base renderer that cannot run the effect
    }
  }
  return pulls_along_everywhere(train, holdout, base, best, candidates);
}

}  // namespace touchstone::discrepancy
