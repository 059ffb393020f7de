#include "harness/golden/comparison/error_regimes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "harness/golden/comparison/contact_events.h"

namespace touchstone::golden {
namespace {

constexpr double event_s = 0.010;
constexpr double holding = 0.02;  // of the fastest speed
constexpr double most_error = 0.9;
enum Regime : std::size_t { free_air, contact_event, hold, load, unload, slide, regime_count };
constexpr std::array<const char*, regime_count> names{"free air", "contact event", "holding",
                                                      "loading",  "unloading",     "sliding"};

bool vectors(const TrajectoryColumns& set, const std::array<const char*, 3>& columns, std::vector<Vec3>& out) {
  std::array<const std::vector<double>*, 3> found{};
  for (std::size_t a = 0; a < 3; ++a) {
    found[a] = set.find(columns[a]);
    if (found[a] == nullptr || found[a]->size() != set.rows()) return false;
  }
  for (std::size_t i = 0; i < set.rows(); ++i) out.emplace_back((*found[0])[i], (*found[1])[i], (*found[2])[i]);
  return true;
}

std::vector<Regime> regimes_of(const std::vector<double>& t, const std::vector<Vec3>& tip,
                               const std::vector<Vec3>& force) {
  const std::size_t rows = t.size();
  std::vector<double> contact(rows);
  for (std::size_t i = 0; i < rows; ++i) contact[i] = force[i].squaredNorm() > 0.0 ? 1.0 : 0.0;
  std::vector<Vec3> velocity(rows, Vec3::Zero());
  double fastest = 0.0;
  for (std::size_t i = 1; i < rows; ++i) {
    if (t[i] > t[i - 1]) velocity[i] = (tip[i] - tip[i - 1]) / (t[i] - t[i - 1]);
    fastest = std::max(fastest, velocity[i].norm());
  }
  std::vector<Regime> regimes(rows, free_air);
  for (std::size_t i = 0; i < rows; ++i) {
    if (contact[i] == 0.0) continue;
    const double along = velocity[i].dot(force[i].normalized());
    const double across = (velocity[i] - along * force[i].normalized()).norm();
    const bool slides = across > std::abs(along);
    regimes[i] = velocity[i].norm() < holding * fastest ? hold : slides ? slide : along < 0.0 ? load : unload;
  }
  for (const std::size_t event : contact_changes(contact)) {
    for (std::size_t i = event; i < rows && t[i] <= t[event] + event_s; ++i) regimes[i] = contact_event;
    for (std::size_t i = event; i-- > 0 && t[i] >= t[event] - event_s;) regimes[i] = contact_event;
  }
  return regimes;
}

}  // namespace

ErrorPlaces locate_error(const TrajectoryColumns& expected, const TrajectoryColumns& obtained) {
  ErrorPlaces places;
  std::vector<Vec3> tip;
  std::vector<Vec3> golden;
  std::vector<Vec3> force;
  const auto* const t = expected.find("t");
  if (t == nullptr || expected.rows() != obtained.rows() || expected.rows() == 0 ||
      !vectors(expected, {"x", "y", "z"}, tip) || !vectors(expected, {"fx", "fy", "fz"}, golden) ||
      !vectors(obtained, {"fx", "fy", "fz"}, force)) {
    return places;
  }
  const auto regimes = regimes_of(*t, tip, golden);
  std::array<RegimeError, regime_count> sums{};
  std::vector<double> square(t->size());
  Vec3 axes = Vec3::Zero();
  for (std::size_t i = 0; i < t->size(); ++i) {
    const Vec3 error = force[i] - golden[i];
    axes += error.cwiseAbs2();
    square[i] = error.squaredNorm();
    ++sums[regimes[i]].rows;
    sums[regimes[i]].rms_N += square[i];
  }
  const double total = axes.sum();
  for (std::size_t r = 0; r < regime_count; ++r) {
    if (sums[r].rows == 0) continue;
    places.regimes.push_back({names[r], sums[r].rows, std::sqrt(sums[r].rms_N / static_cast<double>(sums[r].rows)),
                              total > 0.0 ? sums[r].rms_N / total : 0.0});
  }
  if (!(total > 0.0)) return places;
  for (Eigen::Index a = 0; a < 3; ++a) places.axis_share[static_cast<std::size_t>(a)] = axes[a] / total;
  std::vector<std::size_t> order(square.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, std::greater<>{}, [&](std::size_t i) { return square[i]; });
  double sum = 0.0;
  places.first_t_s = places.last_t_s = (*t)[order.front()];
  for (const std::size_t i : order) {
    if (sum > most_error * total || square[i] == 0.0) break;
    sum += square[i];
    places.region_W_m.extend(tip[i]);
    places.first_t_s = std::min(places.first_t_s, (*t)[i]);
    places.last_t_s = std::max(places.last_t_s, (*t)[i]);
  }
  return places;
}

std::string to_table(const ErrorPlaces& places) {
  std::string text;
  if (places.regimes.empty()) return text;
  text += fmt::format("force error by axis: fx {:.1f}%, fy {:.1f}%, fz {:.1f}%\n", 100.0 * places.axis_share[0],
                      100.0 * places.axis_share[1], 100.0 * places.axis_share[2]);
  for (const RegimeError& regime : places.regimes) {
    text += fmt::format("  {:<14} {:>8} rows   rms {:>11.4g} N   {:>5.1f}% of the error\n", regime.name, regime.rows,
                        regime.rms_N, 100.0 * regime.share);
  }
  if (!places.region_W_m.isEmpty()) {
    const Vec3 low = places.region_W_m.min();
    const Vec3 high = places.region_W_m.max();
    text += fmt::format(
        "nine tenths of it: x {:.6g} to {:.6g}, y {:.6g} to {:.6g}, z {:.6g} to {:.6g} m, t {:.6g} to {:.6g} s\n",
        low.x(), high.x(), low.y(), high.y(), low.z(), high.z(), places.first_t_s, places.last_t_s);
  }
  return text;
}

}  // namespace touchstone::golden
