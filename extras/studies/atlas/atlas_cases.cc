#include "atlas/atlas_cases.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "harness/base/error.h"

namespace touchstone::atlas {
namespace {

using nlohmann::ordered_json;

// Which of the two columns the sharpness stands in.
const char* sharpness_name(Scene scene) { return scene == Scene::bump ? "side_angle_rad" : "thickness_m"; }

constexpr std::size_t first_result = 6;

}  // namespace

runs::CaseTable atlas_case_table(const AtlasGrid& grid) {
  const ordered_json specification{{"schema", "touchstone-atlas-grid/1"},
                                   {"renderers", grid.renderers},
                                   {"side_angles_rad", grid.side_angles_rad},
                                   {"thicknesses_m", grid.thicknesses_m},
                                   {"stiffnesses_N_per_m", grid.stiffnesses_N_per_m},
                                   {"mus", grid.mus},
                                   {"force_N", grid.force_N}};
  using enum runs::CaseColumn::Type;
  return {specification.dump(),
          case_count(grid),
          {{"scene", text},
           {"renderer", text},
           {sharpness_name(Scene::bump), real},
           {sharpness_name(Scene::shell), real},
           {"stiffness_N_per_m", real},
           {"mu", real},
           {"samples", integer},
           {"sticks", integer},
           {"pops_through", integer},
           {"loses_contact", integer},
           {"pulls_inward", integer},
           {"largest_lag_m", real}},
          "grid",
          "--cases"};
}

runs::CaseJob atlas_job(const AtlasGrid& grid, AtlasWorld& world) {
  runs::CaseJob job;
  job.what = "atlas";
  job.cases = case_count(grid);
  job.run = [&world, grid](runs::CaseRow& row, const runs::PartDone&) {
    const AtlasCase one = case_at(grid, row.number);
    const auto sharpness = [&](Scene scene) {
      return one.scene == scene ? runs::CaseValue(one.sharpness) : runs::CaseValue();
    };
    row.values = {name_of(one.scene),      one.renderer,          sharpness(Scene::bump),
                  sharpness(Scene::shell), one.stiffness_N_per_m, one.mu};
    const Anomalies found = world.run(one);
    for (const std::uint64_t count :
         {found.samples, found.sticks, found.pops_through, found.loses_contact, found.pulls_inward})
      row.values.emplace_back(count);
    row.values.emplace_back(found.largest_lag_m);
  };
  return job;
}

std::vector<AtlasCase> stored_cases(const AtlasGrid& grid, const runs::CaseStore& store) {
  std::vector<AtlasCase> cases;
  for (const runs::CaseRow& row : store.rows(0, case_count(grid))) {
    AtlasCase one = case_at(grid, row.number);
    one.error = row.error;
    if (one.error.empty()) {
      auto at = row.values.begin() + first_result;
      for (std::size_t* const count : {&one.found.samples, &one.found.sticks, &one.found.pops_through,
                                       &one.found.loses_contact, &one.found.pulls_inward})
        *count = runs::as_integer(*at++);
      one.found.largest_lag_m = runs::as_number(*at);
    }
    cases.push_back(std::move(one));
  }
  return cases;
}

std::vector<std::string> atlas_words(const AtlasGrid& grid) {
  const auto list = [](const auto& values) { return fmt::format("{}", fmt::join(values, ",")); };
  return {"atlas",
          "--renderers",
          list(grid.renderers),
          "--angles",
          list(grid.side_angles_rad),
          "--thicknesses",
          list(grid.thicknesses_m),
          "--stiffnesses",
          list(grid.stiffnesses_N_per_m),
          "--mus",
          list(grid.mus),
          "--force",
          fmt::format("{}", grid.force_N)};
}

std::string describe_case(const AtlasGrid& grid, std::uint64_t number) {
  const AtlasCase one = case_at(grid, number);
  return ordered_json{{"scene", name_of(one.scene)},
                      {"renderer", one.renderer},
                      {sharpness_name(one.scene), one.sharpness},
                      {"stiffness_N_per_m", one.stiffness_N_per_m},
                      {"mu", one.mu}}
      .dump();
}

}  // namespace touchstone::atlas
