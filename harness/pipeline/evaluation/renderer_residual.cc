#include "harness/pipeline/evaluation/renderer_residual.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "harness/stats/quantile.h"

namespace touchstone::pipeline {
namespace {

constexpr std::size_t most_samples = 120'000, fewest_samples = 200;
// A repair must take half of the squared error, in each half of the recording: what a misfit of another kind looks like
// by chance seldom does so once, and not twice with the same repair.
constexpr double kept_share = 0.5;
constexpr double longest_lag_s = 0.05;  // of physics at 20 Hz
constexpr int lags = 100;               // tried, both ways each

struct Half {
  std::size_t from = 0, to = 0;
};

class Residual {
 public:
  Residual(const std::vector<double>& t_s, const std::vector<Vec3>& tip, const std::vector<Vec3>& measured,
           const std::vector<Vec3>& rendered)
      : t_s_(t_s), tip_(tip), measured_(measured), rendered_(rendered) {}

  [[nodiscard]] std::size_t size() const { return t_s_.size(); }
  [[nodiscard]] std::array<Half, 2> halves() const { return {{{0, size() / 2}, {size() / 2, size()}}}; }

  // Mean square of what a repair of the rendered force leaves.
  template <class Repair>
  [[nodiscard]] double left(const Half& half, const Repair& repair) const {
    // Some thousands of samples, spread over the part, tell as much as all.
    constexpr std::size_t enough = 3000;
    const std::size_t stride = std::max<std::size_t>(1, (half.to - half.from) / enough);
    double sum = 0.0;
    std::size_t n = 0;
    for (std::size_t i = half.from; i < half.to; i += stride, ++n) sum += (repair(i) - measured_[i]).squaredNorm();
    return sum / static_cast<double>(n);
  }
  [[nodiscard]] double as_it_is(const Half& half) const {
    return left(half, [&](std::size_t i) { return rendered_[i]; });
  }
  template <class Repair>
  [[nodiscard]] bool gains_in_both(const Repair& repair) const {
    return std::ranges::all_of(halves(), [&](const Half& half) {
      const double before = as_it_is(half);
      return before > 0.0 && left(half, repair) < kept_share * before;
    });
  }
  [[nodiscard]] std::string gain(double after) const {
    return fmt::format("the RMS force error would be {:.3g} N in place of {:.3g} N", std::sqrt(after),
                       std::sqrt(as_it_is({0, size()})));
  }

  // The rendered force as it is `lag_s` later, linear between samples.
  [[nodiscard]] Vec3 later(std::size_t i, double lag_s) const {
    const double t = t_s_[i] + lag_s;
    if (t <= t_s_.front()) return rendered_.front();
    if (t >= t_s_.back()) return rendered_.back();
    const auto above = std::ranges::upper_bound(t_s_, t);
    const auto k = static_cast<std::size_t>(above - t_s_.begin());
    const double share = (t - t_s_[k - 1]) / (t_s_[k] - t_s_[k - 1]);
    return (1.0 - share) * rendered_[k - 1] + share * rendered_[k];
  }

  // Whether the tip is elsewhere in every sample of [from, to).
  [[nodiscard]] bool moves(std::size_t from, std::size_t to) const {
    for (std::size_t i = from + 1; i < to; ++i) {
      if (tip_[i] == tip_[i - 1]) return false;
    }
    return true;
  }

  const std::vector<double>& t_s_;
  const std::vector<Vec3>&tip_, &measured_, &rendered_;
};

struct Found {
  double left = 0.0;  // mean square
  std::string text;
};

std::optional<Found> find_lag(const Residual& r) {
  double best_lag = 0.0, best = r.as_it_is({0, r.size()});
  std::array<double, 2> of_half{}, least{r.as_it_is(r.halves()[0]), r.as_it_is(r.halves()[1])};
  for (int k = -lags; k <= lags; ++k) {
    const double lag_s = longest_lag_s * k / lags;
    const auto repair = [&](std::size_t i) { return r.later(i, lag_s); };
    if (const double left = r.left({0, r.size()}, repair); left < best) best = left, best_lag = lag_s;
    for (std::size_t h = 0; h < 2; ++h) {
      if (const double left = r.left(r.halves()[h], repair); left < least[h]) least[h] = left, of_half[h] = lag_s;
    }
  }
  // The same lag in both halves, within two steps of the search, and not at its end.
  const double step = longest_lag_s / lags;
  if (best_lag == 0.0 || std::abs(best_lag) > longest_lag_s - step || std::abs(of_half[0] - of_half[1]) > 2.5 * step)
    return std::nullopt;
  if (!r.gains_in_both([&](std::size_t i) { return r.later(i, best_lag); })) return std::nullopt;
  return Found{best,
               fmt::format("The rendered force is {:.1f} ms {} the measured one: in step, {}. The renderer is {}, or "
                           "force and position of the recording are not of one clock.",
                           1e3 * std::abs(best_lag), best_lag > 0.0 ? "behind" : "ahead of", r.gain(best),
                           best_lag > 0.0 ? "late" : "early")};
}

std::optional<Found> find_axes(const Residual& r) {
  constexpr std::array<std::array<int, 3>, 6> orders{
      {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
  std::optional<Found> found;
  double best = r.as_it_is({0, r.size()});
  for (const auto& order : orders) {
    for (int signs = 0; signs < 8; ++signs) {
      const auto repair = [&](std::size_t i) {
        Vec3 f;
        for (int k = 0; k < 3; ++k)
          f[k] = ((signs >> k) & 1) != 0 ? -r.rendered_[i][order[k]] : r.rendered_[i][order[k]];
        return f;
      };
      const double left = r.left({0, r.size()}, repair);
      if (!(left < best) || !r.gains_in_both(repair)) continue;
      best = left;
      std::string axes;
      for (int k = 0; k < 3; ++k) {
        axes += fmt::format("{}{}{}", axes.empty() ? "" : ", ", ((signs >> k) & 1) != 0 ? "-" : "",
                            "xyz"[order[static_cast<std::size_t>(k)]]);
      }
      found = Found{left, fmt::format("The axes of the rendered force are mirrored or exchanged: taken as ({}), {}.",
                                      axes, r.gain(left))};
    }
  }
  return found;
}

// At the limit to rounding in at least 1 % of the samples, where more was measured in nine of ten of them.
std::optional<Found> find_limit(const Residual& r) {
  constexpr double of_samples = 0.01, same = 1e-9, above = 1.02, in_most = 0.9;
  constexpr double of_largest = 0.01;  // an axis without force has a largest value, too: of rounding
  double largest_N = 0.0;
  for (const Vec3& f : r.rendered_) largest_N = std::max(largest_N, f.norm());
  const auto judge = [&](const auto& size, const std::string& of_what) -> std::optional<Found> {
    double limit = 0.0, largest = 0.0;
    for (const Vec3& f : r.rendered_) limit = std::max(limit, size(f));
    std::size_t at = 0, more = 0;
    for (std::size_t i = 0; i < r.size(); ++i) {
      largest = std::max(largest, size(r.measured_[i]));
      if (size(r.rendered_[i]) < limit * (1.0 - same)) continue;
      ++at;
      more += size(r.measured_[i]) > above * limit ? 1 : 0;
    }
    const auto n = static_cast<double>(r.size());
    if (!(limit > of_largest * largest_N) || static_cast<double>(at) < std::max(20.0, of_samples * n) ||
        static_cast<double>(more) < in_most * static_cast<double>(at))
      return std::nullopt;
    return Found{
        0.0, fmt::format("The rendered force never exceeds {:.4g} N{}, and is just that in {:.1f} % of the samples; "
                         "up to {:.4g} N were measured: it is cut there.",
                         limit, of_what, 100.0 * static_cast<double>(at) / n, largest)};
  };
  if (auto found = judge([](const Vec3& f) { return f.norm(); }, "")) return found;
  for (int k = 0; k < 3; ++k) {
    if (auto found = judge([k](const Vec3& f) { return std::abs(f[k]); }, fmt::format(" along {}", "xyz"[k])))
      return found;
  }
  return std::nullopt;
}

// Samples without force between two that have it, where it was measured before, then and after.
std::optional<Found> find_dropouts(const Residual& r) {
  constexpr double none = 1e-3, some = 0.5;
  constexpr std::size_t fewest = 3;    // one or two may be an edge
  constexpr std::size_t longest = 10;  // in a row: more is a contact that the renderer does not have
  constexpr double of_largest = 0.05;  // less is a contact that begins or ends
  double largest_N = 0.0;
  for (const Vec3& f : r.measured_) largest_N = std::max(largest_N, f.norm());
  std::size_t count = 0, times = 0, first = 0;
  for (std::size_t i = 1; i + 1 < r.size(); ++i) {
    const double before = r.rendered_[i - 1].norm();
    const auto out = [&](std::size_t k) {
      return k + 1 < r.size() && r.rendered_[k].norm() <= none * before && r.measured_[k].norm() >= some * before;
    };
    std::size_t end = i;
    while (before > of_largest * largest_N && end - i <= longest && out(end)) ++end;
    if (end == i || end - i > longest || r.rendered_[end].norm() < some * before) continue;
    if (times++ == 0) first = i;
    count += end - i;
    i = end;
  }
  if (times < fewest) return std::nullopt;
  return Found{0.0, fmt::format("In {} samples, at {} times and first at {:.4f} s, the rendered force is missing "
                                "between two that have it.",
                                count, times, r.t_s_[first])};
}

// The rendered force is the same for as many samples every time, though the tip moves.
std::optional<Found> find_hold(const Residual& r) {
  constexpr std::size_t fewest = 20;
  constexpr double most_of_them = 0.9;
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
  if (lengths.size() < fewest) return std::nullopt;
  const double usual = stats::upper_median(lengths);
  const auto alike = std::ranges::count_if(lengths, [&](double n) { return std::abs(n - usual) <= 1.0; });
  if (usual < 2.0 || static_cast<double>(alike) < most_of_them * static_cast<double>(lengths.size()))
    return std::nullopt;
  // Repaired: from one change to the next in a line.
  std::vector<Vec3> repaired = r.rendered_;
  for (std::size_t k = 1; k < changes.size(); ++k) {
    const std::size_t from = changes[k - 1], to = changes[k];
    if (static_cast<double>(to - from) > usual + 1.0) continue;
    for (std::size_t i = from; i < to; ++i)
      repaired[i] +=
          static_cast<double>(i - from) / static_cast<double>(to - from) * (r.rendered_[to] - repaired[from]);
  }
  const double left = r.left({0, r.size()}, [&](std::size_t i) { return repaired[i]; });
  double sum = 0.0;
  for (const double n : lengths) sum += n;
  const double mean = sum / static_cast<double>(lengths.size());
  return Found{left,
               fmt::format("The rendered force is held: it changes at every {:.3g}th sample only; from one change "
                           "to the next in a line, {}.",
                           mean, r.gain(left))};
}

// Each component a multiple of one step, which makes a tenth of the squared error or more.
std::optional<Found> find_steps(const Residual& r) {
  constexpr double same = 1e-6, of_error = 0.1;
  constexpr double fewest = 4.0;  // steps in the largest component
  double step_N = std::numeric_limits<double>::infinity(), largest_N = 0.0;
  for (const Vec3& f : r.rendered_) {
    for (const double part : f) {
      if (part != 0.0) step_N = std::min(step_N, std::abs(part));
      largest_N = std::max(largest_N, std::abs(part));
    }
  }
  // Three components, each off by anything up to half a step (Widrow 1956).
  const double squared_N2 = 3.0 * step_N * step_N / 12.0;
  if (!(largest_N >= fewest * step_N) || squared_N2 < of_error * r.as_it_is({0, r.size()})) return std::nullopt;
  for (const Vec3& f : r.rendered_) {
    if (((f / step_N - (f / step_N).array().round().matrix()).array().abs() > same).any()) return std::nullopt;
  }
  return Found{0.0, fmt::format("Each component of the rendered force is a multiple of {:.3g} N: such steps are {:.3g} "
                                "N of the RMS force error of {:.3g} N.",
                                step_N, std::sqrt(squared_N2), std::sqrt(r.as_it_is({0, r.size()})))};
}

}  // namespace

void RendererResidual::add(const metrics::MetricSample& sample, const Vec3& tip_W_m) {
  if (t_s_.size() >= most_samples || !sample.f_measured_W_N.allFinite() || !sample.f_rendered_W_N.allFinite()) return;
  if (!t_s_.empty() && !(sample.t_s > t_s_.back())) return;
  t_s_.push_back(sample.t_s);
  tip_W_m_.push_back(tip_W_m);
  measured_N_.push_back(sample.f_measured_W_N);
  rendered_N_.push_back(sample.f_rendered_W_N);
}

std::vector<std::string> RendererResidual::faults() const {
  if (t_s_.size() < fewest_samples) return {};
  const Residual residual(t_s_, tip_W_m_, measured_N_, rendered_N_);
  std::vector<std::string> said;
  // Of those that rearrange the force the one that leaves least; what cuts it stands beside each.
  const std::optional<Found> hold = find_hold(residual);
  std::optional<Found> moved = hold;
  for (const auto& other : {find_lag(residual), find_axes(residual)}) {
    if (other && (!moved || other->left < moved->left)) moved = other;
  }
  if (moved) said.push_back(moved->text);
  // What is seen of the rendered force alone stays true.
  if (hold && hold->text != moved->text) said.push_back(hold->text);
  for (const auto& cut : {find_limit(residual), find_dropouts(residual), find_steps(residual)}) {
    if (cut) said.push_back(cut->text);
  }
  return said;
}

}  // namespace touchstone::pipeline
