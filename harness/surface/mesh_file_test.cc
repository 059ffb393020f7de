#include "harness/surface/mesh_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/testing/shared_data.h"
#include "harness/testing/tiny_meshes.h"

namespace touchstone::surface {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::filesystem::path scratch() {
  auto folder = std::filesystem::path(::testing::TempDir()) / "touchstone-mesh-file";
  std::filesystem::create_directories(folder);
  return folder;
}

TriangleMesh awkward() {
  Random random(1);
  return moved(testing::ball(0.031, 3), random.rotation(), Vec3(1.0 / 3.0, -1e-7 / 3.0, 1e3 / 7.0));
}

std::string binary_stl(const TriangleMesh& mesh) {
  std::string out(80, ' ');
  const auto put = [&](auto value) { out.append(reinterpret_cast<const char*>(&value), sizeof value); };
  put(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) {
    for (int i = 0; i < 3; ++i) put(0.0F);
    for (const auto corner : triangle) {
      for (const double x : mesh.vertices_W_m[static_cast<std::size_t>(corner)]) put(static_cast<float>(x));
    }
    put(std::uint16_t{0});
  }
  return out;
}

std::string identifier(const ::testing::TestParamInfo<const char*>& tested) {
  std::string name = tested.param;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}

class RoundTrip : public ::testing::TestWithParam<const char*> {};

TEST_P(RoundTrip, EveryBitOfEveryCoordinate) {
  const auto file = scratch() / GetParam();
  const TriangleMesh mesh = awkward();
  save_mesh(mesh, file);
  const TriangleMesh back = load_mesh(file, 1.0);
  ASSERT_EQ(back.triangles.size(), mesh.triangles.size());
  EXPECT_EQ(back.vertices_W_m.size(), mesh.vertices_W_m.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_EQ(back.vertices_W_m[static_cast<std::size_t>(back.triangles[t][i])],
                mesh.vertices_W_m[static_cast<std::size_t>(mesh.triangles[t][i])]);
    }
  }
  EXPECT_EQ(back.source, file.string());
}

INSTANTIATE_TEST_SUITE_P(MeshFile, RoundTrip,
                         ::testing::Values("a.obj", "a.off", "a.ply", "a.stl", "a.obj.gz", "a.off.gz", "a.ply.gz",
                                           "a.stl.gz", "B.OBJ"),
                         identifier);

TEST(MeshFile, UnitScales) {
  const TriangleMesh mesh = parse_mesh("v 0 0 0\nv 3.15 0 0\nv 0 1 0\nf 1 2 3\n", MeshFormat::obj, 1e-3, "a.obj");
  EXPECT_DOUBLE_EQ(mesh.vertices_W_m[1].x(), 3.15e-3);
  EXPECT_THROW(parse_mesh("v 0 0 0\n", MeshFormat::obj, 0.0, "a.obj"), UsageError);
  EXPECT_THROW(parse_mesh("v 0 0 0\n", MeshFormat::obj, std::nan(""), "a.obj"), UsageError);
}

TEST(MeshFile, ObjIndexFormsPolygonsAndContinuations) {
  const TriangleMesh mesh = parse_mesh(
      "# comment\nmtllib x.mtl\no thing\nv 0 0 0 1\nv 1 0 0 # tail\nv 1 1 0\r\nv +0 1 0\nvt 0 0\nvn 0 0 1\nusemtl red\n"
      "f 1/1/1 2/1/1 \\\n 3//1 4\nf -4 -3 -2\n",
      MeshFormat::obj, 1.0, "a.obj");
  const std::vector<std::array<std::int32_t, 3>> expected{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}};
  EXPECT_EQ(mesh.triangles, expected);
}

TEST(MeshFile, AConcaveQuadIsCutFromItsReflexCorner) {
  const TriangleMesh mesh =
      parse_mesh("v 0 0 0\nv 2 1 0\nv 0 2 0\nv 1.5 1 0\nf 1 2 3 4\n", MeshFormat::obj, 1.0, "a.obj");
  const std::vector<std::array<std::int32_t, 3>> expected{{1, 2, 3}, {1, 3, 0}};
  EXPECT_EQ(mesh.triangles, expected);
}

double area_m2(const TriangleMesh& mesh, const Vec3& normal) {
  double sum = 0.0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const double one = 0.5 * mesh.scaled_normal(t).dot(normal);
    EXPECT_GE(one, 0.0) << "triangle " << t << " is turned over";
    sum += one;
  }
  return sum;
}

// Polygons that no corner sees whole. The area is the shoelace formula's, by hand: a comb of teeth 1 wide and 2 high on
// a bar 1 high, at several sizes and turned in space.
TEST(MeshFile, ConcavePolygonsAreCutByTheirEars) {
  for (const double size : {1e-3, 1.0, 1e4}) {
    for (const int teeth : {2, 3, 40}) {
      std::string text;
      std::string face = "f";
      Random random(11);
      const Quat turned(random.rotation());
      std::vector<Vec3> corners{{0, 0, 0}, {2.0 * teeth - 1, 0, 0}};
      for (int k = teeth - 1; k >= 0; --k) {
        corners.emplace_back(2.0 * k + 1, 3, 0);
        corners.emplace_back(2.0 * k, 3, 0);
        if (k > 0) corners.emplace_back(2.0 * k, 1, 0);
        if (k > 0) corners.emplace_back(2.0 * k - 1, 1, 0);
      }
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3 p = size * (turned * corners[i]);
        text += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
        face += fmt::format(" {}", i + 1);
      }
      const TriangleMesh mesh = parse_mesh(text + face + "\n", MeshFormat::obj, 1.0, "comb.obj");
      ASSERT_EQ(mesh.triangle_count(), corners.size() - 2);
      const double expected = size * size * (2.0 * teeth - 1 + 2.0 * teeth);
      EXPECT_NEAR(area_m2(mesh, turned * Vec3::UnitZ()), expected, 1e-9 * expected) << teeth;
      EXPECT_TRUE(mesh.notes.empty());
    }
  }
}

// A ring, joined to one outline by a cut whose corners stand twice.
TEST(MeshFile, APolygonWithAHoleIsCut) {
  const TriangleMesh mesh =
      parse_mesh("v 0 0 0\nv 6 0 0\nv 6 6 0\nv 0 6 0\nv 2 2 0\nv 2 4 0\nv 4 4 0\nv 4 2 0\nf 1 2 3 4 1 5 6 7 8 5\n",
                 MeshFormat::obj, 1.0, "ring.obj");
  EXPECT_NEAR(area_m2(mesh, Vec3::UnitZ()), 32.0, 1e-12);
  EXPECT_TRUE(mesh.notes.empty());
}

// Corners along its sides, as a CAD program leaves them where other faces end.
TEST(MeshFile, CornersOnAStraightSideAreNoFold) {
  const TriangleMesh mesh = parse_mesh(
      "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 3 3 0\nv 2 3 0\nv 2 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\nv 0 2 0\nv 0 1 0\n"
      "f 1 2 3 4 5 6 7 8 9 10 11 12\n",
      MeshFormat::obj, 1.0, "u.obj");
  EXPECT_NEAR(area_m2(mesh, Vec3::UnitZ()), 7.0, 1e-12);
  EXPECT_TRUE(mesh.notes.empty());
}

TEST(MeshFile, APolygonThatCrossesItselfIsCutAndNoted) {
  const TriangleMesh mesh =
      parse_mesh("v 0 0 0\nv 3 0 0\nv 0 2 0\nv 3 1 0\nv 0 5 0\nf 1 2 5\nf 1 2 3 4\n", MeshFormat::obj, 1.0, "bow.obj");
  EXPECT_EQ(mesh.triangle_count(), 3U);
  ASSERT_EQ(mesh.notes.size(), 1U);
  EXPECT_EQ(mesh.notes[0].name, "folded-polygons");
  EXPECT_THAT(mesh.notes[0].what, HasSubstr("the first in line 7"));
}

// Two strips in one list, joined by -1; the second triangle of a strip runs the other way.
TEST(MeshFile, PlyTriangleStrips) {
  const TriangleMesh mesh = parse_mesh(
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 1 0\n8 0 1 2 3 -1 1 4 3\n",
      MeshFormat::ply, 1.0, "strip.ply");
  const std::vector<std::array<std::int32_t, 3>> expected{{0, 1, 2}, {2, 1, 3}, {1, 4, 3}};
  EXPECT_EQ(mesh.triangles, expected);
  EXPECT_NEAR(area_m2(mesh, Vec3::UnitZ()), 1.5, 1e-12);
}

// Corners off by less than a float's rounding are one corner, in any unit; what the file tells apart stays apart.
TEST(MeshFile, StlCornersThatDifferByRoundingAreJoined) {
  const TriangleMesh sound = testing::ball(1.0, 3);
  const auto text = [&](double size, double noise) {
    Random random(7);
    std::string stl = "solid\n";
    for (const auto& triangle : sound.triangles) {
      stl += "facet normal 0 0 0\nouter loop\n";
      for (const std::int32_t corner : triangle) {
        const Vec3 p = size * (sound.vertices_W_m[at(corner)] + noise * random.direction());
        stl += fmt::format("vertex {} {} {}\n", p.x(), p.y(), p.z());
      }
      stl += "endloop\nendfacet\n";
    }
    return stl + "endsolid\n";
  };
  for (const double size : {1e-3, 20.0, 5e3}) {
    const TriangleMesh joined = parse_mesh(text(size, 1e-17), MeshFormat::stl, 1e-3, "noise.stl");
    EXPECT_EQ(joined.vertices_W_m.size(), sound.vertices_W_m.size()) << size;
    const TriangleMesh rounded = parse_mesh(text(size, 0.2 * stl_rounding), MeshFormat::stl, 1e-3, "noise.stl");
    EXPECT_EQ(rounded.vertices_W_m.size(), sound.vertices_W_m.size()) << size;
    ASSERT_EQ(rounded.notes.size(), 1U);
    EXPECT_EQ(rounded.notes[0].name, "joined-corners");
    EXPECT_EQ(rounded.notes[0].count, 3 * sound.triangle_count() - sound.vertices_W_m.size());
    EXPECT_GT(parse_mesh(text(size, 20 * stl_rounding), MeshFormat::stl, 1e-3, "apart.stl").vertices_W_m.size(),
              2 * sound.vertices_W_m.size());
  }
  EXPECT_TRUE(parse_mesh(text(1.0, 0.0), MeshFormat::stl, 1e-3, "clean.stl").notes.empty());
}

TEST(MeshFile, NothingIsDropped) {
  // Three triangles on one edge, a repeated triangle, and one that names a vertex twice.
  const TriangleMesh mesh =
      parse_mesh("OFF 5 5 0\n0 0 0\n1 0 0\n0 1 0\n0 -1 0\n0 0 1\n3 0 1 2\n3 1 0 3\n3 0 1 4\n3 0 1 2\n3 0 0 1\n",
                 MeshFormat::off, 1.0, "a.off");
  EXPECT_EQ(mesh.triangles.size(), 5U);
  EXPECT_EQ(mesh.vertices_W_m.size(), 5U);
}

TEST(MeshFile, StlIsWeldedBinaryAndText) {
  const TriangleMesh ball = testing::ball(1.0, 2);
  const TriangleMesh read = parse_mesh(binary_stl(ball), MeshFormat::stl, 1.0, "a.stl");
  EXPECT_EQ(read.triangles.size(), ball.triangles.size());
  EXPECT_EQ(read.vertices_W_m.size(), ball.vertices_W_m.size());
  // A binary file may start with the word that marks text.
  std::string solid = binary_stl(ball);
  solid.replace(0, 5, "solid");
  EXPECT_EQ(parse_mesh(solid, MeshFormat::stl, 1.0, "a.stl").triangles, read.triangles);
}

TEST(MeshFile, PlyBigEndianSkipsWhatItDoesNotNeed) {
  std::string ply =
      "ply\nformat binary_big_endian 1.0\ncomment made by hand\nelement vertex 3\nproperty float x\nproperty float "
      "y\nproperty float z\n"
      "property uchar red\nelement face 1\nproperty list uchar uint vertex_index\nproperty float quality\nelement edge "
      "1\nproperty list ushort short stuff\nend_header\n";
  const auto put = [&](auto value) {
    const auto* bytes = reinterpret_cast<const char*>(&value);
    for (std::size_t i = sizeof value; i-- > 0;) ply += bytes[i];
  };
  for (int v = 0; v < 3; ++v) {
    for (int i = 0; i < 3; ++i) put(v == 1 && i == 0 ? 1.5F : v == 2 && i == 1 ? 1.0F : 0.0F);
    put(std::uint8_t{255});
  }
  put(std::uint8_t{3});
  for (const std::uint32_t i : {0U, 1U, 2U}) put(i);
  put(0.5F);
  put(std::uint16_t{2});
  put(std::int16_t{-1});
  put(std::int16_t{7});
  const TriangleMesh mesh = parse_mesh(ply, MeshFormat::ply, 1.0, "a.ply");
  EXPECT_EQ(mesh.vertices_W_m[1], Vec3(1.5, 0, 0));
  EXPECT_EQ(mesh.triangles.size(), 1U);
}

TEST(MeshFile, RealMeshes) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(duck, "meshes/duck-full.obj");
  EXPECT_GT(load_mesh(duck, 1.0).triangles.size(), 1000U);
  TOUCHSTONE_SHARED_DATA_OR_SKIP(bunny, "meshes/bunny.off");
  EXPECT_EQ(load_mesh(bunny, 1.0).triangles.size(), 6966U);
  TOUCHSTONE_SHARED_DATA_OR_SKIP(plane, "peers/in/plane20k.obj.gz");
  EXPECT_EQ(load_mesh(plane, 1.0).triangles.size(), 20000U);
}

struct Bad {
  const char* name;  // of the file
  std::string bytes;
  const char* message;
};
void PrintTo(const Bad& bad, std::ostream* out) { *out << bad.name << ": " << bad.message; }

class BadMesh : public ::testing::TestWithParam<Bad> {};

TEST_P(BadMesh, IsRefusedWithItsPlace) {
  const auto file = scratch() / GetParam().name;
  write_file(file, GetParam().bytes);
  try {
    load_mesh(file, 1.0);
    FAIL() << "was accepted";
  } catch (const BadData& error) {
    EXPECT_THAT(error.what(), StartsWith(file.string() + ": "));
    EXPECT_THAT(error.what(), HasSubstr(GetParam().message));
  }
}

const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
const std::string ply_head =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face "
    "1\nproperty list uchar int vertex_indices\nend_header\n";
const std::string ply_binary =
    "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty double x\nproperty double y\nproperty "
    "double z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0123456789";

INSTANTIATE_TEST_SUITE_P(
    MeshFile, BadMesh,
    ::testing::Values(
        Bad{"empty.obj", "", "is empty"}, Bad{"empty.stl", "", "is empty"}, Bad{"empty.off", "\n\n", "is empty"},
        Bad{"comments.ply", "# x\n", "is empty"}, Bad{"no-triangles.obj", triangle, "has 3 vertices but no triangles"},
        Bad{"no-triangles.off", "OFF\n0 0 0\n", "no vertices and no triangles"},
        Bad{"index.obj", triangle + "f 1 2 4\n",
            "line 4: the vertex index 3 (counted from 0) is out of range: the file has 3 vertices"},
        Bad{"zero-index.obj", triangle + "f 0 1 2\n", "line 4: the vertex index 0 does not exist: OBJ counts from 1"},
        Bad{"negative.obj", triangle + "f -1 -2 -4\n",
            "line 4: the relative vertex index -4 points before the first of 3"},
        Bad{"huge-index.obj", triangle + "f 1 2 99999999999\n", "line 4: the vertex index 99999999998"},
        Bad{"index-overflow.obj", triangle + "f 1 2 99999999999999999999\n",
            "line 4: '99999999999999999999' is not a whole number"},
        Bad{"nan.obj", "v 0 nan 0\n", "line 1: the vertex (0, nan, 0) is not finite"},
        Bad{"infinity.obj", "v 0 0 0\nv 1 1 -inf\n", "line 2: the vertex (1, 1, -inf) is not finite"},
        Bad{"overflow.obj", "v 1e999 0 0\n", "line 1: the vertex (inf, 0, 0) is not finite"},
        Bad{"far.obj", "v 1e17 0 0\n", "line 1: the vertex (1e+17, 0, 0) is more than 1000000000000000"},
        Bad{"point.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", "all triangles lie within 0 m"},
        Bad{"word.obj", "v 0 zero 0\n", "line 1: 'zero' is not a number"},
        Bad{"tail.obj", "v 0 0 1.5mm\n", "line 1: '1.5mm' is not a number"},
        Bad{"short.obj", "v 0 0\n", "line 1: three coordinates were expected after 'v', got 2"},
        Bad{"line-face.obj", triangle + "f 1 2\n", "line 4: a face needs at least 3 corners, this one has 2"},
        Bad{"freeform.obj", triangle + "curv 0 1 1 2\n", "line 4: 'curv' is not an OBJ statement"},
        Bad{"binary.obj", std::string("\0\1\2\n", 4), "is not an OBJ statement"},
        Bad{"html.off", "<html>\n", "line 1: an OFF file starts with the word OFF"},
        Bad{"binary.off", "OFF BINARY\n", "line 1: binary OFF is not supported"},
        Bad{"truncated.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n", "ends after 2 of 3 vertices"},
        Bad{"truncated-faces.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "ends after 1 of 2 faces"},
        Bad{"billions.off", "OFF\n4000000000 4000000000 0\n0 0 0\n", "ends after 1 of 4000000000 vertices"},
        Bad{"index.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
            "line 6: face 0: the vertex index 3 is out of range"},
        Bad{"corners.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n",
            "line 6: face 0: 4 corners announced, 3 numbers follow"},
        Bad{"longer.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n",
            "line 7: more lines than the header's counts"},
        Bad{"index.ply", ply_head + "0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n",
            "face 0: the vertex index 9 (counted from 0) is out of range"},
        Bad{"nan.ply", ply_head + "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", "vertex 1: the vertex (1, nan, 0) is not finite"},
        Bad{"short.ply", ply_head + "0 0 0\n1 0\n0 1 0\n3 0 1 2\n", "line 11: 'vertex' 1: the line ends too early"},
        Bad{"truncated.ply", ply_head + "0 0 0\n1 0 0\n", "ends within 'vertex' 2 of 3"},
        Bad{"billions.ply", ply_binary, "the header announces 4000000000 of 'vertex'"},
        Bad{"type.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\n",
            "line 4: 'quad' is not a type of PLY"},
        Bad{"no-z.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n",
            "has no properties x, y and z"},
        Bad{"header.ply", "ply\nformat ascii 1.0\n", "ends within the header"},
        Bad{"longer.ply", ply_head + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n", "more data than its header announces"},
        Bad{"truncated.stl", binary_stl(testing::cube(1.0)).substr(0, 200),
            "binary STL announces 12 triangles, which take 684 bytes, but the file has 200"},
        Bad{"tiny.stl", "abc", "3 bytes are neither text STL"},
        Bad{"word.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 x\n", "line 4: 'x' is not a number"},
        Bad{"open.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1\n", "ends within a facet"},
        Bad{"cut.stl",
            "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1\nvertex 1 0 1\nvertex 0 1 1\nendloop\nendfacet\n",
            "ends without 'endsolid'"},
        Bad{"format.3ds", "x", "'.3ds' is not a mesh format that is understood; expected .obj, .off, .ply or .stl"},
        Bad{"plain.obj.gz", triangle, "is not gzip data"}));

TEST(MeshFile, DamagedGzipAndAbsentFiles) {
  save_mesh(awkward(), scratch() / "whole.obj.gz");
  const std::string packed = read_file(scratch() / "whole.obj.gz");
  write_file(scratch() / "cut.obj.gz", packed.substr(0, packed.size() / 2));
  EXPECT_THROW(load_mesh(scratch() / "cut.obj.gz", 1.0), BadData);
  std::string flipped = packed;
  flipped[flipped.size() / 2] = static_cast<char>(flipped[flipped.size() / 2] ^ 0x10);
  write_file(scratch() / "flipped.obj.gz", flipped);
  EXPECT_THROW(load_mesh(scratch() / "flipped.obj.gz", 1.0), BadData);
  EXPECT_THROW(load_mesh(scratch() / "absent.obj", 1.0), BadData);
  EXPECT_THROW(load_mesh(scratch() / "absent.obj.gz", 1.0), BadData);
  std::filesystem::create_directories(scratch() / "folder.obj");
  EXPECT_THROW(load_mesh(scratch() / "folder.obj", 1.0), BadData);
}

}  // namespace
}  // namespace touchstone::surface
