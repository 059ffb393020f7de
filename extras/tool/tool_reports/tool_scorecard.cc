#include "tool_reports/tool_scorecard.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "harness/base/hash.h"
#include "harness/rendering/renderer_failed.h"
#include "harness/surface/sphere_mesh.h"
#include "harness/tool/tool_checks.h"
#include "harness/tool/tool_path.h"
#include "harness/tool/worse.h"

namespace touchstone::tool_reports {
namespace {

constexpr double ball_m = 0.02;   // radius of the tool, held at its top
constexpr double world_m = 0.05;  // radius of the object
constexpr int levels = 5;         // 8192 triangles each
// A renderer that asks every pair of triangles takes a good part of a second for a step: then fewer steps are timed.
constexpr std::chrono::seconds most_time{30};

// Comes down in a twentieth of a second, 2 mm into the object, then circles and turns.
tool::Pose on_the_way(int step) {
  constexpr int coming = 50;
  const double t = 1e-3 * step;
  const double depth = step < coming ? 0.003 - 0.005 * step / coming : -0.002;
  const tool::Pose touching{Vec3(0, 0, 2.0 * ball_m), Quat::Identity()};
  return tool::moved(touching, {Vec3(0.005 * std::sin(3.0 * t), 0.005 * (1.0 - std::cos(3.0 * t)), depth),
                                0.1 * Vec3(std::sin(2.0 * t), std::sin(3.1 * t), std::sin(1.3 * t))});
}

ToolCost measure(const tool::ToolRendererEntry& entry, const tool::ToolSettings& settings) {
  using Clock = std::chrono::steady_clock;
  const auto us = [](Clock::duration d) { return std::chrono::duration<double, std::micro>(d).count(); };
  surface::TriangleMesh ball = surface::sphere_mesh(ball_m, levels);
  for (Vec3& v : ball.vertices_W_m) v.z() -= ball_m;
  surface::TriangleMesh world = surface::sphere_mesh(world_m, levels);
  for (Vec3& v : world.vertices_W_m) v.z() -= world_m;
  ToolCost cost;
  cost.tool_triangles = ball.triangle_count();
  cost.object_triangles = world.triangle_count();
  const tool::Tool solid = tool::solid_tool(ball);
  auto began = Clock::now();
  const auto renderer = tool::make_tool_renderer(entry, solid, world, settings);
  cost.build_ms = 1e-3 * us(Clock::now() - began);
  constexpr int step_count = 4000;
  std::vector<double> times_us;
  times_us.reserve(step_count);
  std::size_t contacts = 0;
  renderer->reset();
  const auto first = Clock::now();
  for (int i = 0; i < step_count && Clock::now() - first < most_time; ++i) {
    const tool::ToolState state{1e-3 * i, on_the_way(i)};
    began = Clock::now();
    const tool::ToolResult result = tool::step_or_throw(*renderer, state);
    const double took = us(Clock::now() - began);
    if (!result.contact) continue;  // free steps cost less
    times_us.push_back(took);
    contacts += result.contacts.size();
  }
  cost.memory_bytes = renderer->memory_bytes();
  cost.steps = times_us.size();
  if (times_us.empty())
    throw rendering::RendererFailed("a ball pressed 2 mm into a ball was in contact in none of the steps timed");
  std::ranges::sort(times_us);
  const auto reached_by = [&](double share) {
    return times_us[static_cast<std::size_t>(share * double(times_us.size() - 1))];
  };
  cost.median_us = reached_by(0.5);
  cost.p99_us = reached_by(0.99);
  cost.p999_us = reached_by(0.999);
  cost.contacts = double(contacts) / double(cost.steps);
  return cost;
}

std::string worst_case(const ToolScorecard& card) {
  const auto worst = std::ranges::max_element(card.errors, [](const tool::ToolErrors& a, const tool::ToolErrors& b) {
    return !std::isnan(a.max_torque_jnd) && !(b.max_torque_jnd <= a.max_torque_jnd);
  });
  return worst == card.errors.end() ? "" : worst->contacts;
}

}  // namespace

ToolScorecard score_tool(const tool::ToolRendererEntry& entry, const tool::ToolSettings& settings,
                         std::span<const tool::KnownContacts> cases, bool cost) {
  ToolScorecard card;
  card.renderer = entry.name;
  card.summary = entry.summary;
  card.source = entry.source;
  if (!entry.library.empty()) {
    card.library = entry.library.filename().string();
    card.library_sha256 = sha256_file(entry.library);
  }
  for (const auto& [name, value] : settings.parameters) card.options += fmt::format("{}={:g} ", name, value);
  const auto guarded = [&](const std::string& contacts, const std::function<void()>& run) {
    try {
      run();
    } catch (const rendering::RendererFailed& failure) {
      card.problems.push_back({contacts, failure.what()});
    }
  };
  guarded("", [&] { card.findings = tool::check_tool_renderer(tool::subject_of(entry, settings)); });
  for (const tool::KnownContacts& one : cases) {
    guarded(one.name, [&] {
      const auto renderer = tool::make_tool_renderer(entry, one.tool, one.object_W, settings);
      card.errors.push_back(tool::errors_of(*renderer, entry.name, one));
    });
  }
  if (cost) guarded("", [&] { card.cost = measure(entry, settings); });
  return card;
}

bool clean(const ToolScorecard& card) {
  return card.problems.empty() && tool::passed(card.findings) &&
         std::ranges::all_of(card.errors, [](const tool::ToolErrors& row) {
           return std::isfinite(row.max_force_N) && std::isfinite(row.max_torque_Nm);
         });
}

std::string tool_scorecard_to_json(const ToolScorecard& card) {
  using Json = nlohmann::ordered_json;
  Json json{{"schema", "touchstone-tool-scorecard/1"},
            {"renderer", card.renderer},
            {"summary", card.summary},
            {"source", card.source},
            {"library", card.library},
            {"library_sha256", card.library_sha256},
            {"options", card.options},
            {"clean", clean(card)},
            {"checks", Json::array()},
            {"cases", Json::array()},
            {"problems", Json::array()}};
  for (const tool::ToolFinding& finding : card.findings) {
    json["checks"].push_back({{"name", finding.check},
                              {"applies", finding.applies},
                              {"passed", finding.passed},
                              {"measured", finding.measured},
                              {"limit", finding.limit},
                              {"unit", finding.unit},
                              {"fault", finding.fault}});
  }
  for (const tool::ToolErrors& row : card.errors) {
    json["cases"].push_back({{"name", row.contacts},
                             {"mean_force_error_N", row.mean_force_N},
                             {"max_force_error_N", row.max_force_N},
                             {"mean_torque_error_Nm", row.mean_torque_Nm},
                             {"max_torque_error_Nm", row.max_torque_Nm},
                             {"max_torque_error_jnd", row.max_torque_jnd},
                             {"largest_right_force_N", row.largest_right_force_N},
                             {"largest_right_torque_Nm", row.largest_right_torque_Nm}});
  }
  for (const ToolProblem& problem : card.problems)
    json["problems"].push_back({{"case", problem.contacts}, {"what", problem.what}});
  if (card.cost) {
    json["cost"] = {
        {"tool_triangles", card.cost->tool_triangles},
        {"object_triangles", card.cost->object_triangles},
        {"steps", card.cost->steps},
        {"contacts", card.cost->contacts},
        {"median_us", card.cost->median_us},
        {"p99_us", card.cost->p99_us},
        {"p999_us", card.cost->p999_us},
        {"build_ms", card.cost->build_ms},
        {"memory_bytes", card.cost->memory_bytes ? nlohmann::json(*card.cost->memory_bytes) : nlohmann::json()}};
  }
  return json.dump(2) + "\n";
}

std::string tool_scorecard_to_text(const ToolScorecard& card) {
  std::string text = tool::findings_to_text(card.renderer, card.findings);
  for (const ToolProblem& problem : card.problems)
    text += fmt::format("  {}: {}\n", problem.contacts.empty() ? "did not run" : problem.contacts, problem.what);
  if (const std::string worst = worst_case(card); !worst.empty()) {
    double most_jnd = 0.0;
    for (const tool::ToolErrors& row : card.errors) most_jnd = tool::worse(most_jnd, row.max_torque_jnd);
    text +=
        fmt::format("  exact cases: {}; largest torque error {:.2g} JND, in {}\n", card.errors.size(), most_jnd, worst);
  }
  if (card.cost) {
    text += fmt::format(
        "  step: median {:.3g} us, p99 {:.3g} us, p99.9 {:.3g} us over {} steps of {} against {} triangles\n",
        card.cost->median_us, card.cost->p99_us, card.cost->p999_us, card.cost->steps, card.cost->tool_triangles,
        card.cost->object_triangles);
  }
  return text;
}

}  // namespace touchstone::tool_reports
