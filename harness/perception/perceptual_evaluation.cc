#include "harness/perception/perceptual_evaluation.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <set>
#include <tuple>

#include "harness/base/error.h"
#include "harness/base/in_parallel.h"
#include "harness/perception/distances/signal_distance.h"
#include "harness/stats/summary.h"

namespace touchstone::perception {

const std::vector<StatisticalMethod>& statistical_methods() {
  static const std::vector<StatisticalMethod> methods{
      {{"euclidean", "Euclidean distance of the force (eq 8)", "N", false},
       [](const ComparedSeries& s) -> std::optional<double> { return euclidean_distance(s.real_N, s.rendered_N); }},
      {{"pearson", "Pearson correlation of the force", "1", true},
       [](const ComparedSeries& s) { return pearson_correlation(s.real_N, s.rendered_N); }},
      {{"euclidean-filtered", "Euclidean distance after the perceptual filters", "N", false},
       [](const ComparedSeries& s) -> std::optional<double> {
         return euclidean_distance(s.real_felt_N, s.rendered_felt_N);
       }},
      {{"pearson-filtered", "Pearson correlation after the perceptual filters", "1", true},
       [](const ComparedSeries& s) { return pearson_correlation(s.real_felt_N, s.rendered_felt_N); }},
      {{"root-mean-square-error", "root mean square error of the force", "N", false},
       [](const ComparedSeries& s) -> std::optional<double> {
         return std::sqrt(mean_square_error(s.real_N, s.rendered_N));
       }},
      {{"maximum-absolute-error", "maximum absolute error of the force", "N", false},
       [](const ComparedSeries& s) -> std::optional<double> { return maximum_absolute_error(s.real_N, s.rendered_N); }},
      {{"peak-difference", "difference of the peak force, magnitude", "N", false},
       [](const ComparedSeries& s) -> std::optional<double> {
         return std::abs(peak_difference(s.real_N, s.rendered_N));
       }},
      {{"pmse", "perceptual mean square error (eq 9)", "JND^2", false},
       [](const ComparedSeries& s) -> std::optional<double> {
         return mean_square_error(s.real_steps, noticeable_steps(s.rendered_N, s.law));
       }},
      {{"structural-similarity", "structural similarity of the forces (eq 10, 11)", "1", true},
       [](const ComparedSeries& s) -> std::optional<double> {
         StructuralSimilarityConstants constants;
         constants.window = static_cast<std::size_t>(std::max(4.0, std::round(0.1 * s.rate_Hz)));
         constants.stride = constants.window / 2;
         if (s.real_N.size() < constants.window) return std::nullopt;
         return structural_similarity(s.real_N, s.rendered_N, constants);
       }},
  };
  return methods;
}

namespace {

constexpr std::array<std::size_t, 4> window_sizes{5, 10, 20, 40};  // figure 8

// Cuts every column to the first `count` samples.
void cut(HapticDataMatrix& matrix, std::size_t count) {
  for (auto& part : matrix.parts) {
    for (auto* column :
         {&part.force_N, &part.displacement_m, &part.angle_rad, &part.acceleration_m_per_s2, &part.force_rate_N_per_s,
          &part.velocity_m_per_s, &part.displacement_second_rate_m_per_s2, &part.angle_rate_rad_per_s}) {
      column->resize(std::min(count, column->size()));
    }
  }
}

double span_s(const std::vector<PressSignal>& parts) {
  double first = -std::numeric_limits<double>::infinity();
  double last = std::numeric_limits<double>::infinity();
  for (const auto& part : parts) {
    if (part.t_s.empty()) continue;
    first = std::max(first, part.t_s.front());
    last = std::min(last, part.t_s.back());
  }
  return last - first;
}

// Force across the direction of pressing, which the data matrix has no column for.
std::string sideways_remark(const std::vector<PressSignal>& parts, const std::string& who) {
  constexpr double worth_saying = 0.05;  // of the force along it: its direction is then known no better
  for (const auto& part : parts) {
    const double along_N = stats::root_mean_square(part.force_N);
    if (part.sideways_N > fingertip_force.absolute_threshold && part.sideways_N > worth_saying * along_N) {
      return fmt::format(
          "{}: {:.3g} N root mean square lie across the direction of pressing ({:.3g} N along it); this "
          "method compares the force along it alone",
          who, part.sideways_N, along_N);
    }
  }
  return {};
}

void fill(ConditionResult& result, const HapticImage& image) {
  result.extended_rate_hardness_N_per_m = image.extended_rate_hardness_N_per_m;
  result.harmonic_share = image.harmonic_share;
  result.guarded_share = image.guarded_share;
  result.force_reduction = image.felt_force.reduction();
  result.displacement_reduction = image.felt_displacement.reduction();
}

std::vector<std::optional<double>> statistics(const std::vector<double>& real_N, const std::vector<double>& real_felt_N,
                                              const std::vector<double>& rendered_N, const std::vector<double>& felt_N,
                                              const std::vector<double>& real_steps, double rate_Hz,
                                              const WeberLaw& law) {
  std::vector<std::optional<double>> result;
  for (const auto& method : statistical_methods()) {
    result.push_back(method.value({real_N, rendered_N, real_felt_N, felt_N, real_steps, rate_Hz, law}));
  }
  return result;
}

std::vector<const HapticImage*> pointers(const std::vector<HapticImage>& images) {
  std::vector<const HapticImage*> result;
  result.reserve(images.size());
  for (const auto& image : images) result.push_back(&image);
  return result;
}

// Distance of every condition to the real process within each feature block of the scaled images.
void fill_block_distances(PerceptualEvaluation& evaluation, const Eigen::MatrixXd& rows) {
  Eigen::Index at = 0;
  for (const auto& block : evaluation.images.front().blocks) {
    const auto width = static_cast<Eigen::Index>(block.values.size());
    for (std::size_t c = 0; c < evaluation.conditions.size(); ++c) {
      evaluation.conditions[c].block_distance.push_back(
          (rows.row(static_cast<Eigen::Index>(c) + 1) - rows.row(0)).segment(at, width).norm());
    }
    at += width;
  }
}

void rank(std::vector<ConditionResult>& conditions) {
  for (auto& own : conditions) {
    own.rank_perception =
        1 + static_cast<std::size_t>(std::count_if(conditions.begin(), conditions.end(),
                                                   [&](const auto& o) { return o.distance < own.distance; }));
  }
}

void check(const EvaluationOptions& options) {
  const auto refuse = [](const char* what, double value, const char* unit) {
    throw UsageError(fmt::format("{}: 0 or more{} was expected, not {}", what, unit, value));
  };
  for (const auto& [what, value, unit] :
       {std::tuple{"the rate of the haptic data matrix", options.matrix.rate_Hz, " Hz"},
        std::tuple{"the output band", options.image.output_band_Hz, " Hz"},
        std::tuple{"the dead zone of the sensor", options.image.sensor_dead_zone_N, " N"},
        std::tuple{"the tolerance of durations", options.duration_tolerance, ""}}) {
    if (!(value >= 0.0 && std::isfinite(value))) refuse(what, value, unit);
  }
}

// What the method cuts off or does not look at.
void note_what_is_not_judged(const std::vector<PressSignal>& parts, double own_s, double real_s, double rate_Hz,
                             ConditionResult& own) {
  if (own_s > real_s + 1.5 / rate_Hz) {
    own.remarks.push_back(
        fmt::format("condition '{}' lasts {:.4g} s and the real process {:.4g} s: its last {:.3g} s "
                    "are not compared",
                    own.name, own_s, real_s, own_s - real_s));
  }
  if (auto remark = sideways_remark(parts, fmt::format("condition '{}'", own.name)); !remark.empty())
    own.remarks.push_back(std::move(remark));
}

// Fills the images and statistics of all conditions over the reference's length. Returns the number of samples that all
// have: where it is less than the reference's, the results are of no use.
std::size_t compare_all(PerceptualEvaluation& result, const HapticDataMatrix& reference,
                        const std::vector<ConditionSource>& conditions, const EvaluationOptions& options, double real_s,
                        bool keep) {
  HapticDataMatrixOptions matrix_options = options.matrix;
  matrix_options.rate_Hz = reference.rate_Hz;
  matrix_options.second_rates = false;
  result.images.assign(conditions.size() + 1, {});
  result.conditions.assign(conditions.size(), {});
  result.rendered_N.assign(keep ? conditions.size() + 1 : 0, {});
  result.rendered_displacement_m = result.rendered_N;
  const std::vector<double>& real_N = reference.parts.front().force_N;
  result.images[0] = haptic_image(reference, options.image);
  const std::vector<double>& real_felt_N = result.images[0].felt_force.held;
  result.features.clear();
  for (const auto& block : result.images[0].blocks) result.features.push_back(block.name);
  result.real = {};
  result.real.name = "real";
  fill(result.real, result.images[0]);
  const std::vector<double> real_steps = noticeable_steps(real_N, options.image.force_law);
  result.real.statistics =
      statistics(real_N, real_felt_N, real_N, real_felt_N, real_steps, result.rate_Hz, options.image.force_law);
  if (keep) {
    result.rendered_N[0] = real_N;
    result.rendered_displacement_m[0] = reference.parts.front().displacement_m;
  }
  std::mutex mutex;
  std::size_t shortest = reference.size();
  std::size_t done = 0;
  const auto compare = [&](std::size_t c) {
    const auto parts = conditions[c].load();
    const double own_s = span_s(parts);
    if (!(std::abs(own_s - real_s) <= options.duration_tolerance * real_s)) {
      throw BadData(
          fmt::format("condition '{}' lasts {:.4g} s and the real process {:.4g} s; cut or repeat one so that they "
                      "show the same presses",
                      conditions[c].name, own_s, real_s));
    }
    if (parts.size() != reference.parts.size()) {
      throw BadData(fmt::format("condition '{}' has {} measuring parts and the real process {}", conditions[c].name,
                                parts.size(), reference.parts.size()));
    }
    auto matrix = make_haptic_data_matrix(parts, matrix_options);
    {
      const std::scoped_lock lock(mutex);
      shortest = std::min(shortest, matrix.size());
      if (shortest < reference.size()) return;
    }
    cut(matrix, reference.size());
    auto image = haptic_image(matrix, options.image);
    ConditionResult& own = result.conditions[c];
    own.name = conditions[c].name;
    fill(own, image);
    auto& part = matrix.parts.front();
    own.statistics = statistics(real_N, real_felt_N, part.force_N, image.felt_force.held, real_steps, result.rate_Hz,
                                options.image.force_law);
    if (keep) {
      result.rendered_N[c + 1] = std::move(part.force_N);
      result.rendered_displacement_m[c + 1] = std::move(part.displacement_m);
    } else {
      image.felt_force = {};
      image.felt_displacement = {};
    }
    result.images[c + 1] = std::move(image);
    note_what_is_not_judged(parts, own_s, real_s, result.rate_Hz, own);
    const std::scoped_lock lock(mutex);
    ++done;
    if (options.progress) options.progress(done);
  };
  tbb::task_arena arena(options.threads == 0 ? tbb::task_arena::automatic : static_cast<int>(options.threads));
  arena.execute([&] { in_parallel(conditions.size(), compare, 1); });
  return shortest;
}

}  // namespace

std::vector<double> PerceptualEvaluation::values(std::string_view method) const {
  std::vector<double> result;
  if (method == perception_space_method.name) {
    for (const auto& c : conditions) result.push_back(c.distance);
    return result;
  }
  const auto& methods = statistical_methods();
  const auto found =
      std::find_if(methods.begin(), methods.end(), [method](const auto& m) { return m.method.name == method; });
  if (found == methods.end()) throw UsageError(fmt::format("'{}' is no method of comparison", method));
  const auto index = static_cast<std::size_t>(found - methods.begin());
  for (const auto& c : conditions)
    result.push_back(c.statistics[index].value_or(std::numeric_limits<double>::quiet_NaN()));
  return result;
}

PerceptualEvaluation evaluate(const std::vector<PressSignal>& real, const std::vector<ConditionSource>& conditions,
                              const EvaluationOptions& options) {
  if (conditions.empty()) throw BadData("there is no condition to compare with the real process");
  std::set<std::string> names;
  for (const auto& c : conditions) {
    if (!names.insert(c.name).second) throw BadData(fmt::format("two conditions are called '{}'", c.name));
  }
  check(options);
  PerceptualEvaluation result;
  result.scaling = options.scaling;
  result.explained_share_wanted = options.explained_share;
  HapticDataMatrix reference = make_haptic_data_matrix(real, options.matrix);
  result.rate_Hz = reference.rate_Hz;
  const double real_s = span_s(real);
  const bool keep = conditions.size() <= keep_series_up_to;
  // The shortest condition decides how much is compared. Whether one is shorter shows while they are loaded: then all
  // is done once more over that length, rather than loading everything twice every time.
  std::size_t common = reference.size();
  for (;;) {
    cut(reference, common);
    const std::size_t shortest = compare_all(result, reference, conditions, options, real_s, keep);
    if (shortest == common) break;
    common = shortest;
  }
  if (static_cast<double>(common) < std::floor(real_s * result.rate_Hz)) {
    result.remarks.push_back(
        fmt::format("compared over the first {:.4g} s: a condition is shorter than the real process ({:.4g} s)",
                    static_cast<double>(common) / result.rate_Hz, real_s));
  }
  if (auto remark = sideways_remark(real, "the real process"); !remark.empty())
    result.remarks.push_back(std::move(remark));
  for (const auto& c : result.conditions)
    result.remarks.insert(result.remarks.end(), c.remarks.begin(), c.remarks.end());
  result.samples = common;
  const std::vector<double>& real_N = reference.parts.front().force_N;
  std::vector<std::size_t> windows;
  std::copy_if(window_sizes.begin(), window_sizes.end(), std::back_inserter(windows),
               [&](std::size_t w) { return 4 * w < common; });
  result.windows = window_trade_off(real_N, reference.parts.front().displacement_m, result.rate_Hz, windows);

  const auto images = pointers(result.images);
  ScaledImages scaled = scale_images(images, options.scaling);
  result.remarks.insert(result.remarks.end(), scaled.remarks.begin(), scaled.remarks.end());
  result.space = build_perception_space(scaled.rows, options.explained_share);
  if (result.space.dimensions == 0) result.remarks.emplace_back("all conditions are the same as the real process");
  const auto distances = distances_to(result.space.coordinates, 0);
  for (std::size_t c = 0; c < result.conditions.size(); ++c) result.conditions[c].distance = distances[c + 1];
  fill_block_distances(result, scaled.rows);
  rank(result.conditions);
  if (conditions.size() == 1) {
    result.remarks.emplace_back("a single condition has a distance but no rank and no relative similarity");
  }
  if (conditions.size() > 1 && result.space.explained_share < 1.0 - 1e-9) {
    result.remarks.push_back(
        fmt::format("the {} dimensions kept hold {:.4g} % of the variance between these conditions: adding or removing "
                    "one may change the order of the others; --explained 1 keeps all",
                    result.space.dimensions, 100.0 * result.space.explained_share));
  }
  if (result.real.guarded_share > 0.0) {
    result.remarks.push_back(
        fmt::format("rate-hardness: {:.1f} % of the real process's windows had too little motion to divide "
                    "by; the value before them was held",
                    100.0 * result.real.guarded_share));
  }
  return result;
}

std::vector<double> distances_with_scaling(const PerceptualEvaluation& evaluation, FeatureScaling scaling,
                                           double explained_share) {
  const auto scaled = scale_images(pointers(evaluation.images), scaling);
  auto distances = distances_to(build_perception_space(scaled.rows, explained_share).coordinates, 0);
  distances.erase(distances.begin());
  return distances;
}

std::vector<std::vector<double>> distances_by_scaling(const PerceptualEvaluation& evaluation) {
  std::vector<std::vector<double>> result(feature_scalings.size());
  const auto fill = [&](std::size_t s) {
    result[s] = distances_with_scaling(evaluation, feature_scalings[s], evaluation.explained_share_wanted);
  };
  in_parallel(result.size(), fill, 1);
  return result;
}

namespace {

// The feature whose squared distances differ most in the direction of the space's verdict.
Disagreement explained(const PerceptualEvaluation& evaluation, const Method& method, std::size_t a, std::size_t b) {
  const auto& near = evaluation.conditions[a];
  const auto& far = evaluation.conditions[b];
  std::size_t decisive = 0;
  double largest = -std::numeric_limits<double>::infinity();
  for (std::size_t f = 0; f < evaluation.features.size(); ++f) {
    const double gain = std::pow(far.block_distance[f], 2) - std::pow(near.block_distance[f], 2);
    if (gain > largest) {
      largest = gain;
      decisive = f;
    }
  }
  return {a, b, evaluation.features[decisive],
          fmt::format("'{}' has the smaller {}, but its {} is {:.3g} from the real process's where that of '{}' is "
                      "{:.3g} (scaled {})",
                      far.name, method.larger_is_better ? "loss of " + std::string(method.name) : method.name,
                      evaluation.features[decisive], far.block_distance[decisive], near.name,
                      near.block_distance[decisive], name_of(evaluation.scaling))};
}

}  // namespace

Disagreements disagreements(const PerceptualEvaluation& evaluation, std::string_view statistic, std::size_t told) {
  const auto& methods = statistical_methods();
  const auto method =
      std::find_if(methods.begin(), methods.end(), [=](const auto& m) { return m.method.name == statistic; });
  if (method == methods.end()) throw UsageError(fmt::format("'{}' is no statistical method", statistic));
  auto value = evaluation.values(statistic);
  if (method->method.larger_is_better) {
    for (double& v : value) v = -v;
  }
  struct Pair {
    std::size_t a;
    std::size_t b;
    double between;  // ranks
  };
  std::vector<Pair> pairs;
  const bool ranked = std::all_of(value.begin(), value.end(), [](double v) { return std::isfinite(v); });
  const auto by_value = ranked ? stats::ranks(value) : std::vector<double>(value.size(), 0.0);
  const auto rank_in_space = [&](std::size_t c) {
    return static_cast<double>(evaluation.conditions[c].rank_perception);
  };
  for (std::size_t a = 0; a < value.size(); ++a) {
    for (std::size_t b = 0; b < value.size(); ++b) {
      if (!(evaluation.conditions[a].distance < evaluation.conditions[b].distance && value[a] > value[b])) continue;
      pairs.push_back({a, b, rank_in_space(b) - rank_in_space(a) + by_value[a] - by_value[b]});
    }
  }
  Disagreements result;
  result.pairs = pairs.size();
  result.of = value.size() * (value.size() - 1) / 2;
  const auto end = pairs.begin() + static_cast<std::ptrdiff_t>(std::min(told, pairs.size()));
  std::partial_sort(pairs.begin(), end, pairs.end(), [](const Pair& x, const Pair& y) {
    return std::make_tuple(-x.between, x.a, x.b) < std::make_tuple(-y.between, y.a, y.b);
  });
  std::transform(pairs.begin(), end, std::back_inserter(result.most),
                 [&](const Pair& own) { return explained(evaluation, method->method, own.a, own.b); });
  return result;
}

}  // namespace touchstone::perception
