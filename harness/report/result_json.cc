#include "harness/report/result_json.h"

#include <nlohmann/json.hpp>

#include "harness/base/atomic_file.h"
#include "harness/base/input_files.h"
#include "harness/base/json_reader.h"
#include "harness/report/json_numbers.h"
#include "harness/report/metric_json.h"

namespace touchstone::report {
namespace {

using nlohmann::json;

json points_to_json(const std::vector<Vec3>& points) {
  json out = json::array();
  for (const Vec3& p : points) out.push_back({plotted_number(p.x()), plotted_number(p.y()), plotted_number(p.z())});
  return out;
}

Vec3 point_from_json(const json& value, const JsonObject& owner, std::string_view key) {
  if (!value.is_array() || value.size() != 3) owner.fail_at(key, "a point is an array of three numbers");
  Vec3 p;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!value[i].is_number()) owner.fail_at(key, "a coordinate is not a number");
    p[static_cast<Eigen::Index>(i)] = value[i].get<double>();
  }
  return p;
}

std::vector<Vec3> points_from_json(JsonObject& owner, std::string_view key) {
  std::vector<Vec3> out;
  for (const json& value : owner.raw(key)) out.push_back(point_from_json(value, owner, key));
  return out;
}

json to_json(const EpisodeView& view) {
  json signals = json::array();
  for (const metrics::Series& series : view.signals) signals.push_back(series_to_json(series));
  const metrics::Episode& e = view.episode;
  return {{"of", view.of},
          {"unit", view.unit},
          {"start_s", e.start_s},
          {"end_s", e.end_s},
          {"worst", e.worst},
          {"worst_t_s", e.worst_t_s},
          {"worst_W_m", {e.worst_W_m.x(), e.worst_W_m.y(), e.worst_W_m.z()}},
          {"samples", e.samples},
          {"signals", std::move(signals)}};
}

EpisodeView episode_from_json(JsonObject& in) {
  EpisodeView out;
  out.of = in.text("of");
  out.unit = in.text("unit");
  out.episode.start_s = in.number("start_s");
  out.episode.end_s = in.number("end_s");
  out.episode.worst = in.number("worst");
  out.episode.worst_t_s = in.number("worst_t_s");
  out.episode.worst_W_m = point_from_json(in.raw("worst_W_m"), in, "worst_W_m");
  out.episode.samples = count_from_json(in, "samples");
  for (JsonObject& series : in.objects("signals")) out.signals.push_back(series_from_json(series));
  in.finish();
  return out;
}

json to_json(const ObjectView& object) {
  json triangles = json::array();
  for (const auto& t : object.triangles) triangles.push_back({t[0], t[1], t[2]});
  return {{"vertices_W_m", points_to_json(object.vertices_W_m)},
          {"triangles", std::move(triangles)},
          {"error", plotted_numbers(object.error)},
          {"error_name", object.error_name},
          {"error_unit", object.error_unit},
          {"noticed_share", plotted_numbers(object.noticed_share)},
          {"note", object.note}};
}

ObjectView object_from_json(JsonObject in) {
  ObjectView out;
  out.vertices_W_m = points_from_json(in, "vertices_W_m");
  for (const json& value : in.raw("triangles")) {
    std::array<std::int32_t, 3> triangle{};
    if (!value.is_array() || value.size() != 3) in.fail_at("triangles", "a triangle is an array of three indices");
    for (std::size_t i = 0; i < 3; ++i) {
      if (!value[i].is_number_integer() || value[i] < 0 || value[i] >= out.vertices_W_m.size()) {
        in.fail_at("triangles", "an index is not that of a vertex");
      }
      triangle[i] = value[i].get<std::int32_t>();
    }
    out.triangles.push_back(triangle);
  }
  out.error = nullable_numbers(in, "error");
  out.error_name = in.text("error_name");
  out.error_unit = in.text("error_unit");
  if (in.has("noticed_share")) out.noticed_share = nullable_numbers(in, "noticed_share");
  out.note = in.text("note");
  in.finish();
  return out;
}

}  // namespace

std::string result_to_json(const EvaluationResult& result) {
  json settings = json::array();
  for (const auto& [label, value] : result.settings) settings.push_back({{"name", label}, {"value", value}});
  json metrics = json::array();
  for (const metrics::MetricResult& metric : result.metrics) metrics.push_back(metric_to_json(metric));
  json signals = json::array();
  for (const metrics::Series& series : result.signals) signals.push_back(series_to_json(series));
  json episodes = json::array();
  for (const EpisodeView& episode : result.episodes) episodes.push_back(to_json(episode));
  const json document{{"schema", "touchstone-result/1"},
                      {"title", result.title},
                      {"renderer", result.renderer},
                      {"model", result.model},
                      {"input", input_to_json(result.input)},
                      {"settings", std::move(settings)},
                      {"messages", result.messages},
                      {"metrics", std::move(metrics)},
                      {"signals", std::move(signals)},
                      {"force_threshold_N", exact_number(result.force_threshold_N)},
                      {"position_threshold_m", exact_number(result.position_threshold_m)},
                      {"episodes", std::move(episodes)},
                      {"object", to_json(result.object)},
                      {"path_W_m", points_to_json(result.path_W_m)},
                      {"provenance", provenance_to_json(result.provenance)}};
  return document.dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
}

EvaluationResult parse_result(std::string_view text, std::string_view source) {
  const json document = parse_json(text, source);
  JsonObject in(document, std::string(source), "");
  in.schema("touchstone-result/1");
  EvaluationResult out;
  out.title = in.text("title");
  out.renderer = in.text("renderer");
  out.model = in.text("model");
  if (in.has("input")) out.input = input_from_json(in.object("input"));
  for (JsonObject& one : in.objects("settings")) {
    out.settings.emplace_back(one.text("name"), one.text("value"));
    one.finish();
  }
  for (const json& one : in.raw("messages")) {
    if (!one.is_string()) in.fail_at("messages", "a message is a text");
    out.messages.push_back(one.get<std::string>());
  }
  for (JsonObject& one : in.objects("metrics")) out.metrics.push_back(metric_from_json(one));
  for (JsonObject& one : in.objects("signals")) out.signals.push_back(series_from_json(one));
  out.force_threshold_N = in.number("force_threshold_N");
  out.position_threshold_m = in.number("position_threshold_m");
  for (JsonObject& one : in.objects("episodes")) out.episodes.push_back(episode_from_json(one));
  out.object = object_from_json(in.object("object"));
  out.path_W_m = points_from_json(in, "path_W_m");
  out.provenance = provenance_from_json(in.object("provenance"));
  in.finish();
  return out;
}

EvaluationResult load_result(const std::filesystem::path& path) {
  note_input_file(path);
  return parse_result(read_file(path), path.string());
}

}  // namespace touchstone::report
