// MATLAB files as matio writes them, version 5 (plain and compressed) and 7.3.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <matio.h>
#include <unistd.h>

#include <array>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "import_table.h"

namespace touchstone::importing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::filesystem::path own_folder() {
  auto folder = std::filesystem::path(::testing::TempDir()) / fmt::format("touchstone-import-mat-{}", ::getpid());
  ensure_writable_folder(folder);
  return folder;
}

std::filesystem::path write_mat(mat_ft version, matio_compression compression, const std::string& name) {
  auto path = own_folder() / name;
  std::filesystem::remove(path);
  mat_t* const file = Mat_CreateVer(path.c_str(), nullptr, version);
  const auto put = [&](const char* what, std::vector<double> values, std::size_t rows) {
    std::size_t dims[2] = {rows, values.size() / rows};
    matvar_t* const v = Mat_VarCreate(what, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, values.data(), 0);
    Mat_VarWrite(file, v, compression);
    Mat_VarFree(v);
  };
  put("t", {0.0, 0.1, 0.2, 0.3}, 4);
  put("row", {1, 2, 3, 4}, 1);
  put("force", {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, 4);  // 4 samples of x, y, z, column after column
  put("scalar", {42}, 1);
  put("slow", {5, 6, 7}, 3);
  Mat_Close(file);
  return path;
}

TEST(MatFile, EveryVersionGivesTheSameColumns) {
  for (const auto& [version, compression, name, says] :
       {std::tuple{MAT_FT_MAT5, MAT_COMPRESSION_NONE, "plain5.mat", "MATLAB v5"},
        std::tuple{MAT_FT_MAT5, MAT_COMPRESSION_ZLIB, "zip5.mat", "MATLAB v5"},
        std::tuple{MAT_FT_MAT73, MAT_COMPRESSION_NONE, "h.mat", "MATLAB v7.3"}}) {
    const auto tables = read_foreign(write_mat(version, compression, name), {});
    ASSERT_EQ(tables.size(), 2U) << name;
    EXPECT_EQ(tables[0].format, says);
    EXPECT_EQ(tables[0].name, "4");
    ASSERT_EQ(tables[0].names.size(), 5U);
    const auto column = [&](const std::string& wanted) {
      const auto at = std::ranges::find(tables[0].names, wanted) - tables[0].names.begin();
      return tables[0].columns.at(static_cast<std::size_t>(at));
    };
    EXPECT_THAT(column("t"), ElementsAre(0.0, 0.1, 0.2, 0.3));
    EXPECT_THAT(column("row"), ElementsAre(1, 2, 3, 4));
    EXPECT_THAT(column("force.1"), ElementsAre(1, 2, 3, 4));
    EXPECT_THAT(column("force.3"), ElementsAre(9, 10, 11, 12));
    EXPECT_THAT(tables[1].columns[0], ElementsAre(5, 6, 7));
    EXPECT_THAT(tables[0].notes, ElementsAre(HasSubstr("scalar")));
  }
}

std::string mat_refusal(const std::filesystem::path& path, const std::string& bytes) {
  write_file(path, bytes);
  try {
    read_mat_file(path);
  } catch (const BadData& e) {
    return e.what();
  }
  return "no error";
}

TEST(MatFile, CutFilesAreRefusedAtEveryByte) {
  for (const auto& [version, compression, name] : {std::tuple{MAT_FT_MAT5, MAT_COMPRESSION_NONE, "cut5.mat"},
                                                   std::tuple{MAT_FT_MAT5, MAT_COMPRESSION_ZLIB, "cutzip5.mat"}}) {
    const auto path = write_mat(version, compression, name);
    const std::string whole = read_file(path);
    std::size_t with_byte = 0, refused = 0;
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const std::string what = mat_refusal(path, whole.substr(0, size));
      // Between two variables a file of level 5 may end: nothing in it counts them.
      refused += what == "no error" ? 0 : 1;
      with_byte += what.find("within the variable that begins at byte") != std::string::npos ? 1 : 0;
    }
    EXPECT_GE(refused + 5, whole.size()) << name;
    EXPECT_GT(with_byte, whole.size() / 2) << name;
    EXPECT_EQ(mat_refusal(path, whole), "no error");
  }
  const auto path = write_mat(MAT_FT_MAT73, MAT_COMPRESSION_NONE, "cut73.mat");
  const std::string whole = read_file(path);
  for (const std::size_t size : {whole.size() / 4, whole.size() / 2, whole.size() - 1}) {
    EXPECT_THAT(mat_refusal(path, whole.substr(0, size)), HasSubstr("cut73.mat")) << size;
  }
}

TEST(MatFile, ADamagedTagIsNamedWithItsByte) {
  const auto path = write_mat(MAT_FT_MAT5, MAT_COMPRESSION_NONE, "tag.mat");
  std::string bytes = read_file(path);
  bytes[128] = 99;
  EXPECT_THAT(mat_refusal(path, bytes), HasSubstr("byte 128: a variable of MATLAB was expected"));
}

// The dimensions of the first array, t, stand 8 + 16 + 8 bytes behind its tag.
TEST(MatFile, DamagedDimensionsAreNotBelieved) {
  const auto path = write_mat(MAT_FT_MAT5, MAT_COMPRESSION_NONE, "dims.mat");
  std::string bytes = read_file(path);
  ASSERT_EQ(bytes[160], 4);
  bytes[162] = 64;  // 4 + 64 * 65536 rows
  EXPECT_THAT(mat_refusal(path, bytes), HasSubstr("dims.mat"));
  bytes[163] = 127;
  EXPECT_THAT(mat_refusal(path, bytes), HasSubstr("dims.mat"));
}

// matio allocates a pointer for each structure of an array of structures, before it reads the first.
TEST(MatFile, AnArrayOfStructuresHasNoMoreThanItsBytes) {
  const auto path = own_folder() / "structures.mat";
  ensure_writable_folder(path.parent_path());
  for (const matio_compression compression : {MAT_COMPRESSION_NONE, MAT_COMPRESSION_ZLIB}) {
    std::filesystem::remove(path);
    mat_t* const file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
    const char* fields[] = {"t", "force"};
    std::size_t dims[2] = {1, 1};
    matvar_t* const structure = Mat_VarCreateStruct("s", 2, dims, fields, 2);
    std::size_t size[2] = {4, 1};
    std::array<double, 4> values{1.0, 2.0, 3.0, 4.0};
    for (const char* const field : fields) {
      Mat_VarSetStructFieldByName(structure, field, 0,
                                  Mat_VarCreate(field, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size, values.data(), 0));
    }
    Mat_VarWrite(file, structure, compression);
    Mat_VarFree(structure);
    Mat_Close(file);
    std::string bytes = read_file(path);
    EXPECT_EQ(mat_refusal(path, bytes), "no error");
    if (compression == MAT_COMPRESSION_NONE) {
      ASSERT_EQ(bytes[160], 1);
      bytes[163] = 100;  // 100 * 2^24 + 1 structures
      EXPECT_THAT(mat_refusal(path, bytes), HasSubstr("byte 128: variable 1 has 3355443202 arrays in"));
    } else {
      char& within = bytes[bytes.size() - 30];
      within = static_cast<char>(within ^ 0x55);
      EXPECT_THAT(mat_refusal(path, bytes), HasSubstr("structures.mat"));
    }
  }
}

// matio takes the eight bytes behind the first element's tag for the tag of a name, and makes room for that many
// letters.
TEST(MatFile, AnObjectsNameIsNotLongerThanItsBytes) {
  const auto path = write_mat(MAT_FT_MAT5, MAT_COMPRESSION_NONE, "object.mat");
  const std::string arrays = read_file(path);
  const auto with_object = [&](std::uint32_t letters) {
    // A tag, the array flags of class 17, an element of eight bytes, and a name of four in the small format.
    const std::array<std::uint32_t, 12> words{14, 40, 6, 8, 17, 0, 0x4005, 8, 1, letters, 0x4000a, 0x656d616e};
    return arrays + std::string(reinterpret_cast<const char*>(words.data()), sizeof words);
  };
  EXPECT_THAT(mat_refusal(path, with_object(0xff000003)), HasSubstr("a name that does not end within it"));
  EXPECT_THAT(mat_refusal(path, with_object(9)), HasSubstr("a name that does not end within it"));
}

// Level 4 has no mark of its own: the head of each matrix is five integers, then its name and its numbers.
TEST(MatFile, AMatrixOfLevel4HasNoMoreThanItsBytes) {
  const auto path = own_folder() / "level4.mat";
  ensure_writable_folder(path.parent_path());
  const auto matrix = [](std::array<std::uint32_t, 5> head) {
    std::string bytes(reinterpret_cast<const char*>(head.data()), sizeof head);
    bytes += std::string("t\0", 2);
    for (const double value : {0.0, 0.5, 1.0})
      bytes += std::string(reinterpret_cast<const char*>(&value), sizeof value);
    return bytes;
  };
  EXPECT_EQ(mat_refusal(path, matrix({0, 3, 1, 0, 2})), "no error");
  EXPECT_THAT(mat_refusal(path, matrix({0, 3, 1, 0, 0x73000002})),
              HasSubstr("byte 0: matrix 1 of a MATLAB file of level 4 has a name of"));
  EXPECT_THAT(mat_refusal(path, matrix({0, 3'000'000'000, 4, 0, 2})), HasSubstr("3000000000 x 4 numbers"));
  EXPECT_THAT(mat_refusal(path, matrix({0, 3, 1, 0, 2}).substr(0, 40)), HasSubstr("level 4"));
  EXPECT_THAT(mat_refusal(path, matrix({0, 3, 1, 7, 2})), HasSubstr("imaginary part numbered 7"));
}

}  // namespace
}  // namespace touchstone::importing
