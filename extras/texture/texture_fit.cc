#include "texture_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "delaunay.h"
#include "harness/base/error.h"
#include "line_spectrum.h"
#include "segment_burg.h"

namespace touchstone::texture {
namespace {

constexpr std::size_t least_order = 2;
constexpr std::size_t largest_order = 20;
constexpr std::size_t least_windows = 4;  // of a part: one second
constexpr double driving = 0.02;          // of the load: less is an error of the normal
constexpr double part_share = 1.0 / 6.0;  // of the largest speed and force, that one part may span

using Part = std::vector<const SlideWindow*>;

struct Extremes {
  double least = std::numeric_limits<double>::infinity();
  double most = 0.0;
  void add(double x) {
    least = std::min(least, x);
    most = std::max(most, x);
  }
};

class Parts {
 public:
  explicit Parts(const SlideWindows& windows) {
    Part all;
    for (const SlideWindow& window : windows.windows) {
      all.push_back(&window);
      largest_speed_m_per_s = std::max(largest_speed_m_per_s, window.speed_m_per_s);
      largest_force_N = std::max(largest_force_N, window.load_N);
    }
    split(all);
  }

  std::vector<Part> parts;
  std::size_t left_out = 0;
  double largest_speed_m_per_s = 0.0;
  double largest_force_N = 0.0;

 private:
  void split(const Part& part) {
    if (part.size() < least_windows) {
      left_out += part.size();
      return;
    }
    Extremes speed, force;
    for (const SlideWindow* window : part) {
      speed.add(window->speed_m_per_s / largest_speed_m_per_s);
      force.add(window->load_N / largest_force_N);
    }
    const bool by_speed = speed.most - speed.least > force.most - force.least;
    const Extremes& wider = by_speed ? speed : force;
    if (wider.most - wider.least <= part_share) {
      parts.push_back(part);
      return;
    }
    const double middle = 0.5 * (wider.least + wider.most);
    Part below, above;
    for (const SlideWindow* window : part) {
      const double at = by_speed ? window->speed_m_per_s / largest_speed_m_per_s : window->load_N / largest_force_N;
      (at < middle ? below : above).push_back(window);
    }
    split(below);
    split(above);
  }
};

// The series of a part in m/s^2, and how many independent samples they are: an axis without power has none.
struct PartSeries {
  std::vector<std::vector<double>> series;
  double power = 0.0;  // mean square, of all axes
  double samples = 0.0;
};

PartSeries series_of(const Part& part, double effective_mass_kg) {
  PartSeries result;
  std::array<double, 3> squares{};
  std::size_t length = 0;
  for (const SlideWindow* window : part) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::vector<double> acceleration;
      for (const double force_N : window->fast_N[axis]) {
        acceleration.push_back(force_N / effective_mass_kg);
        squares[axis] += acceleration.back() * acceleration.back();
      }
      length = acceleration.size();
      result.series.push_back(std::move(acceleration));
    }
  }
  const double sum = squares[0] + squares[1] + squares[2];
  const double of_squares = squares[0] * squares[0] + squares[1] * squares[1] + squares[2] * squares[2];
  const auto samples = static_cast<double>(length * part.size());
  result.power = sum / samples;
  result.samples = of_squares > 0.0 ? samples * sum * sum / of_squares : samples;
  return result;
}

double corrected_criterion(double samples, double error, std::size_t order) {
  const double k = static_cast<double>(order) + 1.0;
  return samples * std::log(error) + 2.0 * k * samples / (samples - k - 1.0);
}

double friction(const SlideWindows& windows) {
  double product = 0.0;
  double squares = 0.0;
  for (const SlideWindow& window : windows.windows) {
    product += window.friction_N * window.load_N;
    squares += window.load_N * window.load_N;
  }
  const double slope = product / squares;
  if (slope < -driving) {
    throw BadData(
        fmt::format("{}: the force drives the motion instead of resisting it (friction would be {:.3g}): if the "
                    "file has the force BY the probe, give --flip-force",
                    windows.source, slope));
  }
  return std::max(0.0, slope);
}

// Points on the edges of the rectangle, with the filter of the nearest part.
void add_edges(TextureModel& model) {
  constexpr int steps = 4;
  constexpr double apart = 1e-3;  // of the rectangle: nearer to a part, that stands there
  const std::vector<TextureNode> parts = model.nodes;
  const auto across = [&model](double speed, double force, const TextureNode& node) {
    return std::hypot(speed - node.speed_m_per_s / model.largest_speed_m_per_s,
                      force - node.force_N / model.largest_force_N);
  };
  const auto add = [&](double speed, double force) {
    const auto nearest =
        std::ranges::min_element(parts, {}, [&](const TextureNode& n) { return across(speed, force, n); });
    if (across(speed, force, *nearest) < apart) return;
    TextureNode node = *nearest;
    node.speed_m_per_s = speed * model.largest_speed_m_per_s;
    node.force_N = force * model.largest_force_N;
    if (speed == 0.0 || force == 0.0) node.variance = 0.0;
    model.nodes.push_back(std::move(node));
  };
  for (int i = 0; i < steps; ++i) {
    const double along = static_cast<double>(i) / steps;
    add(along, 0.0);
    add(1.0, along);
    add(1.0 - along, 1.0);
    add(0.0, 1.0 - along);
  }
}

void triangulate(TextureModel& model) {
  std::vector<std::array<double, 2>> points;
  for (const TextureNode& node : model.nodes)
    points.push_back({node.speed_m_per_s / model.largest_speed_m_per_s, node.force_N / model.largest_force_N});
  model.triangles = delaunay(points);
}

}  // namespace

TextureFit fit_texture(const SlideWindows& windows, double effective_mass_kg, const std::string& material) {
  const Parts parts(windows);
  if (parts.parts.empty()) {
    throw BadData(fmt::format(
        "{}: at no speed and force are there {} windows of {:.3g} s, which a model needs, but {} in all; slide longer, "
        "at a few speeds and forces that you hold for two seconds each",
        windows.source, least_windows, windows.window_s, windows.windows.size()));
  }
  std::vector<PartSeries> series;
  std::vector<SegmentBurg> burgs;
  std::array<double, largest_order + 1> criterion{};
  for (const Part& part : parts.parts) {
    series.push_back(series_of(part, effective_mass_kg));
    constexpr double rounding = 1e-9;  // of the load
    if (!(effective_mass_kg * std::sqrt(series.back().power) > rounding * part.front()->load_N)) {
      throw BadData(fmt::format("{}: the force has no fast part at {:.4g} mm/s and {:.4g} N, and so no texture",
                                windows.source, 1e3 * part.front()->speed_m_per_s, part.front()->load_N));
    }
    burgs.push_back(segment_burg(series.back().series, largest_order));
    for (std::size_t order = least_order; order <= largest_order; ++order)
      criterion[order] += corrected_criterion(series.back().samples, burgs.back().errors[order], order);
  }
  TextureFit fit;
  fit.left_out = parts.left_out;
  fit.order =
      static_cast<std::size_t>(std::min_element(criterion.begin() + least_order, criterion.end()) - criterion.begin());
  TextureModel& model = fit.model;
  model.material = material;
  model.rate_Hz = windows.rate_Hz;
  model.mu = friction(windows);
  model.largest_speed_m_per_s = parts.largest_speed_m_per_s;
  model.largest_force_N = parts.largest_force_N;
  for (std::size_t p = 0; p < parts.parts.size(); ++p) {
    FittedPart seen{0.0, 0.0, parts.parts[p].size(), effective_mass_kg * std::sqrt(series[p].power)};
    for (const SlideWindow* window : parts.parts[p]) {
      seen.speed_m_per_s += window->speed_m_per_s / static_cast<double>(seen.windows);
      seen.force_N += window->load_N / static_cast<double>(seen.windows);
    }
    TextureNode node;
    node.speed_m_per_s = seen.speed_m_per_s;
    node.force_N = seen.force_N;
    node.ar_rad = line_spectral_frequencies(burgs[p].polynomials[fit.order]);
    // Of the sum of the axes: Burg's error is the mean of the three.
    node.variance = 3.0 * burgs[p].errors[fit.order];
    model.nodes.push_back(std::move(node));
    fit.parts.push_back(seen);
  }
  add_edges(model);
  triangulate(model);
  return fit;
}

std::string text_of(const TextureFit& fit, const SlideWindows& windows) {
  std::string text = fmt::format(
      "{}: slides for {:.3g} s, {} windows of {:.3g} s at an even speed and force, {} of them too few of a kind\n"
      "friction {:.4g}, order {}, {:.6g} samples per second\n"
      "{:>10} {:>8} {:>8} {:>14}\n",
      windows.source, windows.sliding_s, windows.windows.size(), windows.window_s, fit.left_out, fit.model.mu,
      fit.order, fit.model.rate_Hz, "mm/s", "N", "windows", "fast force, mN");
  for (const FittedPart& part : fit.parts) {
    text += fmt::format("{:10.4g} {:8.3g} {:8} {:14.4g}\n", 1e3 * part.speed_m_per_s, part.force_N, part.windows,
                        1e3 * part.rms_N);
  }
  return text;
}

}  // namespace touchstone::texture
