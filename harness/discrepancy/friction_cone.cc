#include "harness/discrepancy/friction_cone.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "harness/base/random.h"
#include "harness/discrepancy/model_edit.h"
#include "harness/stats/quantile.h"

namespace touchstone::discrepancy {
using rendering::Model;

namespace {

constexpr double fast_share = 0.85;    // of the samples: slower than the fast ones
constexpr double widest_share = 0.98;  // of the samples: within the widest ratio
constexpr std::size_t fewest_samples = 300;
constexpr double steepest = 2.0;  // static coefficient above the dynamic one, at most

std::vector<ConeSample> fastest(const std::vector<ConeSample>& samples) {
  std::vector<double> speeds;
  speeds.reserve(samples.size());
  for (const ConeSample& sample : samples) speeds.push_back(sample.speed_m_per_s);
  const double fast = stats::lower_quantile(std::move(speeds), fast_share);
  std::vector<ConeSample> chosen;
  std::copy_if(samples.begin(), samples.end(), std::back_inserter(chosen),
               [&](const ConeSample& sample) { return sample.speed_m_per_s >= fast; });
  return chosen;
}

// The samples that are faster than almost all that stick.
std::vector<ConeSample> sliding_samples(std::vector<ConeSample> samples, double mu) {
  constexpr double sticks_below = 0.8;  // of the dynamic coefficient
  constexpr double sticking = 0.05;     // of the samples that are taken to slide
  std::sort(samples.begin(), samples.end(),
            [](const ConeSample& a, const ConeSample& b) { return a.speed_m_per_s > b.speed_m_per_s; });
  std::size_t stuck = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    stuck += samples[i].ratio < sticks_below * mu ? 1 : 0;
    if (static_cast<double>(stuck) <= sticking * static_cast<double>(i + 1)) count = i + 1;
  }
  samples.resize(count);
  return samples;
}

// Koenker and Bassett's loss of one residual.
double quantile_loss(double residual, double quantile) {
  return residual > 0.0 ? quantile * residual : (quantile - 1.0) * residual;
}

}  // namespace

ConeEvidence cone_evidence(const FitData& blocks, const NoiseModel& noise, const Model& others, double force_floor_N) {
  return {blocks.predictor->predict(others), &blocks.blocks, &noise.smoothed_motion(), force_floor_N};
}

std::vector<ConeSample> cone_samples(const ConeEvidence& evidence, const std::vector<Vec3>& shown_W_N) {
  constexpr double least_load = 0.15;  // of the load that a tenth of the samples exceed
  const rendering::Prediction& others = evidence.others;
  const MotionColumns& likely = *evidence.likely;
  std::vector<std::pair<ConeSample, double>> loaded;
  std::vector<double> loads_N;
  const auto read = [&](std::size_t i) {
    const Vec3& n = others.n_W[i];
    if (n.isZero() || others.n_W[i - 1].isZero() || others.n_W[i + 1].isZero()) return;
    const Vec3 left_N = shown_W_N[i] - others.f_W_N[i];
    const double load_N = others.normal_N[i] + n.dot(left_N);
    if (!(load_N > evidence.force_floor_N)) return;
    const Vec3 way = likely.p_W_m[i + 1] - likely.p_W_m[i - 1];
    const Vec3 along = way - n.dot(way) * n;
    const double speed = along.norm() / (likely.t_s[i + 1] - likely.t_s[i - 1]);
    const Vec3 direction = along.isZero() ? Vec3(Vec3::Zero()) : Vec3(along.normalized());
    const Vec3 pull = (left_N - n.dot(left_N) * n) / load_N;
    loaded.emplace_back(ConeSample{pull.norm(), speed, direction, pull.dot(direction)}, load_N);
    loads_N.push_back(load_N);
  };
  for (const ResidualBlock& block : *evidence.blocks) {
    const std::size_t end = std::min(block.end, likely.size() - 1);
    for (std::size_t i = std::max<std::size_t>(block.begin, 1); i < end; ++i) read(i);
  }
  const double least_N = least_load * stats::lower_quantile(std::move(loads_N), 0.9);
  std::vector<ConeSample> cone;
  for (const auto& [sample, load_N] : loaded) {
    if (load_N >= least_N) cone.push_back(sample);
  }
  return cone;
}

std::optional<Cone> cone_of(const std::vector<ConeSample>& samples) {
  if (samples.size() < fewest_samples) return std::nullopt;
  std::vector<double> ratios;
  ratios.reserve(samples.size());
  for (const ConeSample& sample : samples) ratios.push_back(sample.ratio);
  std::vector<double> of_fast;
  for (const ConeSample& sample : fastest(samples)) of_fast.push_back(sample.ratio);
  const Cone cone{stats::lower_quantile(std::move(of_fast), 0.5),
                  stats::lower_quantile(std::move(ratios), widest_share)};
  if (!(cone.sliding > 0.0)) return std::nullopt;
  return cone;
}

std::optional<double> pulls_along(const std::vector<ConeSample>& samples) {
  constexpr double least = 0.05;
  constexpr double share_along = 0.9;
  constexpr double one_way = 0.7;  // length of the mean direction: the error of a slope would pull to one side alone
  if (samples.size() < fewest_samples) return std::nullopt;
  const auto fast = fastest(samples);
  const double n = static_cast<double>(fast.size());
  double pulled = 0.0;
  Vec3 mean = Vec3::Zero();
  std::vector<double> along;
  for (const ConeSample& sample : fast) {
    pulled += sample.along > 0.0 ? 1.0 / n : 0.0;
    mean += sample.direction_W / n;
    along.push_back(sample.along);
  }
  const double coefficient = stats::lower_quantile(std::move(along), 0.5);
  if (!(pulled >= share_along) || !(coefficient >= least) || !(mean.norm() < one_way)) return std::nullopt;
  return coefficient;
}

std::vector<double> null_excesses(const ConeEvidence& evidence, NoiseModel& noise, const Model& model,
                                  const rendering::Prediction& nominal) {
  std::vector<double> excesses;
  for (std::size_t world = 0; world < NoiseModel::null_simulations; ++world) {
    const auto cone = cone_of(cone_samples(evidence, noise.null_forces(model, nominal, world)));
    if (cone) excesses.push_back(cone->excess());
  }
  return excesses;
}

std::optional<FallingCoefficient> read_falling(const std::vector<ConeSample>& samples, double quantile) {
  const auto cone = cone_of(samples);
  if (!cone) return std::nullopt;
  const auto sliding = sliding_samples(samples, cone->sliding);
  if (sliding.size() < 2) return std::nullopt;
  const double slowest = std::max(sliding.back().speed_m_per_s, 1e-3 * sliding.front().speed_m_per_s);
  constexpr int steps = 60;
  const double from = 0.3 * slowest;  // a law that falls below what slides at all is seen by its largest values alone
  const double to = sliding.front().speed_m_per_s;
  const double least = std::max(0.0, cone->widest - cone->sliding);
  FallingCoefficient best{cone->widest, cone->sliding, to};
  double best_loss = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= steps; ++i) {
    const double velocity = from * std::pow(to / from, static_cast<double>(i) / steps);
    for (int j = 0; j <= steps; ++j) {
      const double excess = least + (steepest - least) * static_cast<double>(j * j) / (steps * steps);
      double loss = 0.0;
      for (const ConeSample& sample : sliding) {
        const double v = sample.speed_m_per_s / velocity;
        loss += quantile_loss(sample.ratio - cone->sliding - excess * std::exp(-v * v), quantile);
      }
      if (!(loss < best_loss)) continue;
      best_loss = loss;
      best = {cone->sliding + excess, cone->sliding, velocity};
    }
  }
  return best;
}

std::optional<FallingCoefficient> read_again(const std::vector<ConeSample>& samples, std::size_t draw) {
  constexpr std::array quantiles{0.5, 0.6, 0.7, 0.8};
  constexpr std::size_t run = 60;
  if (samples.size() < run) return std::nullopt;
  Random random(0xc04e + draw);
  std::vector<ConeSample> drawn;
  while (drawn.size() < samples.size()) {
    const auto from = static_cast<std::ptrdiff_t>(random.below(samples.size() - run + 1));
    drawn.insert(drawn.end(), samples.begin() + from, samples.begin() + from + run);
  }
  return read_falling(drawn, quantiles.at(draw % quantiles.size()));
}

void set_falling(Model& model, const std::string& friction, const FallingCoefficient& read) {
  auto& parameters = find_entry(model, friction)->parameters;
  parameters["mu_static"] = read.mu_static;
  parameters["mu_dynamic"] = read.mu_dynamic;
  parameters["stribeck_velocity_m_per_s"] = read.velocity_m_per_s;
}

bool is_of_falling(const std::string& parameter) {
  return parameter == "mu_static" || parameter == "mu_dynamic" || parameter == "stribeck_velocity_m_per_s";
}

}  // namespace touchstone::discrepancy
