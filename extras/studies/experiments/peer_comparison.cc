#include "experiments/peer_comparison.h"

#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>

#include "harness/base/error.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/mesh_file.h"
#include "renderers/catalogue.h"
#include "synthetic/surface_catalogue.h"
#include "synthetic/surfaces/exact_contact.h"

namespace touchstone::experiments {
using recording::InTrajectory;
using rendering::Model;
using surface::TriangleMesh;

namespace {

constexpr double stiffness = 500.0;

struct Peer {
  const char* method;
  const char* file;
};
constexpr std::array<Peer, 3> peer_engines{{{"CHAI3D static proxy", "chai3d-mm-static"},
                                            {"CHAI3D dynamic proxy", "chai3d-mm-dynamic"},
                                            {"HAPI god-object", "hapi-godobject"}}};

std::string shape_of(const std::string& mesh) {
  for (const char* shape : {"plane", "bumpy", "gauss"}) {
    if (mesh.starts_with(shape)) return shape;
  }
  throw BadData(fmt::format("{}: no smooth surface is known for this mesh", mesh));
}

// Rows of numbers, comma separated, a header where the first line has letters.
std::vector<std::vector<double>> read_rows(const std::filesystem::path& path, std::size_t columns) {
  struct Close {
    void operator()(gzFile_s* file) const { gzclose(file); }
  };
  const std::unique_ptr<gzFile_s, Close> file(gzopen(path.c_str(), "rb"));
  if (!file) throw BadData(fmt::format("{}: cannot be opened", path.string()));
  std::vector<std::vector<double>> rows;
  std::array<char, 4096> line{};
  for (std::size_t number = 1; gzgets(file.get(), line.data(), static_cast<int>(line.size())) != nullptr; ++number) {
    if (number == 1 && std::isalpha(static_cast<unsigned char>(line[0])) != 0) continue;
    std::vector<double> row;
    const char* at = line.data();
    while (row.size() < columns) {
      char* end = nullptr;
      row.push_back(std::strtod(at, &end));
      if (end == at || !std::isfinite(row.back())) {
        throw BadData(fmt::format("{}: line {}: {} finite numbers were expected", path.string(), number, columns));
      }
      at = *end == ',' ? end + 1 : end;
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

InTrajectory positions(const std::filesystem::path& peers, const std::string& mesh) {
  InTrajectory trajectory;
  for (const auto& row : read_rows(peers / "in" / (shape_of(mesh) + ".csv.gz"), 4)) {
    trajectory.motion.t_s.push_back(row[0]);
    trajectory.motion.p_W_m.emplace_back(row[1], row[2], row[3]);
  }
  return trajectory;
}

std::vector<Vec3> exact_forces(const std::string& mesh, const InTrajectory& in) {
  const auto surface = synthetic::make_surface(shape_of(mesh));
  std::vector<Vec3> forces;
  for (const Vec3& p : in.motion.p_W_m) forces.push_back(synthetic::exact_contact(*surface, p, stiffness, 0.0).f_W_N);
  return forces;
}

// The errors of forces[i + lag] against exact[i].
void score(PeerResult& result, const std::vector<Vec3>& forces, const std::vector<Vec3>& exact,
           const std::vector<Vec3>& of_mesh, int most_lag) {
  result.mean_N = result.max_N = std::numeric_limits<double>::infinity();
  for (int lag = 0; lag <= most_lag; ++lag) {
    double sum = 0.0;
    double most = 0.0;
    double off_mesh = 0.0;
    const std::size_t count = exact.size() - static_cast<std::size_t>(lag);
    for (std::size_t i = 0; i < count; ++i) {
      const double error = (forces[i + static_cast<std::size_t>(lag)] - exact[i]).norm();
      sum += error;
      off_mesh += (forces[i + static_cast<std::size_t>(lag)] - of_mesh[i]).norm();
      most = std::max(most, error);
    }
    if (sum / static_cast<double>(count) < result.mean_N) {
      result.mean_N = sum / static_cast<double>(count);
      result.lag_samples = lag;
      result.off_mesh_N = off_mesh / static_cast<double>(count);
    }
    result.max_N = std::min(result.max_N, most);
  }
}

std::unique_ptr<rendering::Renderer> our_renderer(const TriangleMesh& mesh) {
  Model model;
  model.renderer = "god-object";
  model.parameters = {{"stiffness_N_per_m", stiffness}};
  model.source = "peer comparison";
  return renderers::make_renderer(model, make_embree_surface(mesh));
}

TriangleMesh peer_mesh(const std::filesystem::path& peers, const std::string& mesh) {
  return surface::load_mesh(peers / "in" / (mesh + ".obj.gz"), 1.0);
}

}  // namespace

std::vector<std::string> peer_meshes() { return {"plane20k", "bumpy1k", "bumpy10k", "gauss20k"}; }

Model peer_model(std::shared_ptr<const rendering::RendererEntry> entry) {
  const auto named = [](const rendering::ParameterDeclaration& parameter) {
    return parameter.name == "stiffness_N_per_m";
  };
  if (std::ranges::none_of(entry->parameters, named)) {
    throw UsageError(fmt::format("the renderer {} has no parameter stiffness_N_per_m; the peers ran at {} N/m",
                                 entry->name, stiffness));
  }
  Model model;
  model.renderer = entry->name;
  model.parameters = {{"stiffness_N_per_m", stiffness}};
  model.source = "peer comparison";
  model.provided = std::move(entry);
  return model;
}

PeerCase compare_with_peers(const std::filesystem::path& peers, const std::string& mesh,
                            const std::vector<Model>& besides) {
  const InTrajectory in = positions(peers, mesh);
  const std::vector<Vec3> exact = exact_forces(mesh, in);
  const TriangleMesh triangles = peer_mesh(peers, mesh);
  PeerCase result{mesh, triangles.triangle_count(), in.size(), {}};

  std::vector<Vec3> of_mesh;
  const auto run = [&](const std::string& name, rendering::Renderer& renderer) {
    PeerResult own{name, 0, 0, 0, 0, 0};
    const std::vector<Vec3> forces = replay(renderer, in).f_W_N;
    if (of_mesh.empty()) of_mesh = forces;
    score(own, forces, exact, of_mesh, 0);
    own.mean_us = measure_steps(renderer, [&] { return rendering::tip_source(in.motion); }).mean_us;
    result.results.push_back(own);
  };
  run("Touchstone god-object", *our_renderer(triangles));
  for (const Model& model : besides)
    run(model.renderer, *renderers::make_renderer(model, make_embree_surface(triangles)));

  for (const Peer& peer : peer_engines) {
    const auto path = peers / "out" / fmt::format("{}.{}.csv.gz", mesh, peer.file);
    std::vector<Vec3> forces;
    for (const auto& row : read_rows(path, 7)) forces.emplace_back(row[4], row[5], row[6]);
    if (forces.size() != in.size()) {
      throw BadData(fmt::format("{}: {} rows for {} positions", path.string(), forces.size(), in.size()));
    }
    PeerResult theirs{peer.method, 0, 0, 0, 0, std::numeric_limits<double>::quiet_NaN()};
    score(theirs, forces, exact, of_mesh, 3);
    result.results.push_back(theirs);
  }
  return result;
}

recording::RenderedTrajectory render_peer_case(const std::filesystem::path& peers, const std::string& mesh,
                                               double unit_m) {
  // Through a file in that unit, as a user would bring it.
  const auto file =
      std::filesystem::temp_directory_path() / fmt::format("touchstone-{}-{}-{}.obj", mesh, unit_m, getpid());
  save_mesh(peer_mesh(peers, mesh), file, unit_m);
  const TriangleMesh triangles = surface::load_mesh(file, unit_m);
  std::filesystem::remove(file);
  return replay(*our_renderer(triangles), positions(peers, mesh));
}

std::string peer_table(const std::vector<PeerCase>& cases) {
  std::string table = fmt::format("{:<10} {:>9} {:<24} {:>13} {:>13} {:>13} {:>4} {:>9}\n", "mesh", "triangles",
                                  "renderer", "mean error N", "max error N", "off mesh N", "lag", "us/step");
  for (const PeerCase& one : cases) {
    for (const PeerResult& result : one.results) {
      table += fmt::format("{:<10} {:>9} {:<24} {:>13.6f} {:>13.6f} {:>13.6f} {:>4} {:>9}\n", one.mesh, one.triangles,
                           result.method, result.mean_N, result.max_N, result.off_mesh_N, result.lag_samples,
                           std::isnan(result.mean_us) ? std::string("not run") : fmt::format("{:.3f}", result.mean_us));
    }
  }
  return table;
}

std::string peer_json(const std::vector<PeerCase>& cases) {
  std::string text = "[";
  for (const PeerCase& one : cases) {
    for (const PeerResult& result : one.results) {
      text += fmt::format(
          "{}\n  {{\"mesh\": \"{}\", \"triangles\": {}, \"samples\": {}, \"renderer\": \"{}\", \"mean_N\": {}, "
          "\"max_N\": {}, \"off_mesh_N\": {}, \"lag_samples\": {}, \"mean_us\": {}}}",
          text.size() > 1 ? "," : "", one.mesh, one.triangles, one.samples, result.method, result.mean_N, result.max_N,
          result.off_mesh_N, result.lag_samples,
          std::isnan(result.mean_us) ? std::string("null") : fmt::format("{}", result.mean_us));
    }
  }
  return text + "\n]\n";
}

}  // namespace touchstone::experiments
