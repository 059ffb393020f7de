#include "harness/report/page_markdown.h"

#include <fmt/format.h>

#include <map>
#include <variant>

namespace touchstone::report {
namespace {

// A cell may hold neither a bar nor a line's end; what would be emphasis or a tag stays text.
std::string cell_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\n') {
      out += ' ';
      continue;
    }
    if (c == '|' || c == '\\' || c == '*' || c == '_' || c == '<' || c == '`') out += '\\';
    out += c;
  }
  return out;
}

bool is_number_column(const Table& table, std::size_t column) {
  for (const auto& row : table.rows) {
    if (column < row.cells.size() && row.cells[column].number) return true;
  }
  return false;
}

std::string table_text(const Table& table) {
  std::string out = "|";
  for (const auto& name : table.columns) out += fmt::format(" {} |", cell_text(name));
  out += "\n|";
  for (std::size_t c = 0; c < table.columns.size(); ++c) out += is_number_column(table, c) ? "---:|" : "---|";
  out += "\n";
  for (const auto& row : table.rows) {
    out += "|";
    for (std::size_t c = 0; c < table.columns.size(); ++c)
      out += fmt::format(" {} |", c < row.cells.size() ? cell_text(row.cells[c].text) : "");
    out += "\n";
  }
  return out;
}

}  // namespace

std::string tables_to_markdown(const Page& page) {
  std::string out;
  std::map<std::string, int> used;
  for (const auto& section : page.sections) {
    for (const auto& block : section.blocks) {
      const auto* const table = std::get_if<Table>(&block);
      if (table == nullptr) continue;
      std::string heading = table->caption.empty() ? section.title : table->caption;
      if (const int times = ++used[heading]; times > 1) heading += fmt::format(" ({})", times);
      out += fmt::format("{}### {}\n\n{}", out.empty() ? "" : "\n", heading, table_text(*table));
    }
  }
  return out;
}

}  // namespace touchstone::report
