#include "harness/recording/fuzz/read_structured_recording.h"

#include <fmt/format.h>
#include <hdf5.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "harness/base/atomic_file.h"
#include "harness/recording/fuzz/read_recording.h"
#include "harness/testing/choices.h"

namespace touchstone::recording::fuzz {
namespace {

using testing::Choices;

constexpr std::size_t rows = 5;
constexpr const char* names[] = {"t_s", "x_m", "y_m", "z_m", "fx_N", "fy_N", "fz_N"};

std::string strange_name(Choices& choices, const char* usual) {
  if (!choices.one_in(12)) return usual;
  return choices.text(
      {"t_ms", "x_mm", "x_m", "qw", "qx", "vx_m_per_s", "fx_kN", "fx_lbf", "", " t_s", "t", "x_cm_", "tx_Nm"});
}

// HDF5: each choice is one that the library takes; what it refuses stays out of the file.
void write_attribute(hid_t object, const char* name, Choices& choices, const std::string& text) {
  const hid_t space = H5Screate(H5S_SCALAR);
  if (choices.one_in(8)) {
    const hid_t attribute = H5Acreate2(object, name, H5T_NATIVE_INT, space, H5P_DEFAULT, H5P_DEFAULT);
    const int value = static_cast<int>(choices.whole());
    H5Awrite(attribute, H5T_NATIVE_INT, &value);
    H5Aclose(attribute);
  } else {
    const hid_t type = H5Tcopy(H5T_C_S1);
    if (choices.one_in(4)) {
      H5Tset_size(type, H5T_VARIABLE);
    } else {
      H5Tset_size(type, text.empty() ? 1 : text.size() + choices.below(3));
    }
    const hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    if (H5Tis_variable_str(type) > 0) {
      const char* const value = text.c_str();
      H5Awrite(attribute, type, &value);
    } else {
      const std::string padded = text + std::string(4, '\0');
      H5Awrite(attribute, type, padded.data());
    }
    H5Aclose(attribute);
    H5Tclose(type);
  }
  H5Sclose(space);
}

hid_t type_of(Choices& choices) {
  if (!choices.one_in(6)) return H5T_NATIVE_DOUBLE;
  const hid_t types[] = {H5T_NATIVE_FLOAT, H5T_STD_I32BE, H5T_STD_U64LE,   H5T_IEEE_F64BE,
                         H5T_C_S1,         H5T_STD_B8LE,  H5T_NATIVE_SCHAR};
  return types[choices.below(std::size(types))];
}

void write_dataset(hid_t file, const std::string& name, std::size_t column, Choices& choices) {
  hsize_t length = choices.one_in(8) ? choices.whole() % (std::uint64_t{1} << 40) : rows;
  const int rank = choices.one_in(12) ? static_cast<int>(choices.below(4)) : 1;
  const hsize_t sizes[] = {length, 1 + choices.below(3), 1};
  const hsize_t unlimited[] = {H5S_UNLIMITED, H5S_UNLIMITED, H5S_UNLIMITED};
  const hid_t layout = H5Pcreate(H5P_DATASET_CREATE);
  const bool chunked = length > 4096 || choices.below(2) == 1;
  if (chunked && rank > 0) {
    const hsize_t chunk[] = {choices.one_in(4) ? 1 + choices.below(5000) : 8, 1, 1};
    H5Pset_chunk(layout, rank, chunk);
    if (choices.below(2) == 1) H5Pset_shuffle(layout);
    if (choices.below(2) == 1) H5Pset_deflate(layout, static_cast<unsigned>(choices.below(10)));
    if (choices.below(2) == 1) H5Pset_fletcher32(layout);
  }
  const hid_t space = H5Screate_simple(rank, sizes, chunked && rank > 0 ? unlimited : nullptr);
  const hid_t type = type_of(choices);
  const hid_t set = H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, layout, H5P_DEFAULT);
  if (set >= 0) {
    std::vector<double> values(rows);
    for (std::size_t i = 0; i < rows; ++i) {
      const double usual = column == 0 ? 0.01 * static_cast<double>(i) : 0.1 * static_cast<double>(column);
      values[i] = choices.one_in(24) ? choices.number() : usual;
    }
    // A vast dataset stays unwritten: it declares what it does not hold.
    if (rank == 1 && length == rows && H5Tget_class(type) != H5T_STRING && H5Tget_class(type) != H5T_BITFIELD)
      H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    const auto underscore = name.rfind('_');
    if (choices.below(3) == 1 && underscore != std::string::npos)
      write_attribute(set, "unit", choices, choices.one_in(4) ? "furlong" : name.substr(underscore + 1));
    H5Dclose(set);
  }
  if (space >= 0) H5Sclose(space);
  H5Pclose(layout);
}

std::string hdf5_file(Choices& choices) {
  const auto path = std::filesystem::temp_directory_path() / fmt::format("touchstone-structured-{}.h5", ::getpid());
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  if (choices.below(2) == 1) H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
  if (!choices.one_in(4))
    write_attribute(file, "schema", choices, choices.one_in(6) ? "other/9" : "touchstone-recording/1");
  for (std::size_t column = 0; column < std::size(names); ++column) {
    if (choices.one_in(24)) continue;
    const std::string name = strange_name(choices, names[column]);
    if (choices.one_in(32)) {
      const hid_t group = H5Gcreate2(file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
      if (group >= 0) H5Gclose(group);
    } else if (choices.one_in(32)) {
      H5Lcreate_soft(choices.text({"/t_s", "/nowhere", "/", "."}), file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
    } else {
      write_dataset(file, name, column, choices);
    }
  }
  H5Fclose(file);
  H5Pclose(access);
  std::string bytes = read_file(path);
  std::filesystem::remove(path);
  return bytes;
}

std::string number_text(Choices& choices, double usual) {
  if (!choices.one_in(24)) return fmt::format("{}", usual);
  switch (choices.below(6)) {
    case 0:
      return fmt::format("{}", choices.number());
    case 1:
      return fmt::format("{:e}", choices.number());
    case 2:
      return choices.text({"", " ", "nan", "-inf", "1e999", "1e-999", "0x10", "1,5", "1.5.", "--1", "+1", "1d3",
                           "\"1\"", "\"1",
                           "\xe2\x88\x92"
                           "1"});
    case 3:
      return fmt::format("{}", choices.whole());
    case 4:
      return std::string(1 + choices.below(400), '9');
    default:
      return fmt::format(" {} ", usual);
  }
}

std::string csv_file(Choices& choices) {
  const std::string separator = choices.text({",", ",", ";", "\t", " ", "|"});
  const std::string end = choices.text({"\n", "\n", "\r\n", "\r", "\n\n"});
  std::string text = choices.one_in(16) ? "\xef\xbb\xbf" : "";
  if (choices.one_in(8)) text += choices.text({"# comment", "", "sep=;", "\"quoted, name\"", "1,2,3"}) + end;
  std::vector<std::string> header;
  for (const char* const name : names) {
    if (!choices.one_in(24)) header.push_back(strange_name(choices, name));
    if (choices.one_in(32)) header.push_back(header.empty() ? "t_s" : header.back());
  }
  for (std::size_t c = 0; c < header.size(); ++c) text += (c > 0 ? separator : "") + header[c];
  text += end;
  const std::size_t count = choices.one_in(16) ? choices.below(600) : rows;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t width = choices.one_in(24) ? choices.below(2 * header.size() + 1) : header.size();
    for (std::size_t c = 0; c < width; ++c)
      text += (c > 0 ? separator : "") +
              number_text(choices, c == 0 ? 0.01 * static_cast<double>(i) : 0.1 * static_cast<double>(c));
    text += i + 1 == count && choices.one_in(4) ? "" : end;
  }
  return text;
}

std::size_t read(const std::string& bytes, const char* extension) {
  return read_recording(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), extension);
}

}  // namespace

std::size_t read_structured_recording(const std::uint8_t* data, std::size_t size) {
  Choices choices({data, size});
  if (size == 0) return read(csv_file(choices), ".csv") + read(hdf5_file(choices), ".h5");
  return choices.below(2) == 0 ? read(csv_file(choices), ".csv") : read(hdf5_file(choices), ".h5");
}

}  // namespace touchstone::recording::fuzz
