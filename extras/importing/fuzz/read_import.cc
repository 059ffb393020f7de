#include "fuzz/read_import.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "guess_map.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "import_file.h"

namespace touchstone::importing::fuzz {
namespace {

// A file of this process, in memory if the system has such a place: fuzzers write thousands a second.
class ScratchFile {
 public:
  ScratchFile(const std::string& name, std::string_view bytes) {
    const std::filesystem::path memory = "/dev/shm";
    const auto folder = std::filesystem::exists(memory) ? memory : std::filesystem::temp_directory_path();
    path_ = folder / fmt::format("touchstone-fuzz-import-{}-{}", ::getpid(), name);
    std::FILE* const out = std::fopen(path_.c_str(), "wb");
    const bool written = out != nullptr && std::fwrite(bytes.data(), 1, bytes.size(), out) == bytes.size();
    if (!written || std::fclose(out) != 0) std::abort();
  }
  ~ScratchFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

void check(bool holds) {
  if (!holds) std::abort();
}

// What every reader promises of the tables that it gives out.
void check_tables(const std::vector<ImportTable>& tables) {
  check(!tables.empty());
  for (const ImportTable& table : tables) {
    check(table.names.size() == table.columns.size());
    for (const auto& column : table.columns) check(column.size() == table.rows());
  }
}

// And of what a map makes of one: whole columns, nothing missing.
void check_imported(const Imported& imported) {
  check(imported.names.size() == imported.columns.size() && !imported.columns.empty());
  for (const auto& column : imported.columns) {
    check(column.size() == imported.columns.front().size());
    for (const double value : column) check(std::isfinite(value));
  }
}

}  // namespace

void read_import(const std::uint8_t* data, std::size_t size, const std::string& extension) {
  const ScratchFile file("file" + extension, text_of(data, size));
  try {
    check_tables(read_foreign(file.path(), {}));
    check(!guess_map(file.path()).json.empty());
  } catch (const BadData&) {
  }
}

void read_map(const std::uint8_t* data, std::size_t size) {
  const ScratchFile map("map.json", text_of(data, size));
  const ScratchFile table("table.csv", "t,x,y,z,fx,fy,fz,q\n0,1,2,3,4,5,6,1\n0.1,1,2,3,4,5,6,1\n0.2,1,2,3,4,5,6,1\n");
  try {
    check_imported(import_file(table.path(), load_import_map(map.path())));
  } catch (const BadData&) {
  }
}

}  // namespace touchstone::importing::fuzz
