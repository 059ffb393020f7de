#include "contacts/tool_golden.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "contacts/scripted_path.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/json_reader.h"
#include "harness/recording/recording_writer.h"
#include "harness/tool/tool_path.h"

namespace touchstone::contacts {
namespace {

constexpr double rate_Hz = 1000.0;

Vec3 per_axis(JsonObject& object, const char* key) {
  const std::vector<double> values = object.numbers(key);
  if (values.size() != 3 || !std::ranges::all_of(values, [](double v) { return v >= 0.0; }))
    object.fail_at(key, "three numbers of 0 or more were expected: x, y and z");
  return {values[0], values[1], values[2]};
}

double positive(JsonObject& object, const char* key) {
  const double value = object.number(key);
  if (!(value > 0.0)) object.fail_at(key, fmt::format("more than 0 was expected, got {}", value));
  return value;
}

recording::SampleBlock rendered(const ToolGolden& golden, const tool::ToolRendererEntry& entry) {
  const ExactCase made = make_exact_case(golden.exact_case);
  const auto renderer =
      tool::make_tool_renderer(entry, tool::solid_tool(made.tool_T), made.object_W, {golden.coupling, {}});
  const auto samples = static_cast<std::uint64_t>(golden.seconds * rate_Hz) + 1;
  recording::SampleBlock answer;
  renderer->reset();
  for (std::uint64_t i = 0; i < samples; ++i) {
    const double t_s = double(i) / rate_Hz;
    const tool::Pose handle = scripted_pose(made, t_s, golden.seconds);
    const tool::ToolResult result = tool::step_or_throw(*renderer, {t_s, handle});
    if (i % golden.keep_every != 0) continue;
    answer.motion.t_s.push_back(t_s);
    answer.motion.p_W_m.push_back(handle.p_W_m);
    answer.motion.q_WS.push_back(handle.q_WT);
    answer.f_W_N.push_back(result.f_W_N);
    answer.torque_W_Nm.push_back(result.torque_W_Nm);
    answer.contact.push_back(result.contact ? 1 : 0);
  }
  return answer;
}

}  // namespace

ToolGolden read_tool_golden(const std::filesystem::path& file) {
  const nlohmann::json document = load_json(file);
  JsonObject root(document, file.string(), "");
  root.schema("touchstone-tool-golden/1");
  ToolGolden golden;
  golden.file = file;
  golden.exact_case = root.text("case");
  golden.seconds = positive(root, "seconds");
  const double keep_every = positive(root, "keep_every");
  if (keep_every != std::floor(keep_every)) root.fail_at("keep_every", "a whole number was expected");
  golden.keep_every = static_cast<std::uint64_t>(keep_every);
  golden.coupling = {positive(root, "stiffness_N_per_m"), positive(root, "rotational_stiffness_Nm_per_rad")};
  const nlohmann::json& names = root.raw("renderers");
  if (!names.is_array() || names.empty() ||
      !std::ranges::all_of(names, [](const nlohmann::json& name) { return name.is_string(); }))
    root.fail_at("renderers", "at least one name was expected");
  golden.renderers = names.get<std::vector<std::string>>();
  JsonObject tolerance = root.object("tolerance");
  golden.force_tolerance_N = per_axis(tolerance, "force_N");
  golden.torque_tolerance_Nm = per_axis(tolerance, "torque_Nm");
  if (tolerance.text("reason").empty()) tolerance.fail_at("reason", "why these tolerances was expected");
  tolerance.finish();
  for (JsonObject& accepted : root.objects("accepted")) {
    for (const char* const key : {"renderer", "reason", "commit"}) static_cast<void>(accepted.text(key));
    accepted.finish();
  }
  root.finish();
  return golden;
}

recording::Recording answer_now(const ToolGolden& golden, const tool::ToolRendererEntry& entry) {
  recording::SampleBlock block = rendered(golden, entry);
  return {std::move(block.motion), std::move(block.f_W_N), std::move(block.torque_W_Nm), entry.name + " now"};
}

void accept_tool_golden(const ToolGolden& golden, const tool::ToolRendererEntry& entry, const std::string& reason,
                        const std::string& commit) {
  if (reason.empty()) throw UsageError("--accept: why the answer changed was expected");
  if (std::ranges::find(golden.renderers, entry.name) == golden.renderers.end()) {
    throw UsageError(fmt::format("{}: \"renderers\" does not name {}; add it first", golden.file.string(), entry.name));
  }
  const recording::SampleBlock answer = rendered(golden, entry);
  recording::RecordingWriter writer(
      golden.answer(entry.name),
      {recording::ColumnGroup::time, recording::ColumnGroup::position, recording::ColumnGroup::orientation,
       recording::ColumnGroup::force, recording::ColumnGroup::torque, recording::ColumnGroup::contact});
  writer.append(answer);
  writer.commit();
  auto document = nlohmann::ordered_json::parse(read_file(golden.file));
  document["accepted"].push_back({{"renderer", entry.name}, {"reason", reason}, {"commit", commit}});
  write_file(golden.file, document.dump(2) + "\n", Replace::inputs_too);
}

}  // namespace touchstone::contacts
