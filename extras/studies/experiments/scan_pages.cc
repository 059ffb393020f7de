#include "experiments/scan_pages.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "experiments/rows.h"
#include "harness/report/console.h"
#include "harness/report/evaluation_page.h"

namespace touchstone::experiments {
using report::Line;
using report::Page;
using report::Section;
using report::Tone;

namespace {

std::string findings_text(const std::vector<PaperFinding>& findings) {
  std::string text;
  for (const auto& f : findings)
    text += fmt::format("{}: {}; here: {}\n", f.holds ? "holds" : "DOES NOT HOLD", f.statement, f.here);
  return text;
}

Section findings_section(const std::vector<PaperFinding>& findings) {
  Section section{"Which findings hold here", "Of the paper. Our body is not their duck.", {}, false};
  report::Table table;
  table.columns = {"finding of the paper", "here", "holds"};
  for (const auto& f : findings) {
    table.rows.push_back({{{f.statement, false, Tone::neutral},
                           {f.here, false, Tone::neutral},
                           {f.holds ? "yes" : "no", false, f.holds ? Tone::good : Tone::warning}},
                          "",
                          {}});
  }
  section.blocks.emplace_back(std::move(table));
  return section;
}

Rows friction_rows(const FrictionExperiment& e) {
  Rows rows{{"", "stiffness [N/m]", "true mu", "fitted mu", "without [N]", "with [N]", "left"}};
  const auto add = [&](const std::string& what, const std::string& stiffness, const std::string& truth,
                       const std::string& mu, double without, double with) {
    rows.push_back({what, stiffness, truth, mu, fmt::format("{:.3f}", without), fmt::format("{:.3f}", with),
                    fmt::format("{:.0f} %", 100.0 * with / without)});
  };
  for (const auto& fit : e.fits) {
    for (const FrictionAtStiffness* const own : {&fit.soft, &fit.stiff})
      add(fmt::format("scan {}", fit.seed), fmt::format("{:.0f}", own->stiffness_N_per_m),
          fmt::format("{:.3f}", fit.true_mu), fmt::format("{:.4f}", own->fitted_mu), own->without.mean_N,
          own->with.mean_N);
  }
  add("published, table 2", "500", "unknown", "radius 0.3008 mm", PublishedFriction::without_N,
      PublishedFriction::with_N);
  return rows;
}

Rows friction_estimate_rows(const FrictionExperiment& e) {
  Rows rows{{"", "true mu", "by 500 N/m", "by 5000 N/m", "rigid probe", "with the errors twice", "estimate",
             "standard error", "off", "standard error / mu"}};
  for (const auto& fit : e.fits) {
    const FrictionEstimate& own = fit.estimate;
    rows.push_back({fmt::format("scan {}", fit.seed), fmt::format("{:.3f}", fit.true_mu),
                    fmt::format("{:.4f}", fit.soft.fitted_mu), fmt::format("{:.4f}", fit.stiff.fitted_mu),
                    fmt::format("{:.4f}", own.rigid_mu), fmt::format("{:.4f}", own.again_mu),
                    fmt::format("{:.4f}", own.mu), fmt::format("{:.4f}", own.standard_error),
                    fmt::format("{:+.2f} %", 100.0 * (own.mu / fit.true_mu - 1.0)),
                    fmt::format("{:.2f} %", 100.0 * own.standard_error / own.mu)});
  }
  return rows;
}

Rows real_friction_rows(const FrictionExperiment& e) {
  Rows rows{{"mesh continued by", "fitted stiffness [N/m]", "fitted mu", "without [N]", "with [N]", "left"}};
  for (const RealFrictionFit& own : e.real) {
    rows.push_back({own.extended_m > 0.0 ? fmt::format("{:g} mm", 1e3 * own.extended_m) : "not at all",
                    fmt::format("{:.0f}", own.stiffness_N_per_m), fmt::format("{:.4f}", own.fitted_mu),
                    fmt::format("{:.3f}", own.rms_without_N), fmt::format("{:.3f}", own.rms_with_N),
                    fmt::format("{:.0f} %", 100.0 * own.rms_with_N / own.rms_without_N)});
  }
  return rows;
}

Rows density_rows(const DensityExperiment& e, bool shading) {
  Rows rows{{"triangles", "error [N]", "relative"}};
  if (shading) rows[0].insert(rows[0].end(), {"with shading [N]", "gone"});
  rows[0].insert(rows[0].end(), {"against the whole force [N]", "operations", "published kTri", "published [N]",
                                 "published relative", "published operations"});
  const double finest = e.points.back().plain.mean_N;
  for (std::size_t i = 0; i < e.points.size(); ++i) {
    const DensityPoint& p = e.points[i];
    std::vector<std::string> row{fmt::format("{}", p.triangles), fmt::format("{:.4f}", p.plain.mean_N),
                                 fmt::format("{:.2f}", p.plain.mean_N / finest)};
    if (shading)
      row.insert(row.end(), {fmt::format("{:.4f}", p.shaded.mean_N),
                             fmt::format("{:.0f} %", 100.0 * (1.0 - p.shaded.mean_N / p.plain.mean_N))});
    const auto& theirs = published_density[i];
    row.insert(row.end(), {fmt::format("{:.3f}", shading ? p.shaded_all.mean_N : p.plain_all.mean_N),
                           p.operations ? fmt::format("{}", p.operations->total()) : "not counted",
                           fmt::format("{:g}", theirs.kilo_triangles), fmt::format("{:.3f}", theirs.error_N),
                           fmt::format("{:.2f}", theirs.relative), fmt::format("{:.0f}", theirs.flops)});
    rows.push_back(std::move(row));
  }
  return rows;
}

Line density_line(const DensityExperiment& e, std::string name, double (*value)(const DensityPoint&), Tone tone) {
  Line line{std::move(name), {}, {}, tone, false, true};
  for (const auto& p : e.points) {
    line.x.push_back(static_cast<double>(p.triangles));
    line.y.push_back(value(p));
  }
  return line;
}

}  // namespace

std::string friction_table(const FrictionExperiment& e) {
  std::string text = "Mean force error (their equation 3) on the half not fitted\n" +
                     report::align_columns(friction_rows(e)) +
                     "Coefficient estimated from both probes and the instruments' known errors\n" +
                     report::align_columns(friction_estimate_rows(e));
  if (!e.real.empty())
    text += "Real recording: RMS force error on the blocks not fitted\n" + report::align_columns(real_friction_rows(e));
  return text + findings_text(friction_findings(e));
}

Page friction_page(const FrictionExperiment& e, const report::Provenance& provenance) {
  Page page;
  page.title = "Friction identified from a scan";
  page.subtitle = "Experiment 2 of Ruffaldi et al. 2006 (section 4.2, table 2) on simulated scans of a duck-like body";
  page.sections.push_back(findings_section(friction_findings(e)));
  Section table{"Table 2",
                "Simulated scans with instrument noise: the coefficient is fitted on the first half and the mean error "
                "(equation 3) is of the second. The friction cone of Harwin and Melder, mu_static = mu_dynamic; the "
                "paper varies a friction radius instead.",
                {},
                false};
  table.blocks.emplace_back(table_of(friction_rows(e), "Here and published"));
  report::LinePlot plot;
  plot.title = "Force error against the friction coefficient";
  plot.x_label = "mu";
  plot.y_label = "mean force error [N]";
  plot.height_px = 400;
  constexpr std::array tones{Tone::rendered, Tone::measured, Tone::error, Tone::reference, Tone::good};
  for (std::size_t i = 0; i < e.fits.size(); ++i) {
    for (const FrictionAtStiffness* const own : {&e.fits[i].soft, &e.fits[i].stiff})
      plot.lines.push_back(
          {fmt::format("true mu {:.2f}, {:.1f} N/mm", e.fits[i].true_mu, 1e-3 * own->stiffness_N_per_m), own->mu,
           own->mean_error_N, tones[i % tones.size()], own == &e.fits[i].soft, true});
  }
  table.blocks.emplace_back(std::move(plot));
  page.sections.push_back(std::move(table));
  Section estimate{
      "The coefficient",
      fmt::format("Two probes extrapolated to a rigid one (Richardson 1911); then {} times measured again "
                  "with the instruments' errors added a second time, and followed back to none (simulation "
                  "extrapolation: Cook and Stefanski 1994). The standard error is their spread.",
                  measurements),
      {},
      false};
  estimate.blocks.emplace_back(table_of(friction_estimate_rows(e), "Coefficient estimated"));
  page.sections.push_back(std::move(estimate));
  if (!e.real.empty()) {
    Section real{"A real recording",
                 fmt::format("Stiffness and coefficient fitted on every other {:g} s of the recording, at the measured "
                             "positions; RMS force error on the rest. A mesh that ends where the recording does lets "
                             "the tip slip over an edge that the object does not have, so it is continued.",
                             e.real.front().block_s),
                 {},
                 false};
    real.blocks.emplace_back(table_of(real_friction_rows(e), "Fitted on a real recording"));
    page.sections.push_back(std::move(real));
  }
  page.sections.push_back(provenance_section(provenance));
  return page;
}

std::string density_table(const DensityExperiment& e, bool shading) {
  return "Mean force error (their equation 3) against the normal part of the recorded force\n" +
         report::align_columns(density_rows(e, shading)) +
         findings_text(shading ? shading_findings(e) : density_findings(e));
}

Page density_page(const DensityExperiment& e, bool shading, const report::Provenance& provenance) {
  Page page;
  page.title = shading ? "Force shading and the density of the mesh" : "The density of the mesh";
  page.subtitle = shading ? "Experiment 4 of Ruffaldi et al. 2006 (section 4.4, figure 7) on a duck-like body"
                          : "Experiment 3 of Ruffaldi et al. 2006 (section 4.3, table 3) on a duck-like body";
  page.sections.push_back(findings_section(shading ? shading_findings(e) : density_findings(e)));
  Section table{
      shading ? "Figure 7" : "Table 3",
      "Eight meshes decimated from one of 140,000 triangles. The in-trajectory is made once, over the finest; "
      "the error is against the normal part of the recorded force, from which it was made. Operations are "
      "floating-point operations of the whole trajectory, without shading, of the ball tip, searches on a plain tree "
      "of boxes and not inside Embree; the paper's are of its own trajectory.",
      {},
      false};
  table.blocks.emplace_back(table_of(density_rows(e, shading), "Here and published", 0));
  report::LinePlot plot;
  plot.title = "Force error over the size of the mesh";
  plot.x_label = "triangles";
  plot.log_x = true;
  plot.y_label = "mean force error [N]";
  plot.lines.push_back(density_line(
      e, "proxy", [](const DensityPoint& p) { return p.plain.mean_N; }, Tone::rendered));
  if (shading)
    plot.lines.push_back(density_line(
        e, "with force shading", [](const DensityPoint& p) { return p.shaded.mean_N; }, Tone::good));
  Line published{"published (another body)", {}, {}, Tone::reference, true, true};
  for (const auto& p : published_density) {
    published.x.push_back(1000.0 * p.kilo_triangles);
    published.y.push_back(p.error_N);
  }
  plot.lines.push_back(std::move(published));
  table.blocks.emplace_back(std::move(plot));
  page.sections.push_back(std::move(table));
  page.sections.push_back(provenance_section(provenance));
  return page;
}

}  // namespace touchstone::experiments
