// Arrays of a file (MATLAB, HDF5, NumPy) as tables: an array of N x k is k columns of N samples, which run along the
// longer side; arrays of one group and one length make a table.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "import_table.h"

namespace touchstone::importing {

class ArrayTables {
 public:
  ArrayTables(std::string source, std::string format) : source_(std::move(source)), format_(std::move(format)) {}

  // `at(row, column)`. `unit`: as the file states it, or empty. Of N x 1 the column has the name alone, else .1, .2,
  // ... behind it. Single numbers, and arrays with both sides long, are left out with that reason.
  void add(const std::string& group, const std::string& name, const std::string& unit, std::size_t rows,
           std::size_t columns, const std::function<double(std::size_t, std::size_t)>& at);
  void leave_out(const std::string& name, const std::string& why);
  // The longest first: that one is the recording, more often than not. Throws BadData where there is none, with what
  // the file holds instead.
  std::vector<ImportTable> finish();

 private:
  std::string source_, format_, left_out_;
  std::map<std::pair<std::size_t, std::string>, ImportTable> tables_;  // by length and group
};

}  // namespace touchstone::importing
