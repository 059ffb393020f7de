// What the fuzz targets of the mesh readers share: whatever the bytes, the reader returns a mesh that can be used, or
// throws BadData. Nothing else, and in memory that the size of the input bounds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "harness/base/error.h"
#include "harness/surface/mesh_file.h"
#include "harness/surface/mesh_topology.h"

namespace touchstone {

inline int fuzz_mesh(const std::uint8_t* data, std::size_t size, MeshFormat format) {
  try {
    const TriangleMesh mesh = parse_mesh({reinterpret_cast<const char*>(data), size}, format, 1e-3, "fuzz");
    for (const auto& triangle : mesh.triangles) {
      for (const std::int32_t corner : triangle) {
        if (corner < 0 || static_cast<std::size_t>(corner) >= mesh.vertices_W_m.size()) std::abort();
        if (!mesh.vertices_W_m[static_cast<std::size_t>(corner)].allFinite()) std::abort();
      }
    }
    const MeshTopology topology = make_topology(mesh);
    if (topology.neighbours.size() != mesh.triangles.size()) std::abort();
  } catch (const BadData&) {
    // What bad input is meant to get.
  }
  return 0;
}

}  // namespace touchstone
