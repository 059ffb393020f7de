// MATLAB files as matio writes them, version 5 (plain and compressed) and 7.3.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <matio.h>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/importing/import_table.h"

namespace touchstone::importing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::filesystem::path write_mat(mat_ft version, matio_compression compression, const std::string& name) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "touchstone-import-mat";
  ensure_writable_folder(folder);
  const auto path = folder / name;
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

TEST(MatFile, CutOrForeignFilesAreRefusedOrReadInPart) {
  const auto path = write_mat(MAT_FT_MAT5, MAT_COMPRESSION_NONE, "whole.mat");
  const std::string whole = read_file(path);
  for (const std::size_t size : {std::size_t{0}, std::size_t{10}, std::size_t{127}, std::size_t{140}}) {
    write_file(path, whole.substr(0, size));
    EXPECT_THROW(read_mat_file(path), BadData) << size;
  }
}

}  // namespace
}  // namespace touchstone::importing
