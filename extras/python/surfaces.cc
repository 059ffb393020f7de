#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "arrays.h"
#include "harness/base/units.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/mesh_file.h"
#include "harness/surface/mesh_repair.h"
#include "harness/surface/mesh_warnings.h"
#include "module.h"
#include "synthetic/surface_catalogue.h"
#include "synthetic/surfaces/exact_contact.h"
#include "synthetic/trajectory_catalogue.h"

namespace touchstone::python {
using surface::Surface;
using surface::TriangleMesh;

namespace {

using SharedMesh = std::shared_ptr<TriangleMesh>;

SharedMesh mesh_of(const Doubles& vertices_m, const py::array_t<std::int32_t, py::array::c_style>& triangles,
                   const std::string& source) {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices_W_m = vectors_of(vertices_m, "vertices_m");
  expect_shape(triangles, "triangles", 3);
  mesh->triangles.resize(static_cast<std::size_t>(triangles.shape(0)));
  const auto vertices = static_cast<std::int32_t>(mesh->vertices_W_m.size());
  for (std::size_t i = 0; i < mesh->triangles.size(); ++i) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::int32_t vertex = triangles.data()[3 * i + corner];
      if (vertex < 0 || vertex >= vertices)
        throw UsageError(fmt::format("triangles[{}] names the vertex {}; there are {}", i, vertex, vertices));
      mesh->triangles[i][corner] = vertex;
    }
  }
  mesh->source = source;
  return mesh;
}

// Closest points and signed distances of many points.
py::dict closest_points(const Surface& surface, const Doubles& points_m) {
  const std::vector<Vec3> points = vectors_of(points_m, "points_m");
  std::vector<Vec3> closest(points.size());
  std::vector<Vec3> normals(points.size());
  std::vector<double> distances(points.size());
  LongWork::call([&] {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const surface::SurfacePoint found = surface.closest(points[i]);
      closest[i] = found.p_W_m;
      normals[i] = found.n_W;
      distances[i] = found.signed_distance_m;
    }
    return 0;
  });
  py::dict out;
  out["point_m"] = moved_to_array(std::move(closest));
  out["normal"] = moved_to_array(std::move(normals));
  out["signed_distance_m"] = moved_to_array(std::move(distances));
  return out;
}

py::object first_crossing(const Surface& surface, const std::array<double, 3>& a, const std::array<double, 3>& b) {
  const auto found = surface.first_crossing(Vec3::Map(a.data()), Vec3::Map(b.data()));
  if (!found) return py::none();
  py::dict out;
  out["fraction"] = found->fraction;
  out["point_m"] = moved_to_array(std::vector<Vec3>{found->p_W_m}).attr("reshape")(3);
  out["normal"] = moved_to_array(std::vector<Vec3>{found->n_W}).attr("reshape")(3);
  out["entering"] = found->entering;
  out["triangle"] = found->triangle;
  return out;
}

py::dict exact_contacts(const Surface& surface, const Doubles& tips_m, double stiffness_N_per_m, double tip_radius_m) {
  const std::vector<Vec3> tips = vectors_of(tips_m, "position_m");
  std::vector<Vec3> forces(tips.size());
  std::vector<Vec3> contacts(tips.size());
  std::vector<double> depths(tips.size());
  LongWork::call([&] {
    for (std::size_t i = 0; i < tips.size(); ++i) {
      const auto exact = synthetic::exact_contact(surface, tips[i], stiffness_N_per_m, tip_radius_m);
      forces[i] = exact.f_W_N;
      contacts[i] = exact.proxy_W_m;
      depths[i] = exact.depth_m;
    }
    return 0;
  });
  py::dict out;
  out["force_N"] = moved_to_array(std::move(forces));
  out["contact_m"] = moved_to_array(std::move(contacts));
  out["depth_m"] = moved_to_array(std::move(depths));
  return out;
}

// Wraps what the synthetic room owns alone, so that results can share it.
using SharedSurface = std::shared_ptr<Surface>;

template <class Entry>
py::list catalogue(std::span<const Entry> entries) {
  py::list out;
  for (const Entry& entry : entries) {
    py::list parameters;
    for (const auto& one : entry.parameters) {
      py::dict parameter;
      parameter["name"] = one.name;
      parameter["unit"] = one.unit;
      parameter["minimum"] = one.minimum;
      parameter["maximum"] = one.maximum;
      parameter["default"] = one.initial;
      parameter["meaning"] = one.meaning;
      parameters.append(parameter);
    }
    py::dict about;
    about["name"] = entry.name;
    about["summary"] = entry.summary;
    about["parameters"] = parameters;
    out.append(about);
  }
  return out;
}

}  // namespace

void bind_surfaces(py::module_& module) {
  py::class_<TriangleMesh, SharedMesh>(module, "Mesh",
                                       "A triangle mesh in metres, counter-clockwise seen from outside. The arrays are "
                                       "read-only views of its memory.")
      .def(py::init(&mesh_of), py::arg("vertices_m"), py::arg("triangles"), py::kw_only(), py::arg("source") = "")
      .def_property_readonly(
          "vertices_m", [](const SharedMesh& self) { return view_of(self, self->vertices_W_m); }, "(V, 3) corners [m].")
      .def_property_readonly(
          "triangles",
          [](const SharedMesh& self) {
            return view_of(self, self->triangles.empty() ? nullptr : self->triangles.front().data(),
                           self->triangles.size(), 3);
          },
          "(T, 3) indices of corners.")
      .def_readonly("source", &TriangleMesh::source, "The file or generator that it came from.")
      .def("__len__", &TriangleMesh::triangle_count)
      .def(
          "save",
          [](const TriangleMesh& self, const std::filesystem::path& path, const std::string& unit) {
            save_mesh(self, path, length_unit_factor(unit));
          },
          py::arg("path"), py::kw_only(), py::arg("unit") = "m", "Writes OBJ, OFF, PLY or STL, also .gz.")
      .def(
          "surface", [](const TriangleMesh& self) { return LongWork::call([&] { return make_embree_surface(self); }); },
          "What can be asked of the mesh: closest points, signed distances and crossings.")
      .def(
          "warnings",
          [](const TriangleMesh& self) {
            return LongWork::call([&] { return mesh_warnings(*make_embree_surface(self)); });
          },
          "What is wrong with the mesh for rendering, a sentence each.");
  module.def(
      "load_mesh",
      [](const std::filesystem::path& path, const std::string& unit, bool repair) {
        return LongWork::call([&] {
          TriangleMesh mesh = surface::load_mesh(path, length_unit_factor(unit));
          return std::make_shared<TriangleMesh>(repair ? orient(mesh).mesh : std::move(mesh));
        });
      },
      py::arg("path"), py::kw_only(), py::arg("unit") = "m", py::arg("repair") = false,
      "Reads OBJ, OFF, PLY or STL, also .gz. `unit` is that of the file's coordinates; `repair` turns triangles that "
      "face the other way than most of their piece.");

  py::class_<Surface, SharedSurface>(module, "Surface",
                                     "A surface in the object's frame: of a mesh, or known in closed form.")
      .def("closest", &closest_points, py::arg("points_m"),
           "For points of shape (N, 3) [m]: point_m (N, 3), the closest points of the surface; normal (N, 3), outward "
           "unit normals there; signed_distance_m (N,), negative inside.")
      .def("first_crossing", &first_crossing, py::arg("from_m"), py::arg("to_m"),
           "The first crossing of the segment with the surface, from either side, or None.")
      .def("exact_contact", &exact_contacts, py::arg("position_m"), py::kw_only(), py::arg("stiffness_N_per_m"),
           py::arg("tip_radius_m") = 0.0,
           "The answer of a frictionless god-object at rest for tips of shape (N, 3) [m]: force_N (N, 3), contact_m "
           "(N, 3), depth_m (N,). Exact where the surface is.");

  auto synthetic = module.def_submodule("_synthetic");
  synthetic.def("surfaces", [] { return catalogue(synthetic::surface_catalogue()); });
  synthetic.def("trajectories", [] { return catalogue(synthetic::trajectory_catalogue()); });
  synthetic.def("surface", [](const std::string& name, const synthetic::ParameterOverrides& parameters) {
    return SharedSurface(synthetic::make_surface(name, parameters));
  });
  synthetic.def("mesh",
                [](const std::string& name, const synthetic::ParameterOverrides& parameters, std::size_t triangles) {
                  auto made = LongWork::call([&] { return synthetic::make_mesh(name, parameters, triangles); });
                  return py::make_tuple(std::make_shared<TriangleMesh>(std::move(made.mesh)), made.deviation_bound_m);
                });
  synthetic.def("path", [](const std::string& name, const synthetic::ParameterOverrides& parameters, double rate_Hz,
                           std::uint64_t seed) {
    const recording::InTrajectory made =
        LongWork::call([&] { return synthetic::sample(*synthetic::make_path(name, parameters, seed), rate_Hz); });
    return py::make_tuple(moved_to_array(made.motion.t_s), moved_to_array(made.motion.p_W_m));
  });
}

}  // namespace touchstone::python
