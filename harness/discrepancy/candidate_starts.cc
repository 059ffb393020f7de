#include "harness/discrepancy/candidate_starts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "harness/base/error.h"
#include "harness/discrepancy/bump_peaks.h"
#include "harness/discrepancy/texture_spectrum.h"
#include "harness/rendering/smooth_field.h"
#include "harness/stats/quantile.h"

namespace touchstone::discrepancy {
namespace {

// Of the samples in contact: so many are so by the sensor or by the model alone only where the surface is elsewhere.
constexpr double much_apart = 0.2;

struct Context {
  const Candidate& candidate;
  const RecordingScales& scales;
  const Recording& recording;
  const Prediction& current;
};

NamedParameters entry(const Context& c, std::map<std::string, double> parameters) {
  return {c.candidate.name, std::move(parameters), "/found"};
}

// The catalogue's bounds: what it accepts is searched. Only lengths and times that a scan must resolve to show have
// bounds of the recording instead.
const ParameterDeclaration& declared(const Context& c, const std::string& name) {
  const auto& all = c.candidate.parameters;
  const auto found = std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.name == name; });
  if (found == all.end()) throw BadData(c.candidate.name + ": its catalogue declares no " + name);
  return *found;
}

FreeParameter within_catalogue(const Context& c, const std::string& name, double scale) {
  const ParameterDeclaration& bounds = declared(c, name);
  return linear_parameter(c.candidate.name, name, scale, bounds.minimum, bounds.maximum);
}

// mu_static follows mu_dynamic: plain Coulomb friction has one coefficient.
FreeParameter one_coefficient(const Context& c) {
  const std::string owner = c.candidate.name;
  FreeParameter mu = within_catalogue(c, "mu_dynamic", 1.0);
  mu.set = [owner](Model& model, double u) {
    auto& parameters = find_entry(model, owner)->parameters;
    parameters["mu_dynamic"] = u;
    parameters["mu_static"] = u;
  };
  return mu;
}

// mu_static = mu_dynamic + excess, excess >= 0.
std::vector<FreeParameter> two_coefficients(const Context& c) {
  const std::string owner = c.candidate.name;
  FreeParameter dynamic = within_catalogue(c, "mu_dynamic", 1.0);
  dynamic.set = [owner](Model& model, double u) {
    auto& parameters = find_entry(model, owner)->parameters;
    const double excess = parameters["mu_static"] - parameters["mu_dynamic"];
    parameters["mu_dynamic"] = u;
    parameters["mu_static"] = u + excess;
  };
  FreeParameter excess = within_catalogue(c, "mu_static", 1.0);
  excess.set = [owner](Model& model, double u) {
    auto& parameters = find_entry(model, owner)->parameters;
    parameters["mu_static"] = parameters["mu_dynamic"] + u;
  };
  excess.get = [owner](const Model& model) {
    const auto& parameters = find_entry(model, owner)->parameters;
    return parameters.at("mu_static") - parameters.at("mu_dynamic");
  };
  return {dynamic, excess};
}

// Pre-sliding is fitted along: the path over which friction turns must exceed what the tracker's noise makes of a tip
// that stands still, and below that the recording cannot show it.
double hidden_presliding(const Context& c) { return 12.0 * c.scales.position_noise_m + 0.02 * c.scales.depth_m; }

// A soft object gives way sideways before the tip slides: by 1 to 1.5 times the coefficient times the depth (Mindlin
// 1949: the tangential stiffness of a contact is 2/3 to 1 of the normal one). The coefficient is hardly above one.
double longest_sideways(const Context& c) { return hidden_presliding(c) + 1.5 * c.scales.depth_m; }

FreeParameter presliding(const Context& c) {
  return log_parameter(c.candidate.name, "presliding_m", 0.02 * hidden_presliding(c), longest_sideways(c));
}

std::vector<double> presliding_starts(const Context& c) {
  return {0.1 * hidden_presliding(c), 0.4 * hidden_presliding(c), 0.1 * longest_sideways(c)};
}

CandidateFit coulomb(const Context& c) {
  CandidateFit fit{Side::contact, {one_coefficient(c), presliding(c)}, {}};
  for (const double s : presliding_starts(c)) {
    fit.starts.push_back(entry(c, {{"mu_static", 0.2}, {"mu_dynamic", 0.2}, {"presliding_m", s}}));
  }
  return fit;
}

CandidateFit stribeck(const Context& c) {
  const auto& name = c.candidate.name;
  CandidateFit fit{Side::contact, two_coefficients(c), {}};
  const double v = std::max(c.scales.speed_m_per_s, 1e-4);
  fit.parameters.push_back(log_parameter(name, "stribeck_velocity_m_per_s", 0.02 * v, 20.0 * v));
  fit.parameters.push_back(presliding(c));
  for (const double share : {0.3, 1.0}) {
    for (const double s : presliding_starts(c)) {
      fit.starts.push_back(entry(
          c, {{"mu_static", 0.4}, {"mu_dynamic", 0.2}, {"stribeck_velocity_m_per_s", share * v}, {"presliding_m", s}}));
    }
  }
  return fit;
}

CandidateFit anisotropic(const Context& c) {
  CandidateFit fit{
      Side::contact, {within_catalogue(c, "mu_x", 1.0), within_catalogue(c, "mu_y", 1.0), presliding(c)}, {}};
  for (const double s : presliding_starts(c))
    fit.starts.push_back(entry(c, {{"mu_x", 0.2}, {"mu_y", 0.2}, {"presliding_m", s}}));
  return fit;
}

CandidateFit one_rate(const Context& c, const std::string& parameter, double typical_rate) {
  const double scale = c.scales.force_N / std::max(typical_rate, 1e-12);
  return {Side::contact,
          {linear_parameter(c.candidate.name, parameter, scale, 0.0, 20.0 * scale)},
          {entry(c, {{parameter, 0.05 * scale}})}};
}

CandidateFit power_law(const Context& c) {
  const double reference = 0.5 * c.scales.depth_m;
  return {Side::contact,
          {within_catalogue(c, "exponent", 1.0)},
          {entry(c, {{"exponent", 1.2}, {"reference_depth_m", reference}})}};
}

// A bump somewhere: from the places and widths that explain most of what is left along the normal.
CandidateFit bump(const Context& c, BumpOf of, double scale, double lower, double upper) {
  const auto& name = c.candidate.name;
  const std::string amplitude = of == BumpOf::surface ? "amplitude_m" : "amplitude";
  const double extent = c.scales.extent_m();
  // Wider, it has no flank within the scan: another stiffness or another place of the whole object.
  constexpr double widest = 0.35;
  CandidateFit fit;
  fit.side = of == BumpOf::surface ? Side::instrument : Side::contact;
  fit.parameters = {
      linear_parameter(name, amplitude, scale, lower * scale, upper * scale),
      linear_parameter(name, "x_m", extent, c.scales.low_W_m.x() - 0.2 * extent, c.scales.high_W_m.x() + 0.2 * extent),
      linear_parameter(name, "y_m", extent, c.scales.low_W_m.y() - 0.2 * extent, c.scales.high_W_m.y() + 0.2 * extent),
      log_parameter(name, "width_m", 0.02 * extent, widest * extent)};
  for (const BumpPeak& peak : bump_peaks(c.recording, c.current, of, c.scales.low_W_m, c.scales.high_W_m, 6)) {
    fit.starts.push_back(entry(c, {{amplitude, std::clamp(peak.amplitude, 0.8 * lower * scale, 0.8 * upper * scale)},
                                   {"x_m", peak.x_m},
                                   {"y_m", peak.y_m},
                                   {"width_m", peak.width_m}}));
  }
  return fit;
}

CandidateFit relaxation(const Context& c) {
  const auto& name = c.candidate.name;
  CandidateFit fit{Side::contact,
                   {within_catalogue(c, "ratio", 1.0),
                    log_parameter(name, "time_constant_s", 0.02, 2.0 * std::max(c.scales.duration_s, 0.1))},
                   {}};
  for (const double tau : {0.08, 0.4, 2.0}) fit.starts.push_back(entry(c, {{"ratio", 0.3}, {"time_constant_s", tau}}));
  return fit;
}

CandidateFit tip_radius(const Context& c) {
  // A larger one hardly fits between two places of the scan; and it meets ever more of the mesh, which is dear.
  constexpr double largest = 0.25;
  CandidateFit fit{
      Side::contact,
      {log_parameter(c.candidate.name, "radius_m", 1e-3 * c.scales.extent_m(), largest * c.scales.extent_m())},
      {}};
  for (const double share : {0.02, 0.06}) fit.starts.push_back(entry(c, {{"radius_m", share * c.scales.extent_m()}}));
  if (c.scales.touching_apart > much_apart) {  // as for a registration
    for (const double share : {0.7, 1.5}) fit.starts.push_back(entry(c, {{"radius_m", share * c.scales.depth_m}}));
  }
  return fit;
}

CandidateFit adhesion(const Context& c) {
  const auto& name = c.candidate.name;
  CandidateFit fit{Side::contact,
                   {linear_parameter(name, "force_N", c.scales.force_N, 0.0, 2.0 * c.scales.force_N),
                    log_parameter(name, "range_m", 0.005 * c.scales.depth_m, 5.0 * c.scales.depth_m)},
                   {}};
  for (const double share : {0.05, 0.3}) {
    fit.starts.push_back(entry(c, {{"force_N", 0.1 * c.scales.force_N}, {"range_m", share * c.scales.depth_m}}));
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

CandidateFit one_linear(const Context& c, const std::string& parameter, double scale, double start) {
  return {Side::instrument, {within_catalogue(c, parameter, scale)}, {entry(c, {{parameter, start}})}};
}

// The longer the window that acceleration is taken over, the less of a tracker's noise is in it, and the less of a
// quick motion's: from which the mass explains more is tried.
CandidateFit tool_inertia(const Context& c) {
  CandidateFit fit = one_linear(c, "mass_kg", 0.1, 0.0);
  fit.starts.clear();
  for (const double window_s : {0.033, 0.05, 0.065, 0.08, 0.1, 0.13, 0.17, 0.22, 0.3}) {
    fit.starts.push_back(entry(c, {{"mass_kg", 0.0}, {"window_s", window_s}}));
  }
  return fit;
}

CandidateFit several_linear(const Context& c, const std::vector<std::string>& names, const std::vector<double>& scales,
                            double range) {
  CandidateFit fit;
  fit.side = Side::instrument;
  std::map<std::string, double> zero;
  for (std::size_t i = 0; i < names.size(); ++i) {
    fit.parameters.push_back(
        linear_parameter(c.candidate.name, names[i], scales[i], -range * scales[i], range * scales[i]));
    zero[names[i]] = 0.0;
  }
  fit.starts = {entry(c, zero)};
  return fit;
}

// Where the mesh lies so far off that model and measurement do not touch at the same time, no small shift changes
// anything: the fit starts from larger ones too.
CandidateFit registration(const Context& c) {
  const double d = c.scales.depth_m;
  const double turn = d / c.scales.extent_m();
  CandidateFit fit = several_linear(c, {"dx_m", "dy_m", "dz_m", "rx_rad", "ry_rad"}, {d, d, d, turn, turn}, 3.0);
  for (std::size_t along = 0; along < 2; ++along) fit.parameters[along].step = c.scales.facet_m / d;
  if (c.scales.touching_apart > much_apart) {
    for (const double share : {1.0, -1.0}) {
      fit.starts.push_back(fit.starts.front());
      fit.starts.back().parameters["dz_m"] = share * d;
    }
  }
  return fit;
}

// A sensor that clips shows nothing beyond its limit but noise.
CandidateFit saturation(const Context& c) {
  const double largest = c.scales.largest_axis_N;
  CandidateFit fit{Side::instrument, {log_parameter(c.candidate.name, "limit_N", 0.85 * largest, 1.2 * largest)}, {}};
  for (const double share : {0.88, 0.97}) fit.starts.push_back(entry(c, {{"limit_N", share * largest}}));
  return fit;
}

// A field over the part of the surface that was touched, with knots at equal distances, no more coefficients than the
// blocks determine several times over; one start for each smoothness.
CandidateFit field(const Context& c) {
  constexpr double most_coefficients = 130.0;
  constexpr double seconds_each = 0.25;  // of the whole recording
  const auto& name = c.candidate.name;
  const double most = std::clamp(c.scales.duration_s / seconds_each, 25.0, most_coefficients);
  const Vec3 size = (c.scales.high_W_m - c.scales.low_W_m).cwiseMax(1e-6 * c.scales.extent_m());
  const auto side = [](double length_m, double knot_m) {
    return std::clamp(std::ceil(length_m / knot_m) + 3.0, static_cast<double>(SmoothField::least_side),
                      static_cast<double>(SmoothField::most_side));
  };
  double knot_m = 0.02 * c.scales.extent_m();
  while (side(size.x(), knot_m) * side(size.y(), knot_m) > most) knot_m *= 1.02;
  const double columns = side(size.x(), knot_m);
  const double rows = side(size.y(), knot_m);
  // The range is a whole number of knots around the middle of what was touched.
  const Vec3 middle = 0.5 * (c.scales.high_W_m + c.scales.low_W_m);
  const double half_x = 0.5 * std::max(size.x(), knot_m * (columns - 3.0));
  const double half_y = 0.5 * std::max(size.y(), knot_m * (rows - 3.0));
  const ParameterDeclaration& bounds = declared(c, field_coefficient(0, 0));
  const double scale = bounds.unit == "m" ? c.scales.depth_m : 1.0;
  CandidateFit fit;
  for (std::size_t row = 0; row < static_cast<std::size_t>(rows); ++row) {
    for (std::size_t column = 0; column < static_cast<std::size_t>(columns); ++column) {
      fit.parameters.push_back(
          linear_parameter(name, field_coefficient(column, row), scale, bounds.minimum, bounds.maximum));
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

CandidateFit generic(const Context& c) {
  CandidateFit fit;
  fit.side = c.candidate.side;
  std::map<std::string, double> values;
  for (const ParameterDeclaration& parameter : c.candidate.parameters) {
    values[parameter.name] = parameter.initial;
    const bool logarithmic = parameter.minimum > 0.0 && parameter.maximum > 1e3 * parameter.minimum;
    if (logarithmic) {
      fit.parameters.push_back(log_parameter(c.candidate.name, parameter.name, parameter.minimum, parameter.maximum));
    } else {
      const double scale = parameter.initial != 0.0 ? std::abs(parameter.initial) : 1.0;
      fit.parameters.push_back(
          linear_parameter(c.candidate.name, parameter.name, scale, parameter.minimum, parameter.maximum));
    }
  }
  fit.starts = {entry(c, values)};
  return fit;
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
  Box3 box;
  for (std::size_t i = 0; i < recording.size(); ++i) {
    const auto& q_WS = recording.motion.q_WS;
    const Vec3 f_S_N = q_WS.empty() ? recording.f_W_N[i] : Vec3(q_WS[i].conjugate() * recording.f_W_N[i]);
    scales.largest_axis_N = std::max(scales.largest_axis_N, f_S_N.cwiseAbs().maxCoeff());
    const Vec3& n = prediction.n_W[i];
    // A tip whose radius the model lacks presses before the model touches: the force tells.
    const bool pressed = recording.f_W_N[i].norm() > force_floor_N;
    if (pressed || !n.isZero()) {
      forces.push_back(recording.f_W_N[i].norm());
      box.extend(recording.motion.p_W_m[i]);
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
  scales.touching_apart = forces.empty() ? 0.0 : apart / static_cast<double>(forces.size());
  if (!forces.empty()) scales.force_N = stats::lower_quantile(std::move(forces), 0.9);
  // A model that hardly touches where the sensor is pressed does not know the depth; the force tells it.
  const double by_force_m = scales.force_N / stiffness_N_per_m;
  if (!depths.empty()) scales.depth_m = stats::lower_quantile(depths, 0.9);
  if (depths.empty() || scales.touching_apart > much_apart) scales.depth_m = std::max(scales.depth_m, by_force_m);
  scales.facet_m = turns > 0.0 ? std::min(way_m / turns, scales.depth_m) : scales.depth_m;
  if (!speeds.empty()) {
    scales.speed_m_per_s = stats::lower_quantile(std::move(speeds), 0.5);
    scales.depth_rate_m_per_s = stats::lower_quantile(std::move(rates), 0.9);
  }
  if (recording.size() > 1) scales.duration_s = recording.motion.t_s.back() - recording.motion.t_s.front();
  if (!box.isEmpty()) {
    scales.low_W_m = box.min();
    scales.high_W_m = box.max();
  }
  return scales;
}

CandidateFit candidate_fit(const Candidate& candidate, const RecordingScales& scales, const Recording& recording,
                           const Prediction& current) {
  const Context c{candidate, scales, recording, current};
  const double F = scales.force_N;
  using Maker = std::function<CandidateFit(const Context&)>;
  const std::map<std::string, Maker> makers{
      {"coulomb-friction", coulomb},
      {"stribeck-friction", stribeck},
      {"anisotropic-friction", anisotropic},
      {"viscous-friction",
       [&](const Context& x) { return one_rate(x, "coefficient_N_s_per_m", scales.speed_m_per_s); }},
      {"normal-damping",
       [&](const Context& x) { return one_rate(x, "coefficient_N_s_per_m", scales.depth_rate_m_per_s); }},
      {"hunt-crossley",
       [&](const Context& x) {
         return one_rate(x, "coefficient_N_s_per_m2", scales.depth_rate_m_per_s * scales.depth_m);
       }},
      {"power-law-stiffness", power_law},
      {"stiffness-map",
       [](const Context& x) {
         const ParameterDeclaration& bounds = declared(x, "amplitude");
         return bump(x, BumpOf::stiffness, 1.0, bounds.minimum, bounds.maximum);
       }},
      {"stress-relaxation", relaxation},
      {"tip-radius", tip_radius},
      {"adhesion", adhesion},
      {"surface-texture", texture},
      {"tool-weight", [](const Context& x) { return one_linear(x, "mass_kg", 0.1, 0.0); }},
      {"tool-inertia", tool_inertia},
      {"force-bias",
       [&](const Context& x) {
         return several_linear(x, {"fx_N", "fy_N", "fz_N"}, {F, F, F}, 2.0);
       }},
      {"force-drift",
       [&](const Context& x) {
         const double rate = F / std::max(scales.duration_s, 1e-9);
         return several_linear(x, {"fx_N_per_s", "fy_N_per_s", "fz_N_per_s"}, {rate, rate, rate}, 4.0);
       }},
      {"force-crosstalk",
       [](const Context& x) {
         const double largest = std::min(declared(x, "c_xz").maximum, declared(x, "c_yz").maximum);
         return several_linear(x, {"c_xz", "c_yz"}, {1.0, 1.0}, largest);
       }},
      {"force-saturation", saturation},
      {"time-lag", [](const Context& x) { return one_linear(x, "lag_s", 0.01, 0.005); }},
      {"registration", registration},
      {"surface-geometry", [&](const Context& x) { return bump(x, BumpOf::surface, scales.depth_m, -1.0, 1.0); }},
  };
  // These are lengths along the surface, in terms of the way over it.
  static const std::set<std::string> along_surface{"stiffness-map", "surface-geometry", "surface-texture",
                                                   "tip-radius"};
  const bool needs_way = is_field(candidate.parameters) || along_surface.count(candidate.name) > 0;
  if (needs_way && !scales.over_surface()) return {candidate.side, {}, {}};
  const auto known = makers.find(candidate.name);
  CandidateFit fit = is_field(candidate.parameters) ? field(c) : known == makers.end() ? generic(c) : known->second(c);
  fit.side = candidate.side;
  return fit;
}

double surface_displacement_m(const NamedParameters& entry, const MotionColumns& motion, const std::vector<Vec3>& n_W) {
  const auto& p = entry.parameters;
  if (entry.name == "surface-geometry" || entry.name == "surface-texture") return std::abs(p.at("amplitude_m"));
  if (entry.name == "height-field") {
    const SmoothField height = field_of(entry.parameters, entry.place);
    double squares = 0.0;
    double count = 0.0;
    for (std::size_t i = 0; i < motion.size(); ++i) {
      if (n_W[i].isZero()) continue;
      squares += std::pow(height.at(motion.p_W_m[i].x(), motion.p_W_m[i].y()), 2);
      count += 1.0;
    }
    return count > 0.0 ? std::sqrt(squares / count) : 0.0;
  }
  if (entry.name != "registration") return std::numeric_limits<double>::infinity();
  const Vec3 shift(p.at("dx_m"), p.at("dy_m"), p.at("dz_m"));
  const Vec3 turn(p.at("rx_rad"), p.at("ry_rad"), 0.0);
  double squares = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < motion.size(); ++i) {
    if (n_W[i].isZero()) continue;
    const double along_m = n_W[i].dot(shift + turn.cross(motion.p_W_m[i]));
    squares += along_m * along_m;
    count += 1.0;
  }
  return count > 0.0 ? std::sqrt(squares / count) : shift.norm();
}

}  // namespace touchstone::discrepancy
