#include "harness/surface/fuzz/mesh_fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return touchstone::fuzz_mesh(data, size, touchstone::MeshFormat::stl);
}
