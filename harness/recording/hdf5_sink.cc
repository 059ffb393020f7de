#include "harness/recording/hdf5_sink.h"

#include <fmt/format.h>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/recording/hdf5_handle.h"
#include "harness/recording/hdf5_source.h"

namespace touchstone::recording {
namespace {

constexpr hsize_t chunk_rows = 8192;
constexpr unsigned deflate_level = 4;

class Hdf5Sink final : public TableSink {
 public:
  Hdf5Sink(const std::filesystem::path& path, const std::vector<Column>& columns)
      : name_(path.string()), atomic_(path) {
    const Hdf5Quiet quiet;
    // The newest file format checksums its own structures, so that damage is noticed and not followed.
    const Hdf5Properties access(H5Pcreate(H5P_FILE_ACCESS));
    if (!access || H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110) < 0) fail();
    // Without times the same recording gives the same bytes. Links and attributes stay in the root's header, which has
    // a checksum; the heap that would hold more than eight of them has none.
    constexpr unsigned most_attributes = 64;
    const Hdf5Properties creation(H5Pcreate(H5P_FILE_CREATE));
    if (!creation || H5Pset_obj_track_times(creation.get(), 0) < 0 ||
        H5Pset_link_phase_change(creation.get(), quantity_count, quantity_count) < 0 ||
        H5Pset_attr_phase_change(creation.get(), most_attributes, most_attributes) < 0) {
      fail();
    }
    file_ = Hdf5File(H5Fcreate(atomic_.path().c_str(), H5F_ACC_TRUNC, creation.get(), access.get()));
    if (!file_ || !hdf5_write_text_attribute(file_.get(), "schema", recording_schema)) fail();
    const Hdf5Properties properties(H5Pcreate(H5P_DATASET_CREATE));
    if (!properties || H5Pset_chunk(properties.get(), 1, &chunk_rows) < 0 || H5Pset_shuffle(properties.get()) < 0 ||
        H5Pset_deflate(properties.get(), deflate_level) < 0 || H5Pset_fletcher32(properties.get()) < 0 ||
        H5Pset_obj_track_times(properties.get(), 0) < 0) {
      fail();
    }
    const hsize_t unlimited = H5S_UNLIMITED;
    const hsize_t none = 0;
    const Hdf5Space space(H5Screate_simple(1, &none, &unlimited));
    for (const Column& column : columns) {
      const hid_t type = column.quantity == Quantity::contact ? H5T_STD_U8LE : H5T_IEEE_F64LE;
      datasets_.emplace_back(
          H5Dcreate2(file_.get(), column.name.c_str(), type, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT));
      if (!datasets_.back() || !hdf5_write_text_attribute(datasets_.back().get(), "unit", column.unit)) fail();
    }
  }

  // HDF5 still writes when it closes, and may fail.
  ~Hdf5Sink() override {
    const Hdf5Quiet quiet;
    datasets_.clear();
    file_.close();
  }
  Hdf5Sink(const Hdf5Sink&) = delete;
  Hdf5Sink& operator=(const Hdf5Sink&) = delete;

  void write(std::span<const std::vector<double>> columns) override {
    const Hdf5Quiet quiet;
    const hsize_t rows = columns.front().size();
    if (rows == 0) return;
    const hsize_t total = row_ + rows;
    const Hdf5Space memory(H5Screate_simple(1, &rows, nullptr));
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const hid_t dataset = datasets_[i].get();
      if (H5Dset_extent(dataset, &total) < 0) fail();
      const Hdf5Space space(H5Dget_space(dataset));
      if (!space || H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, &row_, nullptr, &rows, nullptr) < 0 ||
          H5Dwrite(dataset, H5T_NATIVE_DOUBLE, memory.get(), space.get(), H5P_DEFAULT, columns[i].data()) < 0) {
        fail();
      }
    }
    row_ = total;
  }

  void commit() override {
    const Hdf5Quiet quiet;
    for (Hdf5Dataset& dataset : datasets_) {
      if (!dataset.close()) fail();
    }
    if (!file_.close()) fail();
    atomic_.commit();
  }

 private:
  [[noreturn]] void fail() const {
    throw BadData(fmt::format("{}: cannot be written as HDF5: {}", name_, hdf5_reason()));
  }

  std::string name_;
  AtomicFile atomic_;
  Hdf5File file_;
  std::vector<Hdf5Dataset> datasets_;
  hsize_t row_ = 0;
};

}  // namespace

std::unique_ptr<TableSink> create_hdf5_sink(const std::filesystem::path& path, const std::vector<Column>& columns) {
  return std::make_unique<Hdf5Sink>(path, columns);
}

}  // namespace touchstone::recording
