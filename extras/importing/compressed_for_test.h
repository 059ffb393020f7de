// For tests: bytes as a writer of bags compresses them, by libarchive.
#pragma once

#include <archive.h>
#include <archive_entry.h>

#include <string>

namespace touchstone::importing {

// `filter`: "bzip2", "lz4" or "zstd".
inline std::string compressed(const std::string& bytes, const std::string& filter) {
  std::string out(bytes.size() + 4096, '\0');
  std::size_t used = 0;
  archive* const a = archive_write_new();
  archive_write_set_format_raw(a);
  archive_write_add_filter_by_name(a, filter.c_str());
  archive_write_set_bytes_in_last_block(a, 1);
  archive_write_open_memory(a, out.data(), out.size(), &used);
  archive_entry* const entry = archive_entry_new();
  archive_entry_set_filetype(entry, AE_IFREG);
  archive_write_header(a, entry);
  archive_write_data(a, bytes.data(), bytes.size());
  archive_entry_free(entry);
  archive_write_close(a);
  archive_write_free(a);
  return out.substr(0, used);
}

}  // namespace touchstone::importing
