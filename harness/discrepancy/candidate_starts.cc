#include "harness/discrepancy/candidate_starts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "harness/base/error.h"
#include "harness/discrepancy/bump_peaks.h"
#include "harness/discrepancy/texture_spectrum.h"
#include "harness/rendering/declared_effect.h"
#include "harness/rendering/smooth_field.h"
#include "harness/rendering/surface_frame.h"
#include "harness/stats/quantile.h"

namespace touchstone::discrepancy {
using recording::Recording;
using rendering::add_frame;
using rendering::Candidate;
using rendering::displacement_of;
using rendering::EffectTraits;
using rendering::frame_of;
using rendering::has_frame;
using rendering::Model;
using rendering::ObjectDisplacement;
using rendering::ParameterDeclaration;
using rendering::Prediction;
using rendering::RecordingScales;
using rendering::SearchedParameter;
using rendering::SmoothField;
using rendering::SurfaceFrame;

namespace {

struct Context {
  const Candidate& candidate;
  const RecordingScales& scales;
  const Recording& recording;
  const Prediction& current;
};

rendering::NamedParameters entry(const Context& c, std::map<std::string, double> parameters) {
  return {c.candidate.name, std::move(parameters), "/found", {}, c.candidate.law};
}

const ParameterDeclaration& declared(const Context& c, const std::string& name) {
  const auto& all = c.candidate.parameters;
  const auto found = std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.name == name; });
  if (found == all.end()) throw BadData(c.candidate.name + ": its catalogue declares no " + name);
  return *found;
}

// Sought as its excess over another parameter of the entry, or with one that keeps its distance to it.
void couple(const SearchedParameter& searched, const std::string& owner, FreeParameter& free) {
  const std::string name = searched.name;
  const double scale = searched.scale;
  if (!searched.above.empty()) {
    free.set = [=, below = searched.above](Model& model, double u) {
      auto& values = find_entry(model, owner)->parameters;
      values[name] = values[below] + u * scale;
    };
    free.get = [=, below = searched.above](const Model& model) {
      const auto& values = find_entry(model, owner)->parameters;
      return (values.at(name) - values.at(below)) / scale;
    };
  }
  if (!searched.carries.empty()) {
    free.set = [=, carried = searched.carries](Model& model, double u) {
      auto& values = find_entry(model, owner)->parameters;
      const double excess = values[carried] - values[name];
      values[name] = u * scale;
      values[carried] = u * scale + excess;
    };
  }
  if (!searched.along.empty()) {
    const auto part = [](const std::map<std::string, double>& values, const std::map<std::string, double>& along) {
      double sum = 0.0;
      for (const auto& [one, share] : along) sum += share * values.at(one);
      return sum;
    };
    free.set = [=, along = searched.along](Model& model, double u) {
      auto& values = find_entry(model, owner)->parameters;
      const double change = u * scale - part(values, along);
      for (const auto& [one, share] : along) values[one] += share * change;
    };
    free.get = [=, along = searched.along](const Model& model) {
      return part(find_entry(model, owner)->parameters, along) / scale;
    };
    constexpr double seen = 0.3;  // of a parameter, of which this is no small part
    for (const auto& [one, share] : searched.along) {
      if (one != name && std::abs(share) > seen) free.also.push_back(one);
    }
  }
}

// The catalogue's bounds where the plan has none: what it accepts is searched. Only lengths and times that a scan must
// resolve to show have bounds of the recording instead.
FreeParameter free_of(const Context& c, const SearchedParameter& searched) {
  const std::string& owner = c.candidate.name;
  const double lower = std::isinf(searched.lower) ? declared(c, searched.name).minimum : searched.lower;
  const double upper = std::isinf(searched.upper) ? declared(c, searched.name).maximum : searched.upper;
  FreeParameter free = searched.logarithmic ? log_parameter(owner, searched.name, lower, upper)
                                            : linear_parameter(owner, searched.name, searched.scale, lower, upper);
  free.step = searched.step;
  couple(searched, owner, free);
  return free;
}

CandidateFit planned(const Context& c, rendering::SearchPlan plan) {
  CandidateFit fit;
  for (const SearchedParameter& searched : plan.parameters) fit.parameters.push_back(free_of(c, searched));
  for (auto& values : plan.starts) fit.starts.push_back(entry(c, std::move(values)));
  return fit;
}

// A bump somewhere: from the places and widths that explain most of the residual along the normal.
CandidateFit bump(const Context& c, BumpOf of, double scale, double lower, double upper) {
  const auto& name = c.candidate.name;
  const std::string amplitude = of == BumpOf::surface ? "amplitude_m" : "amplitude";
  const double extent = c.scales.extent_m();
  // Wider, it has no flank within the scan: another stiffness or another place of the whole object.
  constexpr double widest = 0.35;
  CandidateFit fit;
  fit.parameters = {
      linear_parameter(name, amplitude, scale, lower * scale, upper * scale),
      linear_parameter(name, "x_m", extent, c.scales.low_m.x() - 0.2 * extent, c.scales.high_m.x() + 0.2 * extent),
      linear_parameter(name, "y_m", extent, c.scales.low_m.y() - 0.2 * extent, c.scales.high_m.y() + 0.2 * extent),
      log_parameter(name, "width_m", 0.02 * extent, widest * extent)};
  for (const BumpPeak& peak : bump_peaks(c.recording, c.current, of, c.scales.low_m, c.scales.high_m, 6)) {
    fit.starts.push_back(entry(c, {{amplitude, std::clamp(peak.amplitude, 0.8 * lower * scale, 0.8 * upper * scale)},
                                   {"x_m", peak.x_m},
                                   {"y_m", peak.y_m},
                                   {"width_m", peak.width_m}}));
  }
  return fit;
}

CandidateFit texture(const Context& c) {
  const auto& name = c.candidate.name;
  const double pi = std::numbers::pi;
  CandidateFit fit;
  for (const TexturePeak& peak : texture_peaks(c.recording, c.current, c.scales.extent_m(), 4)) {
    fit.starts.push_back(entry(c, {{"amplitude_m", peak.amplitude_m},
                                   {"wavelength_m", peak.wavelength_m},
                                   {"direction_rad", peak.direction_rad},
                                   {"phase_rad", peak.phase_rad}}));
  }
  const double scale = 0.1 * c.scales.depth_m;
  // A texture repeats: a wave that the scan sees less than three times of is the object's shape.
  constexpr double longest = 1.0 / 3.0;
  // A wave vector moves the phase at the far end of the scan by radians: a small step of it in u is a small turn.
  FreeParameter direction = linear_parameter(name, "direction_rad", 0.05, -2.0 * pi, 2.0 * pi);
  fit.parameters = {linear_parameter(name, "amplitude_m", scale, 0.0, 10.0 * scale),
                    log_parameter(name, "wavelength_m", 1e-3 * c.scales.extent_m(), longest * c.scales.extent_m()),
                    direction, linear_parameter(name, "phase_rad", 1.0, -2.0 * pi, 2.0 * pi)};
  return fit;
}

CandidateFit from_peaks(const Context& c) {
  switch (c.candidate.traits.peaks) {
    case EffectTraits::Peaks::stiffness: {
      const ParameterDeclaration& bounds = declared(c, "amplitude");
      return bump(c, BumpOf::stiffness, 1.0, bounds.minimum, bounds.maximum);
    }
    case EffectTraits::Peaks::height:
      return bump(c, BumpOf::surface, c.scales.depth_m, -1.0, 1.0);
    case EffectTraits::Peaks::waves:
      return texture(c);
    case EffectTraits::Peaks::none:
      break;
  }
  return {};
}

// A field over the part of the surface that was touched, with knots at equal distances, no more coefficients than the
// blocks determine several times over; one start for each smoothness.
CandidateFit field(const Context& c) {
  constexpr double most_coefficients = 130.0;
  constexpr double seconds_each = 0.25;  // of the whole recording
  const auto& name = c.candidate.name;
  const double most = std::clamp(c.scales.duration_s / seconds_each, 25.0, most_coefficients);
  const Vec3 size = (c.scales.high_m - c.scales.low_m).cwiseMax(1e-6 * c.scales.extent_m());
  const auto side = [](double length_m, double knot_m) {
    return std::clamp(std::ceil(length_m / knot_m) + 3.0, static_cast<double>(SmoothField::least_side),
                      static_cast<double>(SmoothField::most_side));
  };
  double knot_m = 0.02 * c.scales.extent_m();
  while (side(size.x(), knot_m) * side(size.y(), knot_m) > most) knot_m *= 1.02;
  const double columns = side(size.x(), knot_m);
  const double rows = side(size.y(), knot_m);
  // The range is a whole number of knots around the middle of what was touched.
  const Vec3 middle = 0.5 * (c.scales.high_m + c.scales.low_m);
  const double half_x = 0.5 * std::max(size.x(), knot_m * (columns - 3.0));
  const double half_y = 0.5 * std::max(size.y(), knot_m * (rows - 3.0));
  const ParameterDeclaration& bounds = declared(c, rendering::field_coefficient(0, 0));
  const double scale = bounds.unit == "m" ? c.scales.depth_m : 1.0;
  CandidateFit fit;
  for (std::size_t row = 0; row < static_cast<std::size_t>(rows); ++row) {
    for (std::size_t column = 0; column < static_cast<std::size_t>(columns); ++column) {
      fit.parameters.push_back(
          linear_parameter(name, rendering::field_coefficient(column, row), scale, bounds.minimum, bounds.maximum));
      fit.parameters.back().coefficient = true;
    }
  }
  for (const double share : {0.03, 0.1, 0.3}) {
    std::map<std::string, double> values{{"x_low_m", middle.x() - half_x},
                                         {"x_high_m", middle.x() + half_x},
                                         {"y_low_m", middle.y() - half_y},
                                         {"y_high_m", middle.y() + half_y},
                                         {"columns", columns},
                                         {"rows", rows},
                                         {"bend", share * scale}};
    for (const FreeParameter& coefficient : fit.parameters) values[coefficient.name] = 0.0;
    fit.starts.push_back(entry(c, std::move(values)));
  }
  return fit;
}

// Where a search of each parameter begins: what a declared effect says, else the declared initial value.
std::vector<std::vector<double>> declared_starts(const Candidate& candidate) {
  if (candidate.law != nullptr) return candidate.law->starts;
  std::vector<std::vector<double>> starts;
  for (const ParameterDeclaration& parameter : candidate.parameters) starts.push_back({parameter.initial});
  return starts;
}

// The size of a step that a parameter without a decade of its own is sought in.
double generic_scale(const ParameterDeclaration& parameter, const std::vector<double>& starts) {
  double largest = 0.0;
  for (const double start : starts) largest = std::max(largest, std::abs(start));
  constexpr double share = 0.01;  // of the bounds, if nothing says how large it may be
  return largest > 0.0 ? largest : std::min(1.0, share * (parameter.maximum - parameter.minimum));
}

// All declared parameters, from every combination of their starts.
CandidateFit generic(const Context& c) {
  constexpr std::size_t most_starts = 16;
  CandidateFit fit;
  fit.side = c.candidate.side;
  const auto starts = declared_starts(c.candidate);
  std::vector<std::map<std::string, double>> combined{{}};
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const ParameterDeclaration& parameter = c.candidate.parameters[i];
    const bool logarithmic = parameter.minimum > 0.0 && parameter.maximum > 1e3 * parameter.minimum;
    if (logarithmic) {
      fit.parameters.push_back(log_parameter(c.candidate.name, parameter.name, parameter.minimum, parameter.maximum));
    } else {
      fit.parameters.push_back(linear_parameter(c.candidate.name, parameter.name, generic_scale(parameter, starts[i]),
                                                parameter.minimum, parameter.maximum));
    }
    std::vector<std::map<std::string, double>> longer;
    for (const auto& values : combined) {
      for (const double start : starts[i]) {
        longer.push_back(values);
        longer.back()[parameter.name] = start;
      }
    }
    combined = std::move(longer);
  }
  combined.resize(std::min(combined.size(), most_starts));
  for (auto& values : combined) fit.starts.push_back(entry(c, std::move(values)));
  return fit;
}

// The object's where the surface that was touched faces its z as nearly as makes no difference to a map (less than the
// cosine of this angle, in one direction) and lies about its origin.
SurfaceFrame frame_of_touched(const std::vector<Vec3>& touched_W_m, const Vec3& normals_W) {
  constexpr double nearly_facing_rad = 0.15;
  Vec3 middle_W_m = Vec3::Zero();
  for (const Vec3& p : touched_W_m) middle_W_m += p / static_cast<double>(touched_W_m.size());
  double reach_m = 0.0;
  for (const Vec3& p : touched_W_m) reach_m = std::max(reach_m, (p - middle_W_m).norm());
  const bool about_origin = middle_W_m.norm() < 2.0 * reach_m;
  const Vec3 origin_W_m = about_origin ? Vec3(Vec3::Zero()) : middle_W_m;
  // Touched from all sides it faces nowhere.
  constexpr double least_mean = 0.3;
  const bool faces = normals_W.norm() > least_mean * static_cast<double>(touched_W_m.size());
  const Vec3 n_W = normals_W.normalized();
  if (!faces || n_W.z() > std::cos(nearly_facing_rad)) return {origin_W_m, Quat::Identity()};
  return SurfaceFrame::facing(n_W, origin_W_m);
}

// A recording and a prediction as they are seen in a frame.
Recording seen_in(const SurfaceFrame& frame, Recording recording) {
  for (Vec3& p : recording.motion.p_W_m) p = frame.place(p);
  for (Vec3& f : recording.f_W_N) f = frame.direction(f);
  return recording;
}
Prediction seen_in(const SurfaceFrame& frame, Prediction prediction) {
  for (auto* const vectors : {&prediction.f_W_N, &prediction.n_W}) {
    for (Vec3& v : *vectors) v = frame.direction(v);
  }
  return prediction;
}

}  // namespace

RecordingScales measure_scales(const Recording& recording, const Prediction& prediction, double force_floor_N,
                               double stiffness_N_per_m, double position_noise_m) {
  RecordingScales scales;
  scales.position_noise_m = position_noise_m;
  std::vector<double> forces;
  std::vector<double> depths;
  std::vector<double> speeds;
  std::vector<double> rates;
  double apart = 0.0;
  double way_m = 0.0;
  double turns = 0.0;
  std::vector<Vec3> touched_W_m;
  Vec3 normals_W = Vec3::Zero();
  for (std::size_t i = 0; i < recording.size(); ++i) {
    const auto& q_WS = recording.motion.q_WS;
    const Vec3 f_S_N = q_WS.empty() ? recording.f_W_N[i] : Vec3(q_WS[i].conjugate() * recording.f_W_N[i]);
    scales.largest_axis_N = std::max(scales.largest_axis_N, f_S_N.cwiseAbs().maxCoeff());
    const Vec3& n = prediction.n_W[i];
    // A tip whose radius the model lacks presses before the model touches: the force tells.
    const bool pressed = recording.f_W_N[i].norm() > force_floor_N;
    if (pressed || !n.isZero()) {
      forces.push_back(recording.f_W_N[i].norm());
      touched_W_m.push_back(recording.motion.p_W_m[i]);
      normals_W += n;
    }
    if (pressed != !n.isZero()) apart += 1.0;
    if (n.isZero()) continue;
    depths.push_back(prediction.depth_m[i]);
    if (i == 0 || prediction.n_W[i - 1].isZero()) continue;
    const double dt_s = recording.motion.t_s[i] - recording.motion.t_s[i - 1];
    const Vec3 step = recording.motion.p_W_m[i] - recording.motion.p_W_m[i - 1];
    way_m += (step - n.dot(step) * n).norm();
    if (n != prediction.n_W[i - 1]) turns += 1.0;
    speeds.push_back((step - n.dot(step) * n).norm() / dt_s);
    rates.push_back(std::abs(prediction.depth_m[i] - prediction.depth_m[i - 1]) / dt_s);
  }
  scales.contact_disagreement = forces.empty() ? 0.0 : apart / static_cast<double>(forces.size());
  if (!forces.empty()) scales.force_N = stats::lower_quantile(std::move(forces), 0.9);
  // A model that hardly touches where the sensor is pressed does not know the depth; the force tells it.
  const double by_force_m = scales.force_N / stiffness_N_per_m;
  if (!depths.empty()) scales.depth_m = stats::lower_quantile(depths, 0.9);
  if (depths.empty() || scales.surface_is_elsewhere()) scales.depth_m = std::max(scales.depth_m, by_force_m);
  scales.facet_m = turns > 0.0 ? std::min(way_m / turns, scales.depth_m) : scales.depth_m;
  if (!speeds.empty()) {
    scales.speed_m_per_s = stats::lower_quantile(std::move(speeds), 0.5);
    scales.depth_rate_m_per_s = stats::lower_quantile(std::move(rates), 0.9);
  }
  if (recording.size() > 1) scales.duration_s = recording.motion.t_s.back() - recording.motion.t_s.front();
  if (touched_W_m.empty()) return scales;
  scales.frame = frame_of_touched(touched_W_m, normals_W);
  Box3 box;
  for (const Vec3& p : touched_W_m) box.extend(scales.frame.place(p));
  scales.low_m = box.min();
  scales.high_m = box.max();
  return scales;
}

CandidateFit candidate_fit(const Candidate& candidate, const RecordingScales& scales, const Recording& recording,
                           const Prediction& current) {
  const EffectTraits& traits = candidate.traits;
  if (has_frame(candidate.parameters) && !scales.frame.is_objects()) {
    RecordingScales in_frame = scales;
    in_frame.frame = {};
    CandidateFit fit =
        candidate_fit(candidate, in_frame, seen_in(scales.frame, recording), seen_in(scales.frame, current));
    for (rendering::NamedParameters& start : fit.starts) add_frame(scales.frame, start.parameters);
    return fit;
  }
  const Context c{candidate, scales, recording, current};
  const bool needs_way = traits.along_surface || is_field(candidate.parameters);
  if (needs_way && !scales.over_surface()) return {candidate.side, {}, {}};
  CandidateFit fit = is_field(candidate.parameters)              ? field(c)
                     : traits.peaks != EffectTraits::Peaks::none ? from_peaks(c)
                     : traits.plan != nullptr                    ? planned(c, traits.plan(scales))
                                                                 : generic(c);
  fit.side = candidate.side;
  for (FreeParameter& parameter : fit.parameters) parameter.moves_contact = traits.moves_contact;
  return fit;
}

double surface_displacement_m(const EffectTraits& traits, const rendering::NamedParameters& entry,
                              const MotionColumns& motion, const std::vector<Vec3>& n_W) {
  using Surface = EffectTraits::Surface;
  const auto& p = entry.parameters;
  if (traits.surface == Surface::higher_by_amplitude) return std::abs(p.at("amplitude_m"));
  if (traits.surface == Surface::higher_by_field) {
    const SmoothField height = rendering::field_of(entry.parameters, entry.place);
    const SurfaceFrame frame = frame_of(entry.parameters);
    double squares = 0.0;
    double count = 0.0;
    for (std::size_t i = 0; i < motion.size(); ++i) {
      if (n_W[i].isZero()) continue;
      const Vec3 place_m = frame.place(motion.p_W_m[i]);
      squares += std::pow(height.at(place_m.x(), place_m.y()), 2);
      count += 1.0;
    }
    return count > 0.0 ? std::sqrt(squares / count) : 0.0;
  }
  if (traits.surface != Surface::moved) return std::numeric_limits<double>::infinity();
  const ObjectDisplacement moved = displacement_of(p);
  double squares = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < motion.size(); ++i) {
    if (n_W[i].isZero()) continue;
    const double along_m = n_W[i].dot(moved.at(motion.p_W_m[i]));
    squares += along_m * along_m;
    count += 1.0;
  }
  return count > 0.0 ? std::sqrt(squares / count) : moved.shift_W_m.norm();
}

}  // namespace touchstone::discrepancy
