#include "atlas/atlas_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "harness/report/console.h"
#include "harness/report/evaluation_page.h"
#include "harness/report/map_picture.h"

namespace touchstone::atlas {
using report::Section;
using report::Table;
using report::Tone;

namespace {

// The values that occur, in their order.
template <class Value>
std::vector<Value> values_of(const std::vector<AtlasCase>& cases, Scene scene, Value AtlasCase::*member) {
  std::vector<Value> values;
  for (const auto& own : cases) {
    if (own.scene == scene && std::find(values.begin(), values.end(), own.*member) == values.end())
      values.push_back(own.*member);
  }
  return values;
}

// One map: cases of a renderer at a friction.
class Map {
 public:
  Map(const std::vector<AtlasCase>& cases, Scene scene, const std::string& renderer, double mu)
      : sharpness(values_of(cases, scene, &AtlasCase::sharpness)),
        stiffness(values_of(cases, scene, &AtlasCase::stiffness_N_per_m)) {
    for (const auto& own : cases) {
      if (own.scene == scene && own.renderer == renderer && own.mu == mu) cells_.push_back(&own);
    }
  }
  [[nodiscard]] const AtlasCase* at(double of_sharpness, double of_stiffness) const {
    for (const AtlasCase* own : cells_) {
      if (own->sharpness == of_sharpness && own->stiffness_N_per_m == of_stiffness) return own;
    }
    return nullptr;
  }
  [[nodiscard]] const std::vector<const AtlasCase*>& cells() const { return cells_; }

  std::vector<double> sharpness;
  std::vector<double> stiffness;

 private:
  std::vector<const AtlasCase*> cells_;
};

std::string sharpness_label(Scene scene, double value) {
  return scene == Scene::bump ? fmt::format("{:.2f}", value) : fmt::format("{:g}", 1e3 * value);
}
std::string sharpness_axis(Scene scene) { return scene == Scene::bump ? "angle of the sides [rad]" : "thickness [mm]"; }

// Okabe and Ito's palette, as the reports; the worst that a case shows decides.
const char* colour(const std::string& shown) {
  if (shown == "?") return "#BBBBBB";
  if (shown.find('p') != std::string::npos) return "#D55E00";
  if (shown.find('l') != std::string::npos) return "#CC79A7";
  if (shown.find('i') != std::string::npos) return "#0072B2";
  if (shown.find('s') != std::string::npos) return "#E69F00";
  return "#DDEEE7";
}

std::string legend(const std::vector<AtlasCase>& cases) {
  return std::string("s sticks, p pops through, l loses contact, i pulls inward, each in at least 1 % of the samples") +
         (failed_cases(cases) > 0 ? "; ? could not be run" : "");
}

template <class Visit>
void each_map(const std::vector<AtlasCase>& cases, Scene scene, Visit&& visit) {
  for (const auto& renderer : values_of(cases, scene, &AtlasCase::renderer)) {
    for (const double mu : values_of(cases, scene, &AtlasCase::mu))
      visit(renderer, mu, Map(cases, scene, renderer, mu));
  }
}

report::PictureCells drawn(const Map& map, Scene scene) {
  report::PictureCells out;
  for (const double s : map.sharpness) out.across.push_back(sharpness_label(scene, s));
  for (const double k : map.stiffness) {
    out.up.push_back(fmt::format("{:g}", k));
    out.cells.emplace_back();
    for (const double s : map.sharpness) {
      const AtlasCase* const own = map.at(s, k);
      const std::string shown = own == nullptr ? "?" : letters(*own);
      out.cells.back().push_back({shown, colour(shown)});
    }
  }
  return out;
}

Table map_table(const Map& map, Scene scene, const std::string& renderer, double mu) {
  Table table;
  table.caption = fmt::format("{}, mu = {:g}", renderer, mu);
  table.columns = {"stiffness [N/m] \\ " + sharpness_axis(scene)};
  for (const double s : map.sharpness) table.columns.push_back(sharpness_label(scene, s));
  for (auto k = map.stiffness.rbegin(); k != map.stiffness.rend(); ++k) {
    Table::Row row;
    row.cells.push_back({fmt::format("{:g}", *k), true, Tone::neutral});
    for (const double s : map.sharpness) {
      const AtlasCase* const own = map.at(s, *k);
      const std::string shown = own == nullptr ? "?" : letters(*own);
      const Tone tone = shown == "?" ? Tone::error : shown.empty() ? Tone::good : Tone::warning;
      row.cells.push_back({shown.empty() ? "-" : shown, false, tone});
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

namespace {

std::vector<std::vector<std::string>> summary_rows(const std::vector<AtlasCase>& cases) {
  const bool failed = failed_cases(cases) > 0;
  std::vector<std::vector<std::string>> rows{
      {"scene", "renderer", "mu", "cases", "clean", "sticks", "pops through", "loses contact", "pulls inward"}};
  if (failed) rows.front().emplace_back("failed to run");
  for (const Scene scene : {Scene::bump, Scene::shell}) {
    each_map(cases, scene, [&](const std::string& renderer, double mu, const Map& map) {
      std::array<std::size_t, 5> count{};
      for (const AtlasCase* own : map.cells()) {
        const std::string shown = letters(*own);
        count[0] += shown.empty() ? 1U : 0U;
        for (std::size_t i = 0; i < 4; ++i) count[i + 1] += shown.find("spli"[i]) != std::string::npos ? 1U : 0U;
      }
      std::vector<std::string> row{name_of(scene), renderer, fmt::format("{:g}", mu),
                                   fmt::format("{}", map.cells().size())};
      for (const std::size_t own : count) row.push_back(fmt::format("{}", own));
      if (failed)
        row.push_back(fmt::format(
            "{}", std::ranges::count_if(map.cells(), [](const AtlasCase* own) { return !own->error.empty(); })));
      rows.push_back(std::move(row));
    });
  }
  return rows;
}

// Those that could not be run, each with its reason.
Section failed_section(const std::vector<AtlasCase>& cases) {
  Section section{
      "Cases that could not be run", "They stand as ? in the maps and are counted nowhere else.", {}, false};
  Table table;
  table.columns = {"scene", "renderer", "sharpness", "stiffness [N/m]", "mu", "why"};
  for (const auto& own : cases) {
    if (own.error.empty()) continue;
    Table::Row row;
    for (const std::string& text : {name_of(own.scene), own.renderer, sharpness_label(own.scene, own.sharpness),
                                    fmt::format("{:g}", own.stiffness_N_per_m), fmt::format("{:g}", own.mu), own.error})
      row.cells.push_back({text, false, Tone::error});
    table.rows.push_back(std::move(row));
  }
  section.blocks.emplace_back(std::move(table));
  return section;
}

Section summary_section(const std::vector<AtlasCase>& cases) {
  Section section{
      "How many cases show what",
      "A case is one run; sticks, pops through and so on are counted where at least 1 % of its samples show "
      "it. Definitions: extras/studies/atlas/anomalies.h.",
      {},
      false};
  Table table;
  table.caption = "Summary";
  const auto rows = summary_rows(cases);
  table.columns = rows.front();
  for (std::size_t i = 1; i < rows.size(); ++i) {
    Table::Row row;
    for (std::size_t c = 0; c < rows[i].size(); ++c) {
      const bool wrong = c >= 5 && rows[i][c] != "0";
      row.cells.push_back({rows[i][c], c >= 2, wrong ? Tone::warning : Tone::neutral});
    }
    table.rows.push_back(std::move(row));
  }
  section.blocks.emplace_back(std::move(table));
  return section;
}

}  // namespace

std::size_t failed_cases(const std::vector<AtlasCase>& cases) {
  return static_cast<std::size_t>(std::ranges::count_if(cases, [](const auto& own) { return !own.error.empty(); }));
}

std::string atlas_table(const std::vector<AtlasCase>& cases) { return report::align_columns(summary_rows(cases)); }

report::Page atlas_page(const std::vector<AtlasCase>& cases, const report::Provenance& provenance) {
  report::Page page;
  page.title = "Atlas of geometric correctness";
  page.subtitle =
      "Where renderers stick, pop through, lose contact or pull inward: sharpness x stiffness x friction (Ruffaldi et "
      "al. 2006, section 5 and figure 8)";
  page.sections.push_back(summary_section(cases));
  if (failed_cases(cases) > 0) page.sections.push_back(failed_section(cases));
  for (const Scene scene : {Scene::bump, Scene::shell}) {
    for (const auto& renderer : values_of(cases, scene, &AtlasCase::renderer)) {
      Section section{
          fmt::format("{}: {}", scene == Scene::bump ? "Bump" : "Thin shell", renderer), legend(cases), {}, false};
      for (const double mu : values_of(cases, scene, &AtlasCase::mu))
        section.blocks.emplace_back(map_table(Map(cases, scene, renderer, mu), scene, renderer, mu));
      page.sections.push_back(std::move(section));
    }
  }
  page.sections.push_back(provenance_section(provenance));
  return page;
}

std::string atlas_to_json(const std::vector<AtlasCase>& cases) {
  nlohmann::ordered_json document{{"schema", "touchstone-atlas/1"}, {"cases", nlohmann::ordered_json::array()}};
  for (const auto& own : cases) {
    nlohmann::ordered_json one{{"scene", name_of(own.scene)},
                               {"renderer", own.renderer},
                               {own.scene == Scene::bump ? "side_angle_rad" : "thickness_m", own.sharpness},
                               {"stiffness_N_per_m", own.stiffness_N_per_m},
                               {"mu", own.mu}};
    if (own.error.empty()) {
      one.update({{"samples", own.found.samples},
                  {"sticks", own.found.sticks},
                  {"pops_through", own.found.pops_through},
                  {"loses_contact", own.found.loses_contact},
                  {"pulls_inward", own.found.pulls_inward},
                  {"largest_lag_m", own.found.largest_lag_m},
                  {"faults", letters(own)}});
    } else {
      one["error"] = own.error;
    }
    document["cases"].push_back(std::move(one));
  }
  return document.dump(1) + "\n";
}

std::string atlas_picture(const std::vector<AtlasCase>& cases, Scene scene) {
  report::MapPicture picture;
  picture.title = scene == Scene::bump ? "Bump: stiffness [N/m] over the angle of its sides [rad]"
                                       : "Thin shell: stiffness [N/m] over its thickness [mm]";
  picture.rows = values_of(cases, scene, &AtlasCase::renderer);
  picture.legend = legend(cases);
  const auto mus = values_of(cases, scene, &AtlasCase::mu);
  for (const double mu : mus) picture.columns.push_back(fmt::format("mu = {:g}", mu));
  for (const std::string& renderer : picture.rows) {
    picture.maps.emplace_back();
    for (const double mu : mus) picture.maps.back().push_back(drawn(Map(cases, scene, renderer, mu), scene));
  }
  return report::map_picture_svg(picture);
}

}  // namespace touchstone::atlas
