// Reading and writing triangle meshes: OBJ, OFF (text), PLY (text and binary) and STL (text and binary), each also as
// .gz. Strict: whatever would make the mesh differ from what the file says is an error with file and line, never a
// warning.
//
// Why not a mesh library's readers: those of OpenMesh 9 parse coordinates in single precision, so that the same object
// in mm and in km becomes two different objects; they drop faces with a repeated or (in its half-edge mesh) a
// third-owner edge, and pass on indices that are out of range. Its half-edge mesh is the independent twin of our
// adjacency in mesh_topology_test.cc.
//
// Rules:
// - Coordinates are read in double precision and multiplied by `unit_m`. Faces keep the file's order and orientation.
// - A polygon v0 v1 ... vn becomes the fan (v0 v1 v2), (v0 v2 v3), ... Where that would turn a triangle over (the
//   polygon is not star-shaped from v0), the fan is cut from the first corner where it would not; without such a corner
//   the polygon is cut by its ears. One that crosses itself or is folded is cut all the same, with a note.
// - STL repeats the corners of every triangle, and programs write them with the rounding of float: corners closer than
//   stl_rounding of the largest coordinate are joined, with a note where they were not equal. Other formats keep their
//   vertices (weld_coincident_vertices joins them where that is wanted).
// - A face that names a vertex twice is kept: it has no area, and `touchstone doctor` reports it.
// - Normals, colours, texture coordinates, groups and materials are ignored. Facet normals of STL are ignored as well:
//   the order of the corners decides.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "harness/surface/triangle_mesh.h"

namespace touchstone::surface {

enum class MeshFormat { obj, off, ply, stl };

// Beyond these no object is a thing that a hand touches, and squares of lengths could leave the range of double.
inline constexpr double largest_mesh_coordinate_m = 1e15;
inline constexpr double smallest_mesh_extent_m = 1e-15;

// Float has 24 bits: what two programs made of one corner differs by less than this share of the largest coordinate.
inline constexpr double stl_rounding = 0x1p-22;

// Throws BadData: no such file, unknown extension, malformed or truncated content, indices out of range, coordinates
// that are not finite, zero triangles. `unit_m` is the length of the file's unit in metres: 1e-3 for a mesh in mm.
TriangleMesh load_mesh(const std::filesystem::path& path, double unit_m);

// The same from memory; `source` stands for the file's name in messages.
TriangleMesh parse_mesh(std::string_view bytes, MeshFormat format, double unit_m, const std::string& source);

// Writes the format that the extension names, .gz too, atomically. All formats round-trip doubles when unit_m is 1:
// text has as many digits as needed, PLY is binary with double coordinates. Throws BadData naming the file.
void save_mesh(const TriangleMesh& mesh, const std::filesystem::path& path, double unit_m = 1.0);

// The format that the name's extension tells (of the name without .gz); throws BadData that lists the known ones.
MeshFormat mesh_format(const std::filesystem::path& path);

// Vertices with exactly equal coordinates become one. The triangles keep their number and order.
TriangleMesh weld_coincident_vertices(const TriangleMesh& mesh);
// Vertices within `distance_m` of one that was kept become that one; a note says how many and where.
TriangleMesh weld_close_vertices(const TriangleMesh& mesh, double distance_m);

}  // namespace touchstone::surface
