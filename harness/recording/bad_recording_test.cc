// Files that cannot be used, each with what its message must say. Every message names the file; none crashes, and
// nothing is printed on the side.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <filesystem>
#include <string>
#include <vector>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/recording/hdf5_handle.h"
#include "harness/recording/recording_file.h"

namespace touchstone::recording {
namespace {

using ::testing::HasSubstr;

std::filesystem::path folder() {
  auto path = std::filesystem::path(::testing::TempDir()) / "touchstone-bad-recording";
  ensure_writable_folder(path);
  return path;
}

std::string refusal_of(const std::filesystem::path& file, bool rendered = false) {
  ::testing::internal::CaptureStderr();
  std::string message = "no error";
  try {
    if (rendered) {
      load_rendered(file);
    } else {
      load_recording(file);
    }
  } catch (const BadData& error) {
    message = error.what();
    EXPECT_THAT(message, HasSubstr(file.string()));
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  return message;
}

struct BadCsv {
  std::string name;
  std::string bytes;
  std::vector<std::string> says;
  std::size_t times = 1;  // that the bytes stand in the file: every process of this program copies them several times
};

void PrintTo(const BadCsv& bad, std::ostream* out) { *out << bad.name; }

const std::string head = "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N\n";
const std::string first = "0,0,0,0,0,0,1\n";

std::vector<BadCsv> bad_csvs() {
  using namespace std::string_literals;
  return {
      {"empty", "", {"is empty", "header line"}},
      {"header_only", head, {"holds no samples", "at least two"}},
      {"one_sample", head + first, {"holds one sample", "at least two"}},
      {"blank_header", "\n" + first, {"line 1 is blank", "t_s,x_m,y_m,z_m", "touchstone import"}},
      {"no_header",
       first + "1,0,0,0,0,0,1\n",
       {"has no header", "line 1 holds numbers, 7 of them", "t_s,x_m,y_m,z_m", "touchstone import", "--guess"}},
      {"comment_hash", "# a logger's remark\n" + head + first, {"line 1 is a comment", "begin with #", "--guess"}},
      {"comment_percent", "%t [s], x [mm]\n" + first, {"line 1 is a comment", "begin with %", "--guess"}},
      {"comment_slashes", "// by hand\n" + head + first, {"line 1 is a comment", "begin with //"}},
      {"no_force", "t_s,x_m,y_m,z_m\n0,0,0,0\n1,0,0,0\n", {"fx_N, fy_N, fz_N", "missing", "the file has t_s, x_m"}},
      {"no_time", "x_m,y_m,z_m,fx_N,fy_N,fz_N\n", {"t_s", "missing"}},
      {"half_a_group", "t_s,x_m,y_m,z_m,fx_N,fz_N\n", {"line 1, column 5", "'fx_N' is there but fy is missing"}},
      {"two_missing", "t_s,x_m,y_m,z_m,fx_N\n", {"fy, fz are missing"}},
      {"unknown_name",
       "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N,grip_N\n",
       {"column 8", "unknown column 'grip_N'", "known columns: t_s"}},
      {"near_miss", "T_S,x_m,y_m,z_m\n", {"column 1", "'T_S'", "did you mean t_s?"}},
      {"time_without_unit", "time,x_m,y_m,z_m\n", {"did you mean t_s?"}},
      {"unknown_unit", "t_s,x_inch,y_inch,z_inch,fx_N,fy_N,fz_N\n", {"column 2", "unknown unit 'inch'", "m, cm, mm"}},
      {"force_in_pounds", "t_s,x_m,y_m,z_m,fx_lbf,fy_N,fz_N\n", {"column 5", "'lbf'", "N, mN, kN"}},
      {"no_unit", "t,x_m,y_m,z_m,fx_N,fy_N,fz_N\n", {"column 't' has no unit", "t_s"}},
      {"unit_on_a_quaternion", "t_s,x_m,y_m,z_m,qw_1,qx,qy,qz\n", {"qw carries no unit"}},
      {"mixed_units", "t_s,x_m,y_mm,z_m,fx_N,fy_N,fz_N\n", {"'x_m' and 'y_mm'", "different units"}},
      {"twice", "t_s,x_m,y_m,z_m,x_mm\n", {"column 5", "same quantity as column 2 ('x_m')"}},
      {"unnamed_column", "t_s,x_m,y_m,z_m,\n", {"column 5", "has no name"}},
      {"nan", head + first + "1,0,nan,0,0,0,1\n", {"line 3, column 3 (y_m)", "not a finite number"}},
      {"infinity", head + first + "1,0,0,0,-inf,0,1\n", {"line 3, column 5 (fx_N)", "-inf is not a finite number"}},
      {"nan_in_the_time", head + first + "nan,0,0,0,0,0,1\n", {"line 3, column 1 (t_s)"}},
      {"first_of_two_bad_rows", head + first + "1,0,0,0,0,0,inf\n2,nan,0,0,0,0,1\n", {"line 3, column 7"}},
      {"beyond_double", head + first + "1,0,0,0,1e999,0,1\n", {"line 3, column 5", "'1e999'", "beyond what a double"}},
      {"infinite_in_metres",
       "t_s,x_km,y_km,z_km,fx_N,fy_N,fz_N\n0,1e308,0,0,0,0,1\n",
       {"line 2, column 2", "out of range"}},
      {"text", head + first + "1,0,abc,0,0,0,1\n", {"line 3, column 3 (y_m)", "'abc' is not a number"}},
      {"number_with_unit", head + first + "1,0,0,0,0,0,1N\n", {"line 3, column 7", "'1N' is not a number"}},
      {"missing_value", head + first + "1,0,,0,0,0,1\n", {"line 3, column 3", "value is missing"}},
      {"short_row", head + first + "1,0,0,0\n", {"line 3 has 4 values where the header names 7"}},
      {"long_row", head + first + "1,0,0,0,0,0,1,9\n", {"line 3 has 8 values"}},
      {"cut_row", head + first + "1,0,0,0,0,", {"line 3 has 6 values", "was it cut short?"}},
      {"decimal_comma",
       "t_s;x_m;y_m;z_m;fx_N;fy_N;fz_N\n0;0,5;0;0;0;0;1\n",
       {"line 2, column 2", "'0,5'", "decimal point"}},
      {"time_back",
       head + first + "0.5,0,0,0,0,0,1\n0.25,0,0,0,0,0,1\n",
       {"line 4, column 1 (t_s)", "goes back to 0.25 s after 0.5 s in line 3", "sort the samples"}},
      {"time_repeats",
       head + first + first,
       {"line 3, column 1 (t_s)", "repeats that of line 2", "--on-duplicate first"}},
      {"blank_line", head + first + "\n1,0,0,0,0,0,1\n", {"line 3 is blank but line 4 is not"}},
      {"old_mac", "t_s,x_m,y_m,z_m\r0,0,0,0\r1,0,0,0\r", {"bare carriage returns"}},
      {"utf16", "\xff\xfet\0_\0s\0"s, {"UTF-16"}},
      {"binary",
       "\x7f"
       "ELF\x02\x01\x01\0\0\0\0\0\0\n"s,
       {"not text"}},
      {"nul_in_a_row", head + first + "1,0,0\0,0,0,0,1\n"s, {"line 3, column 3", "is not a number"}},
      {"hdf5_named_csv", "\x89HDF\r\n\x1a\n........", {"HDF5 file with the name of a CSV file"}},
      {"one_endless_line", "x", {"line 1 is longer than"}, std::size_t{3} << 20},
      {"quaternion_of_zeros",
       "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N,qw,qx,qy,qz\n0,0,0,0,0,0,0,0,0,0,0\n",
       {"line 2, column 8 (qw)", "length 0;"}},
      {"quaternion_too_long",
       "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N,qw,qx,qy,qz\n0,0,0,0,0,0,0,1,0.1,0,0\n",
       {"length 1.00499"}},
      {"huge_quaternion",
       "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N,qw,qx,qy,qz\n0,0,0,0,0,0,0,1e300,0,0,0\n",
       {"has length inf"}},
  };
}

class BadCsvFile : public ::testing::TestWithParam<BadCsv> {};

TEST_P(BadCsvFile, IsRefusedWithAMessageThatHelps) {
  const auto file = folder() / (GetParam().name + ".csv");
  std::string bytes;
  for (std::size_t i = 0; i < GetParam().times; ++i) bytes += GetParam().bytes;
  write_file(file, bytes);
  const std::string message = refusal_of(file);
  for (const std::string& part : GetParam().says) EXPECT_THAT(message, HasSubstr(part));
}

INSTANTIATE_TEST_SUITE_P(All, BadCsvFile, ::testing::ValuesIn(bad_csvs()),
                         [](const auto& bad) { return bad.param.name; });

TEST(BadRecording, FilesThatAreNotThere) {
  EXPECT_THAT(refusal_of(folder() / "no-such.csv"), HasSubstr("does not exist"));
  EXPECT_THAT(refusal_of(folder() / "no-such.h5"), HasSubstr("does not exist"));
  ensure_writable_folder(folder() / "folder.csv");
  EXPECT_THAT(refusal_of(folder() / "folder.csv"), HasSubstr("is a folder"));
  write_file(folder() / "r.txt", head);
  EXPECT_THAT(refusal_of(folder() / "r.txt"), HasSubstr("name it .csv, .csv.gz, .h5 or .hdf5"));
}

TEST(BadRecording, Rendered) {
  const auto file = folder() / "rendered.csv";
  const std::string columns = "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N,px_m,py_m,pz_m,contact";
  write_file(file, head + first);
  EXPECT_THAT(refusal_of(file, true), HasSubstr("px_m, py_m, pz_m (units: m, cm, mm, um, km) are missing"));
  write_file(file, columns + "\n0,0,0,0,0,0,0,0,0,0,2\n");
  EXPECT_THAT(refusal_of(file, true), HasSubstr("line 2, column 11 (contact): 2 is no contact state; 0 or 1"));
  write_file(file, columns + ",cost_us\n0,0,0,0,0,0,0,0,0,0,1,-3\n");
  EXPECT_THAT(refusal_of(file, true), HasSubstr("line 2, column 12 (cost_us): -3 is out of range"));
}

Recording small() {
  Recording recording;
  for (int i = 0; i < 1000; ++i) {
    recording.motion.t_s.push_back(i * 1e-3);
    recording.motion.p_W_m.emplace_back(i * 1e-6, 1.0 / (i + 1), 0.0);
    recording.f_W_N.emplace_back(0.0, 0.0, 1.0);
  }
  return recording;
}

TEST(BadRecording, GzipCutAnywhereOrDamaged) {
  const auto file = folder() / "r.csv.gz";
  save_recording(file, small());
  const std::string whole = read_file(file);
  for (std::size_t size = 20; size < whole.size(); size += whole.size() / 17) {
    write_file(file, whole.substr(0, size));
    EXPECT_THAT(refusal_of(file), HasSubstr(": ")) << size;
    EXPECT_NE(refusal_of(file), "no error") << size;
  }
  for (std::size_t at = 12; at < whole.size(); at += whole.size() / 23) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    write_file(file, damaged);
    EXPECT_NE(refusal_of(file), "no error") << at;
  }
}

TEST(BadRecording, Hdf5CutAnywhereOrDamaged) {
  const auto file = folder() / "r.h5";
  save_recording(file, small());
  const std::string whole = read_file(file);
  for (std::size_t size = 0; size < whole.size(); size += 1 + whole.size() / 41) {
    write_file(file, whole.substr(0, size));
    EXPECT_THAT(refusal_of(file), HasSubstr("cannot be read as HDF5")) << size;
  }
  write_file(file, whole.substr(0, whole.size() - 1));
  EXPECT_THAT(refusal_of(file), HasSubstr("truncated file"));
  // Every byte is covered by a checksum, or unused: damage is refused or changes nothing.
  const Recording expected = small();
  std::size_t refused = 0;
  std::size_t tried = 0;
  for (std::size_t at = 0; at < whole.size(); at += 1 + whole.size() / 199) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x04);
    write_file(file, damaged);
    ++tried;
    try {
      const Recording read = load_recording(file);
      EXPECT_EQ(read.motion.t_s, expected.motion.t_s) << "byte " << at;
      EXPECT_EQ(read.motion.p_W_m, expected.motion.p_W_m) << "byte " << at;
      EXPECT_EQ(read.f_W_N, expected.f_W_N) << "byte " << at;
    } catch (const BadData&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, tried / 2);
}

// HDF5 files that this project would not write.
class ForeignHdf5 {
 public:
  explicit ForeignHdf5(const std::string& name)
      : path_(folder() / name), file_(H5Fcreate(path_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)) {}
  hid_t id() const { return file_.get(); }
  void add(const std::string& name, const std::vector<double>& values, const char* unit = nullptr) {
    const hsize_t n = values.size();
    const Hdf5Space space(H5Screate_simple(1, &n, nullptr));
    const Hdf5Dataset dataset(
        H5Dcreate2(file_.get(), name.c_str(), H5T_IEEE_F64LE, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Dwrite(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    if (unit != nullptr) hdf5_write_text_attribute(dataset.get(), "unit", unit);
  }
  void add_columns() {
    add("t_s", {0, 1});
    for (const char* name : {"x_mm", "y_mm", "z_mm", "fx_N", "fy_N", "fz_N"}) add(name, {1, 2});
  }
  // Closes the file and tries to read it.
  std::string refusal() {
    file_.close();
    return refusal_of(path_);
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  Hdf5Quiet quiet_;
  std::filesystem::path path_;
  Hdf5File file_;
};

TEST(BadRecording, Hdf5OfAnotherProgramIsReadWithANote) {
  ForeignHdf5 plain("plain.h5");
  plain.add_columns();
  EXPECT_EQ(plain.refusal(), "no error");
  const auto loaded = load_recording(plain.path(), ClockPolicy{});
  EXPECT_EQ(loaded.value.motion.p_W_m[1], Vec3(2e-3, 2e-3, 2e-3));
  EXPECT_THAT(loaded.notes, ::testing::ElementsAre(HasSubstr("has no attribute 'schema'")));
}

TEST(BadRecording, Hdf5OfTheOldFormatCutOrDamagedNeverCrashes) {
  ForeignHdf5 plain("old.h5");
  plain.add_columns();
  EXPECT_EQ(plain.refusal(), "no error");
  const std::string whole = read_file(plain.path());
  for (std::size_t size = 0; size < whole.size(); size += 1 + whole.size() / 23) {
    write_file(plain.path(), whole.substr(0, size));
    EXPECT_THAT(refusal_of(plain.path()), HasSubstr("HDF5")) << size;
  }
  // Without checksums damage may go unnoticed; what is asked for here is that every outcome is an ordinary one.
  for (std::size_t at = 8; at < whole.size(); at += 1 + whole.size() / 41) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0xff);
    write_file(plain.path(), damaged);
    EXPECT_FALSE(refusal_of(plain.path()).empty());
  }
}

TEST(BadRecording, Hdf5OfAnotherLayoutIsRefused) {
  ForeignHdf5 nothing("nothing.h5");
  EXPECT_THAT(nothing.refusal(), HasSubstr("holds no datasets"));
  ForeignHdf5 schema("schema.h5");
  schema.add_columns();
  hdf5_write_text_attribute(schema.id(), "schema", "touchstone-recording/2");
  EXPECT_THAT(schema.refusal(),
              HasSubstr("'schema' is 'touchstone-recording/2'; 'touchstone-recording/1' was expected"));
  ForeignHdf5 unknown("unknown.h5");
  unknown.add_columns();
  unknown.add("grip", {0, 1});
  EXPECT_THAT(unknown.refusal(), HasSubstr("dataset 'grip': unknown column 'grip'"));
  ForeignHdf5 unit("unit.h5");
  unit.add_columns();
  unit.add("qw", {1, 1}, "rad");
  EXPECT_THAT(unit.refusal(), HasSubstr("dataset 'qw' has the attribute unit = 'rad', which its name contradicts"));
  ForeignHdf5 length("length.h5");
  length.add_columns();
  length.add("qw", {1, 1, 1});
  EXPECT_THAT(length.refusal(), HasSubstr("'qw' has 3 values, but 'fx_N' has 2"));
  ForeignHdf5 group("group.h5");
  group.add_columns();
  H5Gclose(H5Gcreate2(group.id(), "run1", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  EXPECT_THAT(group.refusal(), HasSubstr("'run1' is a group"));
  ForeignHdf5 many("many.h5");
  for (int i = 0; i < 100; ++i) many.add(fmt::format("c{}", i), {0});
  EXPECT_THAT(many.refusal(), HasSubstr("more than 64"));
  ForeignHdf5 nan("nan.h5");
  nan.add_columns();
  nan.add("qw", {1, 1});
  nan.add("qx", {0, 0});
  nan.add("qy", {0, std::nan("")});
  nan.add("qz", {0, 0});
  EXPECT_THAT(nan.refusal(), HasSubstr("dataset 'qy', sample 1: nan is not a finite number"));
}

// HDF5 fills in what was never stored: a few kilobytes can declare billions of samples, chunked or not, with one chunk
// written or none.
TEST(BadRecording, Hdf5ThatDeclaresMoreThanItStoresIsRefused) {
  constexpr hsize_t declared = 4'000'000'000;
  for (const bool chunked : {true, false}) {
    for (const bool one_chunk : {true, false}) {
      if (one_chunk && !chunked) continue;
      ForeignHdf5 file(fmt::format("declares-{}-{}.h5", chunked, one_chunk));
      const hsize_t unlimited = H5S_UNLIMITED;
      const Hdf5Space space(H5Screate_simple(1, &declared, chunked ? &unlimited : nullptr));
      const Hdf5Properties properties(H5Pcreate(H5P_DATASET_CREATE));
      constexpr hsize_t rows = 1024;
      if (chunked) {
        H5Pset_chunk(properties.get(), 1, &rows);
        H5Pset_deflate(properties.get(), 9);
      }
      for (const char* const name : {"t_s", "x_m", "y_m", "z_m"}) {
        const Hdf5Dataset dataset(
            H5Dcreate2(file.id(), name, H5T_IEEE_F64LE, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT));
        if (!one_chunk) continue;
        const std::vector<double> zeros(rows, 0.0);
        const hsize_t begin = 0;
        H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, &begin, nullptr, &rows, nullptr);
        const Hdf5Space memory(H5Screate_simple(1, &rows, nullptr));
        H5Dwrite(dataset.get(), H5T_NATIVE_DOUBLE, memory.get(), space.get(), H5P_DEFAULT, zeros.data());
      }
      EXPECT_THAT(file.refusal(), HasSubstr("declares 4000000000 samples")) << chunked << one_chunk;
      EXPECT_LT(std::filesystem::file_size(file.path()), 20000U);
    }
  }
}

// What compresses best of all is read: the same value over and over.
TEST(BadRecording, Hdf5OfEqualValuesIsNotTakenForEmpty) {
  Recording still;
  for (int i = 0; i < 100000; ++i) {
    still.motion.t_s.push_back(0.001 * i);
    still.motion.p_W_m.emplace_back(0.0, 0.0, 0.0);
    still.f_W_N.emplace_back(0.0, 0.0, 0.0);
  }
  const auto file = folder() / "still.h5";
  save_recording(file, still);
  EXPECT_EQ(load_recording(file, ClockPolicy{}).value.motion.t_s.size(), still.motion.t_s.size());
}

TEST(BadRecording, Hdf5ThatLeadsOutOfTheFileIsRefused) {
  ForeignHdf5 soft("soft.h5");
  soft.add_columns();
  H5Lcreate_soft("/t_s", soft.id(), "qw", H5P_DEFAULT, H5P_DEFAULT);
  EXPECT_THAT(soft.refusal(), HasSubstr("'qw' is a soft or external link"));
  ForeignHdf5 external("external.h5");
  external.add_columns();
  H5Lcreate_external("plain.h5", "/t_s", external.id(), "qw", H5P_DEFAULT, H5P_DEFAULT);
  EXPECT_THAT(external.refusal(), HasSubstr("soft or external link"));
  ForeignHdf5 storage("storage.h5");
  const hsize_t n = 2;
  const Hdf5Space space(H5Screate_simple(1, &n, nullptr));
  const Hdf5Properties properties(H5Pcreate(H5P_DATASET_CREATE));
  H5Pset_external(properties.get(), "elsewhere.bin", 0, 16);
  H5Dclose(H5Dcreate2(storage.id(), "qw", H5T_IEEE_F64LE, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT));
  EXPECT_THAT(storage.refusal(), HasSubstr("keeps its values in another file"));
}

TEST(BadRecording, Hdf5OfOtherShapesAndTypesIsRefused) {
  const hsize_t two[2] = {2, 3};
  ForeignHdf5 matrix("matrix.h5");
  const Hdf5Space plane(H5Screate_simple(2, two, nullptr));
  H5Dclose(H5Dcreate2(matrix.id(), "x_m", H5T_IEEE_F64LE, plane.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  EXPECT_THAT(matrix.refusal(), HasSubstr("'x_m' is not one-dimensional"));
  ForeignHdf5 text("text.h5");
  const Hdf5Space line(H5Screate_simple(1, two, nullptr));
  H5Dclose(H5Dcreate2(text.id(), "x_m", H5T_C_S1, line.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  EXPECT_THAT(text.refusal(), HasSubstr("does not hold numbers"));
  // Sizes that were declared but never written would read as zeros, however many.
  ForeignHdf5 vast("vast.h5");
  const hsize_t huge = hsize_t{1} << 50;
  const Hdf5Space space(H5Screate_simple(1, &huge, nullptr));
  const Hdf5Properties chunked(H5Pcreate(H5P_DATASET_CREATE));
  const hsize_t chunk = 1024;
  H5Pset_chunk(chunked.get(), 1, &chunk);
  for (const char* name : {"t_s", "x_m", "y_m", "z_m", "fx_N", "fy_N", "fz_N"}) {
    H5Dclose(H5Dcreate2(vast.id(), name, H5T_IEEE_F64LE, space.get(), H5P_DEFAULT, chunked.get(), H5P_DEFAULT));
  }
  EXPECT_THAT(vast.refusal(), HasSubstr("declares 1125899906842624 samples, but its 0 stored bytes hold at most 0"));
  for (const auto policy : {OnDuplicate::first, OnDuplicate::mean}) {
    EXPECT_THROW(load_recording(vast.path(), {.on_duplicate = policy}), BadData);
  }
}

}  // namespace
}  // namespace touchstone::recording
