// MATLAB files through matio: v4, v5 (also compressed) and v7.3 (HDF5). Real numeric arrays and the fields of plain
// structs become columns; arrays of one length make one table.
#include <fmt/format.h>
#include <matio.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>

#include "array_tables.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "import_table.h"
#include "mat_extent.h"

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
      return v.data != nullptr && v.rank >= 2 && v.isComplex == 0;
    default:
      return false;
  }
}

const char* class_of(const matvar_t& v) {
  switch (v.class_type) {
    case MAT_C_CELL:
      return "a cell array";
    case MAT_C_STRUCT:
      return "a struct array of more elements than are read";
    case MAT_C_CHAR:
      return "text";
    case MAT_C_SPARSE:
      return "a sparse matrix";
    case MAT_C_OBJECT:
    case MAT_C_OPAQUE:
      return "an object (a table or timetable is one): save its columns, or struct(T)";
    case MAT_C_FUNCTION:
      return "a function";
    default:
      return v.isComplex != 0 ? "complex numbers" : "no numbers";
  }
}

class Collector {
 public:
  Collector(std::string source, const std::string& format, std::uintmax_t file_bytes)
      : source_(std::move(source)), file_bytes_(file_bytes), tables_(source_, format) {}

  // `group`: of the element of a struct array, which is a table of its own; `name`: within it.
  void add(matvar_t& v, const std::string& group, const std::string& name) {
    constexpr std::size_t most_elements = 1000;
    const std::string full = group.empty() ? name : name.empty() ? group : group + "." + name;
    if (v.class_type == MAT_C_STRUCT && v.data != nullptr && v.rank == 2 && v.dims[0] > 0 && v.dims[1] > 0 &&
        v.dims[0] <= most_elements / v.dims[1]) {
      return add_struct(v, group, name);
    }
    if (numeric(v) && v.rank > 2) {
      std::string sides;
      for (int k = 0; k < v.rank; ++k) sides += fmt::format("{}{}", k > 0 ? " x " : "", v.dims[k]);
      return tables_.leave_out(full, fmt::format("an array of {}, no columns of samples", sides));
    }
    if (!numeric(v)) return tables_.leave_out(full, class_of(v));
    const std::size_t rows = v.dims[0], columns = v.dims[1];
    // Damaged dimensions must not be believed: the numbers read are fewer.
    const std::size_t most_numbers = std::min<std::size_t>(
        v.data_size > 0 ? v.nbytes / static_cast<std::size_t>(v.data_size) : 0, most_packed * file_bytes_);
    if (columns > 0 && rows > most_numbers / columns) {
      throw BadData(
          fmt::format("{}: variable {} says that it has {} x {} numbers, more than the file holds: it is damaged",
                      source_, full, rows, columns));
    }
    tables_.add(group, name, "", rows, columns, [&](std::size_t i, std::size_t c) { return element(v, c * rows + i); });
  }

  std::vector<ImportTable> finish() { return tables_.finish(); }

 private:
  void add_struct(matvar_t& v, const std::string& group, const std::string& name) {
    const unsigned fields = Mat_VarGetNumberOfFields(&v);
    char* const* const names = Mat_VarGetStructFieldnames(&v);
    const std::size_t elements = v.dims[0] * v.dims[1];
    for (std::size_t e = 0; e < elements; ++e) {
      const std::string outer = group.empty() ? name : group + "." + name;
      const std::string of = elements > 1 ? fmt::format("{}({})", outer, e + 1) : group;
      for (unsigned f = 0; f < fields; ++f) {
        matvar_t* const field = Mat_VarGetStructFieldByIndex(&v, f, e);
        if (field != nullptr) add(*field, of, elements > 1 || name.empty() ? names[f] : name + "." + names[f]);
      }
    }
  }

  std::string source_;
  std::uintmax_t file_bytes_;
  ArrayTables tables_;
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
    collector.add(*variable, "", variable->name != nullptr ? variable->name : "");
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
