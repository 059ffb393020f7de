// MATLAB files through matio: v4, v5 (also compressed) and v7.3 (HDF5). Real numeric arrays and the fields of plain
// structs become columns; arrays of one length make one table.
#include <fmt/format.h>
#include <matio.h>

#include <algorithm>
#include <map>
#include <memory>

#include "harness/base/error.h"
#include "harness/importing/import_table.h"

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
  explicit Collector(std::string source, std::string format) : source_(std::move(source)), format_(std::move(format)) {}

  void add(matvar_t& v, const std::string& name) {
    if (v.class_type == MAT_C_STRUCT && v.data != nullptr && v.rank == 2 && v.dims[0] * v.dims[1] == 1) {
      const unsigned fields = Mat_VarGetNumberOfFields(&v);
      char* const* const names = Mat_VarGetStructFieldnames(&v);
      for (unsigned f = 0; f < fields; ++f) {
        matvar_t* const field = Mat_VarGetStructFieldByIndex(&v, f, 0);
        if (field != nullptr) add(*field, name + "." + names[f]);
      }
      return;
    }
    if (!numeric(v) || v.dims[0] * v.dims[1] < 2) {
      left_out_ += (left_out_.empty() ? "" : ", ") + name;
      return;
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
  std::map<std::size_t, ImportTable> tables_;
};

}  // namespace

std::vector<ImportTable> read_mat_file(const std::filesystem::path& path) {
  Mat_LogInitFunc("touchstone", swallow);
  const std::unique_ptr<mat_t, MatClose> file(Mat_Open(path.c_str(), MAT_ACC_RDONLY));
  if (!file) throw BadData(fmt::format("{}: cannot be read as a MATLAB file; is it complete?", path.string()));
  const char* const version = Mat_GetVersion(file.get()) == MAT_FT_MAT73  ? "v7.3"
                              : Mat_GetVersion(file.get()) == MAT_FT_MAT5 ? "v5"
                                                                          : "v4";
  Collector collector(path.string(), fmt::format("MATLAB {}", version));
  for (;;) {
    const std::unique_ptr<matvar_t, VariableFree> variable(Mat_VarReadNext(file.get()));
    if (!variable) break;
    collector.add(*variable, variable->name != nullptr ? variable->name : "");
  }
  return collector.finish();
}

}  // namespace touchstone::importing
