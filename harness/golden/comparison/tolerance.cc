#include "harness/golden/comparison/tolerance.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "harness/golden/comparison/trajectory_columns.h"

namespace touchstone::golden {
namespace {

void read_limit(JsonObject& object, const std::string& key, std::optional<double>& limit) {
  if (const auto value = object.optional_number(key)) {
    if (*value < 0.0) object.fail_at(key, fmt::format("a limit of at least 0 was expected, got {}", *value));
    limit = value;
  }
}

void read_limit(JsonObject& object, const std::string& key, double& limit) {
  std::optional<double> value;
  read_limit(object, key, value);
  limit = value.value_or(limit);
}

void read_group(JsonObject object, const ComparedQuantity& group, Tolerance& tolerance) {
  GroupTolerance& limits = tolerance.groups.at(std::string(group.name));
  std::optional<double> beyond;
  read_limit(object, "beyond", beyond);
  if (beyond) {
    if (*beyond != std::floor(*beyond) || *beyond > 1e15)
      object.fail_at("beyond", "a whole number of samples was expected");
    limits.beyond = static_cast<std::size_t>(*beyond);
  }
  if (group.id == Quantity::contact) {
    read_limit(object, "tube_s", tolerance.tube_s);
  } else {
    const auto with_unit = [&](std::string_view name) { return fmt::format("{}_{}", name, group.unit); };
    read_limit(object, with_unit("atol"), limits.atol);
    read_limit(object, "rtol", limits.rtol);
    read_limit(object, "rpeak", limits.rpeak);
    read_limit(object, with_unit("rms"), limits.rms);
    read_limit(object, with_unit("p99"), limits.p99);
    read_limit(object, with_unit("max"), limits.max);
    if (group.size() == 3) {
      read_limit(object, "direction_rad", limits.direction_rad);
      read_limit(object, with_unit("direction_floor"), limits.direction_floor);
    }
  }
  object.finish();
  if (limits.direction_rad && !(limits.direction_floor > 0.0)) {
    object.fail_at(
        "direction_rad",
        fmt::format("needs direction_floor_{} above 0: the direction of a tiny vector is noise", group.unit));
  }
}

}  // namespace

Tolerance default_tolerance() {
  constexpr double relative = 1e-6;
  Tolerance tolerance;
  tolerance.groups["time"].atol = 1e-6;
  tolerance.groups["position"] = {.atol = 1e-7, .rtol = relative};
  tolerance.groups["contact_position"] = {.atol = 1e-7, .rtol = relative};
  tolerance.groups["force"] = {.atol = 1e-6, .rtol = relative};
  tolerance.groups["torque"] = {.atol = 1e-7, .rtol = relative};
  tolerance.groups["orientation"].atol = 1e-6;
  tolerance.groups["contact"] = {};
  return tolerance;
}

Tolerance load_tolerance(const std::filesystem::path& path) {
  const nlohmann::json document = load_json(path);
  JsonObject object(document, path.string(), "");
  object.schema("touchstone-tolerance/1");
  return read_tolerance(std::move(object), default_tolerance());
}

Tolerance read_tolerance(JsonObject object, Tolerance base) {
  base.reason = object.optional_text("reason").value_or(base.reason);
  for (const ComparedQuantity& group : compared_quantities()) {
    if (object.has(group.name)) read_group(object.object(group.name), group, base);
  }
  object.finish();
  return base;
}

nlohmann::json to_json(const Tolerance& tolerance) {
  nlohmann::json document{{"schema", "touchstone-tolerance/1"}, {"reason", tolerance.reason}};
  for (const ComparedQuantity& group : compared_quantities()) {
    const GroupTolerance& limits = tolerance.of(group.name);
    auto& object = document[std::string(group.name)];
    object["beyond"] = limits.beyond;
    if (group.id == Quantity::contact) {
      object["tube_s"] = tolerance.tube_s;
      continue;
    }
    const auto put = [&](std::string_view name, std::optional<double> value) {
      if (value) object[fmt::format("{}_{}", name, group.unit)] = *value;
    };
    put("atol", limits.atol);
    object["rtol"] = limits.rtol;
    object["rpeak"] = limits.rpeak;
    put("rms", limits.rms);
    put("p99", limits.p99);
    put("max", limits.max);
    if (limits.direction_rad) {
      object["direction_rad"] = *limits.direction_rad;
      put("direction_floor", limits.direction_floor);
    }
  }
  return document;
}

}  // namespace touchstone::golden
