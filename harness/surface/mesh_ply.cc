// PLY (Stanford polygon format): text, binary little- and big-endian. Vertices need x, y, z; faces need the list
// vertex_indices (or vertex_index). Other elements and properties are skipped. Triangle strips
// (element tristrips: -1 ends one, and every second triangle runs the other way) become triangles.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>

#include "harness/surface/mesh_soup.h"

namespace touchstone::surface::mesh_readers {
namespace {

enum class Type { i8, u8, i16, u16, i32, u32, f32, f64 };
enum class Encoding { text, little, big };

struct Property {
  std::string_view name;
  Type type;
  std::optional<Type> count_type;  // of a list
};
struct Element {
  std::string_view name;
  std::int64_t count;
  std::vector<Property> properties;
};
struct Header {
  Encoding encoding = Encoding::text;
  std::vector<Element> elements;
};

std::size_t size_of(Type type) {
  constexpr std::array<std::size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

Type type_named(std::string_view word, const Soup& soup, std::uint64_t line) {
  constexpr std::array<std::array<std::string_view, 2>, 8> names{{{"char", "int8"},
                                                                  {"uchar", "uint8"},
                                                                  {"short", "int16"},
                                                                  {"ushort", "uint16"},
                                                                  {"int", "int32"},
                                                                  {"uint", "uint32"},
                                                                  {"float", "float32"},
                                                                  {"double", "float64"}}};
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (word == names[i][0] || word == names[i][1]) return static_cast<Type>(i);
  }
  soup.fail_at("line", line, fmt::format("{} is not a type of PLY", quoted(word)));
}

Type whole_type_named(std::string_view word, const Soup& soup, std::uint64_t line) {
  const Type type = type_named(word, soup, line);
  if (type == Type::f32 || type == Type::f64) soup.fail_at("line", line, "the count of a list must be a whole number");
  return type;
}

Header read_header(Lines& lines, const Soup& soup) {
  Header header;
  if (!lines.next()) soup.fail("is empty");
  if (lines.words()[0] != "ply") soup.fail_at("line", lines.number(), "a PLY file starts with the word ply");
  bool has_format = false;
  while (lines.next()) {
    const auto words = lines.words();
    const auto line = lines.number();
    const auto need = [&](std::size_t n) {
      if (words.size() < n)
        soup.fail_at("line", line, fmt::format("{} needs {} more words", quoted(words[0]), n - words.size()));
    };
    if (words[0] == "end_header") {
      if (!has_format) soup.fail_at("line", line, "the header names no format");
      return header;
    }
    if (words[0] == "format") {
      need(2);
      has_format = true;
      if (words[1] == "ascii")
        header.encoding = Encoding::text;
      else if (words[1] == "binary_little_endian")
        header.encoding = Encoding::little;
      else if (words[1] == "binary_big_endian")
        header.encoding = Encoding::big;
      else
        soup.fail_at("line", line,
                     fmt::format("unknown format {}; expected ascii, binary_little_endian or binary_big_endian",
                                 quoted(words[1])));
    } else if (words[0] == "element") {
      need(3);
      const std::int64_t count = to_integer(words[2], soup, line);
      if (count < 0) soup.fail_at("line", line, "a count must not be negative");
      header.elements.push_back({words[1], count, {}});
    } else if (words[0] == "property") {
      need(3);
      if (header.elements.empty()) soup.fail_at("line", line, "a property before the first element");
      auto& properties = header.elements.back().properties;
      if (words[1] == "list") {
        need(5);
        properties.push_back({words[4], type_named(words[3], soup, line), whole_type_named(words[2], soup, line)});
      } else {
        properties.push_back({words[2], type_named(words[1], soup, line), std::nullopt});
      }
    } else if (words[0] != "comment" && words[0] != "obj_info") {
      soup.fail_at("line", line, fmt::format("{} is not a word of a PLY header", quoted(words[0])));
    }
  }
  soup.fail("ends within the header");
}

// The numbers of the body one after the other, whatever their encoding.
class Body {
 public:
  Body(std::string_view bytes, Lines& lines, Encoding encoding, const Soup& soup)
      : bytes_(bytes), position_(lines.offset()), lines_(lines), encoding_(encoding), soup_(soup) {}

  // One element (a line of text) starts.
  void begin(const Element& element, std::int64_t index) {
    element_ = &element;
    index_ = index;
    if (encoding_ != Encoding::text) return;
    if (!lines_.next()) truncated();
    word_ = 0;
  }
  double number(Type type) {
    if (encoding_ != Encoding::text) return binary(type);
    if (word_ >= lines_.words().size())
      soup_.fail_at("line", lines_.number(),
                    fmt::format("{} {}: the line ends too early", quoted(element_->name), index_));
    return to_double(lines_.words()[word_++], soup_, lines_.number());
  }
  std::int64_t whole(Type type) {
    const double value = number(type);
    // Also false for NaN; above 2^53 a double no longer names one integer.
    if (!(value >= -9007199254740992.0 && value <= 9007199254740992.0) ||
        static_cast<double>(static_cast<std::int64_t>(value)) != value) {
      soup_.fail(fmt::format("{} {}: {} is not a whole number", quoted(element_->name), index_, value));
    }
    return static_cast<std::int64_t>(value);
  }
  // The count of a list, which the rest of the file can hold.
  std::int64_t list_length(const Property& property) {
    const std::int64_t n = whole(*property.count_type);
    const std::size_t left = encoding_ == Encoding::text ? lines_.words().size() - word_
                                                         : (bytes_.size() - position_) / size_of(property.type);
    if (n < 0 || static_cast<std::size_t>(n) > left) {
      soup_.fail(fmt::format("{} {}: a list of {} numbers, but only {} follow; is the file truncated?",
                             quoted(element_->name), index_, n, left));
    }
    return n;
  }
  [[nodiscard]] bool at_end() { return encoding_ == Encoding::text ? !lines_.next() : position_ == bytes_.size(); }
  // The least number of bytes that one element takes.
  [[nodiscard]] std::size_t least_bytes(const Element& element) const {
    std::size_t sum = 0;
    for (const Property& property : element.properties)
      sum += encoding_ == Encoding::text ? 2 : size_of(property.count_type.value_or(property.type));
    return std::max<std::size_t>(sum, 1);
  }

 private:
  [[noreturn]] void truncated() const {
    soup_.fail(
        fmt::format("ends within {} {} of {}; is it truncated?", quoted(element_->name), index_, element_->count));
  }
  double binary(Type type) {
    const std::size_t size = size_of(type);
    if (bytes_.size() - position_ < size) truncated();
    std::array<char, 8> raw{};
    std::memcpy(raw.data(), bytes_.data() + position_, size);
    position_ += size;
    if (encoding_ == Encoding::big) std::reverse(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(size));
    const auto as = [&]<class T>(T value) {
      std::memcpy(&value, raw.data(), sizeof value);
      return static_cast<double>(value);
    };
    switch (type) {
      case Type::i8:
        return as(std::int8_t{});
      case Type::u8:
        return as(std::uint8_t{});
      case Type::i16:
        return as(std::int16_t{});
      case Type::u16:
        return as(std::uint16_t{});
      case Type::i32:
        return as(std::int32_t{});
      case Type::u32:
        return as(std::uint32_t{});
      case Type::f32:
        return as(float{});
      case Type::f64:
        return as(double{});
    }
    return 0.0;
  }

  std::string_view bytes_;
  std::size_t position_;
  Lines& lines_;
  Encoding encoding_;
  const Soup& soup_;
  const Element* element_ = nullptr;
  std::int64_t index_ = 0;
  std::size_t word_ = 0;
};

void read_vertices(const Element& element, Body& body, Soup& soup) {
  std::array<std::optional<std::size_t>, 3> column;
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const std::string_view name = element.properties[i].name;
    if (!element.properties[i].count_type && name.size() == 1 && name[0] >= 'x' && name[0] <= 'z')
      column[static_cast<std::size_t>(name[0] - 'x')] = i;
  }
  if (!column[0] || !column[1] || !column[2]) soup.fail("the element vertex has no properties x, y and z");
  for (std::int64_t v = 0; v < element.count; ++v) {
    body.begin(element, v);
    Vec3 p = Vec3::Zero();
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const Property& property = element.properties[i];
      if (property.count_type) {
        for (std::int64_t n = body.list_length(property); n > 0; --n) body.number(property.type);
        continue;
      }
      const double value = body.number(property.type);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (i == *column[axis]) p[static_cast<Eigen::Index>(axis)] = value;
      }
    }
    soup.add_vertex(p, "vertex", static_cast<std::uint64_t>(v));
  }
}

void read_faces(const Element& element, Body& body, Soup& soup) {
  std::vector<std::int64_t> corners;
  for (std::int64_t f = 0; f < element.count; ++f) {
    body.begin(element, f);
    bool found = false;
    for (const Property& property : element.properties) {
      if (!property.count_type) {
        body.number(property.type);
        continue;
      }
      const bool wanted = property.name == "vertex_indices" || property.name == "vertex_index";
      const std::int64_t n = body.list_length(property);
      if (wanted) corners.clear();
      for (std::int64_t i = 0; i < n; ++i) {
        if (wanted)
          corners.push_back(body.whole(property.type));
        else
          body.number(property.type);
      }
      found = found || wanted;
    }
    if (!found) soup.fail("the element face has no list vertex_indices");
    soup.add_polygon(corners, "face", static_cast<std::uint64_t>(f));
  }
}

// A triangle that names a vertex twice joins two strips and is none.
void read_strips(const Element& element, Body& body, Soup& soup) {
  for (std::int64_t e = 0; e < element.count; ++e) {
    body.begin(element, e);
    for (const Property& property : element.properties) {
      std::int64_t n = property.count_type ? body.list_length(property) : 1;
      const bool wanted = property.count_type && (property.name == "vertex_indices" || property.name == "vertex_index");
      std::array<std::int64_t, 3> corners{};
      for (std::int64_t in_strip = 0; n > 0; --n) {
        if (!wanted) {
          body.number(property.type);
          continue;
        }
        const std::int64_t corner = body.whole(property.type);
        corners = {corners[1], corners[2], corner};
        in_strip = corner < 0 ? 0 : in_strip + 1;
        if (in_strip < 3 || corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
        const bool other_way = in_strip % 2 == 0;
        const std::array<std::int64_t, 3> triangle{corners[other_way ? 1 : 0], corners[other_way ? 0 : 1], corners[2]};
        soup.add_polygon(triangle, "strip", static_cast<std::uint64_t>(e));
      }
    }
  }
}

}  // namespace

void read_ply(std::string_view bytes, Soup& soup) {
  Lines lines(bytes);
  const Header header = read_header(lines, soup);
  Body body(bytes, lines, header.encoding, soup);
  for (const Element& element : header.elements) {
    // A header may claim billions of elements: what the file cannot hold is refused before anything is reserved.
    if (element.count > 0 && static_cast<std::uint64_t>(element.count) > bytes.size() / body.least_bytes(element)) {
      soup.fail(fmt::format("the header announces {} of {}, but the file has only {} bytes; is it truncated?",
                            element.count, quoted(element.name), bytes.size()));
    }
    if (element.name == "vertex") {
      read_vertices(element, body, soup);
    } else if (element.name == "face") {
      read_faces(element, body, soup);
    } else if (element.name == "tristrips") {
      read_strips(element, body, soup);
    } else {
      for (std::int64_t i = 0; i < element.count; ++i) {
        body.begin(element, i);
        for (const Property& property : element.properties) {
          for (std::int64_t n = property.count_type ? body.list_length(property) : 1; n > 0; --n)
            body.number(property.type);
        }
      }
    }
  }
  if (!body.at_end()) soup.fail("has more data than its header announces; are the counts right?");
}

}  // namespace touchstone::surface::mesh_readers
