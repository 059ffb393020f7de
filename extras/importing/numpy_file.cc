// Arrays of NumPy: .npy by its published format (NEP 1, numpy.lib.format: magic, version, length, a Python dictionary
// of descr, fortran_order and shape, then the numbers), .npz as a zip archive of them (zip_entries.h). Records
// with named fields become columns; pickled objects are refused.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <memory>
#include <optional>
#include <string_view>

#include "array_tables.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "import_table.h"
#include "raw_number.h"
#include "zip_entries.h"

namespace touchstone::importing {
namespace {

constexpr std::string_view numpy_magic = "\x93NUMPY";

struct RecordField {
  std::string name;
  NumberType type;
  std::size_t offset = 0, count = 1;
};

// "<f8"; nothing where it is no number.
std::optional<NumberType> number_type(std::string_view text) {
  if (text.size() < 3) return std::nullopt;
  NumberType type{text[1], 0, text[0] == '>'};
  const auto [end, status] = std::from_chars(text.data() + 2, text.data() + text.size(), type.bytes);
  const bool whole = type.kind == 'i' || type.kind == 'u';
  const bool size = type.kind == 'f'   ? type.bytes == 2 || type.bytes == 4 || type.bytes == 8
                    : type.kind == 'b' ? type.bytes == 1
                                       : whole && std::has_single_bit(type.bytes) && type.bytes <= 8;
  return status == std::errc{} && end == text.data() + text.size() && size ? std::optional(type) : std::nullopt;
}

class NumpyArray {
 public:
  NumpyArray(const std::string& source, std::string name, std::string_view bytes)
      : source_(source), name_(std::move(name)), bytes_(bytes) {}

  void add_to(ArrayTables& tables) {
    read_header();
    if (fields_.empty()) return tables.leave_out(name_, why_none_);
    if (shape_.size() > 2 || (shape_.size() == 2 && fields_.size() > 1)) {
      std::string text;
      for (const std::size_t side : shape_) text += fmt::format("{}{}", text.empty() ? "" : " x ", side);
      return tables.leave_out(name_, fmt::format("an array of {}, no columns of samples", text));
    }
    const std::size_t rows = shape_.empty() ? 1 : shape_[0], columns = shape_.size() > 1 ? shape_[1] : 1;
    if (columns > 0 && item_bytes_ > 0 && rows > bytes_.size() / item_bytes_ / columns) {
      damaged(fmt::format("it says that it has {} x {} values of {} bytes, and holds {} bytes", rows, columns,
                          item_bytes_, bytes_.size()));
    }
    for (const RecordField& field : fields_) {
      const bool plain = field.name.empty();
      const auto at = [&](std::size_t i, std::size_t c) {
        const std::size_t item = !plain ? i : fortran_ ? c * rows + i : i * columns + c;
        const std::size_t within = plain ? 0 : field.offset + c * field.type.bytes;
        return number_at(bytes_.data() + item * item_bytes_ + within, field.type);
      };
      tables.add(plain ? "" : name_, plain ? name_ : field.name, "", rows, plain ? columns : field.count, at);
    }
  }

 private:
  [[noreturn]] void damaged(const std::string& why) const {
    throw BadData(fmt::format("{}: the array {} is damaged: {}", source_, name_, why));
  }

  // The text behind `key`.
  [[nodiscard]] std::string_view value_of(std::string_view header, std::string_view key) const {
    const auto at = header.find(fmt::format("'{}'", key));
    const auto colon = at == std::string_view::npos ? at : header.find(':', at);
    if (colon == std::string_view::npos) damaged(fmt::format("its header names no {}", key));
    std::string_view rest = header.substr(colon + 1);
    rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
    return rest;
  }

  void read_header() {
    constexpr std::size_t before_length = 8;
    if (!bytes_.starts_with(numpy_magic) || bytes_.size() < before_length + 4) damaged("it has no NumPy header");
    const bool long_length = bytes_[6] >= 2;
    const auto* const at = reinterpret_cast<const unsigned char*>(bytes_.data() + before_length);
    std::size_t length = at[0] + 256U * at[1];
    if (long_length) length += 65536U * at[2] + 16777216U * at[3];
    const std::size_t begin = before_length + (long_length ? 4 : 2);
    if (length > bytes_.size() - begin) damaged("its header does not end");
    const std::string_view header = bytes_.substr(begin, length);
    bytes_.remove_prefix(begin + length);
    fortran_ = value_of(header, "fortran_order").starts_with("True");
    read_shape(value_of(header, "shape"));
    read_descr(value_of(header, "descr"));
  }

  void read_shape(std::string_view text) {
    const auto end = text.find(')');
    if (!text.starts_with('(') || end == std::string_view::npos) damaged("its shape is none");
    text = text.substr(1, end - 1);
    while (text.find_first_of("0123456789") != std::string_view::npos) {
      text.remove_prefix(text.find_first_of("0123456789"));
      std::size_t side = 0;
      const auto [rest, status] = std::from_chars(text.data(), text.data() + text.size(), side);
      if (status != std::errc{}) damaged("its shape is none");
      shape_.push_back(side);
      text.remove_prefix(static_cast<std::size_t>(rest - text.data()));
    }
  }

  // '<f8', or a list of ('name', '<f8') and ('name', '<f8', (3,)).
  void read_descr(std::string_view text) {
    if (text.starts_with('\'')) {
      const auto type = number_type(text.substr(1, text.find('\'', 1) - 1));
      why_none_ =
          text.starts_with("'|O") ? "pickled objects: save the arrays themselves" : "text, times or complex numbers";
      if (type) fields_.push_back({"", *type}), item_bytes_ = type->bytes;
      return;
    }
    if (!text.starts_with('[')) damaged("its type is none");
    text = text.substr(1, text.find(']') - 1);
    why_none_ = "records of other things than numbers";
    while (text.find('(') != std::string_view::npos) {
      text.remove_prefix(text.find('(') + 1);
      RecordField field;
      for (std::string* const part : {&field.name, static_cast<std::string*>(nullptr)}) {
        const auto open = text.find('\''), close = text.find('\'', open + 1);
        if (open == std::string_view::npos || close == std::string_view::npos) damaged("its records are none");
        const std::string_view word = text.substr(open + 1, close - open - 1);
        if (part != nullptr) *part = word;
        const auto type = part != nullptr ? NumberType{} : number_type(word).value_or(NumberType{});
        if (part == nullptr && type.kind == 0) {
          // Where one field's size is not known the places of those behind it are not either.
          fields_.clear();
          return;
        }
        if (part == nullptr) field.type = type;
        text.remove_prefix(close + 1);
      }
      const auto inner = text.find('('), end = text.find(')');
      if (end == std::string_view::npos) damaged("its records are none");
      if (inner < end) {
        const auto number = text.find_first_of("0123456789", inner);
        std::size_t count = 0;
        if (number < end) std::from_chars(text.data() + number, text.data() + end, count);
        constexpr std::size_t widest = 64;
        if (count == 0 || count > widest || text.find_first_of("0123456789", text.find(',', inner)) < end) {
          why_none_ = "records of arrays";
          fields_.clear();
          return;
        }
        field.count = count;
        text.remove_prefix(end + 1);
      }
      field.offset = item_bytes_;
      item_bytes_ += field.count * field.type.bytes;
      fields_.push_back(std::move(field));
    }
  }

  const std::string& source_;
  std::string name_, why_none_;
  std::string_view bytes_;  // first the file, then the numbers
  bool fortran_ = false;
  std::vector<std::size_t> shape_;
  std::vector<RecordField> fields_;
  std::size_t item_bytes_ = 0;
};

}  // namespace

std::vector<ImportTable> read_numpy_array(const std::filesystem::path& path) {
  const std::string bytes = read_file(path), source = path.string();
  ArrayTables tables(source, "NumPy array");
  NumpyArray(source, path.stem().string(), bytes).add_to(tables);
  return tables.finish();
}

std::vector<ImportTable> read_numpy_archive(const std::filesystem::path& path) {
  const std::string source = path.string();
  ArrayTables tables(source, "NumPy archive");
  for_each_zip_entry(
      path, largest_import_bytes, [](const std::string& name) { return name.ends_with(".npy"); },
      [&](const std::string& name, const std::string& bytes) {
        NumpyArray(source, name.substr(0, name.size() - 4), bytes).add_to(tables);
      });
  return tables.finish();
}

}  // namespace touchstone::importing
