#include "harness/golden/comparison/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>

#include "harness/golden/comparison/contact_events.h"

namespace touchstone::golden {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

constexpr std::size_t block = 256;  // rows that are looked at together

using Series = std::span<const double>;

// The columns of one group on both sides.
struct Pair {
  std::size_t axes = 0;
  std::array<Series, 4> expected{};
  std::array<Series, 4> obtained{};
};

// error / bound, where 0/0 is agreement and anything else over 0, or not a number, is unbounded.
double used(double error, double bound) noexcept {
  if (error == 0.0) return 0.0;
  const double ratio = error / bound;
  return ratio <= std::numeric_limits<double>::max() ? ratio : infinity;
}

double squared_norm(const std::array<Series, 4>& columns, std::size_t axes, std::size_t row) noexcept {
  double sum = 0.0;
  for (std::size_t a = 0; a < axes; ++a) sum += columns[a][row] * columns[a][row];
  return sum;
}

double norm(const std::array<Series, 4>& columns, std::size_t axes, std::size_t row) noexcept {
  return std::sqrt(squared_norm(columns, axes, row));
}

bool same_bits(const Pair& pair, std::size_t row, std::size_t count = 1) noexcept {
  for (std::size_t a = 0; a < pair.axes; ++a) {
    if (std::memcmp(&pair.expected[a][row], &pair.obtained[a][row], count * sizeof(double)) != 0) return false;
  }
  return true;
}

double largest_norm(const std::array<Series, 4>& columns, std::size_t axes) noexcept {
  std::array<double, block> square{};
  std::array<double, 8> largest{};
  const std::size_t rows = columns[0].size();
  for (std::size_t row = 0; row < rows; row += block) {
    const std::size_t count = std::min(block, rows - row);
    square.fill(0.0);
    for (std::size_t a = 0; a < axes; ++a) {
      const double* const column = &columns[a][row];
      for (std::size_t i = 0; i < count; ++i) square[i] += column[i] * column[i];
    }
    for (std::size_t i = 0; i < block; i += largest.size()) {
      for (std::size_t lane = 0; lane < largest.size(); ++lane) {
        largest[lane] = largest[lane] < square[i + lane] ? square[i + lane] : largest[lane];
      }
    }
  }
  return std::sqrt(std::ranges::max(largest));
}

// The angle of the rotation between two unit quaternions; q and -q are one rotation.
double rotation_angle(const Pair& pair, std::size_t row) noexcept {
  double plus = 0.0;
  double minus = 0.0;
  for (std::size_t a = 0; a < 4; ++a) {
    plus += std::pow(pair.obtained[a][row] + pair.expected[a][row], 2);
    minus += std::pow(pair.obtained[a][row] - pair.expected[a][row], 2);
  }
  return 4.0 * std::atan2(std::sqrt(std::min(plus, minus)), std::sqrt(std::max(plus, minus)));
}

// Distance of the obtained value from the golden values of the rows allowed; the sign tells on which side it lies.
double band_error(Series golden, double obtained, std::pair<std::size_t, std::size_t> rows) noexcept {
  if (rows.first == rows.second) return obtained - golden[rows.first];
  const auto [low, high] = std::ranges::minmax(golden.subspan(rows.first, rows.second - rows.first + 1));
  return obtained < low ? obtained - low : obtained > high ? obtained - high : obtained - obtained;
}

// Per-sample errors of one row: the largest share of the bound that any axis, the magnitude or the direction uses, and
// the length of the error.
struct RowError {
  double share = 0.0;
  double length = 0.0;
};

RowError row_error(const Pair& pair, std::size_t row, const GroupTolerance& limits, double peak, const TimeTube& tube,
                   std::array<double, 4>& axis_square) {
  RowError error;
  double square = 0.0;
  const auto rows = tube.rows(row);
  for (std::size_t a = 0; a < pair.axes; ++a) {
    const double difference = band_error(pair.expected[a], pair.obtained[a][row], rows);
    const double bound = limits.atol + limits.rtol * std::abs(pair.expected[a][row]) + limits.rpeak * peak;
    error.share = std::max(error.share, used(std::abs(difference), bound));
    axis_square[a] += difference * difference;
    square += difference * difference;
  }
  error.length = std::sqrt(square);
  if (pair.axes < 3 || rows.first != rows.second) return error;
  const double golden = norm(pair.expected, pair.axes, row);
  const double obtained = norm(pair.obtained, pair.axes, row);
  const double bound = limits.atol + limits.rtol * golden + limits.rpeak * peak;
  error.share = std::max(error.share, used(std::abs(obtained - golden), bound));
  if (limits.direction_rad && golden > limits.direction_floor) {
    const Vec3 e(pair.expected[0][row], pair.expected[1][row], pair.expected[2][row]);
    const Vec3 o(pair.obtained[0][row], pair.obtained[1][row], pair.obtained[2][row]);
    const double angle = obtained > 0.0 ? std::atan2(e.cross(o).norm(), e.dot(o)) : infinity;
    error.share = std::max(error.share, used(angle, *limits.direction_rad));
  }
  return error;
}

void fill_worst(const Pair& pair, GroupResult& result) {
  for (std::size_t a = 0; a < pair.axes; ++a) {
    result.worst_expected.push_back(pair.expected[a][result.worst_row]);
    result.worst_obtained.push_back(pair.obtained[a][result.worst_row]);
  }
}

void add_gates(const GroupTolerance& limits, GroupResult& result) {
  const auto add = [&](const char* name, double value, const std::optional<double>& limit) {
    if (!limit) return;
    result.gates.push_back({fmt::format("{}_{}", name, result.unit), value, *limit});
    result.tolerance_used = std::max(result.tolerance_used, used(value, *limit));
    if (!result.gates.back().passed()) result.verdict = worst(result.verdict, Verdict::worse);
  };
  add("rms", result.rms, limits.rms);
  add("p99", result.p99, limits.p99);
  add("max", result.max, limits.max);
}

// Marks in `drifted` the rows in which some bit differs.
GroupResult compare_group(const ComparedQuantity& group, const Pair& pair, const GroupTolerance& limits,
                          const TimeTube& tube, std::vector<unsigned char>& drifted) {
  GroupResult result;
  result.quantity = group.id;
  result.group = group.name;
  result.unit = group.unit;
  const std::size_t rows = pair.expected[0].size();
  result.peak = largest_norm(pair.expected, pair.axes);

  std::vector<double> lengths;  // empty where nothing differs
  std::vector<double> shares;
  std::array<double, 4> axis_square{};
  double square = 0.0;
  double worst_share = 0.0;
  for (std::size_t row = 0; row < rows; ++row) {
    // The same bits lie inside every bound; most rows of most comparisons are such.
    if (row % block == 0 && same_bits(pair, row, std::min(block, rows - row))) {
      row += block - 1;
      continue;
    }
    if (same_bits(pair, row)) continue;
    if (lengths.empty()) lengths.resize(rows);
    ++result.drift;
    drifted[row] = 1;
    RowError error = row_error(pair, row, limits, result.peak, tube, axis_square);
    if (group.id == Quantity::orientation) {
      error.length = rotation_angle(pair, row);
      error.share = used(error.length, limits.atol);
    }
    lengths[row] = error.length;
    square += error.length * error.length;
    if (!(error.share <= 1.0)) {
      ++result.beyond;
      shares.push_back(error.share);
    } else {
      result.tolerance_used = std::max(result.tolerance_used, error.share);
    }
    if (error.share > worst_share) {
      worst_share = error.share;
      result.worst_row = row;
    }
  }
  const double count = static_cast<double>(rows);
  result.rms = std::sqrt(square / count);
  for (std::size_t a = 0; a < pair.axes; ++a) result.axis_rms[a] = std::sqrt(axis_square[a] / count);
  if (!lengths.empty()) {
    const auto p99 = lengths.begin() + static_cast<std::ptrdiff_t>(std::ceil(0.99 * count)) - 1;
    std::ranges::nth_element(lengths, p99);
    result.p99 = *p99;
    result.max = *std::max_element(p99, lengths.end());
  }
  if (!(result.beyond <= limits.beyond)) {
    // The tolerance that would have been needed is that of the first sample that is one too many.
    std::ranges::nth_element(shares, shares.begin() + static_cast<std::ptrdiff_t>(limits.beyond), std::greater<>{});
    result.tolerance_used = std::max(result.tolerance_used, shares[limits.beyond]);
    result.verdict = Verdict::worse;
  }
  add_gates(limits, result);
  fill_worst(pair, result);
  return result;
}

// A number that is not finite times zero is none, and a sum stays none: several at once, without a way out of the loop.
bool all_finite(Series values) noexcept {
  std::array<double, 8> sums{};
  std::size_t i = 0;
  for (; i + sums.size() <= values.size(); i += sums.size()) {
    for (std::size_t lane = 0; lane < sums.size(); ++lane) sums[lane] += 0.0 * values[i + lane];
  }
  for (; i < values.size(); ++i) sums[0] += 0.0 * values[i];
  return std::ranges::all_of(sums, [](double sum) { return sum == 0.0; });
}

// Not finite anywhere: the first place, as a sentence.
std::optional<std::string> not_finite(const TrajectoryColumns& set) {
  for (const TrajectoryColumn& column : set.columns) {
    if (all_finite(column.values)) continue;
    for (std::size_t row = 0; row < column.values.size(); ++row) {
      if (!std::isfinite(column.values[row])) {
        return fmt::format("{}: column {}, row {}: the value is {}", set.source, column.name, row + 1,
                           column.values[row]);
      }
    }
  }
  return std::nullopt;
}

void check_shape(const TrajectoryColumns& expected, const TrajectoryColumns& obtained, Comparison& result) {
  const auto problem = [&](Verdict verdict, std::string text) {
    result.verdict = worst(result.verdict, verdict);
    result.problems.push_back(std::move(text));
  };
  if (expected.columns.empty())
    problem(Verdict::missing, fmt::format("{}: has no columns to compare with", expected.source));
  for (const auto* const sides : {&expected, &obtained}) {
    const TrajectoryColumns& here = *sides;
    const TrajectoryColumns& there = sides == &expected ? obtained : expected;
    for (const TrajectoryColumn& column : here.columns) {
      if (there.find(column.name) == nullptr) {
        problem(Verdict::missing,
                fmt::format("column {} of {} is missing in {}", column.name, here.source, there.source));
      }
      if (quantity_of_column(column.name) == nullptr) {
        problem(Verdict::invalid, fmt::format("{}: column {} is not a known quantity", here.source, column.name));
      }
      if (column.values.size() != here.rows()) {
        problem(Verdict::invalid, fmt::format("{}: column {} has {} rows where others have {}", here.source,
                                              column.name, column.values.size(), here.rows()));
        result.bad_data = true;
      }
      if (std::ranges::count(here.columns, column.name, &TrajectoryColumn::name) > 1) {
        problem(Verdict::invalid, fmt::format("{}: column {} stands twice", here.source, column.name));
        result.bad_data = true;
      }
    }
    if (const auto where = not_finite(here)) {
      problem(Verdict::invalid, *where);
      result.bad_data = true;
    }
  }
  if (result.expected_rows == 0) {
    problem(Verdict::missing, fmt::format("{}: has no rows to compare with", expected.source));
    result.bad_data = true;
  } else if (result.expected_rows != result.obtained_rows) {
    problem(Verdict::invalid, fmt::format("{} has {} rows, {} has {}", expected.source, result.expected_rows,
                                          obtained.source, result.obtained_rows));
  }
}

ContactEvents pair_events(Series t_s, Series expected, Series obtained) {
  const auto golden = contact_changes(expected);
  const auto found = contact_changes(obtained);
  ContactEvents events{golden.size(), found.size(), 0.0, 0.0};
  const bool alike = golden.size() == found.size() && expected.front() == obtained.front();
  if (!alike) events.max_shift_s = events.mean_shift_s = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; alike && i < golden.size(); ++i) {
    const double shift = t_s[found[i]] - t_s[golden[i]];
    events.max_shift_s = std::max(events.max_shift_s, std::abs(shift));
    events.mean_shift_s += shift / static_cast<double>(golden.size());
  }
  return events;
}

// Without a tube contact states agree row by row; with one, events pair up in order and each shift stays within it.
GroupResult compare_contact(Pair pair, Series t_s, const Tolerance& tolerance, Comparison& comparison,
                            std::vector<unsigned char>& drifted) {
  const TimeTube no_tube({}, {}, 0.0);
  const ComparedQuantity& group = compared_quantity(Quantity::contact);
  GroupResult result = compare_group(group, pair, tolerance.of(group.name), no_tube, drifted);
  comparison.events = pair_events(t_s, pair.expected[0], pair.obtained[0]);
  if (tolerance.tube_s > 0.0) {
    result.tolerance_used = used(comparison.events.max_shift_s, tolerance.tube_s);
    result.gates.push_back({"shift_s", comparison.events.max_shift_s, tolerance.tube_s});
    result.verdict = result.gates.back().passed() ? Verdict::equal : Verdict::worse;
  }
  return result;
}

}  // namespace

const GroupResult* Comparison::find(std::string_view group) const noexcept {
  const auto found = std::ranges::find(groups, group, &GroupResult::group);
  return found == groups.end() ? nullptr : &*found;
}

double Comparison::tolerance_used() const noexcept {
  double most = verdict >= Verdict::missing ? infinity : 0.0;
  for (const GroupResult& group : groups) most = std::max(most, group.tolerance_used);
  return most;
}

Comparison compare(const TrajectoryColumns& expected, const TrajectoryColumns& obtained, const Tolerance& tolerance) {
  Comparison result;
  result.expected_rows = expected.rows();
  result.obtained_rows = obtained.rows();
  check_shape(expected, obtained, result);
  if (result.verdict != Verdict::equal) return result;

  const auto* const contact = expected.find("contact");
  const auto* const t_s = expected.find("t");
  if (t_s == nullptr || (tolerance.tube_s > 0.0 && contact == nullptr)) {
    result.verdict = Verdict::missing;
    result.problems.push_back(fmt::format("{}: has no column {}", expected.source,
                                          t_s == nullptr ? "t" : "contact, which a time tube (tube_s) needs"));
    return result;
  }
  const TimeTube tube(*t_s, contact ? Series(*contact) : Series(), tolerance.tube_s);
  const TimeTube no_tube({}, {}, 0.0);
  std::vector<unsigned char> drifted(result.expected_rows, 0);
  for (const ComparedQuantity& group : compared_quantities()) {
    Pair pair;
    for (std::size_t a = 0; a < group.size(); ++a) {
      const auto* const column = expected.find(group.columns[a]);
      if (column == nullptr) continue;
      pair.expected[pair.axes] = *column;
      pair.obtained[pair.axes] = *obtained.find(group.columns[a]);
      ++pair.axes;
    }
    if (pair.axes == 0) continue;
    if (group.id == Quantity::orientation && pair.axes != 4) {
      result.problems.push_back(fmt::format("{}: an orientation needs qw, qx, qy and qz", expected.source));
      result.verdict = Verdict::invalid;
      return result;
    }
    const bool rendered =
        group.id == Quantity::force || group.id == Quantity::contact_position || group.id == Quantity::torque;
    result.groups.push_back(group.id == Quantity::contact ? compare_contact(pair, *t_s, tolerance, result, drifted)
                                                          : compare_group(group, pair, tolerance.of(group.name),
                                                                          rendered ? tube : no_tube, drifted));
    result.verdict = worst(result.verdict, result.groups.back().verdict);
  }
  result.drift = static_cast<std::size_t>(std::ranges::count(drifted, 1));
  return result;
}

}  // namespace touchstone::golden
