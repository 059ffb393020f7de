#include "harness/rendering/scene_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/input_files.h"
#include "harness/base/json_reader.h"
#include "harness/base/units.h"
#include "harness/recording/recording_file.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/mesh_file.h"
#include "harness/surface/mesh_repair.h"

namespace touchstone::rendering {
namespace {

constexpr double unit_quaternion = 1e-6;  // how far its length may be off before it is reported as a mistake

Vec3 read_place(JsonObject& object) {
  if (!object.has("p_m")) return Vec3::Zero();
  const std::vector<double> p = object.numbers("p_m");
  if (p.size() != 3) object.fail_at("p_m", fmt::format("three numbers were expected: x, y, z; got {}", p.size()));
  return {p[0], p[1], p[2]};
}

Quat read_turn(JsonObject& object) {
  if (!object.has("q_wxyz")) return Quat::Identity();
  const std::vector<double> q = object.numbers("q_wxyz");
  if (q.size() != 4) object.fail_at("q_wxyz", fmt::format("four numbers were expected: w, x, y, z; got {}", q.size()));
  const Quat turn(q[0], q[1], q[2], q[3]);
  if (std::abs(turn.norm() - 1.0) > unit_quaternion) {
    object.fail_at("q_wxyz",
                   fmt::format("its length is {:.9g}; a rotation is a quaternion of length 1, w first", turn.norm()));
  }
  return turn.normalized();
}

PoseTrack read_keyframes(JsonObject& body, const std::string& source) {
  MotionColumns poses;
  for (JsonObject& frame : body.objects("keyframes")) {
    poses.t_s.push_back(frame.number("t_s"));
    poses.p_W_m.push_back(read_place(frame));
    poses.q_WS.push_back(read_turn(frame));
    frame.finish();
  }
  return {std::move(poses), fmt::format("{}: {}/keyframes", source, body.place())};
}

std::filesystem::path file_of(JsonObject& body, std::string_view key, const std::filesystem::path& folder,
                              SceneFiles files) {
  const std::filesystem::path file = body.text(key);
  if (files == SceneFiles::own_folder && file.has_parent_path())
    body.fail_at(key, "a file in the scene's own folder was expected, without a path");
  return folder / file;
}

SceneFileBody read_body(JsonObject& object, const std::filesystem::path& folder, SceneFiles files) {
  SceneFileBody body;
  body.name = object.text("name");
  const std::string unit = object.optional_text("unit").value_or("m");
  double factor = 1.0;
  try {
    factor = length_unit_factor(unit);
  } catch (const Error& error) {
    object.fail_at("unit", error.what());
  }
  body.two_sided = object.optional_flag("two_sided").value_or(false);
  body.mesh_B = surface::load_mesh(file_of(object, "mesh", folder, files), factor);
  if (int{object.has("pose")} + int{object.has("poses")} + int{object.has("keyframes")} > 1)
    object.fail("a body has one of \"pose\", \"poses\" and \"keyframes\"; remove the others");
  if (object.has("pose")) {
    JsonObject pose = object.object("pose");
    const Vec3 p_W_m = read_place(pose);
    body.pose = PoseTrack({p_W_m, read_turn(pose)});
    pose.finish();
  } else if (object.has("poses")) {
    const std::filesystem::path file = file_of(object, "poses", folder, files);
    body.pose = PoseTrack(recording::load_trajectory(file).motion, file.string());
  } else if (object.has("keyframes")) {
    body.pose = read_keyframes(object, object.source());
  }
  object.finish();
  return body;
}

}  // namespace

BodyScene SceneFile::scene(bool all_two_sided) const {
  BodyScene out;
  out.source = source;
  for (const SceneFileBody& body : bodies) {
    const bool both = all_two_sided || body.two_sided;
    out.bodies.push_back(
        {body.name, make_embree_surface(both ? surface::two_sided(body.mesh_B) : body.mesh_B), body.pose});
  }
  return out;
}

void SceneFile::rescale(double scale, double speed) {
  for (SceneFileBody& body : bodies) {
    for (Vec3& v : body.mesh_B.vertices_W_m) v *= scale;
    body.pose.rescale(scale, speed);
  }
}

SceneFile parse_scene(std::string_view text, std::string_view source, const std::filesystem::path& folder,
                      SceneFiles files) {
  const nlohmann::json document = parse_json(text, source);
  JsonObject root(document, std::string(source), "");
  root.schema("touchstone-scene/1");
  SceneFile out;
  out.source = std::string(source);
  for (JsonObject& object : root.objects("bodies")) {
    SceneFileBody body = read_body(object, folder, files);
    const auto same = [&](const SceneFileBody& other) { return other.name == body.name; };
    if (std::any_of(out.bodies.begin(), out.bodies.end(), same))
      object.fail_at("name", fmt::format("two bodies have the name \"{}\"", body.name));
    out.bodies.push_back(std::move(body));
  }
  if (out.bodies.empty()) root.fail_at("bodies", "a scene has at least one body");
  root.finish();
  return out;
}

SceneFile load_scene(const std::filesystem::path& path) {
  note_input_file(path);
  return parse_scene(read_file(path), path.string(), path.parent_path());
}

}  // namespace touchstone::rendering
