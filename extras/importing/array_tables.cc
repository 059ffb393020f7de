#include "array_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "harness/base/error.h"

namespace touchstone::importing {

void ArrayTables::leave_out(const std::string& name, const std::string& why) {
  constexpr std::size_t longest = 2000;
  if (left_out_.size() > longest) return;
  left_out_ += fmt::format("{}{} ({})", left_out_.empty() ? "" : ", ", name, why);
}

void ArrayTables::add(const std::string& group, const std::string& name, const std::string& unit, std::size_t rows,
                      std::size_t columns, const std::function<double(std::size_t, std::size_t)>& at) {
  constexpr std::size_t widest = 64;
  const bool along_rows = rows >= columns;
  const std::size_t samples = along_rows ? rows : columns, width = along_rows ? columns : rows;
  const std::string full = group.empty() ? name : group + ":" + name;
  if (samples == 0 || width == 0) return leave_out(full, "empty");
  if (samples == 1) return leave_out(full, "one number");
  if (width > widest) return leave_out(full, fmt::format("{} x {}, no columns of samples", rows, columns));
  ImportTable& table = tables_[{samples, group}];
  for (std::size_t c = 0; c < width; ++c) {
    std::vector<double> values(samples);
    for (std::size_t i = 0; i < samples; ++i) values[i] = along_rows ? at(i, c) : at(c, i);
    table.names.push_back(width == 1 ? name : fmt::format("{}.{}", name, c + 1));
    table.described.push_back(unit.empty() ? "" : fmt::format("{} ({})", table.names.back(), unit));
    table.columns.push_back(std::move(values));
  }
}

std::vector<ImportTable> ArrayTables::finish() {
  std::vector<ImportTable> all;
  for (auto& [key, table] : tables_) {
    const std::size_t samples = key.first;
    const std::string& group = key.second;
    const bool only = std::ranges::count_if(tables_, [&](const auto& t) { return t.first.second == group; }) == 1;
    table.name = group.empty() ? fmt::format("{}", samples) : only ? group : fmt::format("{} ({})", group, samples);
    table.source = source_;
    table.format = format_;
    table.names_from_file = true;
    if (!left_out_.empty()) table.notes.push_back(fmt::format("{}: left out: {}", source_, left_out_));
    all.push_back(std::move(table));
  }
  std::ranges::stable_sort(all, std::greater<>(), &ImportTable::rows);
  if (all.empty()) {
    throw BadData(fmt::format("{}: holds no array of N samples, or of N x k for k columns of them; {}", source_,
                              left_out_.empty() ? "it is empty" : "it holds " + left_out_));
  }
  return all;
}

}  // namespace touchstone::importing
