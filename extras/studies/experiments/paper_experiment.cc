#include "experiments/paper_experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <chrono>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "experiments/density_experiment.h"
#include "experiments/mesh_family.h"
#include "harness/base/error.h"
#include "harness/rendering/in_trajectory.h"
#include "harness/rendering/replay.h"
#include "harness/report/console.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/mesh_topology.h"
#include "renderers/catalogue.h"
#include "renderers/mesh_traversal/contact_mesh.h"

namespace touchstone::experiments {
using recording::InTrajectoryMode;
using recording::OutTrajectory;
using rendering::Model;
using surface::Surface;

namespace {

constexpr double most_mu = 1.0;
constexpr int mu_steps = 10;  // of the curve whose best place is refined

std::vector<Vec3> normal_part_of(const OutTrajectory& out) {
  std::vector<Vec3> normal_W_N;
  for (std::size_t i = 0; i < out.size(); ++i) normal_W_N.push_back(out.normal_force_N[i] * out.n_W[i]);
  return normal_W_N;
}

// One scan with its input, and the error that all four experiments share.
class PaperBench {
 public:
  PaperBench(const PaperScan& scan, const PaperOptions& options)
      : scan_(scan),
        options_(options),
        surface_(make_embree_surface(scan.mesh)),
        kept_(renderers::contact_mesh(surface_)) {
    out_ = rendering::make_out_trajectory(scan.recording, *surface_, {0.0, options.contact_threshold_N});
    switch (options.in_trajectory) {
      case InTrajectoryMode::synthesize:
        in_ = rendering::synthesize_in_trajectory(out_, scan.stiffness_N_per_m);
        break;
      case InTrajectoryMode::whole_force:
        in_ = rendering::whole_force_in_trajectory(out_, scan.recording.f_W_N, scan.stiffness_N_per_m);
        break;
      case InTrajectoryMode::measured:
        in_ = rendering::measured_in_trajectory(scan.recording);
        break;
    }
    normal_W_N_ = normal_part_of(out_);
  }

  [[nodiscard]] Model model(const std::string& renderer) const {
    Model out;
    out.renderer = renderer;
    out.source = "experiment paper";
    out.parameters["stiffness_N_per_m"] = scan_.stiffness_N_per_m;
    return out;
  }

  [[nodiscard]] std::vector<Vec3> render(const Model& model, const std::shared_ptr<const Surface>& surface) const {
    return replay(*renderers::make_renderer(model, surface), in_).f_W_N;
  }

  [[nodiscard]] double error(const std::vector<Vec3>& f_W_N, const std::vector<Vec3>& truth_W_N, std::size_t from,
                             std::size_t to) const {
    double sum = 0.0;
    std::size_t samples = 0;
    for (std::size_t i = from; i < to; ++i) {
      if (options_.counted == Counted::contact && !(out_.normal_force_N[i] > 0.0)) continue;
      const double squared = (f_W_N[i] - truth_W_N[i]).squaredNorm();
      sum += options_.average == Average::rms ? squared : std::sqrt(squared);
      ++samples;
    }
    if (samples == 0) throw BadData(scan_.name + ": no sample to compare: the recording never touches the object");
    const double mean = sum / static_cast<double>(samples);
    return options_.average == Average::rms ? std::sqrt(mean) : mean;
  }
  [[nodiscard]] double error(const std::vector<Vec3>& f_W_N) const {
    return error(f_W_N, scan_.recording.f_W_N, 0, in_.size());
  }

  [[nodiscard]] const PaperScan& scan() const { return scan_; }
  [[nodiscard]] const std::shared_ptr<const Surface>& surface() const { return surface_; }
  [[nodiscard]] const recording::InTrajectory& in() const { return in_; }
  [[nodiscard]] const std::vector<Vec3>& normal_part() const { return normal_W_N_; }

 private:
  const PaperScan& scan_;
  const PaperOptions& options_;
  std::shared_ptr<const Surface> surface_;
  decltype(renderers::contact_mesh(std::declval<std::shared_ptr<const Surface>>())) kept_;  // so that it is built once
  OutTrajectory out_;
  recording::InTrajectory in_;
  std::vector<Vec3> normal_W_N_;
};

PaperRow paper_row(const PaperBench& bench, Model model, const std::string& name) {
  PaperRow row;
  row.renderer = name;
  const auto began = std::chrono::steady_clock::now();
  const auto renderer = renderers::make_renderer(model, bench.surface());
  row.build_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - began).count();
  row.memory_bytes = renderer->memory_bytes().value();
  row.error_N = bench.error(replay(*renderer, bench.in()).f_W_N);
  const rendering::CountedRenderer counted = renderers::make_counted_renderer(model, bench.surface());
  if (counted.renderer) row.operations = count_operations(*counted.renderer, rendering::tip_source(bench.in().motion));
  return row;
}

// Experiment 1.
void run_voxel_part(const PaperBench& bench, const PaperOptions& options, PaperResult& result) {
  result.voxel.push_back(paper_row(bench, bench.model("god-object"), "proxy"));
  for (const int resolution : {32, 64}) {
    Model model = bench.model("voxel");
    model.parameters["resolution"] = resolution;
    const double deep = std::ceil(options.reach_m * resolution / bench.surface()->bounds().sizes().maxCoeff()) + 1.0;
    model.parameters["reach_voxels"] = deep;
    // Below an open surface the grid ends with its margin.
    model.parameters["margin_voxels"] = std::min(deep, 0.25 * resolution);
    result.voxel.push_back(paper_row(bench, model, fmt::format("voxel {}^3", resolution)));
  }
}

// Experiment 2: dynamic friction alone, fitted on the first half, compared on the second.
void run_friction_part(const PaperBench& bench, PaperResult& result) {
  const std::size_t half = bench.in().size() / 2;
  const auto error = [&](double mu, std::size_t from, std::size_t to) {
    Model model = bench.model("friction-cone");
    model.parameters["mu_static"] = model.parameters["mu_dynamic"] = mu;
    return bench.error(bench.render(model, bench.surface()), bench.scan().recording.f_W_N, from, to);
  };
  const auto fitted = [&](double mu) { return error(mu, 0, half); };
  int best = 0;
  double least = fitted(0.0);
  for (int i = 1; i <= mu_steps; ++i) {
    const double here = fitted(most_mu * i / mu_steps);
    if (here < least) {
      least = here;
      best = i;
    }
  }
  constexpr int mu_bits = 10;  // to a thousandth
  result.fitted_mu = boost::math::tools::brent_find_minima(fitted, most_mu * std::max(best - 1, 0) / mu_steps,
                                                           most_mu * std::min(best + 1, mu_steps) / mu_steps, mu_bits)
                         .first;
  result.without_N = error(0.0, half, bench.in().size());
  result.with_N = error(result.fitted_mu, half, bench.in().size());
}

// Experiments 3 and 4: the paper's numbers of triangles, as far as the mesh has them, and the mesh itself.
void run_density_part(const PaperBench& bench, PaperResult& result) {
  std::vector<std::size_t> targets;
  const std::size_t finest = bench.scan().mesh.triangle_count();
  for (const PublishedDensity& published : published_density) {
    const auto triangles = static_cast<std::size_t>(std::lround(1000.0 * published.kilo_triangles));
    if (triangles < finest) targets.push_back(triangles);
  }
  const surface::MeshTopology topology = make_topology(*bench.surface()->mesh());
  if (topology.open_edge_count > 0) targets.clear();
  std::vector<surface::TriangleMesh> meshes = decimated_family(bench.scan().mesh, targets);
  meshes.push_back(bench.scan().mesh);
  for (const surface::TriangleMesh& mesh : meshes) {
    const std::shared_ptr<const Surface> surface = make_embree_surface(mesh);
    const auto kept = renderers::contact_mesh(surface);
    const auto plain = bench.render(bench.model("god-object"), surface);
    const auto shaded = bench.render(bench.model("force-shading"), surface);
    const auto normal = [&](const std::vector<Vec3>& f) { return bench.error(f, bench.normal_part(), 0, f.size()); };
    result.density.push_back(
        {mesh.triangle_count(), bench.error(plain), bench.error(shaded), normal(plain), normal(shaded)});
  }
}

// By the definition of the error that all four share.
PaperFloors paper_floors(const PaperBench& bench, const PaperOptions& options, double fitted_mu) {
  const PaperScan& scan = bench.scan();
  pipeline::FloorWorld world;
  world.law = "friction-cone";
  world.recording = scan.recording;
  world.surface = bench.surface();
  world.in_trajectory = options.in_trajectory;
  world.probe_radius_m = scan.probe_radius_m;
  world.stiffness_N_per_m = scan.stiffness_N_per_m;
  world.mu = scan.friction.value_or(fitted_mu);
  world.contact_threshold_N = options.contact_threshold_N;
  world.instrument = scan.instrument.empty() ? discrepancy::estimate_instrument(scan.recording)
                                             : discrepancy::load_instrument(scan.instrument);
  world.instrument.mesh_extent_m = scan.mesh.bounds().diagonal().norm();
  const std::size_t n = scan.recording.size();
  const auto from = [&](std::size_t first) {
    return [&bench, first, n](const std::vector<Vec3>& rendered, const recording::Recording& recording,
                              const OutTrajectory&) { return bench.error(rendered, recording.f_W_N, first, n); };
  };
  const auto normal = [&](const std::vector<Vec3>& rendered, const recording::Recording&, const OutTrajectory& out) {
    return bench.error(rendered, normal_part_of(out), 0, n);
  };
  constexpr std::uint64_t seed = 1;
  const auto whole = pipeline::floors_of(renderers::built_in_catalogue(), world, {from(0), from(n / 2)}, seed);
  world.mu = 0.0;
  return {whole[0], whole[1], pipeline::floors_of(renderers::built_in_catalogue(), world, {normal}, seed).front()};
}

double operations_of(const PaperRow& row) {
  return row.operations ? static_cast<double>(row.operations->total()) : std::nan("");
}

// Of at least so many triangles; the finest where there are none so large.
const PaperDensity& density_near(const PaperResult& result, std::size_t triangles) {
  const auto found = std::ranges::find_if(
      result.density, [&](const PaperDensity& one) { return 11 * one.triangles >= 10 * triangles; });
  return found == result.density.end() ? result.density.back() : *found;
}

// Of experiments 3 and 4.
std::vector<JudgedFinding> density_findings_of(const PaperResult& r) {
  std::vector<JudgedFinding> out;
  const double finest_N = r.density.back().plain_N;
  const PaperDensity* worst = &density_near(r, 1000);
  for (const PaperDensity* one = worst; one <= &r.density.back(); ++one) {
    if (one->plain_N > worst->plain_N) worst = one;
  }
  const double their_flat = published_density[2].error_N / published_density[7].error_N;
  out.push_back(
      {fmt::format("fairly stable from 1,000 triangles on (theirs grows {:.1f} times)", their_flat),
       worst->plain_N <= their_flat * finest_N,
       fmt::format("grows {:.2f} times at most, at {} triangles", worst->plain_N / finest_N, worst->triangles)});
  const double steep = density_near(r, 200).plain_normal_N / density_near(r, 1000).plain_normal_N;
  out.push_back({"sharply higher below 1,000: at least twice at 200, against the normal part", steep >= 2.0,
                 fmt::format("{:.1f} times", steep)});
  // What the right law leaves, no shading takes: by the squares above the floor.
  const double floor_N = r.floors.normal_part.rms_N;
  const PaperDensity* least = nullptr;
  double least_share = 1.0;
  for (const PaperDensity& one : r.density) {
    const double above_N2 = one.plain_normal_N * one.plain_normal_N - floor_N * floor_N;
    if (one.triangles < 990 || one.triangles > 10000 || !(above_N2 > 0.0)) continue;
    const double share =
        (one.plain_normal_N * one.plain_normal_N - one.shaded_normal_N * one.shaded_normal_N) / above_N2;
    if (least == nullptr || share < least_share) least = &one, least_share = share;
  }
  JudgedFinding shading{
      "shading lowers the error from 1,000 to 10,000 triangles: against the normal part, by a quarter of what lies "
      "above "
      "the floor, in squares",
      std::nullopt, "not judged: no row lies above the floor"};
  if (least != nullptr) {
    shading.holds = least_share >= 0.25;
    shading.here =
        fmt::format("least at {} triangles: {:.0f} % ({:.4f} to {:.4f} N, of which {:.4f} N is floor)",
                    least->triangles, 100.0 * least_share, least->plain_normal_N, least->shaded_normal_N, floor_N);
  }
  out.push_back(std::move(shading));
  if (r.density.size() > 1) return out;
  for (JudgedFinding& one : out) {
    one.holds.reset();
    one.here = "not judged: the mesh is open, or too coarse to be decimated";
  }
  return out;
}

}  // namespace

std::vector<JudgedFinding> paper_findings(const PaperResult& r) {
  std::vector<JudgedFinding> out;
  const PaperRow& proxy = r.voxel[0];
  const PaperRow& fine = r.voxel[2];
  const double off = fine.error_N / proxy.error_N - 1.0;
  out.push_back({"voxels (64^3) offer comparable force error: within a tenth of the proxy's", std::abs(off) <= 0.1,
                 fmt::format("{:+.1f} %", 100.0 * off)});
  const double fewer = operations_of(proxy) / operations_of(fine);
  out.push_back({"voxels take significantly fewer operations: less than half", fewer > 2.0,
                 fmt::format("a factor of {:.1f} fewer", fewer)});
  const double theirs = PublishedFriction::with_N / PublishedFriction::without_N;
  out.push_back({fmt::format("friction about halves the error: {:.0f} % is left", 100.0 * theirs),
                 r.with_N / r.without_N <= 1.1 * theirs,
                 fmt::format("{:.0f} % is left, mu {:.3f}", 100.0 * r.with_N / r.without_N, r.fitted_mu)});
  for (JudgedFinding& one : density_findings_of(r)) out.push_back(std::move(one));
  return out;
}

PaperResult run_paper_experiments(const PaperScan& scan, const PaperOptions& options) {
  if (scan.recording.f_W_N.size() != scan.recording.size())
    throw BadData(scan.name + ": the experiments need a recording with forces");
  const PaperBench bench(scan, options);
  PaperResult result;
  result.scan = scan.name;
  result.measured_N = bench.error(std::vector<Vec3>(scan.recording.size(), Vec3::Zero()));
  run_voxel_part(bench, options, result);
  run_friction_part(bench, result);
  run_density_part(bench, result);
  result.floors = paper_floors(bench, options, result.fitted_mu);
  result.findings = paper_findings(result);
  return result;
}

std::string paper_text(const std::vector<PaperResult>& results) {
  std::string text;
  for (const PaperResult& r : results) {
    text += fmt::format("{}\n\n", r.scan);
    const std::string floor = fmt::format("{:.4f}", r.floors.all.rms_N);
    const std::string half = fmt::format("{:.4f}", r.floors.second_half.rms_N);
    const std::string normal = fmt::format("{:.4f}", r.floors.normal_part.rms_N);
    std::vector<std::vector<std::string>> rows{
        {"1: renderer", "error N", "floor N", "operations", "init ms", "memory MB"}};
    for (const PaperRow& row : r.voxel) {
      rows.push_back({row.renderer, fmt::format("{:.4f}", row.error_N), floor,
                      row.operations ? fmt::format("{:.0f}K", 1e-3 * operations_of(row)) : "not counted",
                      fmt::format("{:.1f}", row.build_ms),
                      fmt::format("{:.2f}", 1e-6 * static_cast<double>(row.memory_bytes))});
    }
    text += report::align_columns(rows) + "\n";
    text += report::align_columns({{"2: friction", "error N", "floor N"},
                                   {"none", fmt::format("{:.4f}", r.without_N), half},
                                   {fmt::format("mu {:.3f}", r.fitted_mu), fmt::format("{:.4f}", r.with_N), half}}) +
            "\n";
    rows = {{"3, 4: triangles", "error N", "shaded", "floor", "normal part", "shaded", "floor"}};
    for (const PaperDensity& one : r.density) {
      rows.push_back({fmt::format("{}", one.triangles), fmt::format("{:.4f}", one.plain_N),
                      fmt::format("{:.4f}", one.shaded_N), floor, fmt::format("{:.4f}", one.plain_normal_N),
                      fmt::format("{:.4f}", one.shaded_normal_N), normal});
    }
    text += report::align_columns(rows) + "\n";
  }
  if (results.empty()) return text;
  for (std::size_t f = 0; f < results.front().findings.size(); ++f) {
    text += results.front().findings[f].statement + "\n";
    for (const PaperResult& r : results)
      text += fmt::format("  {}  {}: {}\n",
                          !r.findings[f].holds   ? "-            "
                          : *r.findings[f].holds ? "holds        "
                                                 : "does not hold",
                          r.scan, r.findings[f].here);
  }
  return text;
}

namespace {

nlohmann::ordered_json floor_json(const pipeline::Floor& floor) {
  return {{"error_N", floor.rms_N}, {"interval95_N", {floor.low95_N, floor.high95_N}}, {"how", floor.how}};
}

}  // namespace

std::string paper_to_json(const std::vector<PaperResult>& results, const PaperOptions& options) {
  using nlohmann::ordered_json;
  ordered_json scans = ordered_json::array();
  for (const PaperResult& r : results) {
    ordered_json voxel = ordered_json::array();
    for (const PaperRow& row : r.voxel) {
      voxel.push_back({{"renderer", row.renderer},
                       {"error_N", row.error_N},
                       {"operations", row.operations ? ordered_json(row.operations->total()) : ordered_json()},
                       {"memory_bytes", row.memory_bytes}});
    }
    ordered_json density = ordered_json::array();
    for (const PaperDensity& one : r.density) {
      density.push_back({{"triangles", one.triangles},
                         {"plain_N", one.plain_N},
                         {"shaded_N", one.shaded_N},
                         {"plain_normal_part_N", one.plain_normal_N},
                         {"shaded_normal_part_N", one.shaded_normal_N}});
    }
    ordered_json findings = ordered_json::array();
    for (const JudgedFinding& one : r.findings)
      findings.push_back({{"statement", one.statement},
                          {"holds", one.holds ? ordered_json(*one.holds) : ordered_json()},
                          {"here", one.here}});
    scans.push_back({{"scan", r.scan},
                     {"measured_N", r.measured_N},
                     {"floors",
                      {{"all", floor_json(r.floors.all)},
                       {"second_half", floor_json(r.floors.second_half)},
                       {"normal_part", floor_json(r.floors.normal_part)}}},
                     {"voxel", std::move(voxel)},
                     {"friction", {{"mu", r.fitted_mu}, {"without_N", r.without_N}, {"with_N", r.with_N}}},
                     {"density", std::move(density)},
                     {"findings", std::move(findings)}});
  }
  const ordered_json document{{"schema", "touchstone-paper/1"},
                              {"average", options.average == Average::rms ? "rms" : "mean"},
                              {"samples", options.counted == Counted::all ? "all" : "contact"},
                              {"in_trajectory", in_trajectory_name(options.in_trajectory)},
                              {"scans", std::move(scans)}};
  return document.dump(1) + "\n";
}

}  // namespace touchstone::experiments
