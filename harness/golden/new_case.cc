#include "harness/golden/new_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/json_reader.h"
#include "harness/base/random.h"
#include "harness/golden/loop_case.h"
#include "harness/recording/recording_file.h"
#include "harness/rendering/model.h"
#include "harness/rendering/nearness.h"
#include "harness/surface/embree_surface.h"

namespace touchstone::golden {
using recording::InTrajectory;

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double least_force_N = 1e-6, least_position_m = 1e-7;  // far below what a fingertip feels
constexpr double times_rounding = 10.0;                          // as the noise floor's rule (golden floor)
// A tolerance above it hides what a finger feels: a twentieth of the smallest force that is felt at all (0.06 N).
constexpr double most_force_N = 0.05 * 0.06;

bool plain_name(const std::string& name) {
  return !name.empty() &&
         std::ranges::all_of(name, [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-'; });
}

// A folder that is removed unless it is kept.
class Draft {
 public:
  explicit Draft(fs::path folder) : folder_(std::move(folder)) {
    if (fs::exists(folder_))
      throw UsageError(fmt::format("{}: is there already; give another name, or remove it", folder_.string()));
    ensure_writable_folder(folder_);
  }
  ~Draft() {
    std::error_code ignored;
    if (!kept_) fs::remove_all(folder_, ignored);
  }
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;
  void keep() { kept_ = true; }

 private:
  fs::path folder_;
  bool kept_ = false;
};

InTrajectory path_of(const NewCase& wanted) {
  const InTrajectory whole = recording::load_trajectory(wanted.trajectory);
  if (wanted.to_s <= 0.0 && wanted.from_s <= 0.0) return whole;
  InTrajectory part;
  const bool turned = !whole.motion.q_WS.empty();
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const double t_s = whole.motion.t_s[i];
    if (t_s < wanted.from_s || (wanted.to_s > 0.0 && t_s > wanted.to_s)) continue;
    part.motion.t_s.push_back(t_s);
    part.motion.p_W_m.push_back(whole.motion.p_W_m[i]);
    if (turned) part.motion.q_WS.push_back(whole.motion.q_WS[i]);
  }
  if (part.size() < 2)
    throw UsageError(fmt::format("{}: from {} to {} s there are {} samples; it goes from {} to {} s",
                                 wanted.trajectory.string(), wanted.from_s, wanted.to_s, part.size(),
                                 whole.motion.t_s.front(), whole.motion.t_s.back()));
  return part;
}

json models_of(const NewCase& wanted) {
  json models = json::object();
  for (const fs::path& file : wanted.models) {
    std::string name = file.stem().string();
    std::ranges::transform(name, name.begin(), [](char c) {
      if (c >= 'A' && c <= 'Z') return static_cast<char>(c - 'A' + 'a');
      return c == '_' || c == ' ' || c == '.' ? '-' : c;
    });
    if (!plain_name(name) || models.contains(name))
      throw UsageError(
          fmt::format("{}: the model would be called \"{}\"; rename the file: each its own name, of letters, "
                      "digits and '-'",
                      file.string(), name));
    models[name] = load_json(file);
    rendering::parse_model(models[name].dump(), file.string(), file.parent_path());
  }
  if (models.empty()) throw UsageError("give at least one --model");
  return models;
}

// A mesh in millimetres that was read as metres makes a golden of nothing but air, or of kilonewtons.
void refuse_another_unit(const Catalogues& catalogues, const GoldenCase& golden, const NewCase& wanted) {
  double tip_radius_m = 0.0;
  for (const auto& [name, ignored] : golden.models) {
    const auto& parameters = case_model(golden, name).parameters;
    if (const auto radius = parameters.find("tip_radius_m"); radius != parameters.end())
      tip_radius_m = std::max(tip_radius_m, radius->second);
  }
  const auto surface = make_embree_surface(case_mesh(catalogues.generators, golden));
  const InTrajectory path = case_trajectory(catalogues.generators, golden);
  if (const auto message = rendering::fits_another_unit(*surface, path.motion.p_W_m, tip_radius_m,
                                                        wanted.trajectory.string(), wanted.mesh_unit))
    throw BadData(*message);
}

json case_json(const NewCase& wanted, const json& models, const std::string& mesh, const std::string& path,
               double force_N, const std::string& reason) {
  json made{{"schema", "touchstone-golden-case/1"},
            {"name", wanted.name},
            {"summary", wanted.summary.empty() ? fmt::format("{} over {}", wanted.trajectory.filename().string(), mesh)
                                               : wanted.summary},
            {"surface", {{"mesh", mesh}, {"unit", wanted.mesh_unit}}},
            {"trajectory", {{"file", path}}},
            {"models", models},
            {"tolerance",
             {{"reason", reason},
              {"force", {{"atol_N", force_N}, {"rtol", 1e-6}}},
              {"contact_position", {{"atol_m", least_position_m}, {"rtol", 1e-6}}},
              {"position", {{"atol_m", wanted.loop ? least_position_m : 1e-12}, {"rtol", 1e-9}}}}}};
  if (const auto& loop = wanted.loop)
    made["loop"] = {{"device", loop->device}, {"grip", loop->grip}, {"set", loop->set}, {"seed", loop->seed}};
  return made;
}

// Every coordinate by up to four units in the last place: what compilers and flags may make of it.
InTrajectory rounded_otherwise(InTrajectory path, std::uint64_t seed) {
  Random random(seed);
  constexpr double unit = std::numeric_limits<double>::epsilon();
  for (Vec3& p : path.motion.p_W_m) {
    for (int k = 0; k < 3; ++k) p[k] *= 1.0 + 4.0 * unit * random.uniform(-1.0, 1.0);
  }
  return path;
}

struct Difference {
  double force_N = 0.0;
  std::size_t at = 0;
};

Difference largest_difference(const recording::RenderedTrajectory& a, const recording::RenderedTrajectory& b) {
  Difference largest;
  for (std::size_t i = 0; i < a.f_W_N.size(); ++i) {
    if (const double force_N = (a.f_W_N[i] - b.f_W_N[i]).norm(); force_N > largest.force_N) largest = {force_N, i};
  }
  return largest;
}

void measure_rounding(const Catalogues& catalogues, const ChangeModel& change, MadeCase& made) {
  constexpr std::uint64_t seeds = 3;
  const fs::path other = made.golden.folder / "rounded.h5";
  const InTrajectory path = recording::load_trajectory(made.golden.trajectory.file);
  for (const auto& [model, ignored] : made.golden.models) {
    const CaseRun usual = run_case(catalogues, made.golden, model, false, change);
    if (usual.loop && !usual.loop->repeats()) continue;
    for (const Vec3& force : usual.rendered.f_W_N) made.largest_N = std::max(made.largest_N, force.norm());
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      fs::remove(other);
      save_trajectory(other, rounded_otherwise(path, seed));
      GoldenCase changed = made.golden;
      changed.trajectory.file = other;
      const Difference found =
          largest_difference(usual.rendered, run_case(catalogues, changed, model, false, change).rendered);
      if (times_rounding * found.force_N > most_force_N) {
        const Vec3& p = path.motion.p_W_m[found.at];
        throw UsageError(fmt::format(
            "{}: at {} s, ({:.6g}, {:.6g}, {:.6g}) m, rounding alone changes the force of {} by {:.2g} N: no "
            "golden holds there. Does the path run along an edge, or begin inside? Move it, or leave that "
            "part out (--from, --to)",
            made.golden.name, path.motion.t_s[found.at], p.x(), p.y(), p.z(), model, found.force_N));
      }
      made.rounding_N = std::max(made.rounding_N, found.force_N);
    }
  }
  fs::remove(other);
}

}  // namespace

MadeCase make_case(const Catalogues& catalogues, const fs::path& golden, const NewCase& wanted,
                   const ChangeModel& change) {
  if (!plain_name(wanted.name))
    throw UsageError(fmt::format("\"{}\": a case's name is of lower-case letters, digits and '-'", wanted.name));
  const json models = models_of(wanted);
  const InTrajectory path = path_of(wanted);
  const fs::path folder = golden / wanted.name;
  Draft draft(folder);
  const std::string mesh = wanted.mesh.filename().string();
  fs::copy_file(wanted.mesh, folder / mesh);
  constexpr const char* path_file = "path.h5";
  save_trajectory(folder / path_file, path);
  const auto write = [&](double force_N, const std::string& reason) {
    write_file(folder / "case.json", case_json(wanted, models, mesh, path_file, force_N, reason).dump(1) + "\n",
               Replace::inputs_too);
    return load_case(folder);
  };
  MadeCase made;
  made.golden = write(least_force_N, "not measured yet");
  refuse_another_unit(catalogues, made.golden, wanted);
  measure_rounding(catalogues, change, made);
  const double force_N = std::max(least_force_N, times_rounding * made.rounding_N);
  made.golden =
      write(force_N, fmt::format("ten times what a change of the path by four units in the last place makes of "
                                 "the force, {:.2g} N, and at least 1 uN: far below what a fingertip feels",
                                 made.rounding_N));
  draft.keep();
  return made;
}

std::vector<std::string> edit_tolerance(const fs::path& case_folder, const std::vector<std::string>& limits,
                                        const std::string& reason) {
  if (reason.find_first_not_of(" \t") == std::string::npos)
    throw UsageError("--reason: say why these are the limits; it stands in the case");
  const fs::path file = case_folder / "case.json";
  const std::string before = read_file(file);
  load_case(case_folder);  // what is wrong already is said with its line
  auto document = nlohmann::ordered_json::parse(before);
  auto& tolerance = document.at("tolerance");
  std::vector<std::string> lines;
  for (const std::string& limit : limits) {
    const std::size_t dot = limit.find('.'), equals = limit.find('=');
    if (dot == std::string::npos || equals == std::string::npos || dot > equals)
      throw UsageError(fmt::format("--set {}: QUANTITY.LIMIT=VALUE was expected: force.atol_N=2e-5", limit));
    const std::string quantity = limit.substr(0, dot), key = limit.substr(dot + 1, equals - dot - 1),
                      text = limit.substr(equals + 1);
    const auto value = json::parse(text.empty() ? "null" : text, nullptr, false);
    if (value.is_discarded() || !(value.is_number() || value.is_null()))
      throw UsageError(fmt::format("--set {}: a number was expected after =", limit));
    auto& entry = tolerance[quantity];
    if (entry.is_null()) entry = nlohmann::ordered_json::object();
    lines.push_back(fmt::format("{}.{}: {} -> {}", quantity, key, entry.contains(key) ? entry[key].dump() : "not given",
                                text.empty() ? "not given" : value.dump()));
    if (text.empty()) {
      entry.erase(key);
    } else {
      entry[key] = value;
    }
  }
  tolerance["reason"] = reason;
  write_file(file, document.dump(1) + "\n", Replace::inputs_too);
  try {
    load_case(case_folder);
  } catch (...) {
    write_file(file, before, Replace::inputs_too);
    throw;
  }
  return lines;
}

fs::path own_golden_folder(const fs::path& own) {
  if (own.is_absolute()) return own;
  std::error_code error;
  for (auto here = fs::current_path(error); !error && here.has_relative_path(); here = here.parent_path()) {
    if (fs::is_directory(here / own) || fs::exists(here / ".git"))
      return (here / own).lexically_proximate(fs::current_path());
  }
  return own;
}

}  // namespace touchstone::golden
