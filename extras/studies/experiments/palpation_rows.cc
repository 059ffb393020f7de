#include "experiments/palpation_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/base/error.h"
#include "harness/base/least_squares.h"

namespace touchstone::experiments {
using recording::Recording;

namespace {

namespace pc = perception;

// Deepest points, at least 0.2 s apart: minima of z over 0.15 s to either side.
std::vector<std::size_t> deepest_points(const Recording& recording) {
  const auto& t = recording.motion.t_s;
  const auto& p = recording.motion.p_W_m;
  std::vector<std::size_t> found;
  std::size_t low = 0;
  std::size_t high = 0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    while (t[i] - t[low] > 0.15) ++low;
    while (high + 1 < t.size() && t[high + 1] - t[i] <= 0.15) ++high;
    const auto least = std::min_element(p.begin() + static_cast<std::ptrdiff_t>(low),
                                        p.begin() + static_cast<std::ptrdiff_t>(high) + 1,
                                        [](const Vec3& a, const Vec3& b) { return a.z() < b.z(); });
    if (static_cast<std::size_t>(least - p.begin()) != i) continue;
    if (found.empty() || t[i] - t[found.back()] > 0.2) found.push_back(i);
  }
  return found;
}

pc::PressSignal signal_of(const Recording& recording, const RasterRow& row, const std::string& name) {
  pc::PressSignal signal;
  signal.name = name;
  const double start_s = recording.motion.t_s[row.first];
  for (std::size_t i = row.first; i < row.end; ++i) {
    signal.t_s.push_back(recording.motion.t_s[i] - start_s);
    signal.force_N.push_back(recording.f_W_N[i].z());
    signal.displacement_m.push_back(recording.motion.p_W_m[row.first].z() - recording.motion.p_W_m[i].z());
  }
  return signal;
}

}  // namespace

std::vector<RasterRow> raster_rows(const Recording& recording, std::size_t presses) {
  const auto deepest = deepest_points(recording);
  const auto& p = recording.motion.p_W_m;
  std::vector<RasterRow> rows;
  for (std::size_t i = 0; i + presses < deepest.size();) {
    std::size_t run = 0;
    while (i + run + 1 < deepest.size() && p[deepest[i + run + 1]].x() > p[deepest[i + run]].x()) ++run;
    if (run >= presses) rows.push_back({deepest[i], deepest[i + presses] + 1});
    i += run + 1;
  }
  if (rows.size() < 2) {
    throw BadData(fmt::format("{}: {} rows of {} presses towards growing x; a raster with at least two was expected",
                              recording.source, rows.size(), presses));
  }
  return rows;
}

double PlaneSpring::force_N(const Vec3& p) const {
  return k_N_per_m * std::max(0.0, z0_m + b * p.x() + c * p.y() - p.z());
}

PlaneSpring fit_plane_spring(const Recording& recording, double contact_force_N) {
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : recording.motion.p_W_m) centre += p / static_cast<double>(recording.size());
  for (std::size_t i = 0; i < recording.size(); ++i) {
    const double force_N = recording.f_W_N[i].z();
    if (force_N < contact_force_N) continue;
    const Vec3 q = recording.motion.p_W_m[i] - centre;
    const Eigen::Vector4d a(1.0, q.x(), q.y(), -q.z());
    normal += a * a.transpose();
    right += force_N * a;
  }
  const Eigen::Vector4d s = solve_symmetric(normal, right);
  if (!(s(3) > 0.0))
    throw BadData(fmt::format("{}: the force does not grow with depth: no spring fits", recording.source));
  // F = s0 + s1 x + s2 y - s3 z about the centre.
  const double b = s(1) / s(3);
  const double c = s(2) / s(3);
  return {s(3), s(0) / s(3) + centre.z() - b * centre.x() - c * centre.y(), b, c};
}

pc::EvaluationOptions raster_options() {
  pc::EvaluationOptions options;
  options.matrix.rate_Hz = 66.0;
  options.image.rate_hardness_window = 5;
  return options;
}

std::vector<RowComparison> compare_rows(const Recording& recording, std::size_t presses,
                                        const pc::EvaluationOptions& options) {
  const auto rows = raster_rows(recording, presses);
  const PlaneSpring spring = fit_plane_spring(recording, options.image.force_law.absolute_threshold);
  std::vector<RowComparison> result;
  for (std::size_t r = 0; r + 1 < rows.size(); ++r) {
    const auto real = signal_of(recording, rows[r], "row");
    const auto next = signal_of(recording, rows[r + 1], "next row");
    auto rendered = next;
    rendered.name = "next row, rendered by one spring on one plane";
    for (std::size_t i = 0; i < rendered.force_N.size(); ++i) {
      rendered.force_N[i] = spring.force_N(recording.motion.p_W_m[rows[r + 1].first + i]);
    }
    const std::vector<pc::ConditionSource> conditions{
        {next.name, [&next] { return std::vector<pc::PressSignal>{next}; }},
        {rendered.name, [&rendered] { return std::vector<pc::PressSignal>{rendered}; }}};
    result.push_back({rows[r], rows[r + 1], pc::evaluate({real}, conditions, options)});
  }
  return result;
}

}  // namespace touchstone::experiments
