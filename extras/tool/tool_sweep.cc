#include "tool_sweep.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "contacts/known_contacts.h"
#include "harness/base/json_reader.h"
#include "harness/tool/tool_renderer_entry.h"
#include "tool_errors.h"
#include "tool_renderers/tool_catalogue.h"

namespace touchstone::tool {
using runs::SweepCase;
using runs::SweepDesign;

namespace {

struct SweptContact {
  std::string name;
  ContactShape shape;
};

struct SweptToolRenderer {
  std::string renderer;
  ToolSettings settings;
};

SweptContact read_swept_contact(JsonObject object) {
  SweptContact contact;
  contact.name = object.text("case");
  contact.shape.scale = object.optional_number("scale").value_or(1.0);
  contact.shape.clearance_m = object.optional_number("clearance_m");
  object.finish();
  return contact;
}

SweptToolRenderer read_swept_tool_renderer(JsonObject object) {
  SweptToolRenderer choice;
  choice.renderer = object.text("renderer");
  Coupling& coupling = choice.settings.coupling;
  coupling.stiffness_N_per_m = object.optional_number("stiffness_N_per_m").value_or(coupling.stiffness_N_per_m);
  coupling.rotational_stiffness_Nm_per_rad =
      object.optional_number("rotational_stiffness_Nm_per_rad").value_or(coupling.rotational_stiffness_Nm_per_rad);
  if (object.has("parameters")) {
    JsonObject parameters = object.object("parameters");
    for (const std::string& parameter : parameters.keys())
      choice.settings.parameters[parameter] = parameters.number(parameter);
    parameters.finish();
  }
  object.finish();
  return choice;
}

ToolErrors run(const SweepCase& one, const std::vector<ToolRendererEntry>& renderers) {
  const std::string source = fmt::format("case {}", one.number);
  const nlohmann::json document = parse_json(one.document, source);
  JsonObject root(document, source, "");
  const auto [name, shape] = read_swept_contact(root.object("contacts"));
  const auto [wanted, settings] = read_swept_tool_renderer(root.object("renderer"));
  root.finish();
  const ToolRendererEntry& entry = find_tool_renderer(renderers, wanted);
  const KnownContacts known = contacts::known_contacts(name, settings.coupling, shape);
  const auto renderer = make_tool_renderer(entry, known.tool, known.object_W, settings);
  return errors_of(*renderer, one.chosen.back(), known);
}

}  // namespace

runs::DesignParts tool_sweep_parts() {
  return {"touchstone-tool-sweep/1",
          {{"contacts", "contacts", [](JsonObject one, const auto&) { read_swept_contact(std::move(one)); }, 0},
           {"renderer", "renderers", [](JsonObject one, const auto&) { read_swept_tool_renderer(std::move(one)); }, 2}},
          {},
          "",
          false};
}

runs::CaseTable tool_sweep_table(const SweepDesign& design) {
  using enum runs::CaseColumn::Type;
  runs::CaseTable table{design.text(), design.size(), {}, "specification", "--out"};
  for (const char* const name : {"contacts", "renderer", "document"}) table.columns.push_back({name, text});
  for (const std::string& pointer : design.varied()) table.columns.push_back({pointer, real});
  for (const char* const name :
       {"mean_force_error_N", "max_force_error_N", "mean_torque_error_Nm", "max_torque_error_Nm", "max_force_error_jnd",
        "max_torque_error_jnd", "largest_right_force_N", "largest_right_torque_Nm"})
    table.columns.push_back({name, real});
  return table;
}

runs::CaseJob tool_sweep_job(const SweepDesign& design) {
  runs::CaseJob job;
  job.what = "sweep";
  job.cases = design.size();
  job.run = [&design, renderers = tool_renderers::tool_renderer_catalogue()](runs::CaseRow& row,
                                                                             const runs::PartDone&) {
    const SweepCase one = design.at(row.number);
    for (const std::string& name : one.chosen) row.values.emplace_back(name);
    row.values.emplace_back(one.document);
    for (const double value : one.varied) row.values.emplace_back(value);
    const ToolErrors errors = run(one, renderers);
    for (const double value :
         {errors.mean_force_N, errors.max_force_N, errors.mean_torque_Nm, errors.max_torque_Nm, errors.max_force_jnd,
          errors.max_torque_jnd, errors.largest_right_force_N, errors.largest_right_torque_Nm})
      row.values.emplace_back(value);
  };
  return job;
}

}  // namespace touchstone::tool
