#include "harness/perception/judge/place.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <tuple>

#include "harness/perception/judge/judge.h"
#include "harness/perception/judge/slow_channels.h"
#include "harness/stats/distributions.h"

namespace touchstone::perception {
namespace {

constexpr double cells_per_side = 10.0;  // of the longer side of what was explored
constexpr double stretch_s = 0.02;       // the smoothing of positions
constexpr double fewest_stretches = 3.0;

// A run of samples of one process in one cell: the force f against an expected one e, summed. Of friction both lie
// across the direction of pressing.
struct Stretch {
  double samples = 0.0;
  double product = 0.0;  // f . e
  double squares = 0.0;  // e . e
  Vec3 force = Vec3::Zero();
  Vec3 expected = Vec3::Zero();
};

struct Seen {
  std::vector<Stretch> stretches;
  double samples = 0.0;
  double product = 0.0;
  double squares = 0.0;
  double depth_m = 0.0;
  double place_m[2] = {0.0, 0.0};
  // Of friction.
  double load_N = 0.0;
  double speed_m2_per_s2 = 0.0;
  Vec3 towards = Vec3::Zero();
  // Of the same motion.
  Vec3 real_N = Vec3::Zero();
  Vec3 rendered_N = Vec3::Zero();
  Vec3 apart_sum_N = Vec3::Zero();  // without the friction of either
  std::vector<Vec3> apart_N;        // by stretch

  void add(const Stretch& own) {
    stretches.push_back(own);
    samples += own.samples;
    product += own.product;
    squares += own.squares;
  }
  [[nodiscard]] double count() const { return static_cast<double>(stretches.size()); }
  [[nodiscard]] double ratio() const { return product / squares; }
  // Of the ratio of two sums over stretches (Cochran 1977, section 6.4).
  [[nodiscard]] double error() const {
    double spread = 0.0;
    for (const Stretch& own : stretches) spread += std::pow(own.product - ratio() * own.squares, 2);
    return std::sqrt(spread * count() / (count() - 1.0)) / squares;
  }
  // Against the means of the cell: a force across that does not turn with the motion is no friction. Nothing is left of
  // sliding one way.
  void take_means_off() {
    Stretch sum;
    for (const Stretch& own : stretches) {
      sum.force += own.force;
      sum.expected += own.expected;
    }
    const bool one_way = towards.norm() >= one_way_share * samples;
    product = squares = 0.0;
    for (Stretch& own : stretches) {
      const Vec3 mean_force = sum.force / samples;
      const Vec3 mean_expected = sum.expected / samples;
      own.product +=
          own.samples * mean_force.dot(mean_expected) - mean_force.dot(own.expected) - mean_expected.dot(own.force);
      own.squares += own.samples * mean_expected.squaredNorm() - 2.0 * mean_expected.dot(own.expected);
      product += one_way ? 0.0 : own.product;
      squares += one_way ? 0.0 : own.squares;
    }
  }
};

using Key = std::array<std::int64_t, 3>;

// Calls `stretch(key, first, end)` for runs of samples of one cell that are no longer than a stretch.
template <class KeyOf, class Stretch>
void by_stretches(std::size_t samples, double rate_Hz, KeyOf key_of, Stretch stretch) {
  const auto longest = static_cast<std::size_t>(std::max(1.0, std::round(stretch_s * rate_Hz)));
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

double PlaceMap::reach(const PlaceDifference& cell) const {
  const auto looks = std::max<double>(
      1.0, static_cast<double>(std::count_if(cells.begin(), cells.end(), [](const auto& c) { return c.known; })));
  return std::hypot(stats::normal_quantile(1.0 - 0.025 / looks) * cell.standard_error, normal95 * cell.by_hand);
}

const PlaceDifference* PlaceMap::strongest() const {
  const PlaceDifference* best = nullptr;
  double most = 0.0;
  for (const auto& cell : cells) {
    const double certain = cell.known ? cell.jnd - reach(cell) : 0.0;
    if (!(certain > most)) continue;
    most = certain;
    best = &cell;
  }
  return best;
}

namespace {

enum class Compared : unsigned char {
  whole_force,  // of one motion
  force,
  friction,
};

// Two processes, and what both are seen to do in the cells of the real one's places.
class PlaceComparison {
 public:
  PlaceComparison(const JudgedProcess& real, const JudgedProcess& rendered, Compared compared, bool same_motion,
                  const Thresholds& thresholds, const PlaceRange& range, double cell_m)
      : sides_{&real, &rendered},
        compared_(compared),
        same_motion_(same_motion),
        thresholds_(thresholds),
        range_(range),
        cell_m_(cell_m),
        common_m_(std::min(real.response->deepest_m, rendered.response->deepest_m)) {
    for (std::size_t side = 0; side < (compared == Compared::whole_force ? 1u : 2u); ++side) {
      const FeltSeries& felt = sides_[side]->felt;
      by_stretches(
          felt.size(), felt.rate_Hz, [&](std::size_t i) { return key_of(*sides_[side], i); },
          [&](const Key& key, std::size_t first, std::size_t end) {
            Seen& in = seen_[key][side];
            for (std::size_t i = first; i < end; ++i) {
              in.depth_m += felt.depth_m[i] - sides_[side]->contact.depth_m;
              for (std::size_t a = 0; a < 2; ++a) in.place_m[a] += felt.place_m[a][i];
            }
            if (compared == Compared::whole_force) return add_same(in, first, end);
            if (compared == Compared::friction) return add_friction(in, felt, first, end);
            add_own(in, *sides_[side], first, end);
          });
    }
    if (compared != Compared::friction) return;
    for (auto& [key, both] : seen_) {
      for (Seen& own : both) own.take_means_off();
    }
  }

  [[nodiscard]] PlaceMap map() const {
    PlaceMap map;
    if (compared_ == Compared::friction) {
      map.quantity = "friction";
      map.more = "more friction";
      map.less = "less friction";
    }
    map.cell_m = cell_m_;
    for (std::size_t a = 0; a < 2; ++a) map.side[a] = sides_[0]->felt.axis[a + 1];
    double sums[2] = {};
    double shares = 0.0;
    for (const auto& [key, both] : seen_) {
      if (both[0].samples == 0.0) continue;
      map.cells.push_back(compared_ == Compared::whole_force ? same(both[0]) : other(key, both));
      PlaceDifference& cell = map.cells.back();
      cell.centre_m = middle(key, 0) * sides_[0]->felt.axis[1] + middle(key, 1) * sides_[0]->felt.axis[2];
      if (compared_ != Compared::force || !cell.known) continue;
      shares += cell.share;
      for (std::size_t side = 0; side < 2; ++side) sums[side] += cell.share * both[side].ratio();
    }
    if (shares > 0.0) {
      map.real_mean = sums[0] / shares;
      map.rendered_mean = sums[1] / shares;
    }
    map.uneven = compared_ == Compared::friction ? uneven_friction()
                                                 : !sides_[0]->response->gain.coefficients.empty() ||
                                                       !sides_[1]->response->gain.coefficients.empty();
    if (map.cells.size() < 2) map.cells.clear();
    return map;
  }

 private:
  [[nodiscard]] std::optional<Key> key_of(const JudgedProcess& own, std::size_t i) const {
    const double d = own.felt.depth_m[i] - own.contact.depth_m;
    const bool whole = compared_ == Compared::whole_force;
    if (!(d >= (whole ? 0.0 : 0.2 * common_m_))) return std::nullopt;
    // Friction is taken to one load, whatever the depth.
    if (compared_ == Compared::friction ? !slides(own.felt, i) : !whole && d > common_m_) return std::nullopt;
    const auto cell = [this](double from_m) { return static_cast<std::int64_t>(std::floor(from_m / cell_m_)); };
    return Key{cell(own.felt.place_m[0][i] - range_[0][0]), cell(own.felt.place_m[1][i] - range_[1][0]),
               whole ? cell(d) : 0};
  }
  [[nodiscard]] double middle(const Key& key, std::size_t a) const {
    return range_[a][0] + (static_cast<double>(key[a]) + 0.5) * cell_m_;
  }

  // By the response: what the channel of friction compares.
  [[nodiscard]] Vec3 friction_N(std::size_t side, std::size_t i) const {
    const FeltSeries& felt = sides_[side]->felt;
    const Response& response = *sides_[side]->response;
    const double against_N =
        at_depth(response.curves.friction_N, felt.depth_m[i] - sides_[side]->contact.depth_m, response.grid);
    return response.gain.of(felt, i) * against_N * Vec3(0.0, felt.slide_x[i], felt.slide_y[i]);
  }

  void add_same(Seen& in, std::size_t first, std::size_t end) const {
    Vec3 apart = Vec3::Zero();
    for (std::size_t i = first; i < end; ++i) {
      const auto force_of = [i](const FeltSeries& f) {
        return Vec3(f.force_N[0][i], f.force_N[1][i], f.force_N[2][i]);
      };
      in.real_N += force_of(sides_[0]->felt);
      in.rendered_N += force_of(sides_[1]->felt);
      apart += force_of(sides_[1]->felt) - force_of(sides_[0]->felt) - friction_N(1, i) + friction_N(0, i);
    }
    in.add({.samples = static_cast<double>(end - first)});
    in.apart_sum_N += apart;
    in.apart_N.push_back(apart / static_cast<double>(end - first));
  }

  // Against its own force over depth, without its gain.
  static void add_own(Seen& in, const JudgedProcess& own, std::size_t first, std::size_t end) {
    Stretch sum{.samples = static_cast<double>(end - first)};
    for (std::size_t i = first; i < end; ++i) {
      const double even_N =
          expected_force_N(*own.response, own.felt, own.contact.depth_m, i)[0] / own.response->gain.of(own.felt, i);
      sum.product += own.felt.force_N[0][i] * even_N;
      sum.squares += even_N * even_N;
    }
    in.add(sum);
  }

  // Against the load, by Amontons' law.
  static void add_friction(Seen& in, const FeltSeries& felt, std::size_t first, std::size_t end) {
    Stretch sum{.samples = static_cast<double>(end - first)};
    double load_N = 0.0;
    for (std::size_t i = first; i < end; ++i) load_N += felt.force_N[0][i] / sum.samples;
    for (std::size_t i = first; i < end; ++i) {
      const Vec3 towards(0.0, felt.slide_x[i], felt.slide_y[i]);
      const Vec3 across_N(0.0, felt.force_N[1][i], felt.force_N[2][i]);
      const Vec3 expected_N = -load_N * towards;
      sum.product += across_N.dot(expected_N);
      sum.squares += expected_N.squaredNorm();
      sum.force += across_N;
      sum.expected += expected_N;
      in.towards += towards;
      in.speed_m2_per_s2 += felt.slide_m_per_s[i] * felt.slide_m_per_s[i];
    }
    in.load_N += sum.samples * load_N;
    in.add(sum);
  }

  // Whether one of the two certainly rubs more in one place than in another, by what is noticed.
  [[nodiscard]] bool uneven_friction() const {
    const double z = stats::normal_quantile(1.0 - 0.025 / std::max<double>(1.0, static_cast<double>(seen_.size())));
    for (std::size_t side = 0; side < 2; ++side) {
      double least = std::numeric_limits<double>::infinity();
      double most = 0.0;
      for (const auto& [key, both] : seen_) {
        const Seen& own = both[side];
        if (own.count() < fewest_stretches || !(own.squares > 0.0)) continue;
        least = std::min(least, own.ratio() + z * own.error());
        most = std::max(most, own.ratio() - z * own.error());
      }
      if (most > (1.0 + thresholds_.friction_fraction) * least) return true;
    }
    return false;
  }

  [[nodiscard]] PlaceDifference same(const Seen& both) const {
    PlaceDifference cell;
    cell.known = both.count() >= fewest_stretches;
    cell.depth_m = both.depth_m / both.samples;
    cell.real_N = both.real_N.norm() / both.samples;
    cell.rendered_N = both.rendered_N.norm() / both.samples;
    cell.share = both.samples / static_cast<double>(sides_[0]->felt.size());
    const Vec3 apart = both.apart_sum_N / both.samples;
    const double apart_N = apart.norm();
    const Vec3 along = apart_N > 0.0 ? Vec3(apart / apart_N) : Vec3::UnitX();
    double squares = 0.0;
    for (const Vec3& of_stretch : both.apart_N) squares += std::pow(of_stretch.dot(along) - apart_N, 2);
    const double error_N = std::sqrt(squares / (both.count() * std::max(1.0, both.count() - 1.0)));
    if (cell.known) count(cell, apart_N, error_N, std::abs(along.x()));
    return cell;
  }

  // By how much the ratio of either side may be another within a cell, as standard error: along each axis what it
  // differs by from the cells beside, all of it where there are none, as far as the two were at different places of
  // this one. A step may lie between them: half a cell apart, it counts whole.
  [[nodiscard]] double within_cell(const Key& key, const std::array<Seen, 2>& both) const {
    constexpr double bound = 0.5;
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
      error += bound * (most < 0.0 ? 1.0 : most) * std::min(1.0, 2.0 * apart_m / cell_m_);
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
    cell.known = std::min(own.count(), other.count()) >= fewest_stretches && std::min(own.squares, other.squares) > 0.0;
    if (!cell.known) return cell;
    cell.depth_m = std::min(own.depth_m / own.samples, other.depth_m / other.samples);
    cell.share = std::min(own.samples / static_cast<double>(sides_[0]->felt.size()),
                          other.samples / static_cast<double>(sides_[1]->felt.size()));
    const bool friction = compared_ == Compared::friction;
    const double load_N = std::min(own.load_N / own.samples, other.load_N / other.samples);
    const auto even_N = [&](std::size_t side) {
      return friction ? load_N : steady_force_N(*sides_[side]->response, *sides_[1 - side]->response, cell.depth_m);
    };
    const double real_even_N = even_N(0);
    const double rendered_even_N = even_N(1);
    cell.real_N = own.ratio() * real_even_N;
    cell.rendered_N = other.ratio() * rendered_even_N;
    const double larger_even_N = std::max(real_even_N, rendered_even_N);
    const double apart_N = std::max(beyond(cell.real_N / rendered_even_N, key, 1) * rendered_even_N,
                                    beyond(cell.rendered_N / real_even_N, key, 0) * real_even_N);
    const double error_N =
        std::hypot(own.error() * real_even_N, other.error() * rendered_even_N, within_cell(key, both) * larger_even_N);
    if (!friction) {
      count(cell, apart_N, error_N, 1.0);
      return cell;
    }
    const double larger_N = std::max(cell.real_N, cell.rendered_N);
    const auto jnd_of = [&](double difference_N) {
      return friction_jnd(larger_N, larger_N - difference_N, difference_N, load_N, thresholds_);
    };
    cell.jnd = jnd_of(apart_N);
    cell.standard_error = jnd_of(apart_N + error_N) - cell.jnd;
    if (same_motion_) return cell;
    const double speeds = (other.speed_m2_per_s2 / other.samples) / (own.speed_m2_per_s2 / own.samples);
    const double loads = load_N / std::max(own.load_N / own.samples, other.load_N / other.samples);
    cell.by_hand = friction_by_hand_jnd(larger_N, loads, std::sqrt(speeds), load_N, thresholds_);
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
  Compared compared_;
  bool same_motion_;
  const Thresholds& thresholds_;
  const PlaceRange& range_;
  double cell_m_;
  double common_m_;
  std::map<Key, std::array<Seen, 2>> seen_;
};

}  // namespace

PlaceMaps place_maps(const JudgedProcess& real, const JudgedProcess& rendered, bool same_motion,
                     const Thresholds& thresholds) {
  const auto range = explored(real.felt, *real.response);
  if (!range) return {};
  const double side_m = std::max((*range)[0][1] - (*range)[0][0], (*range)[1][1] - (*range)[1][0]);
  const auto map = [&](Compared compared) {
    return PlaceComparison(real, rendered, compared, same_motion, thresholds, *range, side_m / cells_per_side).map();
  };
  return {map(same_motion ? Compared::whole_force : Compared::force), map(Compared::friction)};
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
  text += fmt::format("; {} in {} of {} places", more ? map.more : map.less, alike, known);
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
