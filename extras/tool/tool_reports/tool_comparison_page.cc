#include "tool_reports/tool_comparison_page.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <numbers>

#include "harness/report/evaluation_page.h"
#include "tool_reports/tool_plots.h"

namespace touchstone::tool_reports {
namespace {

using report::Headline;
using report::Page;
using report::Section;
using report::Table;
using report::Tone;

constexpr double degrees = 180.0 / std::numbers::pi;

Table per_axis(const ComparedTools& compared, const tool::ToolComparison& errors) {
  Table table;
  table.columns = {"", "largest error", "tolerance", "unit", "passed"};
  const auto add = [&](const std::string& what, double error, double tolerance, double factor, const char* unit) {
    // Not error > tolerance: what is not a number does not pass.
    const bool passed = error <= tolerance;
    Table::Row row;
    row.cells = {report::text_cell(what), report::number_cell(factor * error), report::number_cell(factor * tolerance),
                 report::text_cell(unit), report::text_cell(passed ? "yes" : "NO")};
    row.cells.back().tone = passed ? Tone::good : Tone::error;
    table.rows.push_back(std::move(row));
  };
  for (int k = 0; k < 3; ++k)
    add(fmt::format("force along {}", "xyz"[k]), errors.max_force_error_N[k], compared.force_tolerance_N[k], 1.0, "N");
  for (int k = 0; k < 3; ++k) {
    add(fmt::format("torque about {}", "xyz"[k]), errors.max_torque_error_Nm[k], compared.torque_tolerance_Nm[k], 1e3,
        "mNm");
  }
  return table;
}

Section felt_over_time(const ComparedTools& compared) {
  Section section{"What a person could feel of it",
                  "In just noticeable differences (JND) of the expected force (a fingertip's) and torque (12.7 %, and "
                  "7.6 mNm below 60 mNm: Jandura and Srinivasan 1994). One is noticed three times out of four.",
                  {},
                  false};
  const auto& e = compared.expected;
  const auto& o = compared.obtained;
  const auto add = [&](const char* title, const std::function<double(std::size_t)>& value) {
    section.blocks.emplace_back(plot_over_time(title, "error [JND]", e.motion.t_s, "error", Tone::error, value));
  };
  add("force", [&](std::size_t i) { return tool::force_error_in_jnd(e.f_W_N[i], o.f_W_N[i]); });
  add("torque", [&](std::size_t i) { return tool::torque_error_in_jnd(e.torque_W_Nm[i], o.torque_W_Nm[i]); });
  return section;
}

Section proxy_over_time(const ComparedTools& compared) {
  Section section{"Pose of the proxy", "", {}, false};
  const auto& expected = compared.expected_proxy->motion;
  const auto& obtained = compared.obtained_proxy->motion;
  const auto apart = [&](std::size_t i) {
    return tool::displacement({expected.p_W_m[i], expected.q_WS[i]}, {obtained.p_W_m[i], obtained.q_WS[i]});
  };
  section.blocks.emplace_back(plot_over_time("translation error", "[mm]", expected.t_s, "error", Tone::error,
                                             [&](std::size_t i) { return 1e3 * apart(i).translation_m.norm(); }));
  section.blocks.emplace_back(plot_over_time("rotation error", "[degrees]", expected.t_s, "error", Tone::error,
                                             [&](std::size_t i) { return degrees * apart(i).rotation_rad.norm(); }));
  return section;
}

}  // namespace

tool::ToolComparison compared_errors(const ComparedTools& compared) {
  tool::ToolComparison errors = tool::compare_tools(compared.expected, compared.obtained);
  if (compared.expected_proxy && compared.obtained_proxy) {
    tool::compare_proxies(*compared.expected_proxy, *compared.obtained_proxy, compared.expected, compared.coupling,
                          errors);
  }
  return errors;
}

Page tool_comparison_page(const ComparedTools& compared, const tool::ToolComparison& errors,
                          const report::Provenance& provenance) {
  const auto name = [](const recording::Recording& r) { return std::filesystem::path(r.source).filename().string(); };
  const bool passed = tool::within(errors, compared.force_tolerance_N, compared.torque_tolerance_Nm);
  Page page;
  page.title = fmt::format("{} against {}", name(compared.obtained), name(compared.expected));
  page.subtitle = fmt::format("{}: {} samples, errors per axis against the tolerances", passed ? "passed" : "failed",
                              errors.samples);
  page.headlines = {
      {"force error", fmt::format("{:.3g}", errors.max_force_error_N.maxCoeff()), "N",
       fmt::format("largest of an axis; {:.3g} JND as a vector", errors.max_force_error_jnd), Tone::error},
      {"torque error", fmt::format("{:.3g}", 1e3 * errors.max_torque_error_Nm.maxCoeff()), "mNm",
       fmt::format("largest of an axis; {:.3g} JND as a vector, at row {}", errors.max_torque_error_jnd,
                   errors.worst_torque_row + 1),
       Tone::error}};
  Section table{"Errors per axis", "", {}, false};
  table.blocks.emplace_back(per_axis(compared, errors));
  page.sections.push_back(std::move(table));
  if (errors.max_proxy_translation_m) {
    page.headlines.push_back({"proxy, place", fmt::format("{:.3g}", 1e3 * *errors.max_proxy_translation_m), "mm",
                              fmt::format("{:.3g} JND of force through the coupling of {:g} N/m",
                                          *errors.max_proxy_translation_jnd, compared.coupling.stiffness_N_per_m),
                              Tone::error});
    page.headlines.push_back(
        {"proxy, orientation", fmt::format("{:.3g}", degrees * *errors.max_proxy_rotation_rad), "degrees",
         fmt::format("{:.3g} JND of torque through the coupling of {:g} Nm/rad", *errors.max_proxy_rotation_jnd,
                     compared.coupling.rotational_stiffness_Nm_per_rad),
         Tone::error});
  }
  page.sections.push_back(felt_over_time(compared));
  if (compared.expected_proxy && compared.obtained_proxy) page.sections.push_back(proxy_over_time(compared));
  const auto wrench_of = [](const recording::Recording& r) {
    return [&r](std::size_t i) { return Wrench{r.f_W_N[i], r.torque_W_Nm[i]}; };
  };
  const std::array<WrenchLine, 2> lines{{{"expected", Tone::measured, false, wrench_of(compared.expected)},
                                         {"obtained", Tone::rendered, true, wrench_of(compared.obtained)}}};
  page.sections.push_back(wrench_section("Force and torque", compared.expected.motion.t_s, lines));
  page.sections.push_back(report::provenance_section(provenance));
  return page;
}

}  // namespace touchstone::tool_reports
