#include "experiments/renderer_cost.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "experiments/rows.h"
#include "harness/base/error.h"
#include "harness/report/console.h"
#include "harness/report/evaluation_page.h"
#include "harness/surface/embree_surface.h"
#include "renderers/catalogue.h"
#include "synthetic/surface_catalogue.h"

namespace touchstone::experiments {
using rendering::Model;
using report::Tone;

namespace {

constexpr double stiffness_N_per_m = 500.0;
constexpr double true_mu = 0.3;
constexpr double ball_m = 1e-3;

struct Kind {
  const rendering::RendererEntry* entry;
  double tip_radius_m;
  double mu;
};

std::vector<Kind> kinds() {
  std::vector<Kind> result;
  const auto has = [](const rendering::RendererEntry& entry, std::string_view name) {
    return std::ranges::any_of(entry.parameters, [name](const auto& parameter) { return parameter.name == name; });
  };
  for (const double radius_m : {0.0, ball_m}) {
    for (const auto& entry : renderers::renderer_catalogue()) {
      if (radius_m > 0.0 && !has(entry, "tip_radius_m")) continue;
      const bool friction = has(entry, "mu_dynamic");
      // The friction cone without friction is the god-object.
      if (!entry.needs_friction) result.push_back({&entry, radius_m, 0.0});
      if (friction) result.push_back({&entry, radius_m, true_mu});
    }
  }
  return result;
}

Model model_of(const Kind& kind, double voxels) {
  Model model;
  model.renderer = kind.entry->name;
  model.source = "experiment cost";
  for (const auto& parameter : kind.entry->parameters) {
    if (parameter.name == "stiffness_N_per_m") model.parameters[parameter.name] = stiffness_N_per_m;
    if (parameter.name == "resolution") model.parameters[parameter.name] = voxels;
    if (parameter.name == "tip_radius_m") model.parameters[parameter.name] = kind.tip_radius_m;
    if (parameter.name == "mu_static" || parameter.name == "mu_dynamic") model.parameters[parameter.name] = kind.mu;
  }
  return model;
}

rendering::TipSource source_of(const std::vector<Vec3>& tips) {
  return [&tips, i = std::size_t{0}](rendering::TipState& tip) mutable {
    if (i == tips.size()) return false;
    tip.t_s = static_cast<double>(i) * 1e-3;
    tip.p_W_m = tips[i++];
    return true;
  };
}

RendererCost measure(const Kind& kind, double voxels, const std::shared_ptr<const surface::Surface>& body,
                     const std::vector<Vec3>& tips) {
  RendererCost cost;
  cost.renderer = kind.entry->name;
  cost.tip_radius_m = kind.tip_radius_m;
  cost.mu = kind.mu;
  cost.what = kind.entry->name + (kind.mu > 0.0 ? fmt::format(", mu {:g}", kind.mu) : "") +
              (kind.tip_radius_m > 0.0 ? fmt::format(", ball of {:g} mm", 1e3 * kind.tip_radius_m) : "");
  cost.triangles = body->mesh()->triangle_count();
  const Model model = model_of(kind, voxels);
  const auto began = std::chrono::steady_clock::now();
  const auto renderer = renderers::make_renderer(model, body);
  const double build_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - began).count();
  std::size_t touching = 0;
  replay(*renderer, source_of(tips),
         [&touching](const rendering::TipState&, const rendering::StepResult& step, double) {
           touching += step.contact ? 1 : 0;
         });
  cost.in_contact = static_cast<double>(touching) / static_cast<double>(tips.size());
  cost.timing = measure_steps(*renderer, [&tips] { return source_of(tips); });
  cost.timing.build_ms = build_ms;
  const rendering::CountedRenderer counted = renderers::make_counted_renderer(model, body);
  cost.not_counted = counted.not_counted;
  if (counted.renderer) cost.operations = count_operations(*counted.renderer, source_of(tips));
  return cost;
}

Rows rows_of(const std::vector<RendererCost>& costs) {
  Rows rows{{"renderer", "triangles", "operations", "median", "most", "total", "median us", "p99 us", "mean us",
             "memory [MB]", "made in [ms]"}};
  for (const auto& own : costs) {
    const bool counted = own.operations.has_value();
    rows.push_back(
        {own.what, fmt::format("{}", own.triangles),
         counted ? fmt::format("{:.1f}", own.operations->mean) : "not counted",
         counted ? fmt::format("{:g}", own.operations->median) : "",
         counted ? fmt::format("{}", own.operations->max) : "",
         counted ? fmt::format("{}", own.operations->total()) : "", fmt::format("{:.3f}", own.timing.median_us),
         fmt::format("{:.3f}", own.timing.p99_us), fmt::format("{:.3f}", own.timing.mean_us),
         own.timing.memory_bytes ? fmt::format("{:.3f}", 1e-6 * static_cast<double>(*own.timing.memory_bytes))
                                 : "unknown",
         fmt::format("{:.1f}", own.timing.build_ms)});
  }
  return rows;
}

// A line for every renderer, a dashed one where it has a ball for a tip.
report::LinePlot over_the_mesh(std::string title, std::string y_label, const std::vector<RendererCost>& costs,
                               double (*value)(const RendererCost&)) {
  constexpr std::array tones{Tone::rendered, Tone::measured,  Tone::error,  Tone::good,
                             Tone::warning,  Tone::reference, Tone::neutral};
  report::LinePlot plot;
  plot.title = std::move(title);
  plot.x_label = "triangles";
  plot.y_label = std::move(y_label);
  plot.height_px = 420;
  plot.log_x = plot.log_y = true;
  for (const auto& own : costs) {
    if (plot.lines.empty() || plot.lines.back().name != own.what)
      plot.lines.push_back({own.what, {}, {}, tones[plot.lines.size() % tones.size()], own.tip_radius_m > 0.0, true});
    plot.lines.back().x.push_back(static_cast<double>(own.triangles));
    plot.lines.back().y.push_back(value(own));
  }
  return plot;
}

}  // namespace

std::vector<Vec3> path_over_the_bumpy_body(double tip_radius_m, std::size_t steps) {
  const auto body = synthetic::make_surface("bumpy");
  std::vector<Vec3> tips;
  for (std::size_t i = 0; i < steps; ++i) {
    const double t = static_cast<double>(i) * 1e-3;
    const double around = 2.0 * M_PI * t / 3.3;
    const double up = 0.9 * std::sin(2.0 * M_PI * t / 7.1);
    const Vec3 out(std::cos(around) * std::cos(up), std::sin(around) * std::cos(up), std::sin(up));
    const surface::SurfacePoint foot = body->closest(0.03 * out);
    const double depth = 1e-3 * (0.45 + 0.55 * std::sin(2.0 * M_PI * t));
    tips.push_back(foot.p_W_m + (tip_radius_m - depth) * foot.n_W);
  }
  return tips;
}

std::size_t cost_cases(const CostOptions& options) {
  return kinds().size() * std::set<std::size_t>(options.triangles.begin(), options.triangles.end()).size();
}

std::vector<RendererCost> measure_costs(const CostOptions& options, const std::function<void(std::size_t)>& done) {
  if (options.triangles.empty() || options.steps == 0) throw UsageError("costs need a size of the mesh and a step");
  std::map<std::size_t, std::shared_ptr<const surface::Surface>> bodies;
  for (const std::size_t triangles : options.triangles)
    bodies[triangles] = make_embree_surface(synthetic::make_mesh("bumpy", {}, triangles).mesh);
  std::map<double, std::vector<Vec3>> paths;
  std::vector<RendererCost> costs;
  for (const Kind& kind : kinds()) {
    auto& tips = paths[kind.tip_radius_m];
    if (tips.empty()) tips = path_over_the_bumpy_body(kind.tip_radius_m, options.steps);
    for (const auto& [triangles, body] : bodies) {
      costs.push_back(measure(kind, static_cast<double>(options.voxels), body, tips));
      if (done) done(costs.size());
    }
  }
  return costs;
}

std::string cost_table(const std::vector<RendererCost>& costs) { return report::align_columns(rows_of(costs)); }

report::Page cost_page(const std::vector<RendererCost>& costs, const report::Provenance& provenance) {
  report::Page page;
  page.title = "What a step costs";
  page.subtitle = "Every renderer over the bumpy body, 1 kHz, up to 1 mm deep, in the air once a second";
  report::Section section{
      "Operations, time and memory",
      "Operations are, per step (mean, median, most) and of the whole path, floating-point additions, subtractions, "
      "multiplications, divisions, square roots and "
      "comparisons, one each, of the step alone, counted by running the same code with a counting scalar; "
      "they repeat exactly; searches are counted on a plain tree of boxes, not inside Embree. Microseconds are this "
      "machine's; the mean holds whatever else it did in between, where it is above the 99th percentile nothing but "
      "that. Memory is the "
      "renderer's own, without mesh and Embree's tree; a structure that another renderer over the same "
      "mesh has made already costs no time again.",
      {},
      false};
  report::Table table = table_of(rows_of(costs), "");
  for (std::size_t i = 0; i < costs.size(); ++i) {
    if (!costs[i].not_counted.empty()) table.rows[i].detail = "not counted: " + costs[i].not_counted;
  }
  section.blocks.emplace_back(std::move(table));
  section.blocks.emplace_back(over_the_mesh("Median microseconds per step over the size of the mesh", "us per step",
                                            costs, [](const RendererCost& own) { return own.timing.median_us; }));
  section.blocks.emplace_back(over_the_mesh(
      "Operations per step over the size of the mesh", "operations per step, mean", costs, [](const RendererCost& own) {
        return own.operations ? own.operations->mean : std::numeric_limits<double>::quiet_NaN();
      }));
  page.sections.push_back(std::move(section));
  page.sections.push_back(provenance_section(provenance));
  return page;
}

std::string cost_to_json(const std::vector<RendererCost>& costs) {
  nlohmann::ordered_json document{{"schema", "touchstone-renderer-cost/1"}, {"costs", nlohmann::ordered_json::array()}};
  for (const auto& own : costs) {
    const std::string operations = own.operations ? operations_to_json(*own.operations) : "null";
    document["costs"].push_back({{"renderer", own.renderer},
                                 {"tip_radius_m", own.tip_radius_m},
                                 {"mu", own.mu},
                                 {"triangles", own.triangles},
                                 {"in_contact", own.in_contact},
                                 {"not_counted", own.not_counted},
                                 {"timing", nlohmann::ordered_json::parse(timing_to_json(own.timing, operations))}});
  }
  return document.dump(1) + "\n";
}

}  // namespace touchstone::experiments
