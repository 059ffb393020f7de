#include "harness/discrepancy/law_regression.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "harness/base/error.h"
#include "harness/base/in_parallel.h"
#include "harness/base/least_squares.h"
#include "harness/discrepancy/model_edit.h"
#include "harness/discrepancy/null_gains.h"
#include "harness/discrepancy/whitened_regression.h"

namespace touchstone::discrepancy {
using rendering::Model;
using rendering::Side;

namespace {

constexpr double ridge = 1e-8;

std::vector<Vec3> difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b, double over) {
  std::vector<Vec3> out(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) out[i] = (a[i] - b[i]) / over;
  return out;
}

// Least squares on one side, seen by its squares and products alone.
struct Squares {
  Eigen::MatrixXd responses;  // X' X
  Eigen::MatrixXd products;   // X' r, a column for the recording and one for every null world
  Eigen::VectorXd residual;   // r' r of each

  [[nodiscard]] double left(const Eigen::VectorXd& beta, Eigen::Index world) const {
    return residual[world] - 2.0 * beta.dot(products.col(world)) + beta.dot(responses * beta);
  }
};

Squares squares_of(const Eigen::MatrixXd& responses, const Eigen::MatrixXd& residuals) {
  return {responses.transpose() * responses, responses.transpose() * residuals,
          residuals.colwise().squaredNorm().transpose()};
}

Eigen::VectorXd solve(const Squares& train, Eigen::Index world) {
  const Eigen::VectorXd size = train.responses.diagonal().cwiseSqrt().cwiseMax(1e-300);
  Eigen::MatrixXd normal = size.cwiseInverse().asDiagonal() * train.responses * size.cwiseInverse().asDiagonal();
  normal.diagonal().array() += ridge;
  return size.cwiseInverse().cwiseProduct(
      solve_symmetric(normal, size.cwiseInverse().cwiseProduct(train.products.col(world))));
}

// One side's blocks, whitened: residuals and how they answer to what is free in the model.
struct SideOf {
  const Evidence* evidence;
  const FitData* blocks;
  rendering::Prediction nominal;
  Eigen::MatrixXd residuals;  // the recording's, then each null world's
  Eigen::MatrixXd nuisances;

  [[nodiscard]] Eigen::MatrixXd answer(const std::vector<std::vector<Vec3>>& series) const {
    const std::vector<Vec3> nothing(evidence->recording->size(), Vec3::Zero());
    return whiten_for_regression(*blocks, nothing, series).responses;
  }
};

class Regression {
 public:
  Regression(const SearchState& state) : state_(state) {
    sides_ = {side(state.data->train, state.train), side(state.data->validation, state.validation)};
    for (std::size_t s = 0; s < 2; ++s) {
      plain_[s] = squares_of(sides_[s].nuisances, sides_[s].residuals);
    }
  }

  std::vector<RegressedLaw> all(const std::vector<LawStart>& starts) const {
    std::vector<std::optional<RegressedLaw>> tried(starts.size());
    const auto try_one = [&](std::size_t i) {
      try {
        tried[i] = one(starts[i], i);
      } catch (const BadData&) {
        // A renderer that cannot run such an effect.
      }
    };
    in_parallel(starts.size(), try_one, 1);
    std::vector<RegressedLaw> usable;
    for (auto& each : tried) {
      if (each) usable.push_back(std::move(*each));
    }
    return usable;
  }

 private:
  [[nodiscard]] SideOf side(const Evidence& evidence, const FitData& blocks) const {
    const Model& model = state_.current.model;
    SideOf of{&evidence, &blocks, evidence.predictor->predict(model), {}, {}};
    const auto whitened = [&](const std::vector<Vec3>& forces) {
      return whiten_for_regression(blocks, difference(forces, of.nominal.f_W_N, 1.0), {}).residual;
    };
    of.residuals.resize(static_cast<Eigen::Index>(3 * blocks.blocks.size()), 1 + NoiseModel::null_simulations);
    of.residuals.col(0) = whitened(evidence.recording->f_W_N);
    for (std::size_t world = 0; world < NoiseModel::null_simulations; ++world) {
      of.residuals.col(static_cast<Eigen::Index>(world + 1)) =
          whitened(evidence.noise->null_forces(model, of.nominal, world));
    }
    std::vector<std::vector<Vec3>> series;
    constexpr double step = 1e-3;
    for (const FreeParameter& parameter : state_.compared()) {
      Model moved = model;
      const double u = parameter.get(model);
      parameter.set(moved, u + (u + step > parameter.upper ? -step : step));
      series.push_back(
          difference(evidence.predictor->predict(moved).f_W_N, of.nominal.f_W_N, parameter.get(moved) - u));
    }
    of.nuisances = of.answer(series);
    return of;
  }

  // How the forces of every sample answer to each size of the term, per unit of it.
  [[nodiscard]] std::vector<std::vector<Vec3>> answers_of(const LawStart& start, const SideOf& side) const {
    std::vector<std::vector<Vec3>> series;
    for (const std::string& name : start.term->linear) {
      // Small against the force, so that what cannot pull does not let go.
      constexpr double share = 1e-3;
      const double size = share * declaration(start.term->effect, name).initial;
      rendering::NamedParameters entry = start.entry;
      entry.parameters[name] = size;
      const Model model = with_entry(state_.current.model, side_of(*start.term), entry);
      series.push_back(difference(side.evidence->predictor->predict(model).f_W_N, side.nominal.f_W_N, size));
    }
    return series;
  }

  [[nodiscard]] std::optional<RegressedLaw> one(const LawStart& start, std::size_t number) const {
    std::array<Squares, 2> with;
    std::vector<std::vector<Vec3>> series;
    for (std::size_t s = 0; s < 2; ++s) {
      // Both sides are blocks of one recording, as a rule: one prediction has them all.
      if (s == 0 || sides_[1].evidence->predictor != sides_[0].evidence->predictor)
        series = answers_of(start, sides_[s]);
      const Eigen::MatrixXd answers = sides_[s].answer(series);
      Eigen::MatrixXd responses(answers.rows(), sides_[s].nuisances.cols() + answers.cols());
      responses << sides_[s].nuisances, answers;
      if (!responses.allFinite()) return std::nullopt;
      with[s] = squares_of(responses, sides_[s].residuals);
    }
    RegressedLaw regressed;
    regressed.start = number;
    for (Eigen::Index world = 0; world < plain_[0].residual.size(); ++world) {
      const Eigen::VectorXd before = solve(plain_[0], world);
      const Eigen::VectorXd after = solve(with[0], world);
      const double gain = plain_[1].left(before, world) - with[1].left(after, world);
      if (!std::isfinite(gain)) return std::nullopt;
      if (world > 0) {
        regressed.null_gains.push_back(gain);
        continue;
      }
      regressed.gain = gain;
      regressed.train_gain = plain_[0].left(before, world) - with[0].left(after, world);
      const auto sizes = after.tail(static_cast<Eigen::Index>(start.term->linear.size()));
      regressed.sizes.assign(sizes.begin(), sizes.end());
    }
    return regressed;
  }

  const SearchState& state_;
  std::array<SideOf, 2> sides_;
  std::array<Squares, 2> plain_;
};

}  // namespace

Side side_of(const LawTerm& term) { return term.effect.is_instrument() ? Side::instrument : Side::contact; }

const rendering::ParameterDeclaration& declaration(const rendering::DeclaredEffect& effect, const std::string& name) {
  return *std::ranges::find(effect.parameters, name, &rendering::ParameterDeclaration::name);
}

LawStart law_start(const LawTerm& term, const std::shared_ptr<const rendering::DeclaredEffect>& law,
                   const std::map<std::string, double>& constants) {
  LawStart start{&term, {law->name, constants, "/found", {}, law}};
  for (const std::string& name : term.linear) start.entry.parameters[name] = 0.0;
  return start;
}

std::vector<RegressedLaw> regress_laws(const SearchState& state, const std::vector<LawStart>& starts) {
  return Regression(state).all(starts);
}

double law_bar(const std::vector<RegressedLaw>& all, const SearchSettings& settings) {
  std::vector<double> most(NoiseModel::null_simulations, 0.0);
  for (const RegressedLaw& one : all) {
    for (std::size_t world = 0; world < most.size(); ++world)
      most[world] = std::max(most[world], one.null_gains[world]);
  }
  return std::max(settings.minimum_gain, bar_above(most, settings.null_deviations));
}

}  // namespace touchstone::discrepancy
