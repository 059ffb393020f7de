#include "harness/pipeline/evaluation/residual_timing.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "harness/stats/quantile.h"

namespace touchstone::pipeline {
namespace {

constexpr double longest_lag_s = 0.05;  // of physics at 20 Hz
constexpr int lags = 100;               // tried, both ways each

// Samples at the same place of a period p that are late against their neighbours. With the lags L_q in samples and the
// slope v_i = (f_(i+p) - f_(i-p)) / 2p, which lags do not touch,
// f_i - (f_(i-1) + f_(i+1)) / 2 = -(L_q - (L_(q-1) + L_(q+1)) / 2) v_i.
class AlternateLag {
 public:
  AlternateLag(const ResidualSeries& r, std::size_t period) : r_(r), period_(period), off_(eigen(period)) {
    std::vector<std::vector<double>> seen(period);
    for (std::size_t i = period; i + period < r.size(); ++i) {
      if (const Vec3 v = slope(i); !v.isZero()) seen[i % period].push_back(-bend(i).dot(v) / v.squaredNorm());
    }
    for (std::size_t q = 0; q < period; ++q) off_[eigen(q)] = seen[q].empty() ? 0.0 : stats::upper_median(seen[q]);
    Eigen::MatrixXd neighbours = Eigen::MatrixXd::Identity(eigen(period), eigen(period));
    for (std::size_t q = 0; q < period; ++q) {
      neighbours(eigen(q), eigen((q + 1) % period)) -= 0.5;
      neighbours(eigen(q), eigen((q + period - 1) % period)) -= 0.5;
    }
    lag_ = neighbours.completeOrthogonalDecomposition().solve(off_);
    lag_.array() -= lag_.minCoeff();
  }

  // Whether the rendered force alone shows it: in both halves it takes half of what bends beside a late sample, in most
  // of them (where the force turns round it bends without any lag).
  [[nodiscard]] bool explains() const {
    constexpr double of_samples = 0.6, beside = 0.1;
    const double most = off_.cwiseAbs().maxCoeff();
    return lag_.maxCoeff() > 0.0 && std::ranges::all_of(r_.halves(), [&](const Half& half) {
             std::size_t bent = 0, explained = 0;
             for (std::size_t i = std::max(half.from, period_); i + period_ < half.to; ++i) {
               const double before = bend(i).norm();
               if (before == 0.0 || std::abs(off_[at(i)]) < beside * most) continue;
               ++bent;
               explained += (bend(i) + off_[at(i)] * slope(i)).norm() < kept_share * before ? 1 : 0;
             }
             return period_ * bent > half.to - half.from &&
                    static_cast<double>(explained) > of_samples * static_cast<double>(bent);
           });
  }
  [[nodiscard]] Vec3 repaired(std::size_t i) const {
    return i < period_ || i + period_ >= r_.size() ? r_.rendered_[i] : Vec3(r_.rendered_[i] + lag_[at(i)] * slope(i));
  }
  [[nodiscard]] Eigen::Index late() const { return (lag_.array() > 0.5 * lag_.maxCoeff()).count(); }
  [[nodiscard]] double longest() const { return lag_.maxCoeff(); }

 private:
  static Eigen::Index eigen(std::size_t i) { return static_cast<Eigen::Index>(i); }
  [[nodiscard]] Eigen::Index at(std::size_t i) const { return eigen(i % period_); }
  [[nodiscard]] Vec3 slope(std::size_t i) const {
    return (r_.rendered_[i + period_] - r_.rendered_[i - period_]) / (2.0 * static_cast<double>(period_));
  }
  [[nodiscard]] Vec3 bend(std::size_t i) const {
    return r_.rendered_[i] - 0.5 * (r_.rendered_[i - 1] + r_.rendered_[i + 1]);
  }
  const ResidualSeries& r_;
  std::size_t period_;
  Eigen::VectorXd off_, lag_;
};

// Answers that are given again without a period, though the tip moves, and are caught up with afterwards.
std::optional<Found> find_jitter(const ResidualSeries& r) {
  constexpr double of_samples = 0.05, caught_up = 0.75;
  double share = 0.0;
  for (const Half& half : r.halves()) {
    double again = 0.0, jump_N = 0.0, usual_N = 0.0;
    std::vector<double> steps_N;
    std::size_t held = 1;
    for (std::size_t i = half.from + 1; i < half.to; ++i) {
      const double step_N = (r.rendered_[i] - r.rendered_[i - 1]).norm();
      if (step_N == 0.0 && !r.rendered_[i].isZero() && r.moves(i - 1, i + 1)) {
        ++held;
        continue;
      }
      if (held > 1) {
        again += static_cast<double>(held - 1);
        jump_N += step_N;
        usual_N += static_cast<double>(held);
      } else if (step_N > 0.0) {
        steps_N.push_back(step_N);
      }
      held = 1;
    }
    if (steps_N.empty() || again < of_samples * static_cast<double>(half.to - half.from) ||
        jump_N < caught_up * usual_N * stats::upper_median(steps_N))
      return std::nullopt;
    share += 0.5 * again / static_cast<double>(half.to - half.from);
  }
  const double as_it_is = r.as_it_is({0, r.size()});
  return Found{as_it_is, "an answer for each sample",
               fmt::format("In {:.2g} % of the samples the rendered force is that of the sample before, though the tip "
                           "moves, and is caught up with later, without a period: its answers come with jitter.",
                           100.0 * share)};
}

constexpr std::size_t fewest_lengths = 20;

// Of how many samples nearly all of them are, if of more than one.
std::optional<double> usual_length(std::vector<double> lengths) {
  constexpr double most_of_them = 0.9;
  if (lengths.size() < fewest_lengths) return std::nullopt;
  const double usual = stats::upper_median(lengths);
  const auto alike = std::ranges::count_if(lengths, [&](double n) { return std::abs(n - usual) <= 1.0; });
  if (usual < 2.0 || static_cast<double>(alike) < most_of_them * static_cast<double>(lengths.size()))
    return std::nullopt;
  return usual;
}

double mean_of(const std::vector<double>& lengths) {
  return std::accumulate(lengths.begin(), lengths.end(), 0.0) / static_cast<double>(lengths.size());
}

}  // namespace

std::optional<Found> find_lag(const ResidualSeries& r) {
  // The lag that leaves least, and what it leaves.
  const auto best_of = [&](const Half& half) {
    std::pair best{r.as_it_is(half), 0.0};
    for (int k = -lags; k <= lags; ++k) {
      const double lag_s = longest_lag_s * k / lags;
      const double left = r.left(half, [&](std::size_t i) { return r.later(i, lag_s); });
      if (left < best.first) best = {left, lag_s};
    }
    return best;
  };
  const auto [best, best_lag] = best_of({0, r.size()});
  // Not at the end of the search, and the same lag in both halves within two of its steps.
  const double step = longest_lag_s / lags;
  if (best_lag == 0.0 || std::abs(best_lag) > longest_lag_s - step) return std::nullopt;
  if (!r.gains_in_both([&, lag_s = best_lag](std::size_t i) { return r.later(i, lag_s); })) return std::nullopt;
  const auto [first, second] = r.halves();
  if (std::abs(best_of(first).second - best_of(second).second) > 2.5 * step) return std::nullopt;
  return Found{best, fmt::format("{:.1f} ms earlier", 1e3 * best_lag),
               fmt::format("The rendered force is {:.1f} ms {} the measured one: in step, {}. The renderer is {}, or "
                           "force and position of the recording are not of one clock.",
                           1e3 * std::abs(best_lag), best_lag > 0.0 ? "behind" : "ahead of", r.gain(best),
                           best_lag > 0.0 ? "late" : "early")};
}

// A low-pass filter of first order, f_i = a f_(i-1) + (1 - a) g_i, undone: g_i = f_i + a / (1 - a) (f_i - f_(i-1)).
std::optional<Found> find_filter(const ResidualSeries& r) {
  const auto undone = [&](double tau_s) {
    return [&r, tau_s](std::size_t i) -> Vec3 {
      if (i == 0) return r.rendered_[i];
      return r.rendered_[i] + tau_s / (r.t_s_[i] - r.t_s_[i - 1]) * (r.rendered_[i] - r.rendered_[i - 1]);
    };
  };
  double best_tau = 0.0, best = r.as_it_is({0, r.size()});
  for (int k = 1; k < lags; ++k) {
    const double tau_s = longest_lag_s * k / lags;
    if (const double left = r.left({0, r.size()}, undone(tau_s)); left < best) best = left, best_tau = tau_s;
  }
  if (best_tau == 0.0 || !r.gains_in_both(undone(best_tau))) return std::nullopt;
  // tau = a / (1 - a) steps, a = exp(-step / T).
  const double step_s = (r.t_s_.back() - r.t_s_.front()) / static_cast<double>(r.size() - 1);
  best_tau = step_s / std::log1p(step_s / best_tau);
  return Found{best, fmt::format("without a low-pass filter of {:.1f} ms", 1e3 * best_tau),
               fmt::format("The rendered force is low-pass filtered, with a time constant of {:.1f} ms: undone, {}.",
                           1e3 * best_tau, r.gain(best))};
}

std::optional<Found> find_alternate_lag(const ResidualSeries& r) {
  constexpr std::size_t longest = 8;
  for (std::size_t period = 2; period <= longest; ++period) {
    const AlternateLag lag(r, period);
    if (!lag.explains()) continue;
    const double left = r.left({0, r.size()}, [&](std::size_t i) { return lag.repaired(i); });
    return Found{left, "no sample later than its neighbours",
                 fmt::format("Of every {} samples of the rendered force {} are late, by {:.2g} samples: in step, {}.",
                             period, lag.late(), lag.longest(), r.gain(left))};
  }
  return std::nullopt;
}

// The rendered force is the same for as many samples every time, though the tip moves.
std::optional<Found> find_hold(const ResidualSeries& r) {
  std::vector<std::size_t> changes;
  std::vector<double> lengths;
  for (std::size_t i = 1; i < r.size(); ++i) {
    if (r.rendered_[i] == r.rendered_[i - 1]) continue;
    // Air before or after says nothing; neither does a tip that rests.
    const bool pushed = !changes.empty() && !r.rendered_[i].isZero() && !r.rendered_[i - 1].isZero();
    if (pushed && (i == changes.back() + 1 || r.moves(changes.back(), i)))
      lengths.push_back(static_cast<double>(i - changes.back()));
    changes.push_back(i);
  }
  const auto usual = usual_length(lengths);
  if (!usual) return find_jitter(r);
  // Repaired: from one change to the next in a line.
  std::vector<Vec3> repaired = r.rendered_;
  for (std::size_t k = 1; k < changes.size(); ++k) {
    const std::size_t from = changes[k - 1], to = changes[k];
    if (static_cast<double>(to - from) > *usual + 1.0) continue;
    for (std::size_t i = from; i < to; ++i)
      repaired[i] +=
          static_cast<double>(i - from) / static_cast<double>(to - from) * (r.rendered_[to] - repaired[from]);
  }
  const double left = r.left({0, r.size()}, [&](std::size_t i) { return repaired[i]; });
  return Found{left, "updates at every sample",
               fmt::format("The rendered force is held: it changes at every {:.3g}th sample only; from one change "
                           "to the next in a line, {}.",
                           mean_of(lengths), r.gain(left))};
}

std::optional<Found> find_held_contact(const ResidualSeries& r) {
  constexpr double still = 1e-3;  // of the tip's way: rounding
  std::vector<double> lengths;
  std::size_t since = 0;  // 0: not known
  for (std::size_t i = 1; i < r.size(); ++i) {
    const Vec3 way = r.contact_[i] - r.contact_[i - 1];
    const bool touches = !r.rendered_[i].isZero() && !r.rendered_[i - 1].isZero() && r.moves(i - 1, i + 1);
    if (!touches) {
      since = 0;
    } else if (!(way.norm() <= still * (r.tip_[i] - r.tip_[i - 1]).norm())) {
      if (since > 0) lengths.push_back(static_cast<double>(i - since));
      since = i;
    }
  }
  // One that moves beyond a dead zone alone has no period, but never moves at two samples in a row.
  constexpr double in_a_row = 0.01;
  const auto at_once = static_cast<double>(std::ranges::count(lengths, 1.0));
  const bool never = lengths.size() >= fewest_lengths && at_once <= in_a_row * static_cast<double>(lengths.size());
  if (!never && !usual_length(lengths)) return std::nullopt;
  return Found{0.0, "",
               fmt::format("The rendered surface contact point is held: it moves once in {:.3g} samples{}, and the "
                           "force drags along the surface until then.",
                           mean_of(lengths), never ? " in the mean and never at two in a row" : "")};
}

}  // namespace touchstone::pipeline
