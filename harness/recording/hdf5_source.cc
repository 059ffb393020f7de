#include "harness/recording/hdf5_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>

#include "harness/base/error.h"
#include "harness/recording/child_trial.h"
#include "harness/recording/hdf5_chunks.h"
#include "harness/recording/hdf5_handle.h"

namespace touchstone::recording {
namespace {

// What H5Oget_info_by_name2 fills; from 1.12 on H5O_info_t is another.
#if H5_VERSION_GE(1, 12, 0)
using ObjectInfo = H5O_info1_t;
#else
using ObjectInfo = H5O_info_t;
#endif

constexpr std::size_t most_links = 64;
// No input makes deflate shrink more than 1032 to 1 (zlib's technical notes, "maximum compression factor").
constexpr hsize_t largest_deflate_ratio = 1032;

struct Links {
  std::vector<std::string> names;
  std::string refused;  // the first link that is not a plain one
};

herr_t add_link(hid_t, const char* name, const H5L_info_t* info, void* data) {
  auto& links = *static_cast<Links*>(data);
  // Soft and external links could lead out of the file.
  if (info->type != H5L_TYPE_HARD) links.refused = name;
  links.names.emplace_back(name);
  return links.refused.empty() && links.names.size() <= most_links ? 0 : 1;
}

class Hdf5Source final : public TableSource {
 public:
  // `file`: this file where it is open already.
  explicit Hdf5Source(const std::filesystem::path& path, Hdf5File file = {})
      : name_(path.string()), file_(std::move(file)) {
    const Hdf5Quiet quiet;
    if (!file_) file_ = Hdf5File(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
    if (!file_) {
      throw BadData(
          fmt::format("{}: cannot be read as HDF5: {}; is it complete, and HDF5 at all?", name_, hdf5_reason()));
    }
    check_schema();
    list_datasets();
    for (const std::string& name : names_) open_dataset(name);
  }

  ~Hdf5Source() override {
    const Hdf5Quiet quiet;
    datasets_.clear();
    file_.close();
  }
  Hdf5Source(const Hdf5Source&) = delete;
  Hdf5Source& operator=(const Hdf5Source&) = delete;

  const std::vector<std::string>& names() const noexcept override { return names_; }
  const std::vector<std::string>& notes() const noexcept override { return notes_; }
  std::string format() const override { return "HDF5"; }
  std::string name_place(std::size_t column) const override {
    return fmt::format("{}: dataset '{}'", name_, names_[column]);
  }
  std::string value_place(std::uint64_t row, std::size_t column) const override {
    return fmt::format("{}: dataset '{}', sample {}", name_, names_[column], row);
  }
  std::string row_name(std::uint64_t row) const override { return fmt::format("sample {}", row); }

  std::size_t read(std::size_t max_rows, std::span<std::vector<double>> columns) override {
    const hsize_t rows = std::min<hsize_t>(max_rows, length_ - row_);
    if (rows == 0) return 0;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const std::size_t before = columns[i].size();
      columns[i].resize(before + rows);
      read_dataset(i, std::span(columns[i]).subspan(before));
    }
    row_ += rows;
    return rows;
  }

 private:
  void read_dataset(std::size_t i, std::span<double> to) {
    bool fetched = false;
    {
      const Hdf5Quiet quiet;
      fetched = layouts_[i] && chunks_.fetch(datasets_[i].get(), *layouts_[i], row_, to);
      if (!fetched) read_values(i, to);
    }
    if (!fetched) return;
    if (const auto damage = chunks_.decode()) refuse_values(i, damage->row, damage->what);
  }

  // Through HDF5, which knows every way of storing.
  void read_values(std::size_t i, std::span<double> to) {
    const hsize_t rows = to.size();
    const Hdf5Space file_space(H5Dget_space(datasets_[i].get()));
    const Hdf5Space memory_space(H5Screate_simple(1, &rows, nullptr));
    const bool read = file_space && memory_space &&
                      H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, &row_, nullptr, &rows, nullptr) >= 0 &&
                      H5Dread(datasets_[i].get(), H5T_NATIVE_DOUBLE, memory_space.get(), file_space.get(), H5P_DEFAULT,
                              to.data()) >= 0;
    if (!read) refuse_values(i, row_, hdf5_reason());
  }

  [[noreturn]] void refuse_values(std::size_t i, hsize_t row, const std::string& why) const {
    throw BadData(fmt::format("{}: dataset '{}' cannot be read from sample {} on: {}; the file is damaged", name_,
                              names_[i], row, why));
  }

  void check_schema() {
    const std::string schema = hdf5_text_attribute(file_.get(), "schema");
    if (schema == recording_schema) return;
    if (!schema.empty()) {
      throw BadData(fmt::format("{}: attribute 'schema' is '{}'; '{}' was expected", name_, schema, recording_schema));
    }
    notes_.push_back(fmt::format("{}: has no attribute 'schema'; read as {}", name_, recording_schema));
  }

  void list_datasets() {
    Links links;
    hsize_t at = 0;
    if (H5Literate(file_.get(), H5_INDEX_NAME, H5_ITER_INC, &at, add_link, &links) < 0) {
      throw BadData(
          fmt::format("{}: its list of datasets cannot be read: {}; the file is damaged", name_, hdf5_reason()));
    }
    if (!links.refused.empty()) {
      throw BadData(fmt::format("{}: '{}' is a soft or external link; a recording holds its datasets itself", name_,
                                links.refused));
    }
    if (links.names.size() > most_links) {
      throw BadData(
          fmt::format("{}: holds more than {} datasets or groups; this is not a recording", name_, most_links));
    }
    names_ = std::move(links.names);
    if (names_.empty()) {
      throw BadData(
          fmt::format("{}: holds no datasets; one per column (t_s, x_m, ...) was expected in the root group", name_));
    }
  }

  void open_dataset(const std::string& name) {
    const auto refuse = [&](const std::string& why) {
      throw BadData(fmt::format("{}: dataset '{}' {}", name_, name, why));
    };
    ObjectInfo info{};
    if (H5Oget_info_by_name2(file_.get(), name.c_str(), &info, H5O_INFO_BASIC, H5P_DEFAULT) < 0) {
      refuse("cannot be opened: " + hdf5_reason() + "; the file is damaged");
    }
    if (info.type != H5O_TYPE_DATASET) {
      refuse("is a group or type, not a dataset; a recording holds one dataset per column in the root group");
    }
    Hdf5Dataset dataset(H5Dopen2(file_.get(), name.c_str(), H5P_DEFAULT));
    if (!dataset) refuse("cannot be opened: " + hdf5_reason() + "; the file is damaged");
    const Hdf5Type type(H5Dget_type(dataset.get()));
    const Hdf5Space space(H5Dget_space(dataset.get()));
    const Hdf5Properties properties(H5Dget_create_plist(dataset.get()));
    if (!type || !space || !properties) refuse("cannot be described: " + hdf5_reason() + "; the file is damaged");
    const H5T_class_t kind = H5Tget_class(type.get());
    if (kind != H5T_FLOAT && kind != H5T_INTEGER) refuse("does not hold numbers");
    if (H5Sget_simple_extent_ndims(space.get()) != 1)
      refuse("is not one-dimensional; one value per sample was expected");
    // Both could lead out of the file.
    if (H5Pget_layout(properties.get()) == H5D_VIRTUAL || H5Pget_external_count(properties.get()) > 0) {
      refuse("keeps its values in another file; a recording holds them itself");
    }
    hsize_t length = 0;
    if (H5Sget_simple_extent_dims(space.get(), &length, nullptr) != 1) refuse("has no length; the file is damaged");
    if (!datasets_.empty() && length != length_) {
      refuse(fmt::format("has {} values, but '{}' has {}; all must have the same number", length, names_.front(),
                         length_));
    }
    refuse_more_than_stored(dataset.get(), properties.get(), H5Tget_size(type.get()), length, refuse);
    length_ = length;
    const std::string unit = hdf5_text_attribute(dataset.get(), "unit");
    const auto underscore = name.rfind('_');
    const std::string named = underscore == std::string::npos ? "1" : name.substr(underscore + 1);
    if (!unit.empty() && unit != named) {
      refuse(fmt::format("has the attribute unit = '{}', which its name contradicts; make them agree", unit));
    }
    layouts_.push_back(checksummed_chunks(dataset.get()));
    datasets_.push_back(std::move(dataset));
  }

  // HDF5 fills in what was never stored, so that a few kilobytes can declare more samples than memory holds.
  template <class Refuse>
  static void refuse_more_than_stored(hid_t dataset, hid_t properties, std::size_t value_bytes, hsize_t length,
                                      const Refuse& refuse) {
    const hsize_t stored = H5Dget_storage_size(dataset);
    const hsize_t most = H5Pget_nfilters(properties) > 0 ? stored * largest_deflate_ratio : stored;
    if (length <= most / std::max<std::size_t>(1, value_bytes)) return;
    refuse(fmt::format(
        "declares {} samples, but its {} stored bytes hold at most {}; it was not written to its end, or is damaged",
        length, stored, most / std::max<std::size_t>(1, value_bytes)));
  }

  std::string name_;
  Hdf5File file_;
  std::vector<std::string> names_;
  std::vector<Hdf5Dataset> datasets_;
  std::vector<std::optional<ChunkLayout>> layouts_;  // per dataset
  ChunkReader chunks_;
  std::vector<std::string> notes_;
  hsize_t length_ = 0;
  hsize_t row_ = 0;
};

// Superblocks of version 2 and above belong to formats that checksum most of their own structures, so that the library
// notices damage. It follows damaged structures of the older ones (what h5py writes unless told otherwise) and may
// crash.
bool structures_are_checksummed(const std::filesystem::path& path) {
  constexpr std::string_view signature = "\x89HDF\r\n\x1a\n";
  std::array<char, 9> start{};
  std::ifstream in(path, std::ios::binary);
  return in.read(start.data(), start.size()) && std::string_view(start.data(), 8) == signature && start[8] >= 2;
}

// A header with a checksum, and nothing of it kept in a heap, which has none.
bool checksummed_object(hid_t file, const char* name) {
  ObjectInfo info{};
  return H5Oget_info_by_name2(file, name, &info, H5O_INFO_HDR | H5O_INFO_META_SIZE, H5P_DEFAULT) >= 0 &&
         info.hdr.version >= 2 && info.meta_size.obj.heap_size == 0 && info.meta_size.attr.heap_size == 0;
}

// Opened only if every structure and value that the library would follow has a checksum, as in all files that
// Touchstone writes: then damage is noticed, and no child needs to try the file first.
Hdf5File open_if_checksummed(const std::filesystem::path& path) {
  if (!structures_are_checksummed(path)) return {};
  const Hdf5Quiet quiet;
  Hdf5File file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  Links links;
  hsize_t at = 0;
  const bool all = file && checksummed_object(file.get(), "/") &&
                   H5Literate(file.get(), H5_INDEX_NAME, H5_ITER_INC, &at, add_link, &links) >= 0 &&
                   links.refused.empty() && links.names.size() <= most_links &&
                   std::ranges::all_of(links.names, [&](const std::string& name) {
                     if (!checksummed_object(file.get(), name.c_str())) return false;
                     const Hdf5Dataset dataset(H5Dopen2(file.get(), name.c_str(), H5P_DEFAULT));
                     return dataset && checksummed_chunks(dataset.get());
                   });
  if (!all) file.close();
  return file;
}

// Opens everything, and reads what can be stored: deflate shrinks at most 1032 to 1, so what a file declares beyond
// that is empty. Of a large file whose structures have checksums the values are left out: that would take as long
// again as using it.
void try_to_read(const std::filesystem::path& path) {
  constexpr std::uintmax_t large = 16 << 20;
  constexpr std::size_t rows = 16384;
  Hdf5Source source(path);
  const auto size = std::filesystem::file_size(path);
  if (size > large && structures_are_checksummed(path)) return;
  const auto most = size * largest_deflate_ratio / sizeof(double);
  std::vector<std::vector<double>> columns(source.names().size());
  for (std::uintmax_t done = 0; done < most && source.read(rows, columns) > 0; done += rows) {
    for (auto& column : columns) column.clear();
  }
}

}  // namespace

std::unique_ptr<TableSource> open_hdf5_source(const std::filesystem::path& path) {
  // A child that is forked while another thread is in the library would find it locked for ever.
  const Hdf5Quiet quiet;
  Hdf5File file = open_if_checksummed(path);
  if (!file && try_in_child([&] { try_to_read(path); }) == ChildOutcome::crashed) {
    throw BadData(fmt::format("{}: is damaged: the HDF5 library crashes on it", path.string()));
  }
  return std::make_unique<Hdf5Source>(path, std::move(file));
}

}  // namespace touchstone::recording
