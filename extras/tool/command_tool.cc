#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <utility>

#include "contacts/exact_cases.h"
#include "contacts/known_contacts.h"
#include "harness/base/atomic_file.h"
#include "harness/base/units.h"
#include "harness/recording/recording_file.h"
#include "harness/report/page_html.h"
#include "harness/surface/mesh_file.h"
#include "harness/tool/faulty_tool.h"
#include "harness/tool/tool_checks.h"
#include "tool_commands.h"
#include "tool_errors.h"
#include "tool_metrics.h"
#include "tool_renderer_flags.h"
#include "tool_renderers/tool_catalogue.h"
#include "tool_replay.h"
#include "tool_reports/tool_comparison_page.h"

namespace touchstone::tool {

namespace {

using contacts::ExactCase;

struct ToolListOptions {
  ToolRendererFlags flags;
};

ExitStatus list_tools(const ToolListOptions& options) {
  fmt::print("renderers\n");
  for (const ToolRendererEntry& entry : options.flags.entries()) {
    fmt::print("  {:<18} {} ({})\n", entry.name, entry.summary, entry.source);
    for (const rendering::ParameterDeclaration& p : entry.parameters)
      fmt::print("    {:<26} {} {}: {}\n", p.name, p.initial, p.unit, p.meaning);
  }
  fmt::print("exact cases\n");
  for (const std::string& name : contacts::exact_case_names())
    fmt::print("  {:<18} {}\n", name, contacts::make_exact_case(name).what);
  fmt::print("faults of `tool check --fault`\n");
  for (const std::string_view name : tool_fault_names) fmt::print("  {}\n", name);
  return ExitStatus::passed;
}

struct ToolCaseOptions {
  std::string name, out;
  double seconds = 60.0;
};

ExitStatus write_tool_case(const ToolCaseOptions& options) {
  if (!(options.seconds > 0.0))
    throw UsageError(fmt::format("--seconds {}: more than 0 was expected", options.seconds));
  const ExactCase made = contacts::make_exact_case(options.name);
  const std::filesystem::path folder = options.out;
  const std::size_t samples = contacts::write_exact_case(made, options.seconds, folder);
  fmt::print("{}: tool.obj ({} triangles), object.obj ({} triangles), path.csv ({} samples)\n", folder.string(),
             made.tool_T.triangle_count(), made.object_W.triangle_count(), samples);
  return ExitStatus::passed;
}

struct ToolReplayOptions {
  std::string renderer, object_mesh, path, out, proxy, contacts, timing;
  std::uint64_t keep_every = 1;
  ToolShapeFlags tool;
  ToolRendererFlags flags;
};

ExitStatus tool_replay_command(const ToolReplayOptions& options) {
  const std::vector<ToolRendererEntry> known = options.flags.entries();
  const ToolRendererEntry& entry = find_tool_renderer(known, options.renderer);
  const auto renderer = make_tool_renderer(
      entry, options.tool.load(), surface::load_mesh(options.object_mesh, length_unit_factor(options.tool.unit)),
      options.flags.settings_of(entry, {&entry, 1}));
  ToolReplayFiles files{options.path, options.out, {}, options.keep_every};
  if (!options.proxy.empty()) files.proxy = options.proxy;
  if (!options.contacts.empty()) files.contacts = options.contacts;
  const ToolReplaySummary summary = replay_tool(*renderer, files);
  fmt::print("{}: {} samples, {} in contact, largest force {:.6g} N, largest torque {:.6g} mNm\n", options.out,
             summary.samples, summary.in_contact, summary.largest_force_N, summary.largest_torque_Nm * 1e3);
  if (files.contacts) fmt::print("{}: {} contacts\n", options.contacts, summary.contacts);
  if (!options.timing.empty()) {
    const std::vector<double> times = measure_tool_steps(*renderer, options.path);
    write_file(options.timing, step_times_to_json(times, renderer->memory_bytes()));
    fmt::print("{}", step_times_to_text(times));
  }
  return ExitStatus::passed;
}

struct ToolCompareOptions {
  std::string expected, obtained, expected_proxy, obtained_proxy, json, report;
  std::vector<double> force_N{1e-6}, torque_Nm{1e-7};
  Coupling coupling;
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
  tool_reports::ComparedTools compared{recording::load_recording(options.expected),
                                       recording::load_recording(options.obtained),
                                       {},
                                       {},
                                       options.coupling,
                                       force_N,
                                       torque_Nm};
  report::Provenance provenance = report::make_provenance(apps::command_line());
  provenance.inputs = {report::describe_input("expected", options.expected),
                       report::describe_input("obtained", options.obtained)};
  if (!options.expected_proxy.empty()) {
    compared.expected_proxy = recording::load_trajectory(options.expected_proxy);
    compared.obtained_proxy = recording::load_trajectory(options.obtained_proxy);
    provenance.inputs.push_back(report::describe_input("expected proxy", options.expected_proxy));
    provenance.inputs.push_back(report::describe_input("obtained proxy", options.obtained_proxy));
  }
  const ToolComparison c = tool_reports::compared_errors(compared);
  if (!options.json.empty()) write_file(options.json, comparison_to_json(c));
  if (!options.report.empty()) write_html(options.report, tool_reports::tool_comparison_page(compared, c, provenance));
  fmt::print("{}", comparison_to_text(c));
  const bool passed = within(c, force_N, torque_Nm);
  fmt::print("{}: {} samples within ({:g}, {:g}, {:g}) N and ({:g}, {:g}, {:g}) Nm\n", passed ? "passed" : "failed",
             c.samples, force_N.x(), force_N.y(), force_N.z(), torque_Nm.x(), torque_Nm.y(), torque_Nm.z());
  return passed ? ExitStatus::passed : ExitStatus::failed;
}

struct ToolTableOptions {
  std::string out, largest;
  std::vector<std::string> cases, renderers;
  bool slide = false;
  ToolRendererFlags flags;
};

// That all of the renderers have.
double friction_of(const ToolTableOptions& options, std::span<const ToolRendererEntry> entries) {
  double mu = 0.0;
  for (const ToolRendererEntry& entry : entries) {
    const ToolSettings settings = options.flags.settings_of(entry, entries);
    const auto given = settings.parameters.find(std::string(friction_parameter_name));
    if (given == settings.parameters.end() || !(given->second > 0.0)) {
      throw UsageError(
          fmt::format("--slide: {} has no friction; give --parameter mu=0.3, and with --renderer those that "
                      "have mu (`touchstone tool list`)",
                      entry.name));
    }
    mu = given->second;
  }
  return mu;
}

ExitStatus tool_table_command(const ToolTableOptions& options) {
  if (!options.out.empty()) {  // before the long work
    const std::filesystem::path folder = std::filesystem::path(options.out).parent_path();
    ensure_writable_folder(folder.empty() ? "." : folder);
  }
  std::vector<std::string> cases = options.cases;
  if (cases.empty()) cases = options.slide ? contacts::sliding_case_names() : contacts::exact_case_names();
  const std::vector<ToolRendererEntry> known = options.flags.entries();
  std::vector<ToolRendererEntry> entries;
  for (const std::string& name : options.renderers) entries.push_back(find_tool_renderer(known, name));
  if (entries.empty()) entries = known;
  const double mu = options.slide ? friction_of(options, entries) : 0.0;
  std::vector<ToolErrors> rows;
  for (const std::string& name : cases) {
    const KnownContacts known_answer = options.slide ? contacts::known_slides(name, options.flags.coupling, mu)
                                                     : contacts::known_contacts(name, options.flags.coupling);
    for (const ToolRendererEntry& entry : entries) {
      const ToolSettings settings = options.flags.settings_of(entry, entries);
      const auto renderer = make_tool_renderer(entry, known_answer.tool, known_answer.object_W, settings);
      rows.push_back(errors_of(*renderer, entry.name, known_answer));
    }
  }
  if (!options.largest.empty()) {
    double largest = 0.0;
    for (const ToolErrors& row : rows)
      largest = worse(largest, options.largest == "force" ? row.max_force_N : row.max_torque_Nm);
    fmt::print("{:.17g}\n", largest);
    return ExitStatus::passed;
  }
  const std::string table = tool_error_table(rows);
  fmt::print("{}", table);
  if (!options.out.empty()) write_file(options.out, "### force and torque error\n\n" + table);
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
  if (!options.fault.empty()) subject = with_fault(std::move(subject), options.fault);
  const std::vector<ToolFinding> findings = check_tool_renderer(subject);
  fmt::print("{}", findings_to_text(options.renderer, findings));
  return passed(findings) ? ExitStatus::passed : ExitStatus::failed;
}

void add_tool_compare(CLI::App& tool_command, apps::Run& run) {
  auto* const compare = tool_command.add_subcommand(
      "compare", "Compare two rendered files of one path: force, torque, pose of the proxy");
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
  compare
      ->add_option("--stiffness", compare_options->coupling.stiffness_N_per_m,
                   "N/m: what the hand feels of the proxy's place")
      ->capture_default_str();
  compare
      ->add_option("--rotational-stiffness", compare_options->coupling.rotational_stiffness_Nm_per_rad,
                   "Nm/rad: what the hand feels of the proxy's orientation")
      ->capture_default_str();
  compare->add_option("--json", compare_options->json, "Write the errors as JSON");
  compare->add_option("--report", compare_options->report,
                      "Write a page (HTML): errors per axis, in just noticeable differences and over time");
  compare->footer(
      "Exit status: 0 within the tolerances, 1 not.\n"
      "A just noticeable difference (JND) of torque is 12.7 %, and 7.6 mNm below 60 mNm (Jandura and Srinivasan "
      "1994).\n"
      "Example:\n  touchstone tool compare golden.csv obtained.csv --torque-tolerance 1e-6 1e-6 2e-6");
  compare->callback(
      [compare_options, &run] { run = [compare_options] { return tool_compare_command(*compare_options); }; });
}

}  // namespace

void add_tool(CLI::App& program, apps::Run& run) {
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
  replay_options->tool.add_to(*replay)->required();
  replay->add_option("--object", replay_options->object_mesh, "Closed mesh of the object")->required();
  replay
      ->add_option("--mesh-unit", replay_options->tool.unit,
                   "Unit of both meshes' coordinates: m, mm, cm, km, um, in, ft")
      ->capture_default_str();
  replay
      ->add_option("--path", replay_options->path,
                   "Poses of the handle: CSV or HDF5 with t_s, x_m, y_m, z_m, qw, qx, qy, qz")
      ->required();
  replay->add_option("--out", replay_options->out, "Rendered file: handle, force, torque, contact (CSV or HDF5)")
      ->required();
  replay->add_option("--proxy", replay_options->proxy, "Write the poses of the proxy, columns as in the path");
  replay->add_option(
      "--contacts", replay_options->contacts,
      "Write the contacts, a row each: t_s, px_m.. (where), nx.. (out of the object), fx_N.. (on the tool)");
  replay->add_option("--keep-every", replay_options->keep_every, "Write each Nth sample; all are rendered")
      ->capture_default_str();
  replay->add_option("--timing", replay_options->timing,
                     "Write the cost of the steps alone as JSON (replays once more)");
  replay_options->flags.add_to(*replay);
  replay->footer(
      "Example:\n  touchstone tool replay --renderer god-object-tool --tool tool.obj --object object.obj --path "
      "path.csv --out out.csv");
  replay->callback([replay_options, &run] { run = [replay_options] { return tool_replay_command(*replay_options); }; });

  add_tool_compare(*command, run);

  auto* const table =
      command->add_subcommand("table", "Force and torque error of renderers on cases whose answer is known");
  auto table_options = std::make_shared<ToolTableOptions>();
  table->add_option("--case", table_options->cases, "Only these; see `touchstone tool list`");
  table->add_option("--renderer", table_options->renderers, "Only these");
  table->add_option("--out", table_options->out, "Write the table as Markdown");
  table
      ->add_option("--largest", table_options->largest,
                   "Print one number instead, the largest error of all rows: force [N] or torque [Nm]; for `touchstone "
                   "bisect --measure`")
      ->check(CLI::IsMember({"force", "torque"}));
  table->add_flag("--slide", table_options->slide,
                  "Slid along the object with friction instead of pressed: of renderers with the parameter mu");
  table_options->flags.add_to(*table);
  table->footer(
      "Examples:\n  touchstone tool table --case box-corner --renderer god-object-tool\n"
      "  touchstone tool table --slide --renderer penalty-coupling --parameter mu=0.3\n"
      "  touchstone bisect --build 'make -C $SRC O=$BUILD' --good v1 --bad main --measure 'touchstone tool table "
      "--case "
      "box-corner --plugin $BUILD/libmine.so --renderer mine --largest torque'");
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
  add_fit(*command, run);
  add_golden(*command, run);
  add_scorecard(*command, run);
  add_atlas(*command, run);
  add_sweep(*command, run);
}

}  // namespace touchstone::tool
