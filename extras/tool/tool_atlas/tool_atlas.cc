#include "tool_atlas/tool_atlas.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "contacts/exact_cases.h"
#include "contacts/known_contacts.h"
#include "harness/base/error.h"
#include "harness/tool/worse.h"

namespace touchstone::tool_atlas {
namespace {

using nlohmann::ordered_json;

// The rotational stiffness of a coupling by its stiffness, as in the default coupling [m^2].
constexpr double arm_m2 = 0.002;

constexpr std::size_t first_error = 5;

const std::vector<double>& places_of(const ToolAtlasGrid& grid, std::string_view contacts) {
  return contacts == contacts::peg ? grid.clearances_m : grid.sizes;
}

std::uint64_t cases_of(const ToolAtlasGrid& grid, std::string_view contacts) {
  return std::uint64_t{places_of(grid, contacts).size()} * grid.stiffnesses_N_per_m.size() * grid.renderers.size();
}

tool::ToolErrors run(const ToolAtlasCase& one, const tool::ToolRendererEntry& entry, const tool::ToolSettings& set) {
  const tool::KnownContacts known = contacts::known_contacts(one.contacts, set.coupling, one.shape);
  const auto renderer = tool::make_tool_renderer(entry, known.tool, known.object_W, set);
  return tool::errors_of(*renderer, entry.name, known);
}

// The results of a row in their order; for reading and writing.
template <class Errors>
auto results(Errors& e) {
  return std::array{&e.mean_force_N,  &e.max_force_N,    &e.max_force_jnd,         &e.mean_torque_Nm,
                    &e.max_torque_Nm, &e.max_torque_jnd, &e.largest_right_force_N, &e.largest_right_torque_Nm};
}

}  // namespace

double ToolAtlasCase::jnd() const { return tool::worse(errors.max_force_jnd, errors.max_torque_jnd); }

std::uint64_t case_count(const ToolAtlasGrid& grid) {
  std::uint64_t count = 0;
  for (const std::string& contacts : grid.contacts) count += cases_of(grid, contacts);
  return count;
}

ToolAtlasCase case_at(const ToolAtlasGrid& grid, std::uint64_t number) {
  for (const std::string& contacts : grid.contacts) {
    if (const std::uint64_t here = cases_of(grid, contacts); number >= here) {
      number -= here;
      continue;
    }
    const std::size_t renderers = grid.renderers.size(), stiffnesses = grid.stiffnesses_N_per_m.size();
    ToolAtlasCase one;
    one.contacts = contacts;
    one.renderer = grid.renderers[number % renderers];
    one.stiffness_N_per_m = grid.stiffnesses_N_per_m[number / renderers % stiffnesses];
    const double place = places_of(grid, contacts)[number / renderers / stiffnesses];
    if (contacts == contacts::peg) {
      one.shape.clearance_m = place;
    } else {
      one.shape.scale = place;
    }
    return one;
  }
  throw std::out_of_range("atlas of tools: no case with that number");
}

std::string describe_case(const ToolAtlasGrid& grid, std::uint64_t number) {
  const ToolAtlasCase one = case_at(grid, number);
  return ordered_json{{"contacts", one.contacts},
                      {one.shape.clearance_m ? "clearance_m" : "size", one.place()},
                      {"stiffness_N_per_m", one.stiffness_N_per_m},
                      {"renderer", one.renderer}}
      .dump();
}

runs::CaseTable tool_atlas_table(const ToolAtlasGrid& grid) {
  const ordered_json specification{{"schema", "touchstone-tool-atlas-grid/1"},
                                   {"renderers", grid.renderers},
                                   {"contacts", grid.contacts},
                                   {"sizes", grid.sizes},
                                   {"clearances_m", grid.clearances_m},
                                   {"stiffnesses_N_per_m", grid.stiffnesses_N_per_m},
                                   {"parameters", grid.parameters},
                                   {"plugins", grid.plugins}};
  using enum runs::CaseColumn::Type;
  runs::CaseTable table{
      specification.dump(),
      case_count(grid),
      {{"contacts", text}, {"size", real}, {"clearance_m", real}, {"stiffness_N_per_m", real}, {"renderer", text}},
      "grid",
      "--cases"};
  for (const char* const name :
       {"mean_force_error_N", "max_force_error_N", "max_force_error_jnd", "mean_torque_error_Nm", "max_torque_error_Nm",
        "max_torque_error_jnd", "largest_right_force_N", "largest_right_torque_Nm"})
    table.columns.push_back({name, real});
  return table;
}

runs::CaseJob tool_atlas_job(const ToolAtlasGrid& grid, std::vector<tool::ToolRendererEntry> entries) {
  std::vector<tool::ToolRendererEntry> used;
  for (const std::string& name : grid.renderers) used.push_back(tool::find_tool_renderer(entries, name));
  std::map<std::string, std::map<std::string, double>> values;
  for (const tool::ToolRendererEntry& entry : used) values[entry.name] = tool::own_values(grid.parameters, entry, used);
  runs::CaseJob job;
  job.what = "atlas";
  job.cases = case_count(grid);
  job.run = [grid, used, values](runs::CaseRow& row, const runs::PartDone&) {
    const ToolAtlasCase one = case_at(grid, row.number);
    const auto real_or_none = [](std::optional<double> value) {
      return value ? runs::CaseValue(*value) : runs::CaseValue();
    };
    row.values = {one.contacts, real_or_none(one.shape.clearance_m ? std::nullopt : std::optional(one.shape.scale)),
                  real_or_none(one.shape.clearance_m), one.stiffness_N_per_m, one.renderer};
    const tool::ToolErrors errors =
        run(one, tool::find_tool_renderer(used, one.renderer),
            {{one.stiffness_N_per_m, arm_m2 * one.stiffness_N_per_m}, values.at(one.renderer)});
    for (const double* const value : results(errors)) {
      if (!std::isfinite(*value)) throw BadData(fmt::format("{}: an answer is no number", one.renderer));
      row.values.emplace_back(*value);
    }
  };
  return job;
}

std::vector<ToolAtlasCase> stored_cases(const ToolAtlasGrid& grid, const runs::CaseStore& store) {
  std::vector<ToolAtlasCase> cases;
  for (const runs::CaseRow& row : store.rows(0, case_count(grid))) {
    ToolAtlasCase one = case_at(grid, row.number);
    one.error = row.error;
    if (one.ran()) {
      auto at = row.values.begin() + first_error;
      for (double* const value : results(one.errors)) *value = runs::as_number(*at++);
    }
    cases.push_back(std::move(one));
  }
  return cases;
}

std::vector<std::string> tool_atlas_words(const ToolAtlasGrid& grid) {
  const auto list = [](const auto& values) { return fmt::format("{}", fmt::join(values, ",")); };
  std::vector<std::string> words{"tool",          "atlas",
                                 "--renderers",   list(grid.renderers),
                                 "--contacts",    list(grid.contacts),
                                 "--sizes",       list(grid.sizes),
                                 "--clearances",  list(grid.clearances_m),
                                 "--stiffnesses", list(grid.stiffnesses_N_per_m)};
  for (const auto& [name, value] : grid.parameters) {
    words.emplace_back("--parameter");
    words.push_back(fmt::format("{}={}", name, value));
  }
  return words;
}

}  // namespace touchstone::tool_atlas
