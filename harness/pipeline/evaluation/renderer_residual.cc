#include "harness/pipeline/evaluation/renderer_residual.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "harness/pipeline/evaluation/residual_timing.h"

namespace touchstone::pipeline {
namespace {

constexpr std::size_t most_residual_samples = 120'000, fewest_samples = 200;

std::optional<Found> find_axes(const ResidualSeries& r) {
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
      found = Found{left, "other axes",
                    fmt::format("The axes of the rendered force are mirrored or exchanged: taken as ({}), {}.", axes,
                                r.gain(left))};
    }
  }
  return found;
}

// Larger while it grows and smaller while it falls, each by a factor of its own, against one factor for both: a
// renderer that loses energy which the object does not. The other way round the model lacks a loss, which is no fault
// of the renderer.
std::optional<Found> find_hysteresis(const ResidualSeries& r) {
  Found best;
  best.left = kept_share * r.as_it_is({0, r.size()});
  // The way is that over so many samples: of noise it changes with every sample.
  for (const std::size_t window : {1, 3, 10, 30}) {
    const auto grows = [&](std::size_t i) {
      return r.rendered_[i].norm() > r.rendered_[i - std::min(i, window)].norm();
    };
    std::array<double, 2> product{}, square{};
    std::size_t turns = 0;
    for (std::size_t i = 0; i < r.size(); ++i) {
      const std::size_t way = grows(i) ? 1 : 0;
      turns += i > 0 && grows(i) != grows(i - 1) ? 1 : 0;
      product[way] += r.rendered_[i].dot(r.measured_[i]);
      square[way] += r.rendered_[i].squaredNorm();
    }
    // Longer than half of a usual way it may say the opposite.
    if (2 * window * turns > r.size()) continue;
    const double falling = product[0] / square[0], growing = product[1] / square[1];
    const double both = (product[0] + product[1]) / (square[0] + square[1]);
    const auto by_way = [&](std::size_t i) -> Vec3 { return (grows(i) ? growing : falling) * r.rendered_[i]; };
    const auto by_one = [&](std::size_t i) -> Vec3 { return both * r.rendered_[i]; };
    const bool better = std::ranges::all_of(
        r.halves(), [&](const Half& half) { return r.left(half, by_way) < kept_share * r.left(half, by_one); });
    const double left = r.left({0, r.size()}, by_way);
    if (!better || !(left < best.left) || !r.gains_in_both(by_way)) continue;
    best = {left, "without hysteresis", ""};
    if (growing < falling) {
      best.text = fmt::format(
          "The rendered force is {:.2g} % larger while it grows than while it falls, and the "
          "measured one is not: the renderer has a hysteresis that the object has not; without "
          "it, {}.",
          100.0 * (falling / growing - 1.0), r.gain(left));
    }
  }
  return best.text.empty() ? std::nullopt : std::optional(best);
}

// At the limit to rounding in at least 1 % of the samples, where more was measured in nine of ten of them.
std::optional<Found> find_limit(const ResidualSeries& r) {
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
        0.0, "",
        fmt::format("The rendered force never exceeds {:.4g} N{}, and is just that in {:.1f} % of the samples; "
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
std::optional<Found> find_dropouts(const ResidualSeries& r) {
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
  return Found{0.0, "",
               fmt::format("In {} samples, at {} times and first at {:.4f} s, the rendered force is missing "
                           "between two that have it.",
                           count, times, r.t_s_[first])};
}

// Each component a multiple of one step, which makes a tenth of the squared error or more.
std::optional<Found> find_steps(const ResidualSeries& r) {
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
  return Found{0.0, "",
               fmt::format("Each component of the rendered force is a multiple of {:.3g} N: such steps are {:.3g} "
                           "N of the RMS force error of {:.3g} N.",
                           step_N, std::sqrt(squared_N2), std::sqrt(r.as_it_is({0, r.size()})))};
}

// The repairs after the best one: those that the recording does not tell from it, and the others.
std::string also_considered(const std::vector<Found>& repairs) {
  std::array<std::string, 2> lists;
  for (std::size_t k = 1; k < repairs.size(); ++k) {
    // Told apart by what a repair must gain, here too.
    const bool alike = kept_share * repairs[k].left <= repairs.front().left;
    std::string& list = lists[alike ? 0 : 1];
    list += fmt::format("{}{} ({:.3g} N)", list.empty() ? "" : ", ", repairs[k].repair, std::sqrt(repairs[k].left));
  }
  return (lists[0].empty() ? "" : fmt::format(" This recording does not tell it from: {}.", lists[0])) +
         (lists[1].empty() ? "" : fmt::format(" Also considered: {}.", lists[1]));
}

}  // namespace

void RendererResidual::add(const metrics::MetricSample& sample, const Vec3& tip_W_m) {
  if (t_s_.size() >= most_residual_samples || !sample.f_measured_W_N.allFinite() || !sample.f_rendered_W_N.allFinite())
    return;
  if (!t_s_.empty() && !(sample.t_s > t_s_.back())) return;
  t_s_.push_back(sample.t_s);
  tip_W_m_.push_back(tip_W_m);
  contact_W_m_.push_back(sample.contact_W_m);
  measured_N_.push_back(sample.f_measured_W_N);
  rendered_N_.push_back(sample.f_rendered_W_N);
}

std::vector<std::string> RendererResidual::faults() const {
  if (t_s_.size() < fewest_samples) return {};
  const ResidualSeries residual(t_s_, tip_W_m_, contact_W_m_, measured_N_, rendered_N_);
  std::vector<std::string> said;
  // Of those that rearrange the force the one that leaves least; what cuts it stands beside each.
  const std::optional<Found> hold = find_hold(residual);
  const std::optional<Found> alternate = hold ? std::nullopt : find_alternate_lag(residual);
  std::vector<Found> repairs;
  for (const auto& one :
       {hold, alternate, find_lag(residual), find_filter(residual), find_axes(residual), find_hysteresis(residual)}) {
    if (one) repairs.push_back(*one);
  }
  std::ranges::stable_sort(repairs, {}, &Found::left);
  if (!repairs.empty()) said.push_back(repairs.front().text + also_considered(repairs));
  // What is seen of the rendered force alone stays true.
  for (const auto& seen : {hold, alternate}) {
    if (seen && seen->text != repairs.front().text) said.push_back(seen->text);
  }
  for (const auto& cut :
       {find_held_contact(residual), find_limit(residual), find_dropouts(residual), find_steps(residual)}) {
    if (cut) said.push_back(cut->text);
  }
  return said;
}

}  // namespace touchstone::pipeline
