#include "harness/pipeline/evaluation/run.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <deque>
#include <memory>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/progress.h"
#include "harness/metrics/catalogue.h"
#include "harness/metrics/close_up.h"
#include "harness/metrics/error_map.h"
#include "harness/perception/filters/weber_law.h"
#include "harness/pipeline/evaluation/counted_cost.h"
#include "harness/pipeline/evaluation/inputs.h"
#include "harness/pipeline/evaluation/perceived.h"
#include "harness/pipeline/evaluation/renderer_residual.h"
#include "harness/pipeline/evaluation/sensor_window.h"
#include "harness/recording/recording_writer.h"
#include "harness/rendering/in_trajectory.h"
#include "harness/rendering/measured_renderer.h"
#include "harness/rendering/replay.h"
#include "harness/rendering/seam_watch.h"
#include "harness/report/evaluation_page.h"
#include "harness/report/object_view.h"
#include "harness/report/page_html.h"
#include "harness/report/quantity.h"
#include "harness/report/result_json.h"

namespace touchstone::pipeline {
using metrics::MetricOptions;
using metrics::MetricResult;
using metrics::SeriesRecorder;
using rendering::Catalogue;
using rendering::MeasuredRenderer;
using rendering::OutTrajectorySummary;
using rendering::TipState;
using report::EvaluationResult;

namespace {

// Detail of the drawn error: this many cubes along the longest side of the path's box.
constexpr double cubes_along_path = 96.0;
constexpr std::size_t most_path_points = 8192;

double cell_size(const EvaluationInputs& inputs) {
  const double path = inputs.survey.tips_W_m.diagonal().maxCoeff();
  const double object = inputs.mesh.bounds().diagonal().maxCoeff();
  return (path > 1e-3 * object ? path : object) / cubes_along_path;
}

// A tenth of the usual force, as one significant digit.
double default_force_threshold(const RecordingSurvey& survey) {
  const double tenth = 0.1 * survey.usual_force_N;
  if (!(tenth > 0.0)) return MetricOptions{}.force_threshold_N;
  const double decade = std::pow(10.0, std::floor(std::log10(tenth)));
  return std::round(tenth / decade) * decade;
}

MetricOptions metric_options(const EvaluationRequest& request, const RecordingSurvey& survey) {
  MetricOptions options;
  options.force_floor_N = request.contact_threshold_N;
  options.force_threshold_N = request.force_threshold_N.value_or(default_force_threshold(survey));
  options.position_threshold_m = request.position_threshold_m;
  return options;
}

// What is asked of the catalogue of metrics; perception and operations are beside it.
std::vector<std::string> of_the_catalogue(std::vector<std::string> names) {
  std::erase_if(names, is_perceived_metric);
  std::erase_if(names, is_operation_metric);
  return names;
}

bool asks_for_perception(const std::vector<std::string>& names) {
  return names.empty() || std::ranges::any_of(names, is_perceived_metric);
}

// Everything that looks at the stream of samples.
class Collector {
 public:
  Collector(const EvaluationRequest& request, const EvaluationInputs& inputs)
      : names_(request.metrics),
        ranges_(request.time_ranges),
        first_t_s_(inputs.survey.clock.start_s),
        has_force_(inputs.survey.has_force),
        options_(metric_options(request, inputs.survey)),
        metrics_(of_the_catalogue(request.metrics), {has_force_, true, true}, options_),
        close_ups_(options_.force_threshold_N),
        errors_(cell_size(inputs)),
        noticed_(cell_size(inputs)) {}

  void add(const ComparedSample& sample) {
    const metrics::MetricSample& m = sample.metric;
    if (!ranges_.contains(m.t_s, first_t_s_)) return;
    metrics_.add(m);
    perceived_.add(m, sample.p_W_m);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<Eigen::Index>(axis);
      if (has_force_) measured_[axis].add(m.t_s, m.f_measured_W_N[i]);
      rendered_[axis].add(m.t_s, m.f_rendered_W_N[i]);
    }
    if (has_force_) close_ups_.add(m);
    const double error = has_force_ ? (m.f_measured_W_N - m.f_rendered_W_N).norm() : (m.contact_W_m - m.out_W_m).norm();
    if (sample.touching) {
      errors_.add(sample.surface_W_m, error);
      const double jnd_N = perception::fingertip_force.just_noticeable_difference(m.f_measured_W_N.norm());
      if (has_force_) noticed_.add(sample.surface_W_m, error > jnd_N ? 1.0 : 0.0);
      touched_.extend(sample.surface_W_m);
    }
    if (seen_++ % stride_ == 0) path_.push_back(m.out_W_m);
    if (path_.size() < most_path_points) return;
    for (std::size_t i = 0; 2 * i < path_.size(); ++i) path_[i] = path_[2 * i];
    path_.resize(path_.size() / 2);
    stride_ *= 2;
  }

  void finish(const EvaluationInputs& inputs, EvaluationResult& result) {
    // Names that are all of perception leave none for the catalogue, which would take that for all of its own.
    if (names_.empty() || !of_the_catalogue(names_).empty()) result.metrics = metrics_.results();
    if (asks_for_perception(names_)) {
      for (MetricResult& one : perceived_.results(names_, has_force_)) result.metrics.push_back(std::move(one));
    }
    for (std::size_t axis = 0; has_force_ && axis < 3; ++axis) result.signals.push_back(measured_[axis].series());
    for (const SeriesRecorder& one : rendered_) result.signals.push_back(one.series());
    result.force_threshold_N = options_.force_threshold_N;
    result.position_threshold_m = options_.position_threshold_m;
    const std::vector<metrics::CloseUp> close_ups = close_ups_.worst();
    for (const metrics::Episode& episode : metrics_.force_episodes()) {
      result.episodes.push_back({episode, "force", "N", {}});
      for (const metrics::CloseUp& close_up : close_ups) {
        if (close_up.worst_t_s == episode.worst_t_s) result.episodes.back().signals = close_up.signals;
      }
    }
    for (const metrics::Episode& episode : metrics_.position_episodes()) {
      result.episodes.push_back({episode, "position", "m", {}});
    }
    result.object = report::object_view(inputs.mesh, errors_, touched_, 1.5 * cell_size(inputs));
    result.object.error_name = has_force_ ? "force error" : "position error";
    result.object.error_unit = has_force_ ? "N" : "m";
    if (has_force_) {
      for (const Vec3& v : result.object.vertices_W_m)
        result.object.noticed_share.push_back(noticed_.at(v).value_or(std::nan("")));
    }
    result.path_W_m = path_;
  }

  [[nodiscard]] std::uint64_t seen() const { return seen_; }

 private:
  std::vector<std::string> names_;
  metrics::TimeRanges ranges_;
  double first_t_s_;
  bool has_force_;
  MetricOptions options_;
  metrics::MetricSet metrics_;
  PerceivedQuality perceived_;
  metrics::CloseUpRecorder close_ups_;
  metrics::ErrorMap errors_;
  metrics::ErrorMap noticed_;  // 1 where a person would notice, else 0
  std::array<SeriesRecorder, 3> measured_{SeriesRecorder{"measured_x", "N"}, SeriesRecorder{"measured_y", "N"},
                                          SeriesRecorder{"measured_z", "N"}};
  std::array<SeriesRecorder, 3> rendered_{SeriesRecorder{"rendered_x", "N"}, SeriesRecorder{"rendered_y", "N"},
                                          SeriesRecorder{"rendered_z", "N"}};
  Box3 touched_;
  std::vector<Vec3> path_;
  std::uint64_t seen_ = 0;
  std::uint64_t stride_ = 1;
};

// The recording as a source of renderer input, segment by segment: a gap ends a segment where the request splits.
class MeasuredStream {
 public:
  struct Item {
    double t_s = 0.0;
    Vec3 p_W_m;
    Vec3 f_W_N;
    Quat q_WS;
    rendering::OutSample out;
  };

  MeasuredStream(const EvaluationRequest& request, const EvaluationInputs& inputs, const MeasuredRenderer& comparison)
      : request_(request),
        inputs_(inputs),
        comparison_(comparison),
        stream_(open_recording(request)),
        maker_(*inputs.surface, {inputs.tip_radius_m, request.contact_threshold_N}) {
    for (const Vec3& vertex : inputs.mesh.vertices_W_m) hash_.add_vertex(vertex);
    if (request.clock.on_gap == recording::OnGap::split) {
      longest_step_s_ = request.clock.gap_factor * inputs.survey.clock.median_interval_s;
    }
  }

  // Fills the tip of the next sample; false at the end of a segment.
  bool next(TipState& tip) {
    if (at_ == block_.size()) {
      at_ = 0;
      if (!stream_.next(block_)) return false;
    }
    const double t_s = block_.motion.t_s[at_];
    if (have_last_ && t_s - last_t_s_ > longest_step_s_) {
      have_last_ = false;
      return false;
    }
    Item item;
    item.t_s = t_s;
    item.p_W_m = comparison_.true_position(block_.motion.p_W_m[at_]);
    item.f_W_N = block_.f_W_N.empty() ? Vec3(Vec3::Zero()) : block_.f_W_N[at_];
    if (request_.flip_force) item.f_W_N = -item.f_W_N;
    item.q_WS = block_.motion.q_WS.empty() ? Quat::Identity() : block_.motion.q_WS[at_];
    item.out = maker_(item.p_W_m, item.f_W_N);
    summary_.add(item.out);
    tip = {t_s, in_position(item.out, item.p_W_m, item.f_W_N, inputs_.stiffness_N_per_m, request_.in_trajectory),
           item.q_WS};
    hash_.add(t_s, tip.p_W_m, item.f_W_N, request_.time_ranges.contains(t_s, inputs_.survey.clock.start_s));
    waiting_.push_back(item);
    have_last_ = true;
    last_t_s_ = t_s;
    ++at_;
    return true;
  }

  [[nodiscard]] bool exhausted() const { return at_ == block_.size(); }
  Item take() {
    Item item = waiting_.front();
    waiting_.pop_front();
    return item;
  }
  [[nodiscard]] const OutTrajectorySummary& summary() const { return summary_; }
  [[nodiscard]] std::string hash() const { return hash_.text(); }

 private:
  const EvaluationRequest& request_;
  const EvaluationInputs& inputs_;
  const MeasuredRenderer& comparison_;
  recording::RecordingStream stream_;
  rendering::OutTrajectoryMaker maker_;
  OutTrajectorySummary summary_;
  report::InputHash hash_;
  double longest_step_s_ = std::numeric_limits<double>::infinity();
  recording::SampleBlock block_;
  std::size_t at_ = 0;
  bool have_last_ = false;
  double last_t_s_ = 0.0;
  std::deque<Item> waiting_;
};

// Measured contact that the renderer does not show.
struct LostContact {
  std::uint64_t samples = 0;
  double first_t_s = 0.0;
};

std::string tip_text(const EvaluationRequest& request, const EvaluationInputs& inputs) {
  if (inputs.tip_radius_m > 0.0)
    return fmt::format("ball of radius {}", report::display_setting(inputs.tip_radius_m, "m"));
  if (!(request.probe_radius_m > 0.0)) return "point";
  return fmt::format("point: where the ball of radius {} touched",
                     report::display_setting(request.probe_radius_m, "m"));
}

report::RenderedInput rendered_input(const EvaluationRequest& request, const EvaluationInputs& inputs,
                                     std::string hash) {
  const bool made = request.in_trajectory != recording::InTrajectoryMode::measured;
  return {std::string(in_trajectory_name(request.in_trajectory)), made ? inputs.stiffness_N_per_m : 0.0,
          inputs.tip_radius_m, request.contact_threshold_N, std::move(hash)};
}

void describe(const EvaluationRequest& request, const EvaluationInputs& inputs, const OutTrajectorySummary& summary,
              const LostContact& lost, std::uint64_t segments, EvaluationResult& result) {
  const recording::ClockReport& clock = inputs.survey.clock;
  const Vec3 size = inputs.mesh.bounds().sizes();
  result.settings = {
      {"Recording", fmt::format("{}: {}", request.recording.string(), clock.summary())},
      {"Object", fmt::format("{}: {} triangles, {}, {} x {} x {} (file in {})", request.mesh.string(),
                             inputs.mesh.triangle_count(),
                             inputs.open_edges == 0 ? "closed" : fmt::format("{} open edges", inputs.open_edges),
                             report::display_quantity(size.x(), "m"), report::display_quantity(size.y(), "m"),
                             report::display_quantity(size.z(), "m"), request.mesh_unit)},
      {"Renderer", request.model.renderer},
      {"In-trajectory", input_text(result.input)},
      {"Tip", tip_text(request, inputs)},
      {"Contact threshold", fmt::format("{}: measured contact is a force that pushes outward by more",
                                        report::display_setting(request.contact_threshold_N, "N"))},
      {"Samples in contact", fmt::format("{} of {}", summary.in_contact, summary.samples)},
      {"Moved onto the surface", fmt::format("at most {} in contact, {} in the air",
                                             report::display_quantity(summary.largest_move_in_contact_m, "m"),
                                             report::display_quantity(summary.largest_move_free_m, "m"))},
      {"Time ranges", request.time_ranges.text()}};
  if (inputs.extended_m > 0.0) {
    result.settings.emplace_back("Open edges", fmt::format("continued by {}, holes and notches filled",
                                                           report::display_setting(inputs.extended_m, "m")));
  }
  if (request.flip_force) result.settings.emplace_back("Force sign", "flipped on reading");
  if (segments > 1)
    result.settings.emplace_back("Segments", fmt::format("{}: the renderer starts anew after each gap", segments));
  if (!request.model.instrument.empty()) {
    result.settings.emplace_back("Instrument",
                                 "the model's instrument entries act on the rendered force before the comparison");
  }
  for (const std::string& note : inputs.survey.notes) result.messages.push_back(note);
  if (clock.gap_count > 0 && segments <= 1) {
    result.messages.push_back(
        fmt::format("The recording has {} gaps in time, the longest of {}; the renderer ran across them (--on-gap "
                    "split starts it anew).",
                    clock.gap_count, report::display_quantity(clock.longest_s, "s")));
  }
  if (summary.not_clear > 0) {
    result.messages.push_back(
        fmt::format("At {} samples the ball does not fit between parts of the surface.", summary.not_clear));
  }
  if (summary.free_but_inside > 0) {
    result.messages.push_back(
        fmt::format("{} samples lie inside the object without a force that pushes outward, by at most {}: noise of the "
                    "tracker, or an error of registration.",
                    summary.free_but_inside, report::display_quantity(summary.largest_move_free_m, "m")));
  }
  if (lost.samples > 0) {
    result.messages.push_back(
        fmt::format("At {} samples, first at {:.3f} s, the recording shows contact and the renderer has none.{}",
                    lost.samples, lost.first_t_s,
                    inputs.open_edges > 0 ? " Where the mesh ends but the object does not, the tip may have slipped "
                                            "over an open edge: --extend-edges "
                                            "continues the mesh."
                                          : ""));
  }
  for (const std::string& message : inputs.messages) result.messages.push_back(message);
  if (!inputs.survey.has_force)
    result.messages.emplace_back("The recording has no force: nothing is said about force errors.");
}

// What a repeat of the recording differs by, as metrics beside the error that is held against it, and in words.
void add_floor(const recording_checks::RepeatFloor& floor, EvaluationResult& result) {
  const auto error = std::ranges::find(result.metrics, "rms_force_error", &MetricResult::name);
  if (error == result.metrics.end() || error->status != metrics::MetricStatus::ok) return;
  const double error_N = error->value;
  const auto add = [&](std::string name, std::string unit, double value, std::string meaning) {
    result.metrics.push_back({std::move(name),
                              std::move(unit),
                              value,
                              metrics::MetricStatus::ok,
                              std::move(meaning),
                              "",
                              {},
                              "",
                              {},
                              {},
                              {}});
  };
  add("repeat_floor_force", "N", floor.force_N,
      fmt::format(
          "RMS of what the forces of the recording and of its repeat {} differ by at equal times, over the root of 2: "
          "what one recording does not repeat, as the error holds it.",
          floor.source));
  add("repeat_floor_position", "m", floor.position_m, "RMS of what their positions differ by, over the root of 2.");
  add("rms_force_error_over_floor", "1", error_N / floor.force_N,
      "The RMS force error over repeat_floor_force: up to 1, but for chance, nothing is left that could be explained.");
  result.messages.push_back(
      fmt::format("The RMS force error of {} is {}.", report::display_quantity(error_N, "N"), floor.verdict(error_N)));
  result.settings.emplace_back("Repeat", floor.text());
}

// The same positions once more, through the renderer with counted arithmetic; segments follow one another as before.
void add_operation_metrics(const Catalogue& catalogue, const EvaluationRequest& request, const EvaluationInputs& inputs,
                           const MeasuredRenderer& comparison, std::vector<MetricResult>& metrics) {
  if (!asks_for_operations(request.metrics)) return;
  MeasuredStream positions(request, inputs, comparison);
  const auto source = [&positions](TipState& tip) {
    while (!positions.next(tip)) {
      if (positions.exhausted()) return false;
    }
    positions.take();
    return true;
  };
  for (MetricResult& one : count_of_steps(catalogue, inputs.model, inputs.surface, source, request.metrics)) {
    metrics.push_back(std::move(one));
  }
}

}  // namespace

EvaluationResult run_evaluation(const Catalogue& catalogue, const EvaluationRequest& request,
                                const EvaluationInputs& inputs, const std::filesystem::path& rendered,
                                const ErrorSink& errors) {
  const MeasuredRenderer comparison = catalogue.make_measured(inputs.model, inputs.surface);
  Collector collector(request, inputs);
  RendererResidual residual;
  SensorWindow window(comparison, [&](const ComparedSample& sample) {
    collector.add(sample);
    const metrics::MetricSample& m = sample.metric;
    if (inputs.survey.has_force) residual.add(m, sample.p_W_m);
    if (errors && request.time_ranges.contains(m.t_s, inputs.survey.clock.start_s)) errors(m);
  });
  MeasuredStream measured(request, inputs, comparison);
  std::unique_ptr<recording::RenderedWriter> writer;
  if (!rendered.empty()) writer = std::make_unique<recording::RenderedWriter>(rendered, true);
  Progress progress(fmt::format("rendering with {}", request.model.renderer), inputs.survey.samples);
  std::uint64_t done = 0;
  std::uint64_t segments = 0;
  LostContact lost;
  rendering::SeamSearch seams(inputs.surface);
  const auto sink = [&](const TipState& tip, const rendering::StepResult& step, double cost_us) {
    const MeasuredStream::Item item = measured.take();
    if (writer) writer->append(tip.t_s, tip.p_W_m, step.contact_W_m, step.f_W_N, step.contact, cost_us);
    ComparedSample sample;
    sample.metric = {tip.t_s, item.f_W_N, step.f_W_N, item.out.p_W_m, step.contact_W_m, cost_us};
    sample.p_W_m = item.p_W_m;
    sample.q_WS = item.q_WS;
    sample.touching = step.contact || item.out.contact;
    sample.surface_W_m = step.contact ? Vec3(step.contact_W_m - inputs.tip_radius_m * step.n_W)
                                      : Vec3(item.out.p_W_m - inputs.tip_radius_m * item.out.n_W);
    if (item.out.contact && !step.contact && lost.samples++ == 0) lost.first_t_s = tip.t_s;
    seams.see(tip, step);
    window.add(sample);
    if ((++done & 1023u) == 0) progress.update(done);
  };
  do {
    seams.restart();
    const std::uint64_t before = done;
    replay(
        comparison.renderer(), [&](TipState& tip) { return measured.next(tip); }, sink, true);
    window.finish();
    if (done > before) ++segments;
  } while (!measured.exhausted());
  if (collector.seen() == 0) {
    throw BadData(fmt::format("{}: no sample lies in the time range {}; the recording is from {} s to {} s",
                              request.recording.string(), request.time_ranges.text(), inputs.survey.clock.start_s,
                              inputs.survey.clock.end_s));
  }
  EvaluationResult result;
  result.title = request.title.empty()
                     ? fmt::format("{} on {}", request.model.renderer, request.recording.filename().string())
                     : request.title;
  result.renderer = request.model.renderer;
  result.model = model_to_json(inputs.model);
  collector.finish(inputs, result);
  result.input = rendered_input(request, inputs, measured.hash());
  add_operation_metrics(catalogue, request, inputs, comparison, result.metrics);
  describe(request, inputs, measured.summary(), lost, segments, result);
  if (std::string warning = seam_warning(seams.losses()); !warning.empty())
    result.messages.push_back(std::move(warning));
  for (std::string& fault : residual.faults()) result.messages.push_back(std::move(fault));
  if (inputs.floor) add_floor(*inputs.floor, result);
  result.provenance = report::make_provenance(request.command_line);
  result.provenance.inputs = inputs.files;
  if (writer) writer->commit();
  return result;
}

EvaluationResult run_evaluation(const Catalogue& catalogue, const EvaluationRequest& request,
                                const std::filesystem::path& rendered) {
  return run_evaluation(catalogue, request, load_inputs(catalogue, request), rendered);
}

EvaluationResult evaluate_into(const Catalogue& catalogue, const EvaluationRequest& request,
                               const std::filesystem::path& folder, const ErrorSink& errors) {
  ensure_writable_folder(folder);
  EvaluationResult result =
      run_evaluation(catalogue, request, load_inputs(catalogue, request), folder / "rendered.csv", errors);
  write_file(folder / "result.json", result_to_json(result));
  write_html(folder / "report.html", evaluation_page(result));
  return result;
}

}  // namespace touchstone::pipeline
