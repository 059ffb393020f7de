#include "harness/surface/fuzz/read_mesh.h"

#include <cstdlib>
#include <string_view>

#include "harness/base/error.h"
#include "harness/surface/mesh_doctor.h"

namespace touchstone::surface::fuzz {

bool read_mesh(const std::uint8_t* data, std::size_t size, MeshFormat format) {
  try {
    const TriangleMesh mesh = parse_mesh({reinterpret_cast<const char*>(data), size}, format, 1e-3, "fuzz");
    for (const auto& triangle : mesh.triangles) {
      for (const std::int32_t corner : triangle) {
        if (corner < 0 || static_cast<std::size_t>(corner) >= mesh.vertices_W_m.size()) std::abort();
        if (!mesh.vertices_W_m[static_cast<std::size_t>(corner)].allFinite()) std::abort();
      }
    }
    const MeshDiagnosis diagnosis = examine_mesh(mesh, {}, nullptr);
    if (diagnosis.triangles != mesh.triangles.size() || diagnosis_json(diagnosis, "fuzz").empty()) std::abort();
    return true;
  } catch (const BadData&) {
    // What bad input is meant to get.
  }
  return false;
}

}  // namespace touchstone::surface::fuzz
