#include "harness/discrepancy/identifiability.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "harness/rendering/surface_frame.h"
#include "harness/stats/quantile.h"

namespace touchstone::discrepancy {
using recording::Recording;
using rendering::displacement_of;
using rendering::Model;
using rendering::NamedParameters;
using rendering::Prediction;

namespace {

constexpr double half95 = 1.96;
// An eigenvalue below this share of the largest is zero for derivatives by differences in double precision.
constexpr double zero_share = 1e-12;
// Of the way that the tip slides: less to and fro along an axis is the jitter of a hand, no stroke.
constexpr double least_both_ways = 0.02;
// Side of a cell, as a share of the diagonal of what was scanned: over it the slope of the surface is one number.
constexpr double cell_share = 0.05;

bool is_angle(const std::string& name) { return name == "direction_rad" || name == "phase_rad"; }
bool is_place(const std::string& name) { return name == "x_m" || name == "y_m"; }

// Half of a 95 % interval from which nothing is known, in u (see free_parameter.h).
double widest_half(const FreeParameter& parameter, double u) {
  constexpr double half_scan = 0.5;  // x and y are in units of the scan: anywhere in it
  // Within a decade to both sides.
  if (parameter.logarithmic) return std::numbers::ln10;
  if (is_place(parameter.name)) return half_scan;
  // A quarter turn to both sides is any line; the bounds span two turns to both sides.
  if (is_angle(parameter.name)) return (parameter.upper - parameter.lower) / 8.0;
  return std::max(1.0, std::abs(u));
}

// Tangential velocities of the samples in contact, over a tenth of a second; zero elsewhere.
std::vector<Vec3> sliding(const MotionColumns& motion, const Prediction& prediction) {
  constexpr double half_window_s = 0.05;
  std::vector<Vec3> v_W(motion.size(), Vec3::Zero());
  std::size_t low = 0;
  std::size_t high = 0;
  for (std::size_t i = 0; i < motion.size(); ++i) {
    while (motion.t_s[low] < motion.t_s[i] - half_window_s) ++low;
    while (high + 1 < motion.size() && motion.t_s[high] < motion.t_s[i] + half_window_s) ++high;
    const Vec3& n = prediction.n_W[i];
    if (n.isZero() || high == low) continue;
    const Vec3 v = (motion.p_W_m[high] - motion.p_W_m[low]) / (motion.t_s[high] - motion.t_s[low]);
    v_W[i] = v - n.dot(v) * n;
  }
  return v_W;
}

}  // namespace

double both_ways_share(const Recording& recording, const Prediction& prediction, int axis) {
  const auto v_W = sliding(recording.motion, prediction);
  std::vector<double> speeds;
  Box3 box;
  for (std::size_t i = 0; i < v_W.size(); ++i) {
    if (v_W[i].isZero()) continue;
    speeds.push_back(v_W[i].norm());
    box.extend(recording.motion.p_W_m[i]);
  }
  if (speeds.empty()) return 0.0;
  // Slower, or less than half along the axis, it is no stroke along it.
  const double slow = 0.3 * stats::lower_quantile(std::move(speeds), 0.8);
  constexpr double along = 0.5;
  const double cell_m = cell_share * box.diagonal().norm();
  const auto cell_of = [&](const Vec3& p_W_m) {
    const Vec3 cell = (p_W_m - box.min()) / cell_m;
    return std::array{std::lround(std::floor(cell.x())), std::lround(std::floor(cell.y())),
                      std::lround(std::floor(cell.z()))};
  };
  struct Ways {
    double forth_m = 0.0;
    double back_m = 0.0;
  };
  std::map<std::array<long, 3>, Ways> cells;
  double all_m = 0.0;
  for (std::size_t i = 1; i < v_W.size(); ++i) {
    const double dt_s = recording.motion.t_s[i] - recording.motion.t_s[i - 1];
    const double speed = v_W[i].norm();
    all_m += speed * dt_s;
    if (!(speed > slow) || !(std::abs(v_W[i][axis]) > along * speed)) continue;
    Ways& ways = cells[cell_of(recording.motion.p_W_m[i])];
    (v_W[i][axis] > 0.0 ? ways.forth_m : ways.back_m) += std::abs(v_W[i][axis]) * dt_s;
  }
  double both_m = 0.0;
  for (const auto& [cell, ways] : cells) both_m += 2.0 * std::min(ways.forth_m, ways.back_m);
  return all_m > 0.0 ? both_m / all_m : 0.0;
}

std::vector<Undetermined> find_undetermined(const FitData& data, const Recording& recording, const Model& model,
                                            const std::vector<FreeParameter>& parameters,
                                            const EffectLibrary& library) {
  std::vector<Undetermined> found;
  const Eigen::MatrixXd information = information_matrix(data, model, parameters);
  if (information.size() == 0) return found;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(information);
  const double largest = eigen.eigenvalues().maxCoeff();
  const Prediction prediction = data.predictor->predict(model);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const FreeParameter& parameter = parameters[i];
    if (find_entry(model, parameter.owner) == nullptr) continue;  // the base renderer's own
    if (parameter.coefficient) continue;                          // where nothing touches, its neighbours give it
    double variance = 0.0;
    for (Eigen::Index k = 0; k < information.rows(); ++k) {
      const double part = eigen.eigenvectors()(static_cast<Eigen::Index>(i), k);
      variance += part * part / std::max(eigen.eigenvalues()[k], zero_share * largest);
    }
    if (half95 * std::sqrt(variance) > widest_half(parameter, parameter.get(model))) {
      std::vector<std::string> names = parameter.also;
      names.push_back(parameter.name);
      for (const std::string& name : names) {
        const bool known = std::ranges::any_of(
            found, [&](const Undetermined& one) { return one.effect == parameter.owner && one.parameter == name; });
        if (!known) found.push_back({parameter.owner, name, "this motion shows no difference when it changes"});
      }
      continue;
    }
    const auto& along_axes = library.traits(parameter.owner).along_axes;
    for (const int axis : {0, 1}) {
      if (parameter.name != along_axes.at(static_cast<std::size_t>(axis))) continue;
      if (both_ways_share(recording, prediction, axis) >= least_both_ways) continue;
      // Friction one way only is a tilt of the surface: a force along it in proportion to the load.
      found.push_back({parameter.owner, parameter.name,
                       fmt::format("no place is crossed both ways along {}, and one way a tilt of the surface does "
                                   "the same",
                                   axis == 0 ? "x" : "y")});
    }
  }
  return found;
}

bool is_size(const FreeParameter& parameter) {
  return !parameter.logarithmic && !parameter.coefficient && !is_angle(parameter.name) && !is_place(parameter.name) &&
         parameter.name != "exponent";
}

std::vector<std::string> without_size(const std::vector<Undetermined>& undetermined,
                                      const std::vector<FreeParameter>& parameters) {
  std::vector<std::string> names;
  for (const Undetermined& one : undetermined) {
    if (std::find(names.begin(), names.end(), one.effect) != names.end()) continue;
    bool any_size = false;
    bool any_known = false;
    for (const FreeParameter& parameter : parameters) {
      if (parameter.owner != one.effect || !is_size(parameter)) continue;
      any_size = true;
      any_known = any_known || std::none_of(undetermined.begin(), undetermined.end(), [&](const Undetermined& other) {
                    return other.effect == parameter.owner && other.parameter == parameter.name;
                  });
    }
    if (any_size && !any_known) names.push_back(one.effect);
  }
  return names;
}

namespace {

// A contact that sticks gives way sideways by mu N / k_t before it slides, and its tangential stiffness k_t is at least
// two thirds of the normal one (Mindlin 1949). A longer path is something else's.
void question_paths(const Recording& recording, const Prediction& prediction, const Model& model,
                    double position_noise_m, std::vector<Question>& questions) {
  constexpr double softest_sideways = 1.5;  // k_n / k_t
  constexpr double noise_paths = 12.0;      // a path that a tracker's noise hides
  std::vector<double> depths;
  for (std::size_t i = 0; i < recording.size(); ++i) {
    if (!prediction.n_W[i].isZero()) depths.push_back(prediction.depth_m[i]);
  }
  const double depth_m = depths.empty() ? 0.0 : stats::lower_quantile(std::move(depths), 0.9);
  for (const NamedParameters& entry : model.effects) {
    const auto path = entry.parameters.find("presliding_m");
    if (path == entry.parameters.end()) continue;
    double mu = 0.0;
    for (const char* const name : {"mu_static", "mu_dynamic", "mu_x", "mu_y", "mu_reference"}) {
      const auto coefficient = entry.parameters.find(name);
      if (coefficient != entry.parameters.end()) mu = std::max(mu, coefficient->second);
    }
    const double longest_m = noise_paths * position_noise_m + (0.02 + softest_sideways * mu) * depth_m;
    if (!(path->second > longest_m)) continue;
    questions.push_back(
        {entry.name, fmt::format("presliding_m of {} is {:.3g}: an object pressed in by {:.3g} m gives way "
                                 "sideways by {:.3g} m at most before the tip slides; over so long a path "
                                 "it is a spring along the surface, as of a compliant tool that sticks "
                                 "and slips",
                                 entry.name, path->second, depth_m, longest_m)});
  }
}

// A coefficient that does not fall with speed is not that of a law whose coefficient falls.
void question_falling(const NamedParameters& law, std::vector<Question>& questions) {
  constexpr double no_fall = 1.02;  // two coefficients that differ by 2 % are one
  if (law.parameters.at("mu_static") <= no_fall * law.parameters.at("mu_dynamic"))
    questions.push_back({law.name, "its coefficient does not fall with speed: mu_static is mu_dynamic"});
}

void question_place(const Recording& recording, const Prediction& prediction, const NamedParameters& moved,
                    std::vector<Question>& questions) {
  Vec3 normal = Vec3::Zero();
  Box3 box;
  for (std::size_t i = 0; i < prediction.n_W.size(); ++i) {
    if (prediction.n_W[i].isZero()) continue;
    normal += prediction.n_W[i];
    box.extend(recording.motion.p_W_m[i]);
  }
  const Vec3 n = normal.norm() > 0.0 ? Vec3(normal.normalized()) : Vec3(Vec3::UnitZ());
  const Vec3 shift = displacement_of(moved.parameters).at(box.isEmpty() ? Vec3(Vec3::Zero()) : Vec3(box.center()));
  const double along_m = (shift - n.dot(shift) * n).norm();
  // A tracker and a mesh that are registered at all agree to far better than this share of what was scanned.
  constexpr double far_off = 0.1;
  if (!box.isEmpty() && along_m > far_off * box.diagonal().norm()) {
    questions.push_back({moved.name, fmt::format("it moves the object along its surface by {:.3g} m, {:.0f} % of what "
                                                 "was scanned: a stiffness or a shape that differs over the surface "
                                                 "can do the same",
                                                 along_m, 100.0 * along_m / box.diagonal().norm())});
  }
}

}  // namespace

std::vector<Question> question_values(const Recording& recording, const Prediction& prediction, const Model& model,
                                      const std::vector<FreeParameter>& parameters, const JointFit& fit,
                                      double position_noise_m, const EffectLibrary& library) {
  std::vector<Question> questions;
  for (std::size_t i = 0; i < parameters.size() && i < fit.at_bound.size(); ++i) {
    const FreeParameter& parameter = parameters[i];
    const NamedParameters* const entry = find_entry(model, parameter.owner);
    // At zero an effect or a part of it is not there; the shortest path is that of plain dry friction.
    const bool upper = parameter.get(model) > 0.5 * (parameter.lower + parameter.upper);
    if (entry == nullptr || parameter.coefficient || !fit.at_bound[i] || !upper || is_angle(parameter.name)) continue;
    questions.push_back(
        {parameter.owner, fmt::format("{} of {} is at {:.3g}, the end of what is sought", parameter.name,
                                      parameter.owner, entry->parameters.at(parameter.name))});
  }
  question_paths(recording, prediction, model, position_noise_m, questions);
  for (const auto* const entries : {&model.effects, &model.instrument}) {
    for (const NamedParameters& entry : *entries) {
      const rendering::EffectTraits& traits = library.traits(entry.name);
      if (traits.velocity_weakening) question_falling(entry, questions);
      if (traits.surface == rendering::EffectTraits::Surface::moved)
        question_place(recording, prediction, entry, questions);
    }
  }
  return questions;
}

}  // namespace touchstone::discrepancy
