#include "mat_extent.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "harness/base/error.h"
#include "import_table.h"

namespace touchstone::importing {
namespace {

constexpr std::size_t head_bytes = 128;
constexpr std::size_t tag = 8;
// Types of data elements and classes of arrays: MAT-File Format, tables 1-1 and 1-3.
constexpr std::uint32_t int8_type = 1, int32_type = 5, uint32_type = 6, matrix_type = 14, compressed_type = 15;
constexpr std::uint32_t cell_class = 1, struct_class = 2, object_class = 3, sparse_class = 5, function_class = 16,
                        opaque_class = 17;
constexpr int deepest = 32;

std::uint32_t number(std::string_view bytes, std::size_t at, bool little) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value = value << 8U | static_cast<unsigned char>(bytes[at + (little ? 3 - i : i)]);
  }
  return value;
}

// What matio allocates by: every size and count within one variable, held against the bytes that are there.
class VariableCheck {
 public:
  explicit VariableCheck(bool little) : little_(little) {}

  // The bytes of a matrix element after its tag. What is wrong with it, or nothing.
  [[nodiscard]] std::optional<std::string> matrix(std::string_view body, int depth = 0) const {
    if (body.empty()) return std::nullopt;  // an empty cell or field
    if (depth > deepest) return fmt::format("cells or structures nested more than {} deep", deepest);
    const auto flags = take(body);
    if (!flags || flags->type != uint32_type || flags->data.size() != 8) return "no array flags";
    const std::uint32_t kind = number(flags->data, 0, little_) & 0xffU;
    if (kind == 0 || kind > opaque_class) return fmt::format("the class {}", kind);
    if (kind == opaque_class) return opaque(body);
    const auto dimensions = take(body);
    if (!dimensions || dimensions->type != int32_type || dimensions->data.size() % 4 != 0 ||
        dimensions->data.size() < 8) {
      return "no dimensions";
    }
    const std::uint64_t count = product(dimensions->data);
    if (!take(body)) return "a name that does not end within it";
    if (kind == struct_class || kind == object_class) return structure(body, kind, count, depth);
    if (kind == cell_class || kind == function_class) return children(body, count, depth);
    if (kind == sparse_class) return "a sparse array, which is not read here; save plain arrays, full(x); else";
    // A number takes a byte at least, however it is packed.
    if (count > body.size()) return fmt::format("{} numbers in {} bytes", count, body.size());
    const bool imaginary = (number(flags->data, 0, little_) & 0x800U) != 0;
    if (count > 0 && imaginary && !take(body)) return "no imaginary part";
    if (count > 0 && body.empty()) return "no numbers";
    return elements(body);
  }

 private:
  struct Element {
    std::uint32_t type;
    std::string_view data;
  };

  // Takes one data element, with its padding to eight bytes, from the front.
  std::optional<Element> take(std::string_view& body) const {
    if (body.size() < tag) return std::nullopt;
    const std::uint32_t word = number(body, 0, little_);
    const std::uint32_t small_size = word >> 16U;
    if (small_size != 0) {  // the small format: type and size in one word, the data in the other
      if (small_size > 4) return std::nullopt;
      const Element element{word & 0xffffU, body.substr(4, small_size)};
      body.remove_prefix(tag);
      return element;
    }
    const std::size_t size = number(body, 4, little_);
    if (size > body.size() - tag) return std::nullopt;
    const Element element{word, body.substr(tag, size)};
    body.remove_prefix(std::min(body.size(), tag + (size + 7) / 8 * 8));
    return element;
  }

  [[nodiscard]] std::uint64_t product(std::string_view dimensions) const {
    constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
    std::uint64_t count = 1;
    for (std::size_t at = 0; at < dimensions.size(); at += 4) {
      count = std::min(most, count) * number(dimensions, at, little_);
    }
    return count;
  }

  [[nodiscard]] std::optional<std::string> elements(std::string_view body) const {
    while (!body.empty()) {
      if (!take(body)) return "numbers that do not end within it";
    }
    return std::nullopt;
  }

  // An object of a MATLAB class has no dimensions, and no numbers are taken from it. matio looks for dimensions and a
  // name all the same: whatever its first element is called, the eight bytes behind that tag are the tag of a name to
  // it (Mat_VarReadNextInfo5 of mat5.c, matio 1.5.23), and it makes room for as many letters as they say.
  [[nodiscard]] std::optional<std::string> opaque(std::string_view body) const {
    const bool dimensions = body.size() >= tag && number(body, 0, little_) == int32_type;
    const std::size_t behind_tag = dimensions ? tag + (std::size_t{number(body, 4, little_)} + 7) / 8 * 8 : tag;
    if (body.size() >= behind_tag + tag && number(body, behind_tag, little_) == int8_type &&
        number(body, behind_tag + 4, little_) > body.size() - behind_tag - tag) {
      return "a name that does not end within it";
    }
    return elements(body);
  }

  std::optional<std::string> structure(std::string_view body, std::uint32_t kind, std::uint64_t count,
                                       int depth) const {
    if (kind == object_class && !take(body)) return "a class name that does not end within it";
    const auto length = take(body);
    if (!length || length->type != int32_type || length->data.size() != 4) return "no length of field names";
    const std::uint32_t name_bytes = number(length->data, 0, little_);
    const auto names = take(body);
    if (!names || name_bytes == 0 || names->data.size() % name_bytes != 0) return "no field names";
    const std::uint64_t fields = names->data.size() / name_bytes;
    constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
    return children(body, std::min(most, count) * fields, depth);
  }

  std::optional<std::string> children(std::string_view body, std::uint64_t count, int depth) const {
    if (count > body.size() / tag) return fmt::format("{} arrays in {} bytes", count, body.size());
    for (std::uint64_t i = 0; i < count; ++i) {
      const auto child = take(body);
      if (!child || child->type != matrix_type) return "an array within it that does not end within it";
      if (auto wrong = matrix(child->data, depth + 1)) return wrong;
    }
    return std::nullopt;
  }

  bool little_;
};

// The variable that a compressed element holds, from its tag on; nothing where it cannot be unpacked.
std::optional<std::string> unpacked(std::string_view packed, bool little) {
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return std::nullopt;
  std::string packed_copy(packed);  // zlib wants a pointer that is not const
  stream.next_in = reinterpret_cast<Bytef*>(packed_copy.data());
  stream.avail_in = static_cast<uInt>(packed_copy.size());
  std::string out(tag, '\0');
  int status = Z_OK;
  const auto fill = [&](std::size_t from) {
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + from);
    stream.avail_out = static_cast<uInt>(out.size() - from);
    status = inflate(&stream, Z_SYNC_FLUSH);
    return (status == Z_OK || status == Z_STREAM_END) && stream.avail_out == 0;
  };
  bool whole = fill(0);
  const std::size_t size = whole ? number(out, 4, little) : 0;
  whole = whole && size <= most_packed * packed.size();
  if (whole) {
    out.resize(tag + size);
    whole = size == 0 || fill(tag);
  }
  if (whole && status == Z_OK) {  // nothing follows but the checksum, which must be right
    Bytef beyond = 0;
    stream.next_out = &beyond;
    stream.avail_out = 1;
    whole = inflate(&stream, Z_SYNC_FLUSH) == Z_STREAM_END && stream.avail_out == 1;
  }
  inflateEnd(&stream);
  if (!whole) return std::nullopt;
  return out;
}

// What is wrong with the variable in an element, or nothing.
std::optional<std::string> wrong_in(std::uint32_t type, std::string_view data, bool little) {
  const VariableCheck check(little);
  if (type == matrix_type) return check.matrix(data);
  const auto inside = unpacked(data, little);
  if (!inside) return "packed bytes that cannot be unpacked";
  if (number(*inside, 0, little) != matrix_type) return "no array";
  return check.matrix(std::string_view(*inside).substr(tag));
}

}  // namespace

std::size_t count_mat5_elements(std::string_view file, const std::string& source) {
  if (file.size() < head_bytes) {
    throw BadData(fmt::format("{}: ends after {} bytes, within the head of a MATLAB file: was it cut short?", source,
                              file.size()));
  }
  const bool little = file.substr(126, 2) == "IM";
  std::size_t elements = 0;
  for (std::size_t at = head_bytes; at < file.size(); ++elements) {
    const bool whole_tag = file.size() - at >= tag;
    const std::uint32_t type = whole_tag ? number(file, at, little) : 0;
    if (whole_tag && type != matrix_type && type != compressed_type) {
      throw BadData(
          fmt::format("{}: byte {}: a variable of MATLAB was expected (element 14 or 15), not element {}; the "
                      "file is damaged",
                      source, at, type));
    }
    if (!whole_tag || number(file, at + 4, little) > file.size() - at - tag) {
      throw BadData(
          fmt::format("{}: ends at byte {}, within the variable that begins at byte {}: was the file cut short?",
                      source, file.size(), at));
    }
    const std::uint32_t size = number(file, at + 4, little);
    if (const auto wrong = wrong_in(type, file.substr(at + tag, size), little)) {
      throw BadData(
          fmt::format("{}: byte {}: variable {} has {}: the file is damaged", source, at, elements + 1, *wrong));
    }
    at += tag + size;
  }
  return elements;
}

std::size_t count_mat4_matrices(std::string_view file, const std::string& source) {
  constexpr std::size_t head = 20;
  // By the digit of thousands and tens of the type: bytes of a number, 0 where there is no such type.
  constexpr std::array<std::uint64_t, 6> bytes_of{8, 4, 4, 2, 2, 1};
  constexpr std::uint32_t most_type = 1052;  // big-endian text of bytes
  std::size_t matrices = 0;
  for (std::size_t at = 0; at < file.size(); ++matrices) {
    const auto damaged = [&](const std::string& what) {
      return BadData(
          fmt::format("{}: byte {}: matrix {} of a MATLAB file of level 4 has {}: the file is damaged, or "
                      "no file of MATLAB",
                      source, at, matrices + 1, what));
    };
    if (file.size() - at < head) throw damaged("a head that does not end within the file");
    const bool little = number(file, at, true) <= most_type;
    const auto word = [&](std::size_t i) { return std::uint64_t{number(file, at + 4 * i, little)}; };
    const std::uint64_t type = word(0), precision = type / 10 % 10;
    if (type > most_type || precision >= bytes_of.size()) throw damaged(fmt::format("the type {}", type));
    if (word(3) > 1) throw damaged(fmt::format("an imaginary part numbered {}", word(3)));
    const std::uint64_t left = file.size() - at - head;
    if (word(4) > left) throw damaged(fmt::format("a name of {} bytes", word(4)));
    const std::uint64_t most = left / bytes_of[precision] / (1 + word(3));
    if (word(2) != 0 && word(1) > most / word(2)) throw damaged(fmt::format("{} x {} numbers", word(1), word(2)));
    const std::uint64_t size = word(4) + word(1) * word(2) * bytes_of[precision] * (1 + word(3));
    if (size > left) throw damaged("numbers that do not end within the file");
    at += head + size;
  }
  return matrices;
}

}  // namespace touchstone::importing
