// Files that are not read, by their first bytes: what each is and how its numbers get out of it. The marks are those of
// the formats' published descriptions.
#include <fmt/format.h>

#include <array>

#include "harness/base/error.h"
#include "import_table.h"

namespace touchstone::importing {
namespace {

struct FileKind {
  std::string_view mark;
  const char* what;
  const char* to_do;
};

constexpr auto file_kinds = std::to_array<FileKind>({
    {"PAR1", "a Parquet file",
     "write it as CSV: python3 -c \"import pandas; pandas.read_parquet('FILE').to_csv('table.csv')\""},
    {"ARROW1", "an Arrow (Feather) file",
     "write it as CSV: python3 -c \"import pandas; pandas.read_feather('FILE').to_csv('table.csv')\""},
    {"TDSh", "the index of a TDMS file", "give the .tdms file beside it"},
    {"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "an old Office file (.xls, or a tester's own)",
     "save the sheet, or export the test, as CSV"},
    {"ULog\x01\x12\x35", "a ULog file (PX4)", "write it as CSV: ulog2csv FILE"},
    {"BZh", "compressed (bzip2)", "unpack it first: bunzip2 -k FILE"},
    {"\xfd"
     "7zXZ",
     "compressed (xz)", "unpack it first: unxz -k FILE"},
    {"\x28\xb5\x2f\xfd", "compressed (zstd)", "unpack it first: unzstd FILE"},
    {"7z\xbc\xaf\x27\x1c", "a 7-Zip archive", "unpack it first"},
    {"Rar!", "a RAR archive", "unpack it first"},
    {"\x1f\x8b", "compressed (gzip)", "unpack it first: gunzip -k FILE"},
    {"%PDF", "a PDF document", "export the numbers as CSV"},
    {"\x89PNG", "a picture", "a table of numbers was expected"},
    {"Obj\x01", "an Avro file", "write it as CSV"},
    {"CDF\x01", "a netCDF file of version 3", "write it as netCDF 4, which is HDF5: nccopy -k nc4 FILE FILE.nc4"},
    {"CDF\x02", "a netCDF file of version 3", "write it as netCDF 4, which is HDF5: nccopy -k nc4 FILE FILE.nc4"},
    {"\x80\x04\x95", "a Python pickle", "save the arrays with numpy.savez, or the table with to_csv"},
    {"RDX", "an R data file", "write the table as CSV: write.csv"},
    {"%YAML", "a YAML file", "the description of a ROS 2 bag is one: its .mcap or .db3 file is what can be imported"},
    {"{", "JSON",
     "write the samples as a table: python3 -c \"import pandas; pandas.read_json('FILE', "
     "lines=True).to_csv('table.csv')\""},
    {"[{", "JSON",
     "write the samples as a table: python3 -c \"import pandas; pandas.read_json('FILE').to_csv('table.csv')\""},
    {"<", "XML or HTML", "save or export the table as CSV"},
    {"version https://git-lfs.github.com/", "a pointer of Git LFS, not the file itself", "fetch it: git lfs pull"},
});

}  // namespace

void refuse_known_kind(const std::filesystem::path& path, std::string_view head) {
  for (const FileKind& kind : file_kinds) {
    if (!head.starts_with(kind.mark)) continue;
    std::string to_do = kind.to_do;
    if (const auto at = to_do.find("FILE"); at != std::string::npos) to_do.replace(at, 4, path.filename().string());
    throw BadData(fmt::format("{}: is {}, which is not read: {}", path.string(), kind.what, to_do));
  }
  if (path.extension() == ".ibw" && head.size() > 1 && (head[0] == 0) != (head[1] == 0)) {  // a version of 2 or 5
    throw BadData(
        fmt::format("{}: is an Igor binary wave, which is not read: save the waves as delimited text (Data, "
                    "Save Waves)",
                    path.string()));
  }
  // The second byte of a C3D file; its first points to the parameters, which are near.
  if (path.extension() == ".c3d" && head.size() > 1 && head[1] == '\x50') {
    throw BadData(fmt::format(
        "{}: is a C3D file (motion capture), which is not read: export the points and forces as CSV", path.string()));
  }
}

}  // namespace touchstone::importing
