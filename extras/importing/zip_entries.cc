#include "zip_entries.h"

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "harness/base/error.h"

namespace touchstone::importing {

void for_each_zip_entry(const std::filesystem::path& path, std::uintmax_t most_bytes,
                        const std::function<bool(const std::string&)>& wanted,
                        const std::function<void(const std::string&, std::string)>& use) {
  const std::unique_ptr<archive, int (*)(archive*)> in(archive_read_new(), archive_read_free);
  archive_read_support_format_zip(in.get());
  constexpr std::size_t block = 65536;
  if (archive_read_open_filename(in.get(), path.c_str(), block) != ARCHIVE_OK) {
    throw BadData(fmt::format("{}: cannot be read as a zip archive; is it complete?", path.string()));
  }
  archive_entry* entry = nullptr;
  std::uintmax_t total = 0;
  int status = ARCHIVE_OK;
  while ((status = archive_read_next_header(in.get(), &entry)) == ARCHIVE_OK) {
    const std::string name = archive_entry_pathname(entry) != nullptr ? archive_entry_pathname(entry) : "";
    if (!wanted(name)) continue;
    std::string bytes;
    // By pieces: a small file may unpack to a large one.
    constexpr std::size_t piece = std::size_t{1} << 20;
    for (la_ssize_t got = 1; got > 0;) {
      const std::size_t before = bytes.size();
      bytes.resize(before + piece);
      got = archive_read_data(in.get(), bytes.data() + before, piece);
      bytes.resize(before + static_cast<std::size_t>(std::max<la_ssize_t>(got, 0)));
      if (got < 0) {
        throw BadData(fmt::format("{}: {} in it does not unpack: the file is damaged", path.string(), name));
      }
      total += static_cast<std::uintmax_t>(got);
      if (total > most_bytes)
        throw BadData(fmt::format("{}: unpacks to more than {} bytes", path.string(), most_bytes));
    }
    use(name, std::move(bytes));
  }
  if (status != ARCHIVE_EOF) {
    throw BadData(fmt::format("{}: the zip archive does not end: was it cut short?", path.string()));
  }
}

}  // namespace touchstone::importing
