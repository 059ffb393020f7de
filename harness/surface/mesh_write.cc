// save_mesh: the four formats.
#include <fmt/format.h>
#include <zlib.h>

#include <cctype>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/surface/mesh_file.h"

namespace touchstone::surface {
namespace {

using Buffer = fmt::memory_buffer;

template <class... Args>
void print(Buffer& out, fmt::format_string<Args...> format, Args&&... args) {
  fmt::format_to(std::back_inserter(out), format, std::forward<Args>(args)...);
}

template <class T>
void raw(Buffer& out, const T& value) {
  const auto* const bytes = reinterpret_cast<const char*>(&value);
  out.append(bytes, bytes + sizeof value);
}

// "{}" prints the shortest text that reads back as the same double.
void write_obj(const TriangleMesh& mesh, double scale, Buffer& out) {
  for (const Vec3& v : mesh.vertices_W_m) print(out, "v {} {} {}\n", scale * v.x(), scale * v.y(), scale * v.z());
  for (const auto& [a, b, c] : mesh.triangles) print(out, "f {} {} {}\n", a + 1, b + 1, c + 1);
}

void write_off(const TriangleMesh& mesh, double scale, Buffer& out) {
  print(out, "OFF\n{} {} 0\n", mesh.vertices_W_m.size(), mesh.triangles.size());
  for (const Vec3& v : mesh.vertices_W_m) print(out, "{} {} {}\n", scale * v.x(), scale * v.y(), scale * v.z());
  for (const auto& [a, b, c] : mesh.triangles) print(out, "3 {} {} {}\n", a, b, c);
}

void write_ply(const TriangleMesh& mesh, double scale, Buffer& out) {
  print(out,
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty "
        "double z\n"
        "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.vertices_W_m.size(), mesh.triangles.size());
  for (const Vec3& v : mesh.vertices_W_m) {
    for (const double x : v) raw(out, scale * x);
  }
  for (const auto& triangle : mesh.triangles) {
    out.push_back('\3');
    for (const std::int32_t corner : triangle) raw(out, corner);
  }
}

// Text, because binary STL has only single precision.
void write_stl(const TriangleMesh& mesh, double scale, Buffer& out) {
  print(out, "solid\n");
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 n = mesh.scaled_normal(t).normalized();
    print(out, "facet normal {} {} {}\nouter loop\n", n.x(), n.y(), n.z());
    for (const std::int32_t corner : mesh.triangles[t]) {
      const Vec3 v = scale * mesh.vertices_W_m[static_cast<std::size_t>(corner)];
      print(out, "vertex {} {} {}\n", v.x(), v.y(), v.z());
    }
    print(out, "endloop\nendfacet\n");
  }
  print(out, "endsolid\n");
}

void write_packed(const Buffer& text, const std::filesystem::path& path) {
  AtomicFile file(path);
  gzFile out = gzopen(file.path().c_str(), "wb6");
  bool good = out != nullptr;
  constexpr std::size_t block = std::size_t{1} << 20U;
  for (std::size_t i = 0; good && i < text.size(); i += block) {
    const auto n = static_cast<unsigned>(std::min(block, text.size() - i));
    good = gzwrite(out, text.data() + i, n) == static_cast<int>(n);
  }
  if (out != nullptr) good = gzclose_w(out) == Z_OK && good;
  if (!good) throw BadData(fmt::format("{}: cannot be written", path.string()));
  file.commit();
}

}  // namespace

void save_mesh(const TriangleMesh& mesh, const std::filesystem::path& path, double unit_m) {
  const double scale = 1.0 / unit_m;
  Buffer out;
  switch (mesh_format(path)) {
    case MeshFormat::obj:
      write_obj(mesh, scale, out);
      break;
    case MeshFormat::off:
      write_off(mesh, scale, out);
      break;
    case MeshFormat::ply:
      write_ply(mesh, scale, out);
      break;
    case MeshFormat::stl:
      write_stl(mesh, scale, out);
      break;
  }
  const std::string extension = path.extension().string();
  if (extension == ".gz" || extension == ".GZ") {
    write_packed(out, path);
  } else {
    write_file(path, {out.data(), out.size()});
  }
}

}  // namespace touchstone::surface
