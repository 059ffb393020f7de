#include "tool_atlas/tool_atlas_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "harness/report/console.h"
#include "harness/report/evaluation_page.h"
#include "harness/report/map_picture.h"

namespace touchstone::tool_atlas {
using report::Section;
using report::Table;
using report::Tone;

namespace {

// The values that occur among the cases, in their order.
template <class Value, class Cases>
std::vector<Value> occurring(const Cases& cases, Value ToolAtlasCase::*member) {
  std::vector<Value> values;
  for (const auto* own : cases) {
    if (std::ranges::find(values, own->*member) == values.end()) values.push_back(own->*member);
  }
  return values;
}

using Chosen = std::vector<const ToolAtlasCase*>;

Chosen chosen(const std::vector<ToolAtlasCase>& cases, const std::string& renderer = {},
              const std::string& contacts = {}) {
  Chosen out;
  for (const ToolAtlasCase& own : cases) {
    if ((renderer.empty() || own.renderer == renderer) && (contacts.empty() || own.contacts == contacts))
      out.push_back(&own);
  }
  return out;
}

std::vector<std::string> renderers_of(const std::vector<ToolAtlasCase>& cases) {
  return occurring(chosen(cases), &ToolAtlasCase::renderer);
}
std::vector<std::string> contacts_of(const std::vector<ToolAtlasCase>& cases) {
  return occurring(chosen(cases), &ToolAtlasCase::contacts);
}

struct Counts {
  std::size_t cases = 0, noticed = 0, failed = 0;
  const ToolAtlasCase* worst = nullptr;  // of those that ran
};

Counts counted(const Chosen& cases) {
  Counts counts;
  for (const ToolAtlasCase* own : cases) {
    ++counts.cases;
    if (!own->ran()) {
      ++counts.failed;
      continue;
    }
    counts.noticed += own->noticed() ? 1U : 0U;
    if (counts.worst == nullptr || std::isnan(own->jnd()) || own->jnd() > counts.worst->jnd()) counts.worst = own;
  }
  return counts;
}

std::string place_text(const ToolAtlasCase& own) {
  return own.shape.clearance_m ? fmt::format("{:g} mm", *own.shape.clearance_m * 1e3)
                               : fmt::format("size {:g}", own.shape.scale);
}

// Okabe and Ito's palette, as the other atlas.
std::string colour(const ToolAtlasCase& own) {
  if (!own.ran()) return "#BBBBBB";
  return !(own.jnd() <= 2.0) ? "#D55E00" : own.noticed() ? "#E69F00" : "#DDEEE7";
}
std::string cell_text(const ToolAtlasCase& own) {
  if (!own.ran()) return "?";
  return own.jnd() < 0.05   ? "0"
         : own.jnd() < 10.0 ? fmt::format("{:.1f}", own.jnd())
                            : fmt::format("{:.0f}", own.jnd());
}

// The places and stiffnesses of one renderer and contact as a map.
struct Places {
  std::vector<double> across, up;
  Chosen cases;
  [[nodiscard]] const ToolAtlasCase& at(double place, double stiffness) const {
    return **std::ranges::find_if(
        cases, [&](const ToolAtlasCase* own) { return own->place() == place && own->stiffness_N_per_m == stiffness; });
  }
};
Places places(const std::vector<ToolAtlasCase>& cases, const std::string& renderer, const std::string& contacts) {
  Places out{{}, {}, chosen(cases, renderer, contacts)};
  for (const ToolAtlasCase* own : out.cases) {
    if (std::ranges::find(out.across, own->place()) == out.across.end()) out.across.push_back(own->place());
  }
  out.up = occurring(out.cases, &ToolAtlasCase::stiffness_N_per_m);
  return out;
}
std::string place_label(const ToolAtlasCase& own) {
  return fmt::format("{:g}", own.shape.clearance_m ? *own.shape.clearance_m * 1e3 : own.shape.scale);
}

report::LinePlot plot_of(const std::vector<ToolAtlasCase>& cases, const std::string& contacts) {
  report::LinePlot plot;
  plot.half_width = true;
  plot.log_x = true;
  plot.y_label = "largest error [JND]";
  plot.levels = {{"just noticeable", 1.0}};
  constexpr std::array tones{Tone::measured, Tone::rendered, Tone::reference, Tone::warning, Tone::good};
  std::size_t tone = 0;
  for (const std::string& renderer : renderers_of(cases)) {
    const Places map = places(cases, renderer, contacts);
    const double stiffness = map.up[map.up.size() / 2];
    plot.title = fmt::format("{}, coupling {:g} N/m", contacts, stiffness);
    report::Line line{renderer, {}, {}, tones[tone++ % tones.size()], false, true};
    for (const double place : map.across) {
      const ToolAtlasCase& own = map.at(place, stiffness);
      plot.x_label = own.shape.clearance_m ? "clearance [mm]" : "size, of the usual one [1]";
      line.x.push_back(own.shape.clearance_m ? place * 1e3 : place);
      line.y.push_back(own.ran() ? own.jnd() : std::nan(""));
    }
    plot.lines.push_back(std::move(line));
  }
  return plot;
}

Table map_table(const std::vector<ToolAtlasCase>& cases, const std::string& renderer, const std::string& contacts) {
  const Places map = places(cases, renderer, contacts);
  Table table;
  table.caption = fmt::format("{}, {}", contacts, renderer);
  table.columns = {map.cases.front()->shape.clearance_m ? "stiffness [N/m] \\ clearance [mm]"
                                                        : "stiffness [N/m] \\ size [1]"};
  for (const double place : map.across) table.columns.push_back(place_label(map.at(place, map.up.front())));
  for (auto k = map.up.rbegin(); k != map.up.rend(); ++k) {
    Table::Row row;
    row.cells.push_back(report::number_cell(fmt::format("{:g}", *k)));
    for (const double place : map.across) {
      const ToolAtlasCase& own = map.at(place, *k);
      row.cells.push_back({own.ran() ? fmt::format("{:.2g}", own.jnd()) : "?", true,
                           !own.ran()      ? Tone::error
                           : own.noticed() ? Tone::warning
                                           : Tone::good});
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<std::vector<std::string>> summary_rows(const std::vector<ToolAtlasCase>& cases) {
  std::vector<std::vector<std::string>> rows{{"contact", "renderer", "cases", "above 1 JND", "could not run",
                                              "force error (N)", "force (JND)", "torque error (mNm)", "torque (JND)",
                                              "worst at"}};
  for (const std::string& contacts : contacts_of(cases)) {
    for (const std::string& renderer : renderers_of(cases)) {
      const Counts counts = counted(chosen(cases, renderer, contacts));
      std::vector<std::string> row{contacts, renderer, fmt::format("{}", counts.cases),
                                   fmt::format("{}", counts.noticed), fmt::format("{}", counts.failed)};
      if (counts.worst == nullptr) {
        row.insert(row.end(), 5, "none");
      } else {
        const tool::ToolErrors& e = counts.worst->errors;
        for (const double value : {e.max_force_N, e.max_force_jnd, e.max_torque_Nm * 1e3, e.max_torque_jnd})
          row.push_back(fmt::format("{:.2g}", value));
        row.push_back(fmt::format("{}, {:g} N/m", place_text(*counts.worst), counts.worst->stiffness_N_per_m));
      }
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

Section summary_section(const std::vector<ToolAtlasCase>& cases) {
  Section section{"By contact and renderer", "The errors are those of the worst case.", {}, false};
  Table table;
  table.caption = "Summary";
  const auto rows = summary_rows(cases);
  table.columns = rows.front();
  for (std::size_t i = 1; i < rows.size(); ++i) {
    Table::Row row;
    for (std::size_t c = 0; c < rows[i].size(); ++c)
      row.cells.push_back(
          {rows[i][c], c >= 2 && c <= 8, (c == 3 || c == 4) && rows[i][c] != "0" ? Tone::warning : Tone::neutral});
    table.rows.push_back(std::move(row));
  }
  section.blocks.emplace_back(std::move(table));
  return section;
}

Section failed_section(const std::vector<ToolAtlasCase>& cases) {
  Section section{"Cases that could not be run", "They stand as ? in the maps.", {}, false};
  Table table;
  table.columns = {"contact", "at", "stiffness [N/m]", "renderer", "why"};
  for (const ToolAtlasCase& own : cases) {
    if (own.ran()) continue;
    Table::Row row;
    for (const std::string& text :
         {own.contacts, place_text(own), fmt::format("{:g}", own.stiffness_N_per_m), own.renderer, own.error})
      row.cells.push_back({text, false, Tone::error});
    table.rows.push_back(std::move(row));
  }
  section.blocks.emplace_back(std::move(table));
  return section;
}

}  // namespace

std::string tool_atlas_sentence(const std::vector<ToolAtlasCase>& cases) {
  std::string text;
  for (const std::string& renderer : renderers_of(cases)) {
    const Counts counts = counted(chosen(cases, renderer));
    text += fmt::format("{}{} is off by more than a person notices (1 JND) in {} of {} cases", text.empty() ? "" : " ",
                        renderer, counts.noticed, counts.cases - counts.failed);
    if (counts.worst != nullptr)
      text += fmt::format(", most in {} ({}, {:g} N/m): {:.2g} JND", counts.worst->contacts, place_text(*counts.worst),
                          counts.worst->stiffness_N_per_m, counts.worst->jnd());
    text += counts.failed > 0 ? fmt::format("; {} could not be run.", counts.failed) : ".";
  }
  return text;
}

std::string tool_atlas_text(const std::vector<ToolAtlasCase>& cases) {
  return report::align_columns(summary_rows(cases));
}

report::Page tool_atlas_page(const std::vector<ToolAtlasCase>& cases, const report::Provenance& provenance) {
  report::Page page;
  page.title = "Atlas of tools";
  page.subtitle = tool_atlas_sentence(cases);
  Section pictures{"Largest error over size and clearance",
                   "Of force or torque, whichever a person notices more, against the exact equilibrium at rest.",
                   {},
                   false};
  for (const std::string& contacts : contacts_of(cases)) pictures.blocks.emplace_back(plot_of(cases, contacts));
  page.sections.push_back(std::move(pictures));
  page.sections.push_back(summary_section(cases));
  if (counted(chosen(cases)).failed > 0) page.sections.push_back(failed_section(cases));
  for (const std::string& contacts : contacts_of(cases)) {
    Section section{"Map: " + contacts, "Largest error in just noticeable differences.", {}, true};
    for (const std::string& renderer : renderers_of(cases))
      section.blocks.emplace_back(map_table(cases, renderer, contacts));
    page.sections.push_back(std::move(section));
  }
  page.sections.push_back(provenance_section(provenance));
  return page;
}

std::string tool_atlas_to_json(const std::vector<ToolAtlasCase>& cases) {
  nlohmann::ordered_json document{{"schema", "touchstone-tool-atlas/1"}, {"cases", nlohmann::ordered_json::array()}};
  for (const ToolAtlasCase& own : cases) {
    nlohmann::ordered_json one{{"contacts", own.contacts},
                               {own.shape.clearance_m ? "clearance_m" : "size", own.place()},
                               {"stiffness_N_per_m", own.stiffness_N_per_m},
                               {"renderer", own.renderer}};
    if (own.ran()) {
      one.update({{"max_force_error_N", own.errors.max_force_N},
                  {"max_force_error_jnd", own.errors.max_force_jnd},
                  {"max_torque_error_Nm", own.errors.max_torque_Nm},
                  {"max_torque_error_jnd", own.errors.max_torque_jnd}});
    } else {
      one["error"] = own.error;
    }
    document["cases"].push_back(std::move(one));
  }
  return document.dump(1) + "\n";
}

std::string tool_atlas_picture(const std::vector<ToolAtlasCase>& cases) {
  report::MapPicture picture;
  picture.title = "Stiffness [N/m] over size, or clearance of the peg [mm]";
  picture.columns = renderers_of(cases);
  picture.rows = contacts_of(cases);
  picture.legend = "largest error in just noticeable differences: above 1 orange, above 2 red; ? could not be run";
  for (const std::string& contacts : picture.rows) {
    picture.maps.emplace_back();
    for (const std::string& renderer : picture.columns) {
      const Places map = places(cases, renderer, contacts);
      report::PictureCells drawn;
      for (const double place : map.across) drawn.across.push_back(place_label(map.at(place, map.up.front())));
      for (const double k : map.up) {
        drawn.up.push_back(fmt::format("{:g}", k));
        drawn.cells.emplace_back();
        for (const double place : map.across)
          drawn.cells.back().push_back({cell_text(map.at(place, k)), colour(map.at(place, k))});
      }
      picture.maps.back().push_back(std::move(drawn));
    }
  }
  return report::map_picture_svg(picture);
}

}  // namespace touchstone::tool_atlas
