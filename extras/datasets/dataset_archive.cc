#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

#include <memory>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/loaded_library.h"
#include "packed_dataset.h"

namespace touchstone::datasets {
namespace {

// libarchive brings nine libraries more: 10 ms of every start, where it was linked.
struct Libarchive {
  static const Libarchive& library() {
    static const Libarchive loaded;
    return loaded;
  }
  decltype(&archive_error_string) error_string = nullptr;
  decltype(&archive_write_new) write_new = nullptr;
  decltype(&archive_write_free) write_free = nullptr;
  decltype(&archive_write_set_format_pax_restricted) write_set_format_pax_restricted = nullptr;
  decltype(&archive_write_add_filter_gzip) write_add_filter_gzip = nullptr;
  decltype(&archive_write_set_filter_option) write_set_filter_option = nullptr;
  decltype(&archive_write_open_filename) write_open_filename = nullptr;
  decltype(&archive_write_header) write_header = nullptr;
  decltype(&archive_write_data) write_data = nullptr;
  decltype(&archive_write_close) write_close = nullptr;
  decltype(&archive_entry_new) entry_new = nullptr;
  decltype(&archive_entry_free) entry_free = nullptr;
  decltype(&archive_entry_set_pathname) entry_set_pathname = nullptr;
  decltype(&archive_entry_set_size) entry_set_size = nullptr;
  decltype(&archive_entry_set_filetype) entry_set_filetype = nullptr;
  decltype(&archive_entry_set_perm) entry_set_perm = nullptr;

 private:
  Libarchive() {
    const LoadedLibrary library("libarchive.so.13", "packs data sets", "libarchive13");
    library.find(error_string, "archive_error_string");
    library.find(write_new, "archive_write_new");
    library.find(write_free, "archive_write_free");
    library.find(write_set_format_pax_restricted, "archive_write_set_format_pax_restricted");
    library.find(write_add_filter_gzip, "archive_write_add_filter_gzip");
    library.find(write_set_filter_option, "archive_write_set_filter_option");
    library.find(write_open_filename, "archive_write_open_filename");
    library.find(write_header, "archive_write_header");
    library.find(write_data, "archive_write_data");
    library.find(write_close, "archive_write_close");
    library.find(entry_new, "archive_entry_new");
    library.find(entry_free, "archive_entry_free");
    library.find(entry_set_pathname, "archive_entry_set_pathname");
    library.find(entry_set_size, "archive_entry_set_size");
    library.find(entry_set_filetype, "archive_entry_set_filetype");
    library.find(entry_set_perm, "archive_entry_set_perm");
  }
};

struct CloseArchive {
  void operator()(archive* a) const noexcept { Libarchive::library().write_free(a); }
  void operator()(archive_entry* e) const noexcept { Libarchive::library().entry_free(e); }
};

}  // namespace

void archive_dataset(const recording::Dataset& dataset, const std::filesystem::path& out) {
  const std::string name = out.filename().string();
  if (!name.ends_with(".tar.gz") && !name.ends_with(".tgz")) {
    throw BadData(fmt::format("{}: data sets are packed as .tar.gz; name it so", out.string()));
  }
  const Libarchive& with = Libarchive::library();
  AtomicFile file(out);
  const std::unique_ptr<archive, CloseArchive> writer(with.write_new());
  const auto check = [&](la_ssize_t status) {
    if (status >= ARCHIVE_OK) return;
    const char* const reason = with.error_string(writer.get());
    throw BadData(
        fmt::format("{}: cannot be written: {}", out.string(), reason != nullptr ? reason : "unknown reason"));
  };
  if (writer == nullptr) throw std::bad_alloc();
  check(with.write_set_format_pax_restricted(writer.get()));
  check(with.write_add_filter_gzip(writer.get()));
  // No times and owners: the same content gives the same bytes.
  check(with.write_set_filter_option(writer.get(), "gzip", "timestamp", nullptr));
  check(with.write_open_filename(writer.get(), file.path().c_str()));
  std::vector<std::string> files = dataset.files();
  files.insert(files.begin(), "dataset.json");
  auto folder = std::filesystem::weakly_canonical(dataset.folder).filename();
  for (const std::string& member : files) {
    const std::string content = read_file(dataset.own_path_of(member));
    const std::unique_ptr<archive_entry, CloseArchive> entry(with.entry_new());
    with.entry_set_pathname(entry.get(), (folder / member).generic_string().c_str());
    with.entry_set_size(entry.get(), static_cast<la_int64_t>(content.size()));
    with.entry_set_filetype(entry.get(), AE_IFREG);
    with.entry_set_perm(entry.get(), 0644);
    check(with.write_header(writer.get(), entry.get()));
    check(with.write_data(writer.get(), content.data(), content.size()));
  }
  check(with.write_close(writer.get()));
  file.commit();
}

}  // namespace touchstone::datasets
