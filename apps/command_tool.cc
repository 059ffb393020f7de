#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "apps/commands.h"
#include "apps/tool_renderer_flags.h"
#include "harness/base/atomic_file.h"
#include "harness/base/units.h"
#include "harness/recording/recording_file.h"
#include "harness/recording/recording_writer.h"
#include "harness/surface/mesh_file.h"
#include "harness/tool/faulty_tool.h"
#include "harness/tool/tool_checks.h"
#include "harness/tool/tool_metrics.h"
#include "harness/tool/tool_path.h"
#include "harness/tool/tool_replay.h"
#include "renderers/tool/tool_catalogue.h"
#include "synthetic/tool/exact_cases.h"
#include "synthetic/tool/scripted_path.h"

namespace touchstone::apps {
namespace {

using namespace tool;
using synthetic::ExactCase;

constexpr double kToolDensity_kg_per_m3 = 1000.0;  // of water: between wood and plastic

Tool solid_tool(const TriangleMesh& mesh) { return {mesh, solid_mass_frame(mesh, kToolDensity_kg_per_m3)}; }

struct ToolListOptions {
  ToolRendererFlags flags;
};

ExitStatus list_tools(const ToolListOptions& options) {
  fmt::print("renderers\n");
  for (const ToolRendererEntry& entry : options.flags.entries()) {
    fmt::print("  {:<18} {} ({})\n", entry.name, entry.summary, entry.source);
    for (const ParameterDeclaration& p : entry.parameters)
      fmt::print("    {:<26} {} {}: {}\n", p.name, p.initial, p.unit, p.meaning);
  }
  fmt::print("exact cases\n");
  for (const std::string& name : synthetic::exact_case_names())
    fmt::print("  {:<18} {}\n", name, synthetic::make_exact_case(name).what);
  fmt::print("faults of `tool check --fault`\n");
  for (const std::string_view name : kToolFaultNames) fmt::print("  {}\n", name);
  return ExitStatus::passed;
}

struct ToolCaseOptions {
  std::string name, out;
  double seconds = 60.0;
};

ExitStatus write_tool_case(const ToolCaseOptions& options) {
  if (!(options.seconds > 0.0))
    throw UsageError(fmt::format("--seconds {}: more than 0 was expected", options.seconds));
  const ExactCase made = synthetic::make_exact_case(options.name);
  const std::filesystem::path folder = options.out;
  ensure_writable_folder(folder);
  save_mesh(made.tool_T, folder / "tool.obj");
  save_mesh(made.object_W, folder / "object.obj");
  constexpr double kRate_Hz = 1000.0;
  TrajectoryWriter writer(folder / "path.csv", true);
  const auto samples = static_cast<std::size_t>(options.seconds * kRate_Hz);
  for (std::size_t i = 0; i <= samples; ++i) {
    const double t_s = double(i) / kRate_Hz;
    const Pose pose = synthetic::scripted_pose(made, t_s, options.seconds);
    writer.append(t_s, pose.p_W_m, pose.q_WT);
  }
  writer.commit();
  fmt::print("{}: tool.obj ({} triangles), object.obj ({} triangles), path.csv ({} samples)\n", folder.string(),
             made.tool_T.triangle_count(), made.object_W.triangle_count(), samples + 1);
  return ExitStatus::passed;
}

struct ToolReplayOptions {
  std::string renderer, tool_mesh, object_mesh, unit = "m", path, out, proxy, timing;
  std::uint64_t keep_every = 1;
  ToolRendererFlags flags;
};

double quantile_of_steps(const std::vector<double>& sorted, double share) {
  return sorted[std::min(sorted.size() - 1, static_cast<std::size_t>(share * double(sorted.size())))];
}

ExitStatus tool_replay_command(const ToolReplayOptions& options) {
  const double unit_m = length_unit_factor(options.unit);
  const std::vector<ToolRendererEntry> known = options.flags.entries();
  const ToolRendererEntry& entry = find_tool_renderer(known, options.renderer);
  const auto renderer =
      tool::make_tool_renderer(entry, solid_tool(load_mesh(options.tool_mesh, unit_m)),
                               load_mesh(options.object_mesh, unit_m), options.flags.settings_of(entry, {&entry, 1}));
  ToolReplayFiles files{options.path, options.out, {}, options.keep_every};
  if (!options.proxy.empty()) files.proxy = options.proxy;
  const ToolReplaySummary summary = replay_tool(*renderer, files);
  fmt::print("{}: {} samples, {} in contact, largest force {:.6g} N, largest torque {:.6g} mNm\n", options.out,
             summary.samples, summary.in_contact, summary.largest_force_N, summary.largest_torque_Nm * 1e3);
  if (!options.timing.empty()) {
    const std::vector<double> times = measure_tool_steps(*renderer, options.path);
    const nlohmann::ordered_json json{{"steps", times.size()},
                                      {"median_us", quantile_of_steps(times, 0.5)},
                                      {"p99_us", quantile_of_steps(times, 0.99)},
                                      {"p999_us", quantile_of_steps(times, 0.999)},
                                      {"max_us", times.back()},
                                      {"memory_bytes", renderer->memory_bytes()}};
    write_file(options.timing, json.dump(2) + "\n");
    fmt::print("step: median {:.3f} us, p99 {:.3f} us, p99.9 {:.3f} us, max {:.3f} us\n", quantile_of_steps(times, 0.5),
               quantile_of_steps(times, 0.99), quantile_of_steps(times, 0.999), times.back());
  }
  return ExitStatus::passed;
}

struct ToolCompareOptions {
  std::string expected, obtained, expected_proxy, obtained_proxy, json;
  std::vector<double> force_N{1e-6}, torque_Nm{1e-7};
};

Vec3 tolerance_per_axis(const std::vector<double>& values, std::string_view name) {
  if (values.size() != 1 && values.size() != 3)
    throw UsageError(fmt::format("{}: {} values; one, or one per axis, was expected", name, values.size()));
  for (const double v : values) {
    if (!(v >= 0.0)) throw UsageError(fmt::format("{}: {}; 0 or more was expected", name, v));
  }
  return values.size() == 1 ? Vec3::Constant(values[0]) : Vec3(values[0], values[1], values[2]);
}

ExitStatus tool_compare_command(const ToolCompareOptions& options) {
  const Vec3 force_N = tolerance_per_axis(options.force_N, "--force-tolerance");
  const Vec3 torque_Nm = tolerance_per_axis(options.torque_Nm, "--torque-tolerance");
  if (options.expected_proxy.empty() != options.obtained_proxy.empty()) {
    throw UsageError("--expected-proxy and --obtained-proxy belong together: give both or none");
  }
  ToolComparison c = compare_tools(load_recording(options.expected), load_recording(options.obtained));
  if (!options.expected_proxy.empty())
    compare_proxies(load_trajectory(options.expected_proxy), load_trajectory(options.obtained_proxy), c);
  if (!options.json.empty()) write_file(options.json, comparison_to_json(c));
  fmt::print("force error: rms {:.3g} N, largest ({:.3g}, {:.3g}, {:.3g}) N\n", c.rms_force_error_N,
             c.max_force_error_N.x(), c.max_force_error_N.y(), c.max_force_error_N.z());
  fmt::print("torque error: rms {:.3g} mNm, largest ({:.3g}, {:.3g}, {:.3g}) mNm, {:.3g} JND, at row {}\n",
             c.rms_torque_error_Nm * 1e3, c.max_torque_error_Nm.x() * 1e3, c.max_torque_error_Nm.y() * 1e3,
             c.max_torque_error_Nm.z() * 1e3, c.max_torque_error_jnd, c.worst_torque_row + 1);
  if (c.max_proxy_translation_m) {
    fmt::print("pose of the proxy: at most {:.3g} mm and {:.3g} degrees apart\n", *c.max_proxy_translation_m * 1e3,
               *c.max_proxy_rotation_rad * 180.0 / std::numbers::pi);
  }
  const bool passed = (c.max_force_error_N.array() <= force_N.array()).all() &&
                      (c.max_torque_error_Nm.array() <= torque_Nm.array()).all();
  fmt::print("{}: {} samples within ({:g}, {:g}, {:g}) N and ({:g}, {:g}, {:g}) Nm\n", passed ? "passed" : "failed",
             c.samples, force_N.x(), force_N.y(), force_N.z(), torque_Nm.x(), torque_Nm.y(), torque_Nm.z());
  return passed ? ExitStatus::passed : ExitStatus::failed;
}

struct ToolTableOptions {
  std::string out;
  std::vector<std::string> cases, renderers;
  ToolRendererFlags flags;
};

ExitStatus tool_table_command(const ToolTableOptions& options) {
  std::vector<std::string> cases = options.cases.empty() ? synthetic::exact_case_names() : options.cases;
  const std::vector<ToolRendererEntry> known = options.flags.entries();
  std::vector<ToolRendererEntry> entries;
  for (const std::string& name : options.renderers) entries.push_back(find_tool_renderer(known, name));
  if (entries.empty()) entries = known;
  const Coupling& coupling = options.flags.coupling;
  std::string table =
      "| case | renderer | force error, mean (N) | max (N) | torque error, mean (mNm) | max (mNm) | max (JND) | force "
      "(N) | torque (mNm) |\n"
      "|---|---|---|---|---|---|---|---|---|\n";
  for (const std::string& name : cases) {
    const ExactCase made = synthetic::make_exact_case(name);
    const Tool tool = solid_tool(made.tool_T);
    std::vector<synthetic::Equilibrium> truths;
    for (const Pose& handle : made.handles) {
      truths.push_back(quasi_static_equilibrium(made.gaps, handle, coupling));
      if (!truths.back().found)
        throw BadData(fmt::format("{}: no equilibrium was found with these stiffnesses; give softer ones", name));
    }
    for (const ToolRendererEntry& entry : entries) {
      const auto renderer =
          tool::make_tool_renderer(entry, tool, made.object_W, options.flags.settings_of(entry, entries));
      double force_sum = 0.0, force_max = 0.0, torque_sum = 0.0, torque_max = 0.0, jnd = 0.0, force = 0.0, torque = 0.0;
      for (std::size_t i = 0; i < made.handles.size(); ++i) {
        const ToolResult result = settle(*renderer, made.free, made.handles[i]);
        const Wrench& truth = truths[i].wrench_W;
        const double force_error = (result.f_W_N - truth.f_N).norm();
        const double torque_error = (result.torque_W_Nm - truth.torque_Nm).norm();
        force_sum += force_error;
        torque_sum += torque_error;
        force_max = std::max(force_max, force_error);
        torque_max = std::max(torque_max, torque_error);
        jnd = std::max(jnd, torque_error_in_jnd(truth.torque_Nm, result.torque_W_Nm));
        force = std::max(force, truth.f_N.norm());
        torque = std::max(torque, truth.torque_Nm.norm());
      }
      const auto n = static_cast<double>(made.handles.size());
      table +=
          fmt::format("| {} | {} | {:.2g} | {:.2g} | {:.2g} | {:.2g} | {:.2g} | {:.3g} | {:.3g} |\n", name, entry.name,
                      force_sum / n, force_max, torque_sum / n * 1e3, torque_max * 1e3, jnd, force, torque * 1e3);
    }
  }
  fmt::print("{}", table);
  if (!options.out.empty()) write_file(options.out, table);
  return ExitStatus::passed;
}

struct ToolCheckOptions {
  std::string renderer, fault;
  ToolRendererFlags flags;
};

ExitStatus tool_check_command(const ToolCheckOptions& options) {
  const std::vector<ToolRendererEntry> known = options.flags.entries();
  const ToolRendererEntry& entry = find_tool_renderer(known, options.renderer);
  ToolSubject subject = subject_of(entry, options.flags.settings_of(entry, {&entry, 1}));
  if (!options.fault.empty()) {
    const auto* const found = std::ranges::find(kToolFaultNames, options.fault);
    if (found == kToolFaultNames.end())
      throw UsageError(fmt::format("--fault {}: not known; `touchstone tool list` shows what is", options.fault));
    const auto fault = static_cast<ToolFault>(found - kToolFaultNames.begin());
    subject.make = [make = subject.make, fault](const Tool& tool, const TriangleMesh& object_W,
                                                const Coupling& coupling) {
      return std::make_unique<FaultyTool>(make(tool, object_W, coupling), fault, tool.mass.center_T_m);
    };
  }
  std::size_t failed = 0;
  std::size_t count = 0;
  for (const ToolFinding& finding : check_tool_renderer(subject)) {
    if (!finding.applies) {
      fmt::print("  n/a   {:<30} its normals are the tool's own\n", finding.check);
      continue;
    }
    ++count;
    failed += finding.passed ? 0U : 1U;
    fmt::print("  {:<5} {:<30} {:.3g} of at most {:.3g} {}{}\n", finding.passed ? "ok" : "WRONG", finding.check,
               finding.measured, finding.limit, finding.unit, finding.fault.empty() ? "" : ": " + finding.fault);
  }
  fmt::print("{}: {} of {} checks passed\n", options.renderer, count - failed, count);
  return failed == 0 ? ExitStatus::passed : ExitStatus::failed;
}

}  // namespace

void add_tool(CLI::App& program, Run& run) {
  auto* const command =
      program.add_subcommand("tool", "Render a tool with a shape: six degrees of freedom, force and torque");
  command->require_subcommand(1);
  command->footer(
      "Torques are about the handle (the tool's origin), on the tool by the object, in the axes of the object.\n"
      "Examples:\n"
      "  touchstone tool case peg-0.2mm --out peg\n"
      "  touchstone tool replay --renderer god-object-tool --tool peg/tool.obj --object peg/object.obj --path "
      "peg/path.csv --out "
      "peg/rendered.csv\n"
      "  touchstone tool table");

  auto* const list = command->add_subcommand("list", "Renderers of tools, exact cases and faults that can be planted");
  auto list_options = std::make_shared<ToolListOptions>();
  list_options->flags.plugins.add_to(*list);
  list->footer("Example:\n  touchstone tool list");
  list->callback([list_options, &run] { run = [list_options] { return list_tools(*list_options); }; });

  auto* const one =
      command->add_subcommand("case", "Write the meshes of an exact case and a scripted path of the handle");
  auto case_options = std::make_shared<ToolCaseOptions>();
  one->add_option("NAME", case_options->name, "See `touchstone tool list`")->required();
  one->add_option("--out", case_options->out, "Folder for tool.obj, object.obj and path.csv")->required();
  one->add_option("--seconds", case_options->seconds, "Duration of the path, at 1 kHz")->capture_default_str();
  one->footer("Example:\n  touchstone tool case peg-0.2mm --out peg --seconds 5");
  one->callback([case_options, &run] { run = [case_options] { return write_tool_case(*case_options); }; });

  auto* const replay = command->add_subcommand("replay", "Run one renderer over poses of the handle as they are");
  auto replay_options = std::make_shared<ToolReplayOptions>();
  replay->add_option("--renderer", replay_options->renderer, "See `touchstone tool list`")->required();
  replay
      ->add_option("--tool", replay_options->tool_mesh,
                   "Closed mesh in the tool's frame, origin at the handle: OBJ, OFF, PLY or STL")
      ->required();
  replay->add_option("--object", replay_options->object_mesh, "Closed mesh of the object")->required();
  replay->add_option("--mesh-unit", replay_options->unit, "Unit of both meshes' coordinates: m, mm, cm, km, um")
      ->capture_default_str();
  replay
      ->add_option("--path", replay_options->path,
                   "Poses of the handle: CSV or HDF5 with t_s, x_m, y_m, z_m, qw, qx, qy, qz")
      ->required();
  replay->add_option("--out", replay_options->out, "Rendered file: handle, force, torque, contact (CSV or HDF5)")
      ->required();
  replay->add_option("--proxy", replay_options->proxy, "Write the poses of the proxy, columns as in the path");
  replay->add_option("--keep-every", replay_options->keep_every, "Write each Nth sample; all are rendered")
      ->capture_default_str();
  replay->add_option("--timing", replay_options->timing,
                     "Write the cost of the steps alone as JSON (replays once more)");
  replay_options->flags.add_to(*replay);
  replay->footer(
      "Example:\n  touchstone tool replay --renderer god-object-tool --tool tool.obj --object object.obj --path "
      "path.csv --out out.csv");
  replay->callback([replay_options, &run] { run = [replay_options] { return tool_replay_command(*replay_options); }; });

  auto* const compare =
      command->add_subcommand("compare", "Compare two rendered files of one path: force, torque, pose of the proxy");
  auto compare_options = std::make_shared<ToolCompareOptions>();
  compare->add_option("EXPECTED", compare_options->expected, "Rendered file that is right")->required();
  compare->add_option("OBTAINED", compare_options->obtained, "Rendered file to judge")->required();
  compare->add_option("--force-tolerance", compare_options->force_N, "N; one value, or one per axis")
      ->expected(1, 3)
      ->capture_default_str();
  compare->add_option("--torque-tolerance", compare_options->torque_Nm, "Nm; one value, or one per axis")
      ->expected(1, 3)
      ->capture_default_str();
  compare->add_option("--expected-proxy", compare_options->expected_proxy, "Poses of the proxy that are right");
  compare->add_option("--obtained-proxy", compare_options->obtained_proxy, "Poses of the proxy to judge");
  compare->add_option("--json", compare_options->json, "Write the errors as JSON");
  compare->footer(
      "Exit status: 0 within the tolerances, 1 not.\n"
      "A just noticeable difference (JND) of torque is 12.7 %, and 7.6 mNm below 60 mNm (Jandura and Srinivasan "
      "1994).\n"
      "Example:\n  touchstone tool compare golden.csv obtained.csv --torque-tolerance 1e-6 1e-6 2e-6");
  compare->callback(
      [compare_options, &run] { run = [compare_options] { return tool_compare_command(*compare_options); }; });

  auto* const table =
      command->add_subcommand("table", "Force and torque error of renderers on cases whose answer is known");
  auto table_options = std::make_shared<ToolTableOptions>();
  table->add_option("--case", table_options->cases, "Only these; see `touchstone tool list`");
  table->add_option("--renderer", table_options->renderers, "Only these");
  table->add_option("--out", table_options->out, "Write the table as Markdown");
  table_options->flags.add_to(*table);
  table->footer("Example:\n  touchstone tool table --case box-corner --renderer god-object-tool");
  table->callback([table_options, &run] { run = [table_options] { return tool_table_command(*table_options); }; });

  auto* const check =
      command->add_subcommand("check", "Hold a renderer to what every renderer of a tool must do; faults are named");
  auto check_options = std::make_shared<ToolCheckOptions>();
  check->add_option("--renderer", check_options->renderer, "See `touchstone tool list`")->required();
  check->add_option("--fault", check_options->fault,
                    "Plant this fault first, to see it found; see `touchstone tool list`");
  check_options->flags.add_to(*check);
  check->footer(
      "Exit status: 0 all passed, 1 not.\nExample:\n  touchstone tool check --renderer god-object-tool --fault "
      "torque-sign");
  check->callback([check_options, &run] { run = [check_options] { return tool_check_command(*check_options); }; });
}

}  // namespace touchstone::apps
