// HDF5 as other programs write it: datasets of N and of N x k numbers, or of records with named numbers (PyTables,
// h5py), in groups. A group whose name ends in a number ("demo_3") is a table of its own; an attribute `units` is the
// unit.
#include <fmt/format.h>

#include <array>

#include "array_tables.h"
#include "harness/base/error.h"
#include "harness/recording/child_trial.h"
#include "harness/recording/hdf5_handle.h"
#include "import_table.h"

namespace touchstone::importing {
using recording::Hdf5Type;

namespace {

using Hdf5Group = recording::Hdf5Handle<H5Gclose>;
using Hdf5Object = recording::Hdf5Handle<H5Oclose>;

constexpr std::size_t most_objects = 4096, deepest = 16;

herr_t add_name(hid_t /*group*/, const char* name, const H5L_info_t* info, void* data) {
  // Soft and external links could lead out of the file, or round.
  if (info->type == H5L_TYPE_HARD) static_cast<std::vector<std::string>*>(data)->emplace_back(name);
  return 0;
}

class Hdf5Arrays {
 public:
  explicit Hdf5Arrays(const std::filesystem::path& path)
      : source_(path.string()),
        most_bytes_(std::min<std::uintmax_t>(largest_import_bytes, most_packed * std::filesystem::file_size(path))),
        tables_(source_, "HDF5") {
    file_ = recording::Hdf5File(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
    if (!file_) {
      throw BadData(fmt::format("{}: cannot be read as HDF5: {}; is it complete, and HDF5 at all?", source_,
                                recording::hdf5_reason()));
    }
  }

  std::vector<ImportTable> read() {
    const Hdf5Object root(H5Oopen(file_.get(), "/", H5P_DEFAULT));
    visit(root.get(), "", "", 0);
    return tables_.finish();
  }

 private:
  // `group`: of the table; `path`: within it.
  void visit(hid_t object, const std::string& group, const std::string& path, std::size_t depth) {
    if (++objects_ > most_objects || depth > deepest) {
      throw BadData(
          fmt::format("{}: holds more than {} groups and datasets, or more than {} levels of them: cut out "
                      "the recording that is wanted",
                      source_, most_objects, deepest));
    }
    const H5I_type_t type = H5Iget_type(object);
    if (type == H5I_DATASET) return add_dataset(object, group, path);
    if (type != H5I_GROUP) return;
    std::vector<std::string> names;
    hsize_t at = 0;
    if (H5Literate(object, H5_INDEX_NAME, H5_ITER_INC, &at, add_name, &names) < 0) {
      throw BadData(fmt::format("{}: the group '{}' cannot be read: {}; the file is damaged", source_, path,
                                recording::hdf5_reason()));
    }
    for (const std::string& name : names) {
      const Hdf5Object child(H5Oopen(object, name.c_str(), H5P_DEFAULT));
      if (!child) {
        tables_.leave_out(joined(path, name), "it cannot be opened");
        continue;
      }
      const bool numbered = H5Iget_type(child.get()) == H5I_GROUP && name.back() >= '0' && name.back() <= '9';
      if (numbered) {
        visit(child.get(), joined(group.empty() ? path : joined(group, path), name), "", depth + 1);
      } else {
        visit(child.get(), group, joined(path, name), depth + 1);
      }
    }
  }

  static std::string joined(const std::string& path, const std::string& name) {
    return path.empty() ? name : path + "/" + name;
  }

  void add_dataset(hid_t dataset, const std::string& group, const std::string& name) {
    const recording::Hdf5Space space(H5Dget_space(dataset));
    const Hdf5Type type(H5Dget_type(dataset));
    const int rank = space ? H5Sget_simple_extent_ndims(space.get()) : -1;
    std::array<hsize_t, 32> sides{1, 1};
    const std::string full = joined(group, name);
    if (rank < 1) return tables_.leave_out(full, "one value");
    H5Sget_simple_extent_dims(space.get(), sides.data(), nullptr);
    if (rank > 2) {
      std::string text;
      for (int k = 0; k < rank; ++k)
        text += fmt::format("{}{}", k > 0 ? " x " : "", sides[static_cast<std::size_t>(k)]);
      return tables_.leave_out(full, fmt::format("an array of {}, no columns of samples", text));
    }
    const std::size_t rows = sides[0], columns = rank == 2 ? sides[1] : 1;
    const H5T_class_t kind = H5Tget_class(type.get());
    if (kind == H5T_COMPOUND && rank == 1) return add_records(dataset, type.get(), group, name, rows);
    if (kind != H5T_INTEGER && kind != H5T_FLOAT) return tables_.leave_out(full, "text or records");
    std::string unit = recording::hdf5_text_attribute(dataset, "units");
    if (unit.empty()) unit = recording::hdf5_text_attribute(dataset, "unit");
    add_values(dataset, H5T_NATIVE_DOUBLE, {group, name, unit}, rows, columns);
  }

  struct Place {
    std::string group, name, unit;
  };

  void add_values(hid_t dataset, hid_t memory_type, const Place& place, std::size_t rows, std::size_t columns) {
    const std::uintmax_t left = most_bytes_ / sizeof(double);
    if (columns > 0 && rows > left / columns) {
      throw BadData(
          fmt::format("{}: dataset '{}' says that it has {} x {} numbers, more than the file can hold: it is "
                      "damaged, or was never filled",
                      source_, place.name, rows, columns));
    }
    std::vector<double> values(rows * columns);
    if (!values.empty() && H5Dread(dataset, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
      throw BadData(fmt::format("{}: dataset '{}' cannot be read: {}; the file is damaged", source_, place.name,
                                recording::hdf5_reason()));
    }
    tables_.add(place.group, place.name, place.unit, rows, columns,
                [&](std::size_t i, std::size_t c) { return values[i * columns + c]; });
  }

  // The numbers of records, member by member.
  void add_records(hid_t dataset, hid_t type, const std::string& group, const std::string& name, std::size_t rows) {
    constexpr hsize_t widest = 64;
    for (int m = 0; m < H5Tget_nmembers(type); ++m) {
      const auto number = static_cast<unsigned>(m);
      char* const text = H5Tget_member_name(type, number);
      const std::string member = text != nullptr ? text : "";
      H5free_memory(text);
      const Hdf5Type of_member(H5Tget_member_type(type, number));
      const H5T_class_t kind = H5Tget_class(of_member.get());
      hsize_t width = 1;
      if (kind == H5T_ARRAY && H5Tget_array_ndims(of_member.get()) == 1) H5Tget_array_dims2(of_member.get(), &width);
      const bool array = kind == H5T_ARRAY && width >= 1 && width <= widest;
      const std::string path = joined(name, member);
      if (kind != H5T_INTEGER && kind != H5T_FLOAT && !array) {
        tables_.leave_out(joined(group, path), "text or records");
        continue;
      }
      const Hdf5Type values(array ? H5Tarray_create2(H5T_NATIVE_DOUBLE, 1, &width) : H5Tcopy(H5T_NATIVE_DOUBLE));
      const Hdf5Type memory(H5Tcreate(H5T_COMPOUND, sizeof(double) * width));
      H5Tinsert(memory.get(), member.c_str(), 0, values.get());
      add_values(dataset, memory.get(), {group, path, ""}, rows, width);
    }
  }

  std::string source_;
  std::uintmax_t most_bytes_;
  std::size_t objects_ = 0;
  recording::Hdf5File file_;
  ArrayTables tables_;
};

}  // namespace

std::vector<ImportTable> read_hdf5_arrays(const std::filesystem::path& path) {
  const recording::Hdf5Quiet quiet;
  // The library may not survive a damaged file: a child tries it first.
  if (recording::try_in_child([&] { static_cast<void>(Hdf5Arrays(path).read()); }) ==
      recording::ChildOutcome::crashed) {
    throw BadData(fmt::format("{}: is damaged: the HDF5 library crashes on it", path.string()));
  }
  return Hdf5Arrays(path).read();
}

}  // namespace touchstone::importing
