#include "cluster_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "harness/base/error.h"
#include "harness/recording/raw_table.h"
#include "windowed_sinc.h"

namespace touchstone::texture {
using recording::RawTable;

namespace {

constexpr double set_rate_Hz = 1000.0;  // as the toolkit's models have
constexpr std::size_t window_samples = 256;
constexpr double standard_gravity_m_per_s2 = 9.80665;
constexpr double band = 0.9;  // of half the rate
constexpr double half_width_s = 0.016;
constexpr double hole_s = 0.002;     // longer between two accelerations: nothing is known there
constexpr double speed_share = 0.2;  // what the tip's speed may differ from the name's by

struct ClusterName {
  int texture = 0, direction_deg = 0, speed_mm_per_s = 0, force_mN = 0, repeat = 0;
};

std::optional<ClusterName> parsed(const std::string& stem) {
  ClusterName name;
  int read = 0;
  const int found = std::sscanf(stem.c_str(), "%d_%d_%d_%d_%d%n", &name.texture, &name.direction_deg,
                                &name.speed_mm_per_s, &name.force_mN, &name.repeat, &read);
  if (found != 5 || read != static_cast<int>(stem.size()) || name.speed_mm_per_s <= 0) return std::nullopt;
  return name;
}

// A column over ascending times.
struct Series {
  std::vector<double> t_s;
  std::vector<double> x;

  [[nodiscard]] bool holds(double from_s, double to_s) const { return t_s.front() <= from_s && to_s <= t_s.back(); }
  [[nodiscard]] double at(double t) const {
    const auto after = std::clamp<std::ptrdiff_t>(std::upper_bound(t_s.begin(), t_s.end(), t) - t_s.begin(), 1,
                                                  static_cast<std::ptrdiff_t>(t_s.size()) - 1);
    const auto i = static_cast<std::size_t>(after);
    return x[i - 1] + (x[i] - x[i - 1]) * (t - t_s[i - 1]) / (t_s[i] - t_s[i - 1]);
  }
};

Series series_of(const RawTable& table, const std::string& column) {
  Series series{table.column("time"), table.column(column)};
  if (series.t_s.size() < 2) throw BadData(fmt::format("{}: has no samples", table.source()));
  for (std::size_t i = 1; i < series.t_s.size(); ++i) {
    if (!(series.t_s[i] > series.t_s[i - 1])) {
      throw BadData(fmt::format("{}: line {}: time does not advance: {} s after {} s", table.source(), i + 2,
                                series.t_s[i], series.t_s[i - 1]));
    }
  }
  return series;
}

// One recording's files.
class ClusterFiles {
 public:
  ClusterFiles(const std::filesystem::path& sensor_data, const std::filesystem::path& file)
      : force_(series_of(RawTable(sensor_data / "force" / file), "force")) {
    const RawTable accelerations(sensor_data / "accel" / file);
    for (const char* const axis : {"X", "Y", "Z"}) accelerations_g_.push_back(series_of(accelerations, axis));
    const RawTable position(sensor_data / "position" / file);
    for (const char* const axis : {"X", "Y"}) place_mm_.push_back(series_of(position, axis));
  }

  void add_windows(double speed_mm_per_s, double mass_kg, SlideWindows& result) const {
    const double window_s = static_cast<double>(window_samples) / set_rate_Hz;
    const double begin_s = std::max({place_mm_[0].t_s.front(), force_.t_s.front(), first_s() + half_width_s});
    for (double t = begin_s; t + window_s + half_width_s <= last_s(); t += window_s) {
      if (!place_mm_[0].holds(t, t + window_s) || !force_.holds(t, t + window_s)) continue;
      if (!even(t, window_s, speed_mm_per_s)) continue;
      result.sliding_s += window_s;
      if (hole(t - half_width_s, t + window_s + half_width_s)) continue;
      const double load_N = mean_force_N(t, t + window_s);
      if (!(load_N > 0.0)) continue;
      SlideWindow window{t, travelled_mm(t, t + window_s) / window_s / 1000.0, load_N, 0.0, {}};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        std::vector<double> force_N;
        for (std::size_t i = 0; i < window_samples; ++i)
          force_N.push_back(mass_kg * standard_gravity_m_per_s2 *
                            resampled(accelerations_g_[axis], t + static_cast<double>(i) / set_rate_Hz));
        window.fast_N[axis] = without_parabola(force_N, 0, window_samples);
      }
      result.windows.push_back(std::move(window));
    }
  }

 private:
  [[nodiscard]] double first_s() const { return accelerations_g_[0].t_s.front(); }
  [[nodiscard]] double last_s() const { return accelerations_g_[0].t_s.back(); }
  [[nodiscard]] double travelled_mm(double from_s, double to_s) const {
    return std::hypot(place_mm_[0].at(to_s) - place_mm_[0].at(from_s), place_mm_[1].at(to_s) - place_mm_[1].at(from_s));
  }
  // In both halves, so that it neither starts nor stops in the window.
  [[nodiscard]] bool even(double from_s, double length_s, double speed_mm_per_s) const {
    const double half_s = 0.5 * length_s;
    for (const double begin_s : {from_s, from_s + half_s}) {
      const double speed = travelled_mm(begin_s, begin_s + half_s) / half_s;
      if (!(std::abs(speed / speed_mm_per_s - 1.0) <= speed_share)) return false;
    }
    return true;
  }
  [[nodiscard]] bool hole(double from_s, double to_s) const {
    const std::vector<double>& t = accelerations_g_[0].t_s;
    const auto first = std::lower_bound(t.begin(), t.end(), from_s);
    for (auto at = first; at != t.end() && *at < to_s; ++at)
      if (at != t.begin() && *at - *(at - 1) > hole_s) return true;
    return false;
  }
  [[nodiscard]] double mean_force_N(double from_s, double to_s) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < window_samples; ++i)
      sum += force_.at(from_s + (to_s - from_s) * (static_cast<double>(i) + 0.5) / static_cast<double>(window_samples));
    return sum / static_cast<double>(window_samples);
  }
  // The integral of the samples over the kernel, by the time that each stands for.
  [[nodiscard]] static double resampled(const Series& series, double t) {
    const auto first = std::lower_bound(series.t_s.begin() + 1, series.t_s.end() - 1, t - half_width_s);
    double sum = 0.0, weights = 0.0;
    for (auto at = first; at != series.t_s.end() - 1 && *at < t + half_width_s; ++at) {
      const double away = *at - t;
      const double weight =
          0.5 * (*(at + 1) - *(at - 1)) * sinc(band * set_rate_Hz * away) * blackman(away / half_width_s);
      sum += weight * series.x[static_cast<std::size_t>(at - series.t_s.begin())];
      weights += weight;
    }
    return sum / weights;
  }

  Series force_;
  std::vector<Series> accelerations_g_;
  std::vector<Series> place_mm_;
};

}  // namespace

SlideWindows cluster_windows(const std::filesystem::path& sensor_data, int texture, double effective_mass_kg) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  std::size_t others = 0;
  for (const auto& entry : std::filesystem::directory_iterator(sensor_data / "accel", error)) {
    const auto name = parsed(entry.path().stem().string());
    if (!name) continue;
    if (name->texture == texture) {
      files.push_back(entry.path().filename());
    } else {
      ++others;
    }
  }
  if (files.empty()) {
    throw BadData(
        fmt::format("{}: has no file accel/{}_DIRECTION_SPEED_FORCE_REPEAT.csv ({} of other textures); the folder "
                    "sensor_data of the "
                    "Cluster Haptic Texture Dataset was expected, and the number of a texture in it",
                    sensor_data.string(), texture, others));
  }
  std::ranges::sort(files);
  SlideWindows result;
  result.source = sensor_data.string();
  result.rate_Hz = set_rate_Hz;
  result.window_s = static_cast<double>(window_samples) / set_rate_Hz;
  for (const std::filesystem::path& file : files) {
    ClusterFiles(sensor_data, file)
        .add_windows(parsed(file.stem().string())->speed_mm_per_s, effective_mass_kg, result);
  }
  if (result.windows.empty()) {
    throw BadData(
        fmt::format("{}: in {} files of texture {} the tip nowhere slides for {:.3g} s at the speed of the "
                    "file's name, with a force above 0 and without a hole in the accelerations",
                    sensor_data.string(), files.size(), texture, result.window_s));
  }
  return result;
}

}  // namespace touchstone::texture
