#include "harness/golden/felt_verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "harness/base/error.h"
#include "harness/golden/judges.h"
#include "harness/perception/filters/weber_law.h"
#include "harness/recording/recording_file.h"
#include "harness/rendering/generators.h"
#include "harness/rendering/model.h"
#include "harness/surface/embree_surface.h"

namespace touchstone::golden {
using recording::RenderedTrajectory;
using rendering::Model;

namespace {

// The model's parameter with its default filled in; nothing where the renderer is not of the catalogue or has none.
std::optional<double> parameter_of(const rendering::Catalogue& catalogue, const Model& model, const std::string& name) {
  for (const rendering::RendererEntry& entry : catalogue.renderers()) {
    if (entry.name != model.renderer) continue;
    const rendering::Parameters values(entry.parameters, model.parameters, "renderer " + model.renderer, model.source,
                                       "");
    const auto found = values.values().find(name);
    if (found != values.values().end()) return found->second;
  }
  return std::nullopt;
}

// The smooth body's answer to the tips of a run.
class SmoothBody {
 public:
  // Empty where none is known: no formula, friction, effects.
  static std::optional<SmoothBody> of(const Catalogues& catalogues, const GoldenCase& golden, const Model& model) {
    const auto& known = catalogues.renderers.renderers();
    const auto entry = std::ranges::find(known, model.renderer, &rendering::RendererEntry::name);
    if (golden.surface.generator.empty() || entry == known.end() || !entry->has_exact_answer || !model.effects.empty())
      return std::nullopt;
    return SmoothBody(catalogues, golden, model);
  }

  struct Answer {
    Vec3 f_W_N = Vec3::Zero();
    bool contact = false;
    double allowed_N = 0.0;  // for the mesh that the engine was given
  };
  [[nodiscard]] Answer at(const Vec3& tip_W_m) const {
    const Vec3 p = tip_W_m / scale_;
    const auto exact = generators_->exact_response(*analytic_, p, stiffness_, radius_m_);
    const auto on_mesh = generators_->exact_response(*mesh_, p, stiffness_, radius_m_);
    const double bound_N = stiffness_ * (deviation_m_ + std::sqrt(8.0 * deviation_m_ * exact.depth_m));
    return {scale_ * exact.f_W_N, exact.contact, scale_ * std::min(bound_N, (on_mesh.f_W_N - exact.f_W_N).norm())};
  }
  [[nodiscard]] bool leaves_sheet(const Vec3& from_W_m, const Vec3& to_W_m) const {
    return generators_->leaves_sheet(*analytic_, from_W_m / scale_, to_W_m / scale_, radius_m_);
  }

 private:
  SmoothBody(const Catalogues& catalogues, const GoldenCase& golden, const Model& model)
      : generators_(&catalogues.generators),
        scale_(golden.scale),
        stiffness_(parameter_of(catalogues.renderers, model, "stiffness_N_per_m").value_or(0.0)),
        radius_m_(parameter_of(catalogues.renderers, model, "tip_radius_m").value_or(0.0) / golden.scale),
        analytic_(generators_->surface(golden.surface.generator, golden.surface.parameters)) {
    const auto made = generators_->mesh(golden.surface.generator, golden.surface.parameters, golden.surface.triangles);
    deviation_m_ = made.deviation_bound_m;
    mesh_ = make_embree_surface(made.mesh);
  }

  const rendering::Generators* generators_;
  double scale_;
  double stiffness_;
  double radius_m_;
  double deviation_m_ = 0.0;
  std::shared_ptr<const surface::Surface> analytic_;
  std::shared_ptr<const surface::Surface> mesh_;
};

// What a sample is judged by.
struct RightAnswer {
  enum class By : std::uint8_t { nothing, body, golden };
  By by = By::nothing;
  Vec3 f_W_N = Vec3::Zero();
  double allowed_N = 0.0;
};

std::vector<RightAnswer> right_answers(const Catalogues& catalogues, const GoldenCase& golden, const std::string& model,
                                       const Model& own, const RenderedTrajectory& run) {
  const auto smooth = SmoothBody::of(catalogues, golden, own);
  std::optional<RenderedTrajectory> known;
  if (std::filesystem::exists(golden.expected(model))) known = recording::load_rendered(golden.expected(model));
  if (known && known->size() != run.size()) known.reset();
  std::vector<RightAnswer> right(run.size());
  bool on_sheet = smooth.has_value();
  for (std::size_t i = 0; i < run.size(); ++i) {
    if (smooth) {
      const SmoothBody::Answer answer = smooth->at(run.tip_W_m[i]);
      if (i > 0 && smooth->leaves_sheet(run.tip_W_m[i - 1], run.tip_W_m[i])) on_sheet = false;
      if (!answer.contact && known && known->contact[i] == 0) on_sheet = true;
      if (on_sheet) right[i] = {RightAnswer::By::body, answer.f_W_N, answer.allowed_N};
    }
    if (!on_sheet && known) right[i] = {RightAnswer::By::golden, known->f_W_N[i], 0.0};
  }
  return right;
}

double just_noticeable_N(const RightAnswer& right) {
  return perception::fingertip_force.just_noticeable_difference(right.f_W_N.norm());
}

double felt_jnd(const Vec3& f_W_N, const RightAnswer& right, double epsilon_N) {
  const double off_N = (f_W_N - right.f_W_N).norm();
  // NaN counts as infinite.
  const double felt_N = off_N - off_N == 0.0 ? std::max(0.0, off_N - epsilon_N - right.allowed_N)
                                             : std::numeric_limits<double>::infinity();
  return felt_N / just_noticeable_N(right);
}

bool jumps(const RightAnswer& here, const RightAnswer& beside, double jnd) {
  return beside.by != RightAnswer::By::nothing &&
         (here.f_W_N - beside.f_W_N).norm() > jnd * std::min(just_noticeable_N(here), just_noticeable_N(beside));
}

}  // namespace

FeltError felt_error(const Catalogues& catalogues, const GoldenCase& golden, const std::string& model,
                     const RenderedTrajectory& run, const FeltTolerance& tolerance) {
  const Model own = case_model(golden, model);
  // An epsilon is a length: as force it is that times the steepest rise, which a case's model states.
  const double epsilon_N =
      tolerance.epsilon_m * parameter_of(catalogues.renderers, own, "stiffness_N_per_m").value_or(0.0);
  const std::vector<RightAnswer> right = right_answers(catalogues, golden, model, own, run);
  FeltError error;
  double sum_N = 0.0;
  double square = 0.0;
  for (std::size_t i = 0; i < run.size(); ++i) {
    if (right[i].by == RightAnswer::By::nothing) continue;
    ++(right[i].by == RightAnswer::By::body ? error.by_exact : error.by_golden);
    const Vec3 off = run.f_W_N[i] - right[i].f_W_N;
    const double off_N = off.norm();
    if (i > 0 && right[i - 1].by != RightAnswer::By::nothing)
      error.jump_N = std::max(error.jump_N, (off - (run.f_W_N[i - 1] - right[i - 1].f_W_N)).norm());
    error.right_N = std::max(error.right_N, right[i].f_W_N.norm());
    double jnd = felt_jnd(run.f_W_N[i], right[i], epsilon_N);
    for (const std::size_t j : {i - 1, i + 1}) {
      if (j < run.size() && jumps(right[i], right[j], tolerance.jnd))
        jnd = std::min(jnd, felt_jnd(run.f_W_N[i], right[j], epsilon_N));
    }
    sum_N += off_N;
    square += off_N * off_N;
    error.max_N = std::max(error.max_N, off_N);
    if (jnd > error.max_jnd) {
      error.max_jnd = jnd;
      error.worst_t_s = run.t_s[i];
    }
  }
  const std::size_t judged = error.by_exact + error.by_golden;
  if (judged == 0) {
    throw BadData(fmt::format("{}: neither an exact answer nor a golden of {} samples is known to judge {} by",
                              golden.name, run.size(), model));
  }
  error.reference = error.by_golden == 0 ? "exact" : error.by_exact == 0 ? "golden" : "both";
  error.mean_N = sum_N / static_cast<double>(judged);
  error.rms_N = std::sqrt(square / static_cast<double>(judged));
  error.passed = error.max_jnd <= tolerance.jnd && std::isfinite(error.rms_N);
  return error;
}

void judge_felt(const JudgedRun& judged, CheckResult& result) {
  const auto& tolerance = judged.options.felt;
  if (!tolerance || judged.golden.loop || judged.obtained.columns.empty()) return;
  result.felt = std::make_shared<const FeltError>(
      felt_error(judged.catalogues, judged.golden, judged.model.name, judged.run.rendered, *tolerance));
  result.comparison.problems.push_back(to_sentence(*result.felt, *tolerance));
}

std::string to_sentence(const FeltError& error, const FeltTolerance& tolerance) {
  const std::string by = error.by_exact == 0    ? std::string("golden")
                         : error.by_golden == 0 ? std::string("exact answer")
                                                : fmt::format("exact answer ({} samples) and the golden ({})",
                                                              error.by_exact, error.by_golden);
  return fmt::format(
      "felt: {} from the {}: {:.3g} N rms, {:.3g} N and {:.3g} JND at most, at {:.4g} s (within {:g} JND{})",
      error.passed ? "passes" : "fails", by, error.rms_N, error.max_N, error.max_jnd, error.worst_t_s, tolerance.jnd,
      tolerance.epsilon_m > 0.0 ? fmt::format(" and {:g} m", tolerance.epsilon_m) : "");
}

}  // namespace touchstone::golden
