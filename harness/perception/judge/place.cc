#include "harness/perception/judge/place.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <tuple>

#include "harness/base/least_squares.h"
#include "harness/perception/judge/judge.h"
#include "harness/perception/judge/slow_channels.h"
#include "harness/stats/distributions.h"

namespace touchstone::perception {
namespace {

constexpr double kIntervals = 20.0;  // of the longer side of what was explored, for the gain
constexpr double kCells = 10.0;      // and for the comparison
constexpr double kStretch_s = 0.02;  // the smoothing of positions
constexpr double kFewestStretches = 3.0;

// The four cubic B-splines that are not zero at `share` of an interval.
std::array<double, 4> cubic(double share) {
  const double rest = 1.0 - share;
  return {rest * rest * rest / 6.0, (3.0 * share * share * share - 6.0 * share * share + 4.0) / 6.0,
          (-3.0 * share * share * share + 3.0 * share * share + 3.0 * share + 1.0) / 6.0, share * share * share / 6.0};
}

// The sixteen coefficients that a place draws on, and their weights.
struct Drawn {
  std::array<std::size_t, 16> index{};
  std::array<double, 16> weight{};
};

Drawn drawn_at(const PlaceGain& gain, double x_m, double y_m) {
  std::array<std::size_t, 2> from{};
  std::array<std::array<double, 4>, 2> weights{};
  const double place[2] = {x_m, y_m};
  for (std::size_t a = 0; a < 2; ++a) {
    const double last = static_cast<double>(gain.intervals[a]);
    const double at = std::clamp((place[a] - gain.first_m[a]) / gain.spacing_m, 0.0, last);
    from[a] = std::min(static_cast<std::size_t>(at), gain.intervals[a] - 1);
    weights[a] = cubic(at - static_cast<double>(from[a]));
  }
  Drawn drawn;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      drawn.index[4 * i + j] = (from[0] + i) * (gain.intervals[1] + 3) + from[1] + j;
      drawn.weight[4 * i + j] = weights[0][i] * weights[1][j];
    }
  }
  return drawn;
}

bool touches(const FeltSeries& felt, const Response& response, std::size_t i) {
  return felt.depth_m[i] >= response.contact_m;
}

// Least and largest place in contact along axis 1 and 2.
using Range = std::array<std::array<double, 2>, 2>;
std::optional<Range> explored(const FeltSeries& felt, const Response& response) {
  Range range;
  for (auto& r : range) r = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < felt.size(); ++i) {
    if (!touches(felt, response, i)) continue;
    for (std::size_t a = 0; a < 2; ++a) {
      range[a][0] = std::min(range[a][0], felt.place_m[a][i]);
      range[a][1] = std::max(range[a][1], felt.place_m[a][i]);
    }
  }
  if (!(std::max(range[0][1] - range[0][0], range[1][1] - range[1][0]) > kFinestPlace_m)) return std::nullopt;
  return range;
}

}  // namespace

double PlaceGain::of(const FeltSeries& felt, std::size_t i) const {
  if (coefficients.empty()) return 1.0;
  const Drawn drawn = drawn_at(*this, felt.place_m[0][i], felt.place_m[1][i]);
  double sum = 0.0;
  for (std::size_t k = 0; k < drawn.index.size(); ++k) sum += drawn.weight[k] * coefficients[drawn.index[k]];
  return sum;
}

std::optional<PlaceGain> place_gain(const FeltSeries& felt, const Response& response) {
  const auto range = explored(felt, response);
  if (!range) return std::nullopt;
  PlaceGain gain;
  const double side_m[2] = {(*range)[0][1] - (*range)[0][0], (*range)[1][1] - (*range)[1][0]};
  gain.spacing_m = std::max(side_m[0], side_m[1]) / kIntervals;
  for (std::size_t a = 0; a < 2; ++a) {
    gain.first_m[a] = (*range)[a][0];
    gain.intervals[a] = static_cast<std::size_t>(std::max(1.0, std::ceil(side_m[a] / gain.spacing_m * (1.0 - 1e-12))));
  }
  const auto n = static_cast<Eigen::Index>((gain.intervals[0] + 3) * (gain.intervals[1] + 3));
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  const double* const force_N = felt.force_N[0].data();
  // Places are smoothed: ten samples of a stretch say as much of them as all.
  const auto step = static_cast<std::size_t>(std::max(1.0, std::floor(0.1 * kStretch_s * felt.rate_Hz)));
  for (std::size_t i = 0; i < felt.size(); i += step) {
    if (!touches(felt, response, i)) continue;
    const double before = response.gain.of(felt, i);
    const double even_N = expected_force_N(response, felt, response.contact_m, i)[0] / before;
    const Drawn drawn = drawn_at(gain, felt.place_m[0][i], felt.place_m[1][i]);
    for (std::size_t k = 0; k < drawn.index.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(drawn.index[k]);
      const double own = drawn.weight[k] * even_N;
      right(row) += own * (force_N[i] - even_N);
      for (std::size_t l = 0; l <= k; ++l)  // indices ascend: the lower triangle
        information(row, static_cast<Eigen::Index>(drawn.index[l])) += own * drawn.weight[l] * even_N;
    }
  }
  // What was not explored stays at 1.
  const double least = 1e-6 * information.diagonal().maxCoeff();
  if (!(least > 0.0)) return std::nullopt;
  information.diagonal().array() += least;
  information.triangularView<Eigen::StrictlyUpper>() = information.transpose();
  const Eigen::VectorXd beyond_1 = solve_symmetric(information, right);
  for (Eigen::Index k = 0; k < n; ++k) gain.coefficients.push_back(1.0 + beyond_1(k));
  // The mean is the curves' own.
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < felt.size(); ++i) {
    if (!touches(felt, response, i)) continue;
    sum += gain.of(felt, i);
    count += 1.0;
  }
  if (!(sum > 0.0)) return std::nullopt;
  for (double& c : gain.coefficients) c *= count / sum;
  return gain;
}

namespace {

// Sums over the stretches of one process in one cell.
struct Seen {
  // Of the force over the expected one: f e, e^2, and of the stretches' (f e)^2, f e e^2, (e^2)^2.
  double product = 0.0;
  double squares = 0.0;
  double product_squares = 0.0;
  double mixed = 0.0;
  double squares_squares = 0.0;
  double depth_m = 0.0;
  double place_m[2] = {0.0, 0.0};
  double samples = 0.0;
  double stretches = 0.0;
  // Of the same motion.
  Vec3 real_N = Vec3::Zero();
  Vec3 rendered_N = Vec3::Zero();
  std::vector<Vec3> apart_N;  // by stretch

  [[nodiscard]] double ratio() const { return product / squares; }
  // Of the ratio of two sums over stretches (Cochran 1977, section 6.4).
  [[nodiscard]] double error() const {
    const double g = ratio();
    const double spread = product_squares - 2.0 * g * mixed + g * g * squares_squares;
    return std::sqrt(std::max(0.0, spread) * stretches / (stretches - 1.0)) / squares;
  }
};

using Key = std::array<std::int64_t, 3>;

// Calls `stretch(key, first, end)` for runs of samples of one cell that are no longer than a stretch.
template <class KeyOf, class Stretch>
void by_stretches(std::size_t samples, double rate_Hz, KeyOf key_of, Stretch stretch) {
  const auto longest = static_cast<std::size_t>(std::max(1.0, std::round(kStretch_s * rate_Hz)));
  std::size_t first = 0;
  while (first < samples) {
    const std::optional<Key> key = key_of(first);
    std::size_t end = first + 1;
    while (key && end < samples && end < first + longest && key_of(end) == key) ++end;
    if (key) stretch(*key, first, end);
    first = end;
  }
}

}  // namespace

double PlaceMap::reach() const {
  const auto looks = std::max<double>(
      1.0, static_cast<double>(std::count_if(cells.begin(), cells.end(), [](const auto& c) { return c.known; })));
  return stats::normal_quantile(1.0 - 0.025 / looks);
}

const PlaceDifference* PlaceMap::strongest() const {
  const PlaceDifference* best = nullptr;
  const double z = reach();
  for (const auto& cell : cells) {
    const double certain = cell.jnd - z * cell.standard_error;
    if (cell.known && certain > 0.0 && (best == nullptr || certain > best->jnd - z * best->standard_error))
      best = &cell;
  }
  return best;
}

namespace {

// Two processes, and what both are seen to do in the cells of the real one's places.
class PlaceComparison {
 public:
  PlaceComparison(const JudgedProcess& real, const JudgedProcess& rendered, bool same_motion,
                  const Thresholds& thresholds, const Range& range, double cell_m)
      : sides_{&real, &rendered},
        same_motion_(same_motion),
        thresholds_(thresholds),
        range_(range),
        cell_m_(cell_m),
        common_m_(std::min(real.response->deepest_m, rendered.response->deepest_m)) {
    for (std::size_t side = 0; side < (same_motion ? 1u : 2u); ++side) {
      const FeltSeries& felt = sides_[side]->felt;
      by_stretches(
          felt.size(), felt.rate_Hz, [&](std::size_t i) { return key_of(*sides_[side], i); },
          [&](const Key& key, std::size_t first, std::size_t end) {
            Seen& in = seen_[key][side];
            in.samples += static_cast<double>(end - first);
            in.stretches += 1.0;
            same_motion ? add_same(in, first, end) : add_own(in, *sides_[side], first, end);
          });
    }
  }

  [[nodiscard]] PlaceMap map() const {
    PlaceMap map;
    map.cell_m = cell_m_;
    for (std::size_t a = 0; a < 2; ++a) map.side[a] = sides_[0]->felt.axis[a + 1];
    double sums[2] = {};
    double shares = 0.0;
    for (const auto& [key, both] : seen_) {
      if (both[0].samples == 0.0) continue;
      map.cells.push_back(same_motion_ ? same(both[0]) : other(key, both));
      PlaceDifference& cell = map.cells.back();
      cell.centre_m = middle(key, 0) * sides_[0]->felt.axis[1] + middle(key, 1) * sides_[0]->felt.axis[2];
      if (same_motion_ || !cell.known) continue;
      shares += cell.share;
      for (std::size_t side = 0; side < 2; ++side) sums[side] += cell.share * both[side].ratio();
    }
    if (shares > 0.0) {
      map.real_mean = sums[0] / shares;
      map.rendered_mean = sums[1] / shares;
    }
    if (map.cells.size() < 2) map.cells.clear();
    return map;
  }

 private:
  [[nodiscard]] std::optional<Key> key_of(const JudgedProcess& own, std::size_t i) const {
    const double d = own.felt.depth_m[i] - own.contact.depth_m;
    if (same_motion_ ? !(d >= 0.0) : !(d >= 0.2 * common_m_ && d <= common_m_)) return std::nullopt;
    const auto cell = [this](double from_m) { return static_cast<std::int64_t>(std::floor(from_m / cell_m_)); };
    return Key{cell(own.felt.place_m[0][i] - range_[0][0]), cell(own.felt.place_m[1][i] - range_[1][0]),
               same_motion_ ? cell(d) : 0};
  }
  [[nodiscard]] double middle(const Key& key, std::size_t a) const {
    return range_[a][0] + (static_cast<double>(key[a]) + 0.5) * cell_m_;
  }

  void add_same(Seen& in, std::size_t first, std::size_t end) const {
    Vec3 apart = Vec3::Zero();
    for (std::size_t i = first; i < end; ++i) {
      const auto force_of = [i](const FeltSeries& f) {
        return Vec3(f.force_N[0][i], f.force_N[1][i], f.force_N[2][i]);
      };
      in.depth_m += sides_[0]->felt.depth_m[i] - sides_[0]->contact.depth_m;
      in.real_N += force_of(sides_[0]->felt);
      in.rendered_N += force_of(sides_[1]->felt);
      apart += force_of(sides_[1]->felt) - force_of(sides_[0]->felt);
    }
    in.apart_N.push_back(apart / static_cast<double>(end - first));
  }

  // Against its own force over depth, without its gain.
  static void add_own(Seen& in, const JudgedProcess& own, std::size_t first, std::size_t end) {
    double product = 0.0;
    double squares = 0.0;
    for (std::size_t i = first; i < end; ++i) {
      in.depth_m += own.felt.depth_m[i] - own.contact.depth_m;
      for (std::size_t a = 0; a < 2; ++a) in.place_m[a] += own.felt.place_m[a][i];
      const double even_N =
          expected_force_N(*own.response, own.felt, own.contact.depth_m, i)[0] / own.response->gain.of(own.felt, i);
      product += own.felt.force_N[0][i] * even_N;
      squares += even_N * even_N;
    }
    in.product += product;
    in.squares += squares;
    in.product_squares += product * product;
    in.mixed += product * squares;
    in.squares_squares += squares * squares;
  }

  [[nodiscard]] PlaceDifference same(const Seen& both) const {
    PlaceDifference cell;
    cell.known = both.stretches >= kFewestStretches;
    cell.depth_m = both.depth_m / both.samples;
    cell.real_N = both.real_N.norm() / both.samples;
    cell.rendered_N = both.rendered_N.norm() / both.samples;
    cell.share = both.samples / static_cast<double>(sides_[0]->felt.size());
    const Vec3 apart = (both.rendered_N - both.real_N) / both.samples;
    const double apart_N = apart.norm();
    const Vec3 along = apart_N > 0.0 ? Vec3(apart / apart_N) : Vec3::UnitX();
    double squares = 0.0;
    for (const Vec3& of_stretch : both.apart_N) squares += std::pow(of_stretch.dot(along) - apart_N, 2);
    const double error_N = std::sqrt(squares / (both.stretches * std::max(1.0, both.stretches - 1.0)));
    if (cell.known) count(cell, apart_N, error_N, std::abs(along.x()));
    return cell;
  }

  // By how much the ratio of either side may be another within a cell, as standard error: along each axis what it
  // differs by from the cells beside, all of it where there are none, as far as the two were at different places of
  // this one. A step may lie between them: half a cell apart, it counts whole.
  [[nodiscard]] double within_cell(const Key& key, const std::array<Seen, 2>& both) const {
    constexpr double kBound = 0.5;
    double error = 0.0;
    for (std::size_t a = 0; a < 2; ++a) {
      const double apart_m = std::abs(both[0].place_m[a] / both[0].samples - both[1].place_m[a] / both[1].samples);
      double most = -1.0;
      for (const std::int64_t step : {-1, 1}) {
        Key beside = key;
        beside[a] += step;
        const auto found = seen_.find(beside);
        for (std::size_t side = 0; found != seen_.end() && side < 2; ++side) {
          const Seen& there = found->second[side];
          if (there.squares > 0.0) most = std::max(most, std::abs(there.ratio() - both[side].ratio()));
        }
      }
      error += kBound * (most < 0.0 ? 1.0 : most) * std::min(1.0, 2.0 * apart_m / cell_m_);
    }
    return error;
  }

  // How far a ratio lies outside all that a side has in this cell and those around it: within a cell an edge may lie
  // anywhere.
  [[nodiscard]] double beyond(double ratio, const Key& key, std::size_t side) const {
    double least = std::numeric_limits<double>::infinity();
    double most = -least;
    for (const std::int64_t x : {-1, 0, 1}) {
      for (const std::int64_t y : {-1, 0, 1}) {
        const auto found = seen_.find({key[0] + x, key[1] + y, key[2]});
        if (found == seen_.end() || !(found->second[side].squares > 0.0)) continue;
        least = std::min(least, found->second[side].ratio());
        most = std::max(most, found->second[side].ratio());
      }
    }
    return std::max({0.0, least - ratio, ratio - most});
  }

  [[nodiscard]] PlaceDifference other(const Key& key, const std::array<Seen, 2>& both) const {
    PlaceDifference cell;
    const Seen& own = both[0];
    const Seen& other = both[1];
    cell.known =
        std::min(own.stretches, other.stretches) >= kFewestStretches && std::min(own.squares, other.squares) > 0.0;
    if (!cell.known) return cell;
    cell.depth_m = std::min(own.depth_m / own.samples, other.depth_m / other.samples);
    const double real_even_N = steady_force_N(*sides_[0]->response, *sides_[1]->response, cell.depth_m);
    const double rendered_even_N = steady_force_N(*sides_[1]->response, *sides_[0]->response, cell.depth_m);
    cell.share = std::min(own.samples / static_cast<double>(sides_[0]->felt.size()),
                          other.samples / static_cast<double>(sides_[1]->felt.size()));
    cell.real_N = own.ratio() * real_even_N;
    cell.rendered_N = other.ratio() * rendered_even_N;
    const double larger_even_N = std::max(real_even_N, rendered_even_N);
    const double apart_N = std::max(beyond(cell.real_N / rendered_even_N, key, 1) * rendered_even_N,
                                    beyond(cell.rendered_N / real_even_N, key, 0) * real_even_N);
    count(
        cell, apart_N,
        std::hypot(own.error() * real_even_N, other.error() * rendered_even_N, within_cell(key, both) * larger_even_N),
        1.0);
    return cell;
  }

  // An error of the depth looks like a force along the direction of pressing, not like one across: `along` of it.
  void count(PlaceDifference& cell, double apart_N, double error_N, double along) const {
    const NoticeableSteps steps(thresholds_.force);
    const Response& response = *sides_[0]->response;
    const double larger = std::max(cell.real_N, cell.rendered_N);
    const double exponent =
        along * depth_exponent(response.curves, cell.depth_m, 0.1 * response.deepest_m, response.grid);
    const auto jnd_of = [&](double difference_N) {
      const double smaller = std::max(0.0, larger - difference_N);
      return force_at_depth_jnd(steps(larger) - steps(smaller), larger, smaller, exponent, thresholds_);
    };
    cell.jnd = jnd_of(apart_N);
    cell.standard_error = jnd_of(apart_N + error_N) - cell.jnd;
  }

  const JudgedProcess* sides_[2];
  bool same_motion_;
  const Thresholds& thresholds_;
  const Range& range_;
  double cell_m_;
  double common_m_;
  std::map<Key, std::array<Seen, 2>> seen_;
};

}  // namespace

PlaceMap place_map(const JudgedProcess& real, const JudgedProcess& rendered, bool same_motion,
                   const Thresholds& thresholds) {
  const auto range = explored(real.felt, *real.response);
  if (!range) return {};
  const double side_m = std::max((*range)[0][1] - (*range)[0][0], (*range)[1][1] - (*range)[1][0]);
  return PlaceComparison(real, rendered, same_motion, thresholds, *range, side_m / kCells).map();
}

std::string describe_place(const PlaceMap& map, const PlaceDifference& strongest) {
  const bool more = strongest.rendered_N > strongest.real_N;
  // A place is known to a cell: no digit below a tenth of it. (Adding 0 takes the sign off a zero.)
  const double step_mm = std::pow(10.0, std::floor(std::log10(1e3 * map.cell_m / 10.0)));
  const auto rounded_mm = [step_mm](double x_m) { return step_mm * std::round(1e3 / step_mm * x_m) + 0.0; };
  const Vec3 at_mm = strongest.centre_m.unaryExpr(rounded_mm);
  std::string text = fmt::format(
      "{:.3g} N instead of {:.3g} N ({:+.3g} %) near ({:.3g}, {:.3g}, {:.3g}) mm", strongest.rendered_N,
      strongest.real_N, 100.0 * (strongest.rendered_N / strongest.real_N - 1.0), at_mm.x(), at_mm.y(), at_mm.z());
  std::size_t known = 0;
  std::size_t alike = 0;
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = -low;
  Vec3 own_low = low;
  Vec3 own_high = high;
  for (const auto& cell : map.cells) {
    if (!cell.known) continue;
    ++known;
    low = low.cwiseMin(cell.centre_m);
    high = high.cwiseMax(cell.centre_m);
    if (!(cell.jnd > 1.0) || (cell.rendered_N > cell.real_N) != more) continue;
    ++alike;
    own_low = own_low.cwiseMin(cell.centre_m);
    own_high = own_high.cwiseMax(cell.centre_m);
  }
  if (alike == 0) return text;
  text += fmt::format("; {} in {} of {} places", more ? "stiffer" : "softer", alike, known);
  // On one half of what both explored, along the frame's axis that it is longest in.
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const double middle = 0.5 * (low[axis] + high[axis]);
  const char name = "xyz"[axis];
  if (own_low[axis] > middle)
    text += fmt::format(", all where {} is above {:.3g} mm", name, rounded_mm(own_low[axis] - 0.5 * map.cell_m));
  if (own_high[axis] < middle)
    text += fmt::format(", all where {} is below {:.3g} mm", name, rounded_mm(own_high[axis] + 0.5 * map.cell_m));
  return text;
}

}  // namespace touchstone::perception
