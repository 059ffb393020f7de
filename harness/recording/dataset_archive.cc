#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

#include <memory>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/recording/dataset.h"

namespace touchstone::recording {
namespace {

struct CloseArchive {
  void operator()(archive* a) const noexcept { archive_write_free(a); }
  void operator()(archive_entry* e) const noexcept { archive_entry_free(e); }
};

}  // namespace

void archive_dataset(const Dataset& dataset, const std::filesystem::path& out) {
  const std::string name = out.filename().string();
  if (!name.ends_with(".tar.gz") && !name.ends_with(".tgz")) {
    throw BadData(fmt::format("{}: data sets are packed as .tar.gz; name it so", out.string()));
  }
  AtomicFile file(out);
  const std::unique_ptr<archive, CloseArchive> writer(archive_write_new());
  const auto check = [&](la_ssize_t status) {
    if (status >= ARCHIVE_OK) return;
    const char* const reason = archive_error_string(writer.get());
    throw BadData(
        fmt::format("{}: cannot be written: {}", out.string(), reason != nullptr ? reason : "unknown reason"));
  };
  if (writer == nullptr) throw std::bad_alloc();
  check(archive_write_set_format_pax_restricted(writer.get()));
  check(archive_write_add_filter_gzip(writer.get()));
  // No times and owners: the same content gives the same bytes.
  check(archive_write_set_filter_option(writer.get(), "gzip", "timestamp", nullptr));
  check(archive_write_open_filename(writer.get(), file.path().c_str()));
  std::vector<std::string> files = dataset.files();
  files.insert(files.begin(), "dataset.json");
  auto folder = std::filesystem::weakly_canonical(dataset.folder).filename();
  for (const std::string& member : files) {
    const std::string content = read_file(dataset.own_path_of(member));
    const std::unique_ptr<archive_entry, CloseArchive> entry(archive_entry_new());
    archive_entry_set_pathname(entry.get(), (folder / member).generic_string().c_str());
    archive_entry_set_size(entry.get(), static_cast<la_int64_t>(content.size()));
    archive_entry_set_filetype(entry.get(), AE_IFREG);
    archive_entry_set_perm(entry.get(), 0644);
    check(archive_write_header(writer.get(), entry.get()));
    check(archive_write_data(writer.get(), content.data(), content.size()));
  }
  check(archive_write_close(writer.get()));
  file.commit();
}

}  // namespace touchstone::recording
