#include "harness/surface/fuzz/read_mesh.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  touchstone::surface::fuzz::read_mesh(data, size, touchstone::surface::MeshFormat::ply);
  return 0;
}
