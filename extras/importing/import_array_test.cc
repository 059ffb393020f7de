// Arrays as HDF5, NumPy and MATLAB files hold them, written here by HDF5's and matio's own libraries, and NumPy's by
// its published format (NEP 1).
#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <matio.h>
#include <unistd.h>

#include <bit>
#include <cstring>
#include <functional>

#include "guess_map.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/recording/hdf5_handle.h"
#include "import_table.h"

namespace touchstone::importing {
using recording::Hdf5Dataset;
using recording::Hdf5File;
using recording::Hdf5Quiet;
using recording::Hdf5Space;

namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::filesystem::path array_file(const std::string& name) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / fmt::format("touchstone-arrays-{}", ::getpid());
  ensure_writable_folder(folder);
  std::filesystem::remove(folder / name);
  return folder / name;
}

std::string array_refusal(const std::filesystem::path& path) {
  try {
    read_foreign(path, {});
  } catch (const BadData& error) {
    return error.what();
  }
  return "no error";
}

void put_dataset(hid_t where, const char* name, std::vector<hsize_t> sides, const std::vector<double>& values,
                 const std::string& unit = "") {
  const Hdf5Space space(H5Screate_simple(static_cast<int>(sides.size()), sides.data(), nullptr));
  const Hdf5Dataset set(H5Dcreate2(where, name, H5T_IEEE_F64LE, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  ASSERT_GE(H5Dwrite(set.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
  ASSERT_TRUE(unit.empty() || recording::hdf5_write_text_attribute(set.get(), "units", unit));
}

TEST(ImportArrays, Hdf5GroupsAndArrays) {
  const auto path = array_file("groups.h5");
  {
    const Hdf5Quiet quiet;
    const Hdf5File file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
    using Group = recording::Hdf5Handle<H5Gclose>;
    for (const char* const name : {"trial_1", "trial_2"}) {
      const Group group(H5Gcreate2(file.get(), name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
      put_dataset(group.get(), "time", {4}, {0, 0.1, 0.2, 0.3});
      put_dataset(group.get(), "force", {4, 3}, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, "mN");
      put_dataset(group.get(), "image", {2, 2, 2}, {1, 2, 3, 4, 5, 6, 7, 8});
    }
  }
  const auto tables = read_foreign(path, {});
  ASSERT_EQ(tables.size(), 2U);
  EXPECT_EQ(tables[0].name, "trial_1");
  EXPECT_THAT(tables[0].names, ElementsAre("force.1", "force.2", "force.3", "time"));
  EXPECT_THAT(tables[0].columns[1], ElementsAre(2, 5, 8, 11));
  EXPECT_EQ(tables[0].description(0), "force.1 (mN)");
  EXPECT_THAT(tables[0].notes, ::testing::Contains(HasSubstr("trial_1/image (an array of 2 x 2 x 2")));
  const GuessedMap guess = guess_map(path);
  EXPECT_THAT(guess.decide, ::testing::Contains(HasSubstr("are as likely")));
  EXPECT_THAT(guess.decide, ::testing::Contains(HasSubstr("there are clocks in trial_1, trial_2")));
}

TEST(ImportArrays, Hdf5RecordsAndSizesThatAreNotThere) {
  const auto path = array_file("records.h5");
  {
    const Hdf5Quiet quiet;
    struct Record {
      double t;
      float f[3];
    };
    const std::array<Record, 3> records{{{0.0, {1, 2, 3}}, {0.5, {4, 5, 6}}, {1.0, {7, 8, 9}}}};
    const Hdf5File file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
    const hsize_t three = 3;
    const recording::Hdf5Type vector(H5Tarray_create2(H5T_NATIVE_FLOAT, 1, &three));
    const recording::Hdf5Type type(H5Tcreate(H5T_COMPOUND, sizeof(Record)));
    H5Tinsert(type.get(), "t", HOFFSET(Record, t), H5T_NATIVE_DOUBLE);
    H5Tinsert(type.get(), "F", HOFFSET(Record, f), vector.get());
    const Hdf5Space space(H5Screate_simple(1, &three, nullptr));
    const Hdf5Dataset set(
        H5Dcreate2(file.get(), "log", type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Dwrite(set.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, records.data());
  }
  const auto tables = read_foreign(path, {});
  EXPECT_THAT(tables[0].names, ElementsAre("log/t", "log/F.1", "log/F.2", "log/F.3"));
  EXPECT_THAT(tables[0].columns[2], ElementsAre(2, 5, 8));
  const auto huge = array_file("huge.h5");
  {
    const Hdf5Quiet quiet;
    const Hdf5File file(H5Fcreate(huge.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
    const hsize_t many = hsize_t{1} << 40;
    const Hdf5Space space(H5Screate_simple(1, &many, nullptr));
    const Hdf5Dataset set(
        H5Dcreate2(file.get(), "x", H5T_IEEE_F64LE, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  }
  EXPECT_THAT(array_refusal(huge), HasSubstr("more than the file can hold"));
}

std::string npy(const std::string& descr, const std::string& order, const std::string& shape, const std::string& data) {
  std::string header = "{'descr': " + descr + ", 'fortran_order': " + order + ", 'shape': " + shape + ", }";
  header += std::string((64 - (10 + header.size() + 1) % 64) % 64, ' ') + "\n";
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() % 256);
  bytes += static_cast<char>(header.size() / 256);
  return bytes + header + data;
}

template <class Number>
std::string bytes_of(const std::vector<Number>& numbers, bool swapped = false) {
  std::string bytes;
  for (const Number number : numbers) {
    std::array<char, sizeof(Number)> raw = std::bit_cast<std::array<char, sizeof(Number)>>(number);
    if (swapped) std::ranges::reverse(raw);
    bytes.append(raw.data(), raw.size());
  }
  return bytes;
}

std::vector<ImportTable> read_npy(const std::string& bytes) {
  const auto path = array_file("force.npy");
  write_file(path, bytes);
  return read_foreign(path, {});
}

TEST(ImportArrays, NumpyByItsPublishedFormat) {
  const std::vector<double> six{1, 2, 3, 4, 5, 6};
  EXPECT_THAT(read_npy(npy("'<f8'", "False", "(3, 2)", bytes_of(six)))[0].columns[1], ElementsAre(2, 4, 6));
  EXPECT_THAT(read_npy(npy("'<f8'", "True", "(3, 2)", bytes_of(six)))[0].columns[1], ElementsAre(4, 5, 6));
  EXPECT_THAT(read_npy(npy("'>f8'", "False", "(6,)", bytes_of(six, true)))[0].columns[0],
              ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(read_npy(npy("'<i2'", "False", "(2,)", bytes_of<std::int16_t>({-7, 300})))[0].columns[0],
              ElementsAre(-7, 300));
  EXPECT_THAT(read_npy(npy("'|u1'", "False", "(2,)", "\x01\xff"))[0].columns[0], ElementsAre(1, 255));
  // Half precision (IEEE 754): 1.5, -2, the smallest 2^-24.
  EXPECT_THAT(read_npy(npy("'<f2'", "False", "(3,)", bytes_of<std::uint16_t>({0x3e00, 0xc000, 1})))[0].columns[0],
              ElementsAre(1.5, -2.0, std::ldexp(1.0, -24)));
  const auto records = read_npy(
      npy("[('t', '<f8'), ('f', '<f4', (2,))]", "False", "(2,)",
          bytes_of<double>({0.25}) + bytes_of<float>({1, 2}) + bytes_of<double>({0.5}) + bytes_of<float>({3, 4})));
  EXPECT_THAT(records[0].names, ElementsAre("t", "f.1", "f.2"));
  EXPECT_THAT(records[0].columns[2], ElementsAre(2, 4));
}

TEST(ImportArrays, NumpyThatIsNoneIsRefused) {
  for (const auto& [bytes, why] :
       {std::pair{npy("'|O'", "False", "(2,)", "xx"), "pickled objects"},
        {npy("'<U7'", "False", "(2,)", "xx"), "text, times or complex"},
        {npy("'<f8'", "False", "(2, 2, 2)", bytes_of<double>({1, 2, 3, 4, 5, 6, 7, 8})), "an array of 2 x 2 x 2"},
        {npy("'<f8'", "False", "(999999999999, 3)", "xx"), "it says that it has 999999999999 x 3"},
        {npy("'<f8'", "False", "none", "xx"), "its shape is none"},
        {npy("[('t', '<f8', ('f', '<i0',] (2,))", "False", "(2,)", "xx"), "its records are none"},
        {std::string("\x93NUMPY\x01\x00\xff\xff", 10), "it has no NumPy header"}}) {
    const auto path = array_file("bad.npy");
    write_file(path, bytes);
    EXPECT_THAT(array_refusal(path), HasSubstr(why));
  }
}

TEST(ImportArrays, NumpyArchives) {
  const auto path = array_file("log.npz");
  archive* const out = archive_write_new();
  archive_write_set_format_zip(out);
  ASSERT_EQ(archive_write_open_filename(out, path.c_str()), ARCHIVE_OK);
  for (const auto& [name, bytes] :
       {std::pair{"t.npy", npy("'<f8'", "False", "(3,)", bytes_of<double>({0, 0.1, 0.2}))},
        {"force.npy", npy("'<f8'", "False", "(3, 2)", bytes_of<double>({1, 2, 3, 4, 5, 6}))}}) {
    archive_entry* const entry = archive_entry_new();
    archive_entry_set_pathname(entry, name);
    archive_entry_set_size(entry, static_cast<la_int64_t>(bytes.size()));
    archive_entry_set_filetype(entry, AE_IFREG);
    archive_write_header(out, entry);
    archive_write_data(out, bytes.data(), bytes.size());
    archive_entry_free(entry);
  }
  archive_write_free(out);
  const auto tables = read_foreign(path, {});
  EXPECT_THAT(tables[0].names, ElementsAre("t", "force.1", "force.2"));
  EXPECT_THAT(tables[0].columns[2], ElementsAre(2, 4, 6));
}

TEST(ImportArrays, StructArraysOfMatlabAreTables) {
  const auto path = array_file("trials.mat");
  mat_t* const file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
  std::array<const char*, 2> fields{"t", "F"};
  std::array<std::size_t, 2> one_by_two{1, 2}, column{3, 1}, matrix{3, 2};
  std::vector<std::array<double, 3>> times{{0, 1, 2}, {5, 6, 7}};
  std::vector<std::array<double, 6>> forces{{1, 2, 3, 4, 5, 6}, {7, 8, 9, 10, 11, 12}};
  matvar_t* const trials = Mat_VarCreateStruct("trial", 2, one_by_two.data(), fields.data(), 2);
  for (std::size_t e = 0; e < 2; ++e) {
    Mat_VarSetStructFieldByName(
        trials, "t", e, Mat_VarCreate(nullptr, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, column.data(), times[e].data(), 0));
    Mat_VarSetStructFieldByName(
        trials, "F", e, Mat_VarCreate(nullptr, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, matrix.data(), forces[e].data(), 0));
  }
  Mat_VarWrite(file, trials, MAT_COMPRESSION_NONE);
  Mat_VarFree(trials);
  Mat_Close(file);
  const auto tables = read_foreign(path, {});
  ASSERT_EQ(tables.size(), 2U);
  EXPECT_EQ(tables[1].name, "trial(2)");
  EXPECT_THAT(tables[1].names, ElementsAre("t", "F.1", "F.2"));
  EXPECT_THAT(tables[1].columns[2], ElementsAre(10, 11, 12));
}

TEST(ImportArrays, WhatMatlabHoldsInsteadIsSaid) {
  const auto path = array_file("cube.mat");
  mat_t* const file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
  std::array<std::size_t, 3> cube{2, 2, 3};
  std::array<double, 12> values{};
  matvar_t* const v = Mat_VarCreate("taxels", MAT_C_DOUBLE, MAT_T_DOUBLE, 3, cube.data(), values.data(), 0);
  Mat_VarWrite(file, v, MAT_COMPRESSION_NONE);
  Mat_VarFree(v);
  Mat_Close(file);
  EXPECT_THAT(array_refusal(path), HasSubstr("it holds taxels (an array of 2 x 2 x 3, no columns of samples)"));
}

TEST(ImportArrays, FilesThatAreNotReadSayWhatTheyAre) {
  for (const auto& [bytes, what] :
       {std::pair{std::string("ARROW1____"), "an Arrow (Feather) file"},
        {std::string("PAR1____"), "a Parquet file"},
        {std::string("version https://git-lfs.github.com/spec/v1\noid sha256:4d7\n"), "Git LFS"},
        {std::string("{\"t\": 0.5, \"fz\": 2}\n"), "is JSON"},
        {std::string("<html><table>"), "is XML or HTML"},
        {std::string("\x1f\x8b____"), "compressed (gzip)"}}) {
    const auto path = array_file("some.bin");
    write_file(path, bytes);
    EXPECT_THAT(array_refusal(path), HasSubstr(what));
  }
}

}  // namespace
}  // namespace touchstone::importing
