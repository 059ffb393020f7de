#include "harness/surface/mesh_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/input_files.h"
#include "harness/surface/mesh_soup.h"

namespace touchstone::surface {
namespace {

// A few kilobytes of gzip can stand for terabytes.
constexpr std::size_t largest_unpacked_bytes = std::size_t{8} << 30U;

std::string lower_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

std::string unpacked(const std::filesystem::path& path) {
  struct Closer {
    void operator()(gzFile_s* file) const { gzclose_r(file); }
  };
  // For its message about a missing file, a folder or a lack of permission.
  const std::string packed = read_file(path);
  if (packed.size() < 2 || packed[0] != '\x1f' || packed[1] != '\x8b') {
    throw BadData(fmt::format("{}: is not gzip data although its name ends in .gz", path.string()));
  }
  const std::unique_ptr<gzFile_s, Closer> file(gzopen(path.c_str(), "rb"));
  if (!file) throw BadData(fmt::format("{}: cannot be opened for reading", path.string()));
  std::string text;
  std::array<char, 1 << 16> block{};
  int n = 0;
  while ((n = gzread(file.get(), block.data(), block.size())) > 0) {
    text.append(block.data(), static_cast<std::size_t>(n));
    if (text.size() > largest_unpacked_bytes) {
      throw BadData(fmt::format("{}: unpacks to more than {} GiB", path.string(), largest_unpacked_bytes >> 30U));
    }
  }
  int code = Z_OK;
  const std::string reason = gzerror(file.get(), &code);
  // A file cut off at its end yields data, then Z_BUF_ERROR.
  if (n < 0 || code != Z_OK) {
    throw BadData(fmt::format("{}: the gzip data are damaged or truncated ({})", path.string(), reason));
  }
  return text;
}

std::uint64_t hash(const Vec3& p) {
  std::uint64_t h = 0x9E3779B97F4A7C15ULL;
  for (const double x : p) {
    h ^= std::bit_cast<std::uint64_t>(x + 0.0);  // -0.0 + 0.0 is +0.0
    h *= 0xD6E8FEB86659FD93ULL;
    h ^= h >> 32U;
  }
  return h;
}

}  // namespace

MeshFormat mesh_format(const std::filesystem::path& path) {
  const std::string extension = lower_extension(lower_extension(path) == ".gz" ? path.stem() : path);
  if (extension == ".obj") return MeshFormat::obj;
  if (extension == ".off") return MeshFormat::off;
  if (extension == ".ply") return MeshFormat::ply;
  if (extension == ".stl") return MeshFormat::stl;
  throw BadData(fmt::format(
      "{}: '{}' is not a mesh format that is understood; expected .obj, .off, .ply or .stl, each also as .gz",
      path.string(), extension));
}

TriangleMesh load_mesh(const std::filesystem::path& path, double unit_m) {
  const MeshFormat format = mesh_format(path);
  note_input_file(path);
  const std::string bytes = lower_extension(path) == ".gz" ? unpacked(path) : read_file(path);
  return parse_mesh(bytes, format, unit_m, path.string());
}

TriangleMesh parse_mesh(std::string_view bytes, MeshFormat format, double unit_m, const std::string& source) {
  if (!(unit_m > 0.0 && unit_m <= largest_mesh_coordinate_m))
    throw UsageError(fmt::format("{}: a mesh unit of {} m makes no sense", source, unit_m));
  mesh_readers::Soup soup(source, unit_m);
  if (bytes.empty()) soup.fail("is empty; a mesh was expected");
  switch (format) {
    case MeshFormat::obj:
      mesh_readers::read_obj(bytes, soup);
      break;
    case MeshFormat::off:
      mesh_readers::read_off(bytes, soup);
      break;
    case MeshFormat::ply:
      mesh_readers::read_ply(bytes, soup);
      break;
    case MeshFormat::stl:
      mesh_readers::read_stl(bytes, soup);
      break;
  }
  TriangleMesh mesh = std::move(soup).finish();
  if (format != MeshFormat::stl) return mesh;
  const Box3 box = mesh.bounds();
  const double largest = std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
  return weld_close_vertices(weld_coincident_vertices(mesh), stl_rounding * largest);
}

TriangleMesh weld_close_vertices(const TriangleMesh& mesh, double distance_m) {
  TriangleMesh welded = mesh;
  if (!(distance_m > 0.0)) return welded;
  // Cells as wide as the distance: whatever is that near lies in a cell's own neighbours.
  using Cell = std::array<std::int64_t, 3>;
  const auto cell_of = [&](const Vec3& p) {
    Cell cell{};
    for (std::size_t k = 0; k < 3; ++k) {
      cell[k] = static_cast<std::int64_t>(std::floor(p[static_cast<Eigen::Index>(k)] / distance_m));
    }
    return cell;
  };
  const auto hash_of = [](const Cell& cell) {
    std::uint64_t h = 0x9E3779B97F4A7C15ULL;
    for (const std::int64_t k : cell) h = (h ^ static_cast<std::uint64_t>(k)) * 0xD6E8FEB86659FD93ULL, h ^= h >> 32U;
    return static_cast<std::size_t>(h);
  };
  std::unordered_map<Cell, std::vector<std::int32_t>, decltype(hash_of)> kept(mesh.vertices_W_m.size(), hash_of);
  std::vector<std::int32_t> renamed(mesh.vertices_W_m.size());
  MeshReadingNote note{"joined-corners", 0, "", {}};
  double widest_m = 0.0;
  welded.vertices_W_m.clear();
  for (std::size_t v = 0; v < mesh.vertices_W_m.size(); ++v) {
    const Vec3& p = mesh.vertices_W_m[v];
    const Cell own = cell_of(p);
    std::int32_t found = -1;
    for (int n = 0; n < 27 && found < 0; ++n) {
      const auto place = kept.find({own[0] + n / 9 - 1, own[1] + n / 3 % 3 - 1, own[2] + n % 3 - 1});
      if (place == kept.end()) continue;
      for (const std::int32_t other : place->second) {
        const double apart_m = (welded.vertices_W_m[at(other)] - p).norm();
        if (apart_m > distance_m) continue;
        found = other;
        widest_m = std::max(widest_m, apart_m);
        break;
      }
    }
    if (found < 0) {
      found = static_cast<std::int32_t>(welded.vertices_W_m.size());
      welded.vertices_W_m.push_back(p);
      kept[own].push_back(found);
    } else if (note.count++ == 0) {
      note.first_W_m = p;
    }
    renamed[v] = found;
  }
  for (auto& triangle : welded.triangles) {
    for (std::int32_t& corner : triangle) corner = renamed[at(corner)];
  }
  if (note.count > 0) {
    note.what = fmt::format(
        "{} {} not equal to others but within {:.3g} m of them, as far as the file rounds, and {} "
        "joined; they were up to {:.3g} m apart",
        note.count, note.count == 1 ? "corner was" : "corners were", distance_m, note.count == 1 ? "was" : "were",
        widest_m);
    welded.notes.push_back(std::move(note));
  }
  return welded;
}

TriangleMesh weld_coincident_vertices(const TriangleMesh& mesh) {
  const std::size_t count = mesh.vertices_W_m.size();
  TriangleMesh welded;
  welded.source = mesh.source;
  welded.notes = mesh.notes;
  welded.vertices_W_m.reserve(count);
  // Open addressing: slots hold the index of a welded vertex.
  std::vector<std::int32_t> slots(std::bit_ceil(2 * count + 2), -1);
  const std::size_t mask = slots.size() - 1;
  std::vector<std::int32_t> renamed(count);
  for (std::size_t v = 0; v < count; ++v) {
    const Vec3& p = mesh.vertices_W_m[v];
    std::size_t slot = hash(p) & mask;
    while (slots[slot] >= 0 && welded.vertices_W_m[static_cast<std::size_t>(slots[slot])] != p)
      slot = (slot + 1) & mask;
    if (slots[slot] < 0) {
      slots[slot] = static_cast<std::int32_t>(welded.vertices_W_m.size());
      welded.vertices_W_m.push_back(p);
    }
    renamed[v] = slots[slot];
  }
  welded.triangles = mesh.triangles;
  for (auto& triangle : welded.triangles) {
    for (std::int32_t& corner : triangle) corner = renamed[static_cast<std::size_t>(corner)];
  }
  return welded;
}

}  // namespace touchstone::surface
