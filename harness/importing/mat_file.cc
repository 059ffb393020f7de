// MATLAB files through matio: v4, v5 (also compressed) and v7.3 (HDF5). Real numeric arrays and the fields of plain
// structs become columns; arrays of one length make one table.
#include <fmt/format.h>
#include <matio.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/importing/import_table.h"
#include "harness/importing/mat_extent.h"

namespace touchstone::importing {
namespace {

// matio prints what it does not like; the messages here say it instead.
void swallow(int /*level*/, char* /*message*/) {}

struct MatClose {
  void operator()(mat_t* file) const { Mat_Close(file); }
};
struct VariableFree {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};

double element(const matvar_t& v, std::size_t i) {
  switch (v.data_type) {
    case MAT_T_DOUBLE:
      return static_cast<const double*>(v.data)[i];
    case MAT_T_SINGLE:
      return static_cast<const float*>(v.data)[i];
    case MAT_T_INT8:
      return static_cast<const mat_int8_t*>(v.data)[i];
    case MAT_T_UINT8:
      return static_cast<const mat_uint8_t*>(v.data)[i];
    case MAT_T_INT16:
      return static_cast<const mat_int16_t*>(v.data)[i];
    case MAT_T_UINT16:
      return static_cast<const mat_uint16_t*>(v.data)[i];
    case MAT_T_INT32:
      return static_cast<const mat_int32_t*>(v.data)[i];
    case MAT_T_UINT32:
      return static_cast<const mat_uint32_t*>(v.data)[i];
    case MAT_T_INT64:
      return static_cast<double>(static_cast<const mat_int64_t*>(v.data)[i]);
    case MAT_T_UINT64:
      return static_cast<double>(static_cast<const mat_uint64_t*>(v.data)[i]);
    default:
      return 0.0;
  }
}

bool numeric(const matvar_t& v) {
  switch (v.class_type) {
    case MAT_C_DOUBLE:
    case MAT_C_SINGLE:
    case MAT_C_INT8:
    case MAT_C_UINT8:
    case MAT_C_INT16:
    case MAT_C_UINT16:
    case MAT_C_INT32:
    case MAT_C_UINT32:
    case MAT_C_INT64:
    case MAT_C_UINT64:
      return v.data != nullptr && v.rank == 2 && v.isComplex == 0;
    default:
      return false;
  }
}

class Collector {
 public:
  Collector(std::string source, std::string format, std::uintmax_t file_bytes)
      : source_(std::move(source)), format_(std::move(format)), file_bytes_(file_bytes) {}

  void add(matvar_t& v, const std::string& name) {
    if (v.class_type == MAT_C_STRUCT && v.data != nullptr && v.rank == 2 && v.dims[0] == 1 && v.dims[1] == 1) {
      const unsigned fields = Mat_VarGetNumberOfFields(&v);
      char* const* const names = Mat_VarGetStructFieldnames(&v);
      for (unsigned f = 0; f < fields; ++f) {
        matvar_t* const field = Mat_VarGetStructFieldByIndex(&v, f, 0);
        if (field != nullptr) add(*field, name + "." + names[f]);
      }
      return;
    }
    if (!numeric(v) || v.dims[0] == 0 || v.dims[1] == 0 || (v.dims[0] == 1 && v.dims[1] == 1)) {
      left_out_ += (left_out_.empty() ? "" : ", ") + name;
      return;
    }
    // Damaged dimensions must not be believed: the numbers read are fewer, and deflate packs at most 1032 bytes in one.
    constexpr std::size_t most_packed = 1032;
    const std::size_t most_elements = std::min<std::size_t>(
        v.data_size > 0 ? v.nbytes / static_cast<std::size_t>(v.data_size) : 0, most_packed * file_bytes_);
    if (v.dims[0] > most_elements / v.dims[1]) {
      throw BadData(
          fmt::format("{}: variable {} says that it has {} x {} numbers, more than the file holds: it is damaged",
                      source_, name, v.dims[0], v.dims[1]));
    }
    // Samples run along the longer side; one row of numbers is one column.
    const std::size_t rows = v.dims[0], columns = v.dims[1];
    const bool along_rows = rows >= columns;
    const std::size_t samples = along_rows ? rows : columns, width = along_rows ? columns : rows;
    ImportTable& table = tables_[samples];
    for (std::size_t c = 0; c < width; ++c) {
      std::vector<double> values(samples);
      for (std::size_t i = 0; i < samples; ++i) values[i] = element(v, along_rows ? c * rows + i : i * rows + c);
      table.names.push_back(width == 1 ? name : fmt::format("{}.{}", name, c + 1));
      table.columns.push_back(std::move(values));
    }
  }

  std::vector<ImportTable> finish() {
    std::vector<ImportTable> all;
    for (auto& [samples, table] : tables_) {
      table.name = fmt::format("{}", samples);
      table.source = source_;
      table.format = format_;
      table.names_from_file = true;
      if (!left_out_.empty()) table.notes.push_back(fmt::format("{}: not numeric arrays: {}", source_, left_out_));
      all.push_back(std::move(table));
    }
    // The longest first: that one is the recording, more often than not.
    std::ranges::reverse(all);
    if (all.empty()) {
      throw BadData(
          fmt::format("{}: holds no numeric arrays{}", source_, left_out_.empty() ? "" : "; it holds " + left_out_));
    }
    return all;
  }

 private:
  std::string source_, format_, left_out_;
  std::uintmax_t file_bytes_;
  std::map<std::size_t, ImportTable> tables_;
};

// How many variables a file of level 5 or 4 must hold; none for level 7.3, which is HDF5.
std::optional<std::size_t> declared_variables(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  // Version 0x0100 in the order of the bytes that follow it: level 5. Level 7.3 has 0x0200 and is HDF5.
  constexpr std::size_t version_at = 124;
  const bool level5 = bytes.size() < 128 ? bytes.starts_with("MATLAB 5.0")
                                         : bytes.substr(version_at, 4) == std::string("\0\1IM", 4) ||
                                               bytes.substr(version_at, 4) == std::string("\1\0MI", 4);
  if (!level5) {
    // HDF5, perhaps behind a text of MATLAB.
    if (bytes.starts_with("MATLAB") || bytes.starts_with("\x89HDF")) return std::nullopt;
    return count_mat4_matrices(bytes, path.string());
  }
  return count_mat5_elements(bytes, path.string());
}

}  // namespace

std::vector<ImportTable> read_mat_file(const std::filesystem::path& path) {
  Mat_LogInitFunc("touchstone", swallow);
  const std::optional<std::size_t> variables = declared_variables(path);
  const std::unique_ptr<mat_t, MatClose> file(Mat_Open(path.c_str(), MAT_ACC_RDONLY));
  if (!file) throw BadData(fmt::format("{}: cannot be read as a MATLAB file; is it complete?", path.string()));
  const char* const version = Mat_GetVersion(file.get()) == MAT_FT_MAT73  ? "v7.3"
                              : Mat_GetVersion(file.get()) == MAT_FT_MAT5 ? "v5"
                                                                          : "v4";
  std::size_t read = 0;
  Collector collector(path.string(), fmt::format("MATLAB {}", version), std::filesystem::file_size(path));
  for (;;) {
    const std::unique_ptr<matvar_t, VariableFree> variable(Mat_VarReadNext(file.get()));
    if (!variable) break;
    ++read;
    collector.add(*variable, variable->name != nullptr ? variable->name : "");
  }
  if (variables && read < *variables) {
    throw BadData(fmt::format(
        "{}: variable {} of {} cannot be read: the file is damaged, or holds what is no plain array; save the "
        "arrays anew: save('plain.mat', 't', 'force')",
        path.string(), read + 1, *variables));
  }
  return collector.finish();
}

}  // namespace touchstone::importing
