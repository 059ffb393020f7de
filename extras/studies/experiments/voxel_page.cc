#include "experiments/voxel_page.h"

#include <fmt/format.h>

#include "harness/report/evaluation_page.h"

namespace touchstone::experiments {
using report::LinePlot;
using report::Section;
using report::Table;
using report::Tone;

namespace {

std::string cube(int resolution) { return resolution > 0 ? fmt::format("{}^3", resolution) : "none"; }

Section findings_section(const VoxelExperiment& e) {
  Section section{"Which findings hold here", "Of the paper's section 4.1. Our body is not their duck.", {}, false};
  Table table;
  table.columns = {"finding of the paper", "here", "holds"};
  for (const VoxelFinding& finding : e.findings) {
    table.rows.push_back({{report::text_cell(finding.statement),
                           report::text_cell(finding.here),
                           {finding.holds ? "yes" : "no", false, finding.holds ? Tone::good : Tone::warning}},
                          "",
                          {}});
  }
  section.blocks.emplace_back(std::move(table));
  return section;
}

Section table_section(const VoxelExperiment& e) {
  Section section{"Table 1",
                  fmt::format("Errors over {} samples of one simulated scan ({} in contact, up to {:.2f} mm deep, "
                              "measured force {:.3f} N RMS). Most of the error against the measured forces is "
                              "friction, which none of these renderers has; the own part is the distance to the "
                              "frictionless answer on the smooth body at the same positions.",
                              e.samples, e.in_contact, 1e3 * e.deepest_m, e.rms_measured_N),
                  {},
                  false};
  Table ours;
  ours.caption = "Here";
  ours.columns = {"renderer",   "voxels",          "RMS force error [N]", "own part [N]",
                  "operations", "median per step", "max per step",        "us/step",
                  "init [s]",   "memory [MB]"};
  for (const VoxelRow& row : e.rows) {
    Table::Row cells;
    cells.cells = {report::text_cell(row.renderer), report::number_cell(cube(row.resolution)),
                   report::number_cell(fmt::format("{:.4f}", row.rms_N)),
                   report::number_cell(fmt::format("{:.4f}", row.own_rms_N))};
    if (row.operations) {
      cells.cells.push_back(report::number_cell(fmt::format("{}", row.operations->total())));
      cells.cells.push_back(report::number_cell(fmt::format("{:g}", row.operations->median)));
      cells.cells.push_back(report::number_cell(fmt::format("{}", row.operations->max)));
    } else {
      for (int i = 0; i < 3; ++i) cells.cells.push_back(report::text_cell("not counted"));
    }
    cells.cells.push_back(report::number_cell(fmt::format("{:.3f}", row.timing.mean_us)));
    cells.cells.push_back(report::number_cell(fmt::format("{:.3f}", 1e-3 * row.timing.build_ms)));
    cells.cells.push_back(report::number_cell(fmt::format("{:.3f}", memory_MB(row))));
    ours.rows.push_back(std::move(cells));
  }
  section.blocks.emplace_back(std::move(ours));
  Table theirs;
  theirs.caption = "Table 1 of the paper (a scanned duck, a 1.5 GHz Pentium)";
  theirs.columns = {"renderer", "voxels", "RMS force error [N]", "operations", "init [s]", "memory [MB]"};
  for (const PublishedVoxelRow& row : published_voxel_table()) {
    theirs.rows.push_back({{report::text_cell(row.algorithm), report::number_cell(cube(row.resolution)),
                            report::number_cell(fmt::format("{:.3f}", row.rms_N)),
                            report::number_cell(fmt::format("{:.0f}", row.operations)),
                            report::number_cell(fmt::format("{:.2f}", row.init_s)),
                            report::number_cell(fmt::format("{:.1f}", row.memory_MB))},
                           "",
                           {}});
  }
  section.blocks.emplace_back(std::move(theirs));
  return section;
}

LinePlot over_resolution(const VoxelExperiment& e, std::string title, std::string y_label, const char* renderer,
                         double (*value)(const VoxelRow&)) {
  LinePlot plot;
  plot.title = std::move(title);
  plot.x_label = "voxels along the longest side";
  plot.y_label = std::move(y_label);
  plot.half_width = true;
  report::Line line;
  line.name = renderer;
  line.tone = Tone::rendered;
  line.markers = true;
  for (const VoxelRow& row : e.rows) {
    if (row.renderer != renderer) continue;
    line.x.push_back(row.resolution);
    line.y.push_back(value(row));
  }
  plot.lines.push_back(std::move(line));
  return plot;
}

Section plots_section(const VoxelExperiment& e) {
  Section section{"Over the resolution", "", {}, false};
  const VoxelRow& proxy = e.rows.front();
  auto error = over_resolution(e, "RMS error against the measured force", "N", "voxel",
                               [](const VoxelRow& row) { return row.rms_N; });
  error.levels = {{"god-object", proxy.rms_N}};
  section.blocks.emplace_back(std::move(error));
  auto own =
      over_resolution(e, "The renderer's own part", "N", "voxel", [](const VoxelRow& row) { return row.own_rms_N; });
  own.levels = {{"god-object", proxy.own_rms_N}};
  section.blocks.emplace_back(std::move(own));
  section.blocks.emplace_back(over_resolution(e, "Memory of the dense grid", "MB", "voxel", memory_MB));
  section.blocks.emplace_back(over_resolution(e, "Memory of the narrow band", "MB", "voxel-sparse", memory_MB));
  LinePlot forces;
  forces.title = "Magnitude of the force along the scan";
  forces.x_label = "time [s]";
  forces.y_label = "force [N]";
  const auto add = [&](const std::string& name, const std::vector<Vec3>& f_W_N, Tone tone, bool dashed) {
    report::Line line{name, e.t_s, {}, tone, dashed, false};
    for (const Vec3& f : f_W_N) line.y.push_back(f.norm());
    forces.lines.push_back(std::move(line));
  };
  add("measured", e.measured_W_N, Tone::measured, false);
  add("god-object", proxy.f_W_N, Tone::reference, false);
  add("voxel 32^3", e.find("voxel", 32)->f_W_N, Tone::error, true);
  add("voxel 64^3", e.find("voxel", 64)->f_W_N, Tone::rendered, true);
  section.blocks.emplace_back(std::move(forces));
  return section;
}

}  // namespace

report::Page voxel_page(const VoxelExperiment& e, const report::Provenance& provenance) {
  report::Page page;
  page.title = "Proxy against voxels";
  page.subtitle = "The first experiment of Ruffaldi et al. 2006 (section 4.1, table 1) on a duck-like body";
  const auto headline = [&](const std::string& label, const VoxelRow& row) {
    page.headlines.push_back({label, fmt::format("{:.4f}", row.rms_N), "N",
                              row.operations ? fmt::format("{:.0f} operations a step", row.operations->mean) : "",
                              Tone::neutral});
  };
  headline("god-object", e.rows.front());
  headline("voxel 32^3", *e.find("voxel", 32));
  headline("voxel 64^3", *e.find("voxel", 64));
  page.sections.push_back(findings_section(e));
  page.sections.push_back(table_section(e));
  page.sections.push_back(plots_section(e));
  page.sections.push_back(
      {"What is counted",
       "Operations are floating-point additions, subtractions, multiplications, divisions, square roots and "
       "comparisons of the servo step, one each, counted by running the same code with a counting scalar. The "
       "god-object's search for what it meets next is counted on a plain tree of boxes, because the tree that the fast "
       "path uses cannot be counted. Not counted: sign changes, absolute values, rounding to integers, indexing.",
       {},
       true});
  page.sections.push_back(provenance_section(provenance));
  return page;
}

}  // namespace touchstone::experiments
