#include "axis_fit.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "axis_design.h"
#include "harness/base/error.h"
#include "harness/base/least_squares.h"
#include "harness/stats/quantile.h"

namespace touchstone::axis {
namespace {

constexpr std::size_t block_count = 20;
// A term is taken if the held-out blocks gain by so many standard errors, and its coefficient is so many from zero.
// Student's t with 19 degrees of freedom exceeds 3.5 by chance in 0.12 % of the trials; about ten are made.
constexpr double clear = 3.5;
// And if it takes away so much of the RMS: less is no explanation of anything.
constexpr double least_gain = 0.02;
constexpr std::array<Eigen::Index, 3> knot_counts{6, 12, 24};

// Held-out blocks: the normal equations of each block are added up once, and each block taken out in turn.
struct Judged {
  AxisStructure structure;
  Eigen::VectorXd x;                     // from all samples
  std::vector<double> square_of_block;   // mean held-out square, block by block
  std::vector<Eigen::VectorXd> without;  // coefficients without each block
  [[nodiscard]] double rms() const {
    double sum = 0.0;
    for (const double square : square_of_block) sum += square / static_cast<double>(square_of_block.size());
    return std::sqrt(sum);
  }
  // The first term's column is that behind the knots.
  [[nodiscard]] double coefficient(Eigen::Index term) const { return x[structure.knots + term]; }
  // Delete-one-group jackknife.
  [[nodiscard]] double error(Eigen::Index term) const {
    const auto n = static_cast<double>(without.size());
    double mean = 0.0, square = 0.0;
    for (const auto& one : without) mean += one[structure.knots + term] / n;
    for (const auto& one : without) square += std::pow(one[structure.knots + term] - mean, 2);
    return std::sqrt((n - 1.0) / n * square);
  }
  [[nodiscard]] bool determined(Eigen::Index term) const { return coefficient(term) > clear * error(term); }
};

Eigen::VectorXd solve(Eigen::MatrixXd normal, const Eigen::VectorXd& right, const AxisStructure& structure) {
  // A touch of smoothness, so that a knot without samples has its neighbours' value.
  const double weight = 1e-6 * normal.topLeftCorner(structure.knots, structure.knots).diagonal().maxCoeff();
  const auto smooth = [&](Eigen::Index from, Eigen::Index count) {
    for (Eigen::Index k = from; k + 1 < from + count; ++k) {
      normal(k, k) += weight, normal(k + 1, k + 1) += weight;
      normal(k, k + 1) -= weight, normal(k + 1, k) -= weight;
    }
  };
  smooth(0, structure.knots);
  if (structure.friction_over_place) smooth(structure.columns() - friction_knots, friction_knots);
  return solve_symmetric(normal, right);
}

Judged judge(const AxisSamples& s, const AxisStructure& structure) {
  const Eigen::MatrixXd a = design_of(s, structure, s.used);
  Eigen::VectorXd b(a.rows());
  for (Eigen::Index row = 0; row < a.rows(); ++row) b[row] = s.load[s.used[static_cast<std::size_t>(row)]];
  std::vector<Eigen::MatrixXd> normals;
  std::vector<Eigen::VectorXd> rights;
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(a.cols(), a.cols());
  Eigen::VectorXd right = Eigen::VectorXd::Zero(a.cols());
  const auto bounds = [&](std::size_t block) {
    const Eigen::Index from = a.rows() * static_cast<Eigen::Index>(block) / static_cast<Eigen::Index>(block_count);
    const Eigen::Index to = a.rows() * static_cast<Eigen::Index>(block + 1) / static_cast<Eigen::Index>(block_count);
    return std::pair{from, to - from};
  };
  for (std::size_t block = 0; block < block_count; ++block) {
    const auto [from, count] = bounds(block);
    const auto part = a.middleRows(from, count);
    normals.emplace_back(part.transpose() * part);
    rights.emplace_back(part.transpose() * b.segment(from, count));
    normal += normals.back(), right += rights.back();
  }
  Judged judged;
  judged.structure = structure;
  judged.x = solve(normal, right, structure);
  for (std::size_t block = 0; block < block_count; ++block) {
    const auto [from, count] = bounds(block);
    judged.without.push_back(solve(normal - normals[block], right - rights[block], structure));
    const Eigen::VectorXd left = b.segment(from, count) - a.middleRows(from, count) * judged.without.back();
    judged.square_of_block.push_back(left.squaredNorm() / static_cast<double>(count));
  }
  return judged;
}

// Whether `b` leaves less than `a` beyond chance and by enough: paired differences of the blocks.
bool clearly_better(const Judged& a, const Judged& b) {
  if (!(b.rms() < (1.0 - least_gain) * a.rms())) return false;
  const auto n = static_cast<double>(a.square_of_block.size());
  double mean = 0.0, square = 0.0;
  for (std::size_t k = 0; k < a.square_of_block.size(); ++k) mean += (a.square_of_block[k] - b.square_of_block[k]) / n;
  for (std::size_t k = 0; k < a.square_of_block.size(); ++k) {
    square += std::pow(a.square_of_block[k] - b.square_of_block[k] - mean, 2);
  }
  return mean > 2.0 * std::sqrt(square / (n * (n - 1.0)));
}

void check_run(const AxisRun& run) {
  const bool whole = run.place.size() == run.t_s.size() && run.load.size() == run.t_s.size() &&
                     (run.rate.empty() || run.rate.size() == run.t_s.size());
  if (!whole || run.t_s.size() < fewest_samples) {
    throw BadData(fmt::format("{}: {} samples of one axis; at least {} of each column are needed", run.source,
                              run.t_s.size(), fewest_samples));
  }
  for (const auto& [name, column] : {std::pair{"place", &run.place}, {"rate", &run.rate}, {"load", &run.load}}) {
    const auto bad = std::ranges::find_if_not(*column, [](double value) { return std::isfinite(value); });
    if (bad == column->end()) continue;
    throw BadData(fmt::format("{}: sample {}: the {} is {}, and a finite number was expected; take that line out",
                              run.source, bad - column->begin() + 1, name, *bad));
  }
  for (std::size_t i = 1; i < run.t_s.size(); ++i) {
    if (!(run.t_s[i] > run.t_s[i - 1])) {
      throw BadData(fmt::format("{}: sample {}: time does not increase", run.source, i + 1));
    }
  }
}

// The fewest knots that leave hardly more than the most do.
AxisStructure with_knots(const AxisSamples& s, AxisStructure structure) {
  constexpr double hardly_more = 1.01;
  std::vector<double> left;
  for (const Eigen::Index knots : knot_counts) {
    structure.knots = knots;
    left.push_back(judge(s, structure).rms());
  }
  const double least = *std::ranges::min_element(left);
  std::size_t chosen = 0;
  while (left[chosen] > hardly_more * least) ++chosen;
  structure.knots = knot_counts[chosen];
  return structure;
}

// Steps of a grid of widths and of time constants.
constexpr double grid_step = 1.6;

// Dry friction with the reversal and its width that leave least, if they are clearly better than turning at once.
Judged with_width(const AxisSamples& s, Judged best) {
  const double span = s.highest - s.lowest;
  const Judged sharp = best;
  AxisStructure structure = sharp.structure;
  for (const bool backlash : {false, true}) {
    structure.backlash = backlash;
    for (double width = 0.002 * span; width < 0.3 * span; width *= grid_step) {
      structure.width = width;
      Judged judged = judge(s, structure);
      if (judged.determined(0) && clearly_better(sharp, judged) && judged.rms() < best.rms()) best = std::move(judged);
    }
  }
  return best;
}

// What `b` has and `a` has not.
std::string added_terms(const AxisStructure& a, const AxisStructure& b) {
  std::string names;
  const auto add = [&](bool had, bool has, AxisTermKind kind) {
    if (has && !had) names += (names.empty() ? "" : ", ") + std::string(to_string(kind));
  };
  add(a.dry || a.friction_over_place, b.dry, AxisTermKind::dry_friction);
  add(a.friction_over_place, b.friction_over_place, AxisTermKind::friction_over_place);
  add(a.viscous, b.viscous, AxisTermKind::viscous_friction);
  add(a.inertia, b.inertia, AxisTermKind::inertia);
  add(a.width > 0.0, b.width > 0.0, AxisTermKind::reversal_width);
  add(a.tau_s > 0.0, b.tau_s > 0.0, AxisTermKind::relaxation);
  return names;
}

// Dry or viscous friction, both, or none, and whether the motion can tell.
Judged choose_friction(const AxisSamples& s, const AxisStructure& bare, AxisFit& fit) {
  const auto with = [&](bool dry, bool viscous) {
    AxisStructure structure = bare;
    structure.dry = dry, structure.viscous = viscous;
    return judge(s, structure);
  };
  const Judged none = with(false, false), sharp = with(true, false), viscous = with(false, true);
  // After a reversal presliding looks viscous: it goes first.
  const Judged dry = with_width(s, sharp);
  fit.dry_alone = dry.coefficient(0), fit.viscous_alone = viscous.coefficient(0);
  fit.dry_left = dry.rms(), fit.viscous_left = viscous.rms();
  fit.steps.push_back({"place", none.rms()});
  if (!clearly_better(none, dry) && !clearly_better(none, viscous)) return none;
  const bool dry_better = dry.rms() <= viscous.rms();
  const Judged& best = dry_better ? dry : viscous;
  fit.reversed = best.coefficient(0) < 0.0;
  // Speeds that hardly vary leave the split to accidents: both coefficients must be determined.
  constexpr double one_speed = 1.5;
  AxisStructure with_both = dry.structure;
  with_both.viscous = true;
  const Judged both = judge(s, with_both);
  const bool split = both.determined(0) && both.determined(1);
  const bool told = clearly_better(dry_better ? viscous : dry, best);
  fit.friction_undecided = fit.fastest < one_speed * fit.slowest || (!told && !split);
  const Judged& chosen = !fit.friction_undecided && split && clearly_better(best, both) ? both : best;
  fit.steps.push_back({added_terms(bare, chosen.structure), chosen.rms()});
  return chosen;
}

// Each further term in turn, the one that leaves least first, until none is clearly better.
Judged add_terms(const AxisSamples& s, Judged best, AxisFit& fit) {
  const double duration_s = s.t_s.back() - s.t_s.front();
  const double interval_s = duration_s / static_cast<double>(s.t_s.size() - 1);
  for (bool added = true; added;) {
    added = false;
    std::vector<Judged> tried;
    const auto consider = [&](const AxisStructure& structure, Eigen::Index term) {
      Judged judged = judge(s, structure);
      if (term >= 0 && !judged.determined(term)) return;
      if (clearly_better(best, judged)) tried.push_back(std::move(judged));
    };
    const AxisStructure& now = best.structure;
    if (!now.inertia) {
      AxisStructure next = now;
      next.inertia = true;
      consider(next, Eigen::Index{next.dry} + Eigen::Index{next.viscous});
    }
    if (now.tau_s == 0.0) {
      // From a few samples to a third of the run.
      for (double tau_s = 10.0 * interval_s; tau_s < duration_s / 3.0; tau_s *= grid_step) {
        AxisStructure next = now;
        next.tau_s = tau_s;
        consider(next, next.terms() - 1);
      }
    }
    if (now.dry && !now.friction_over_place) {
      AxisStructure next = now;
      next.friction_over_place = true;
      next.dry = false;
      consider(next, -1);
    }
    if (tried.empty()) break;
    const AxisStructure before = best.structure;
    best = *std::ranges::min_element(tried, {}, [](const Judged& one) { return one.rms(); });
    fit.steps.push_back({added_terms(before, best.structure), best.rms()});
    added = true;
  }
  return best;
}

// A width or time constant between the places of its grid.
Judged improved(const AxisSamples& s, Judged best, double AxisStructure::*value) {
  for (double step = std::sqrt(grid_step); step > 1.02; step = std::sqrt(step)) {
    for (const double factor : {step, 1.0 / step}) {
      AxisStructure next = best.structure;
      next.*value *= factor;
      Judged judged = judge(s, next);
      if (judged.rms() < best.rms()) best = std::move(judged);
    }
  }
  return best;
}

// Presliding against backlash, each with the width that leaves least.
Judged choose_reversal(const AxisSamples& s, Judged best, AxisFit& fit) {
  AxisStructure flipped = best.structure;
  flipped.backlash = !flipped.backlash;
  Judged other = judge(s, flipped);
  constexpr int steps_away = 3;
  for (int k = -steps_away; k <= steps_away; ++k) {
    AxisStructure next = flipped;
    next.width *= std::pow(grid_step, k);
    Judged judged = judge(s, next);
    if (judged.rms() < other.rms()) other = std::move(judged);
  }
  other = improved(s, std::move(other), &AxisStructure::width);
  if (other.rms() < best.rms()) std::swap(best, other);
  const AxisReversal shape = best.structure.backlash ? AxisReversal::backlash : AxisReversal::presliding;
  fit.reversal = clearly_better(other, best) ? shape : AxisReversal::undecided;
  return best;
}

Judged fitted_again(const AxisSamples& s, const AxisStructure& structure) {
  Judged best = judge(s, structure);
  if (structure.width > 0.0) best = improved(s, std::move(best), &AxisStructure::width);
  if (structure.tau_s > 0.0) best = improved(s, std::move(best), &AxisStructure::tau_s);
  return best;
}

// Takes back what a later term, or a finer width or time constant, makes needless: as long as a term can go and what is
// left is not clearly worse for it.
Judged drop_terms(const AxisSamples& s, Judged best, AxisFit& fit) {
  for (;;) {
    const AxisStructure now = best.structure;
    std::vector<AxisStructure> without;
    const auto leave_out = [&](bool there, auto change) {
      if (!there) return;
      without.push_back(now);
      change(without.back());
    };
    leave_out(now.dry, [](AxisStructure& a) { a.dry = false, a.width = 0.0, a.backlash = false; });
    leave_out(now.viscous, [](AxisStructure& a) { a.viscous = false; });
    leave_out(now.inertia, [](AxisStructure& a) { a.inertia = false; });
    leave_out(now.width > 0.0, [](AxisStructure& a) { a.width = 0.0, a.backlash = false; });
    leave_out(now.tau_s > 0.0, [](AxisStructure& a) { a.tau_s = 0.0; });
    std::optional<Judged> kept;
    for (const AxisStructure& structure : without) {
      Judged judged = fitted_again(s, structure);
      if (!clearly_better(judged, best) && (!kept || judged.rms() < kept->rms())) kept = std::move(judged);
    }
    if (!kept) return best;
    fit.steps.push_back({"without " + added_terms(kept->structure, now), kept->rms()});
    best = *std::move(kept);
  }
}

Judged refine(const AxisSamples& s, Judged best, AxisFit& fit) {
  best = drop_terms(s, fitted_again(s, best.structure), fit);
  if (best.structure.width > 0.0) best = choose_reversal(s, std::move(best), fit);
  const AxisStructure knotted = with_knots(s, best.structure);
  return knotted.knots == best.structure.knots ? best : judge(s, knotted);
}

// The standard deviation of a column's noise: that of second differences is sqrt(6) times as large. What the column
// bends within three samples counts as noise, too.
double noise_of(const std::vector<double>& column) {
  double square = 0.0;
  for (std::size_t i = 2; i < column.size(); ++i)
    square += std::pow(column[i] - 2.0 * column[i - 1] + column[i - 2], 2);
  return std::sqrt(square / 6.0 / static_cast<double>(column.size() - 2));
}

// The loop's area over a mean cycle: the integral of the load over the place, whatever h is.
void measure_loop(const AxisSamples& s, AxisFit& fit) {
  const std::vector<double> z = directions(s, 0.0, false);
  double work = 0.0;
  for (std::size_t i = 1; i < s.place.size(); ++i) {
    work += 0.5 * (s.load[i] + s.load[i - 1]) * (s.place[i] - s.place[i - 1]);
    if (z[i] != z[i - 1]) ++fit.reversals;
  }
  fit.loss = fit.reversals > 0 ? 2.0 * work / static_cast<double>(fit.reversals + 1) : work;
  // Work from place to place may be stored; only around a closed loop must it be lost. The way that is missing to the
  // first place is closed in a straight line: on a spring that is tight there, it holds more than friction loses.
  constexpr double closed = 0.02, clear_deviations = 5.0;
  const double back = s.place.front() - s.place.back();
  if (std::abs(back) > closed * (s.highest - s.lowest)) return;
  const double around = work + 0.5 * (s.load.front() + s.load.back()) * back;
  double of_places = back * back, of_loads = std::pow(s.load.front() - s.load.back(), 2);
  for (std::size_t i = 1; i < s.place.size(); ++i) {
    of_places += std::pow(s.place[i] - s.place[i - 1], 2);
    of_loads += std::pow(s.load[i] - s.load[i - 1], 2);
  }
  const double error = std::hypot(noise_of(s.load) * std::sqrt(of_places), noise_of(s.place) * std::sqrt(of_loads));
  fit.gives_work = around < -clear_deviations * error;
}

void report(const AxisSamples& s, const Judged& best, AxisFit& fit) {
  const AxisStructure& structure = best.structure;
  fit.backlash = structure.backlash;
  Eigen::Index term = 0;
  const auto add = [&](AxisTermKind kind) {
    fit.terms.push_back({kind, best.coefficient(term), best.error(term)});
    ++term;
  };
  if (structure.dry) fit.dry = best.coefficient(term), add(AxisTermKind::dry_friction);
  if (structure.viscous) add(AxisTermKind::viscous_friction);
  if (structure.inertia) add(AxisTermKind::inertia);
  if (structure.tau_s > 0.0) {
    add(AxisTermKind::relaxation);
    fit.terms.push_back({AxisTermKind::relaxation_time, structure.tau_s, {}});
  }
  if (structure.width > 0.0) fit.terms.push_back({AxisTermKind::reversal_width, structure.width, {}});
  for (Eigen::Index k = 0; k < structure.knots; ++k) {
    fit.knots.push_back(knot_place(s, k, structure.knots));
    fit.over_place.push_back(best.x[k]);
  }
  if (structure.friction_over_place) {
    double mean = 0.0, error = 0.0;
    for (Eigen::Index k = 0; k < friction_knots; ++k) {
      mean += best.coefficient(term + k) / static_cast<double>(friction_knots);
      error = std::max(error, best.error(term + k));
    }
    fit.dry = mean;
    fit.terms.push_back({AxisTermKind::friction_over_place, mean, error});
    for (const double knot : fit.knots) {
      const AxisHat hat = hat_at(s, knot, friction_knots);
      fit.friction_over_place.push_back((1.0 - hat.share) * best.coefficient(term + hat.left) +
                                        hat.share * best.coefficient(term + hat.left + 1));
    }
  }
  const auto [low, high] = std::ranges::minmax(fit.over_place);
  fit.place_range = high - low;
}

double term_of(const AxisFit& fit, AxisTermKind kind) {
  const auto found = std::ranges::find(fit.terms, kind, &AxisTerm::kind);
  return found == fit.terms.end() ? 0.0 : found->value;
}

}  // namespace

const char* to_string(AxisTermKind kind) {
  switch (kind) {
    case AxisTermKind::dry_friction:
      return "dry friction";
    case AxisTermKind::viscous_friction:
      return "viscous friction";
    case AxisTermKind::inertia:
      return "inertia";
    case AxisTermKind::friction_over_place:
      return "friction over place";
    case AxisTermKind::reversal_width:
      return "reversal width";
    case AxisTermKind::relaxation:
      return "relaxation";
    case AxisTermKind::relaxation_time:
      return "relaxation time";
  }
  return "";
}

AxisFit fit_axis(const AxisRun& run) {
  check_run(run);
  const AxisSamples s = samples_of(run);
  AxisFit fit;
  fit.samples = s.used.size();
  std::size_t forth = 0, moving = 0;
  std::vector<double> speeds;
  for (const double v : s.rate) {
    if (!(std::abs(v) > share_at_rest * s.usual_speed)) continue;
    ++moving, forth += v > 0.0 ? 1 : 0;
    speeds.push_back(std::abs(v));
  }
  if (!(s.highest > s.lowest) || forth * 20 < moving || forth * 20 > 19 * moving) {
    throw BadData(
        fmt::format("{}: the axis hardly moves both ways; friction and what depends on the place can then not "
                    "be told apart: record there and back over the same places",
                    run.source));
  }
  fit.slowest = stats::lower_quantile(speeds, 0.1), fit.fastest = stats::lower_quantile(speeds, 0.9);
  AxisStructure bare;
  bare.dry = true;
  bare = with_knots(s, bare);
  bare.dry = false;
  const Judged friction = choose_friction(s, bare, fit);
  const Judged best = fit.reversed ? friction : refine(s, add_terms(s, friction, fit), fit);
  report(s, best, fit);
  measure_loop(s, fit);
  double mean = 0.0, square = 0.0;
  for (const std::size_t i : s.used) mean += s.load[i] / static_cast<double>(s.used.size());
  for (const std::size_t i : s.used) square += std::pow(s.load[i] - mean, 2) / static_cast<double>(s.used.size());
  fit.before = std::sqrt(square);
  fit.after = best.rms();
  return fit;
}

std::vector<double> fitted_load(const AxisFit& fit, const AxisRun& run) {
  AxisSamples s = samples_of(run);
  s.lowest = fit.knots.front(), s.highest = fit.knots.back();
  const auto knots = static_cast<Eigen::Index>(fit.knots.size());
  const std::vector<double> z = directions(s, term_of(fit, AxisTermKind::reversal_width), fit.backlash);
  const double tau_s = term_of(fit, AxisTermKind::relaxation_time);
  const std::vector<double> passed = tau_s > 0.0 ? high_passed(s, tau_s) : std::vector<double>(s.place.size());
  const auto at = [](const std::vector<double>& values, const AxisHat& hat) {
    const auto left = static_cast<std::size_t>(hat.left);
    return (1.0 - hat.share) * values[left] + hat.share * values[left + 1];
  };
  std::vector<double> load;
  for (std::size_t i = 0; i < s.place.size(); ++i) {
    const AxisHat hat = hat_at(s, s.place[i], knots);
    const double friction = fit.friction_over_place.empty() ? fit.dry : at(fit.friction_over_place, hat);
    load.push_back(
        at(fit.over_place, hat) + friction * z[i] + term_of(fit, AxisTermKind::viscous_friction) * s.rate[i] +
        term_of(fit, AxisTermKind::inertia) * s.acceleration[i] + term_of(fit, AxisTermKind::relaxation) * passed[i]);
  }
  return load;
}

}  // namespace touchstone::axis
