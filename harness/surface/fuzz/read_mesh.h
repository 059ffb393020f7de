// What the fuzz targets of the mesh readers share: whatever the bytes, the reader returns a mesh that can be used, or
// throws BadData. Nothing else, and in memory that the size of the input bounds. Aborts otherwise. Returns
// whether there was a mesh.
#pragma once

#include <cstddef>
#include <cstdint>

#include "harness/surface/mesh_file.h"

namespace touchstone::surface::fuzz {

bool read_mesh(const std::uint8_t* data, std::size_t size, MeshFormat format);

}  // namespace touchstone::surface::fuzz
