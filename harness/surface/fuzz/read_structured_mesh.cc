#include "harness/surface/fuzz/read_structured_mesh.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <string>

#include "harness/surface/fuzz/read_mesh.h"
#include "harness/testing/choices.h"

namespace touchstone::surface::fuzz {
namespace {

using testing::Choices;

constexpr double corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
constexpr int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

double coordinate(Choices& c, double usual) { return c.one_in(24) ? c.number() : usual; }
std::int64_t index(Choices& c, int usual) { return c.one_in(16) ? static_cast<std::int64_t>(c.whole()) : usual; }
std::uint64_t declared(Choices& c, std::uint64_t usual) { return c.one_in(8) ? c.whole() : usual; }

std::string obj(Choices& c) {
  std::string text;
  for (const auto& v : corners) {
    text += fmt::format("v {} {} {}", coordinate(c, v[0]), coordinate(c, v[1]), coordinate(c, v[2]));
    text += c.one_in(16) ? c.text({" 1", " 0.1 0.2 0.3", " x", " \\\n 1"}) : "";
    text += "\n";
  }
  if (c.one_in(4)) text += "vt 0 0\nvn 0 0 1\n";
  for (const auto& f : faces) {
    text += "f";
    const std::size_t sides = c.one_in(16) ? c.below(9) : 3;
    for (std::size_t i = 0; i < sides; ++i) {
      text += fmt::format(" {}", index(c, (c.one_in(8) ? -4 : 1) + f[i % 3]));
      if (c.one_in(8)) text += c.text({"/1", "//1", "/1/1", "/", "/99", "//-1", "/x"});
    }
    text += "\n";
  }
  return text;
}

std::string off(Choices& c) {
  std::string text = c.one_in(8) ? c.text({"COFF", "NOFF", "4OFF", "OFF BINARY", "off", "# x\nOFF"}) : "OFF";
  text += fmt::format("\n{} {} {}\n", declared(c, 4), declared(c, 4), declared(c, 0));
  for (const auto& v : corners)
    text += fmt::format("{} {} {}\n", coordinate(c, v[0]), coordinate(c, v[1]), coordinate(c, v[2]));
  for (const auto& f : faces)
    text += fmt::format("{} {} {} {}\n", declared(c, 3), index(c, f[0]), index(c, f[1]), index(c, f[2]));
  return text;
}

template <class T>
void append(std::string& bytes, T value, bool big) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  for (std::size_t i = 0; i < sizeof(T); ++i) bytes += raw[big ? sizeof(T) - 1 - i : i];
}

std::string ply(Choices& c, bool binary) {
  const bool big = binary && c.below(2) == 1;
  std::string text = fmt::format("ply\nformat {} 1.0\n", !binary ? "ascii"
                                                         : big   ? "binary_big_endian"
                                                                 : "binary_little_endian");
  if (c.one_in(8)) text += "comment x\nobj_info y\n";
  text += fmt::format("element vertex {}\n", declared(c, 4));
  for (const char* const axis : {"x", "y", "z"}) {
    const char* const type = c.one_in(12) ? c.text({"double", "uchar", "int16", "list uchar float", "quad"}) : "float";
    text += fmt::format("property {} {}\n", type, c.one_in(24) ? "w" : axis);
  }
  if (c.one_in(8)) text += fmt::format("element edge {}\nproperty int vertex1\n", declared(c, 0));
  text += fmt::format("element face {}\n", declared(c, 4));
  const char* const count = c.one_in(12) ? c.text({"uint", "float", "char", "ushort"}) : "uchar";
  text += fmt::format("property list {} {} {}\n", count, c.one_in(12) ? c.text({"uchar", "double", "uint"}) : "int",
                      c.one_in(12) ? "corners" : "vertex_indices");
  if (!c.one_in(24)) text += "end_header\n";
  for (const auto& v : corners) {
    for (const double x : v) {
      const double value = coordinate(c, x);
      if (binary) {
        append(text, static_cast<float>(value), big);
      } else {
        text += fmt::format("{} ", value);
      }
    }
    if (!binary) text += "\n";
  }
  for (const auto& f : faces) {
    if (binary) {
      append(text, static_cast<std::uint8_t>(declared(c, 3)), big);
      for (const int i : f) append(text, static_cast<std::int32_t>(index(c, i)), big);
    } else {
      text += fmt::format("{} {} {} {}\n", declared(c, 3), index(c, f[0]), index(c, f[1]), index(c, f[2]));
    }
  }
  return text;
}

std::string stl(Choices& c, bool binary) {
  std::string text = binary ? std::string(80, c.one_in(4) ? 's' : '\0') : "solid x\n";
  if (binary) append(text, static_cast<std::uint32_t>(declared(c, 4)), false);
  for (const auto& f : faces) {
    if (!binary) text += "facet normal 0 0 1\nouter loop\n";
    if (binary) {
      for (int i = 0; i < 3; ++i) append(text, static_cast<float>(coordinate(c, 0.0)), false);
    }
    const std::size_t sides = !binary && c.one_in(16) ? c.below(6) : 3;
    for (std::size_t i = 0; i < sides; ++i) {
      if (!binary) text += "vertex";
      for (const double x : corners[f[i % 3]]) {
        if (binary) {
          append(text, static_cast<float>(coordinate(c, x)), false);
        } else {
          text += fmt::format(" {}", coordinate(c, x));
        }
      }
      if (!binary) text += "\n";
    }
    if (binary) append(text, static_cast<std::uint16_t>(declared(c, 0)), false);
    if (!binary) text += c.one_in(16) ? "endfacet\n" : "endloop\nendfacet\n";
  }
  return binary || c.one_in(16) ? text : text + "endsolid x\n";
}

std::size_t read(const std::string& bytes, MeshFormat format) {
  return read_mesh(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), format) ? 1 : 0;
}

std::size_t read(std::size_t which, Choices& c) {
  if (which == 0) return read(obj(c), MeshFormat::obj);
  if (which == 1) return read(off(c), MeshFormat::off);
  if (which <= 3) return read(ply(c, which == 3), MeshFormat::ply);
  return read(stl(c, which == 5), MeshFormat::stl);
}

}  // namespace

std::size_t read_structured_mesh(const std::uint8_t* data, std::size_t size) {
  Choices choices({data, size});
  if (size > 0) return read(choices.below(6), choices);
  std::size_t count = 0;
  for (std::size_t which = 0; which < 6; ++which) count += read(which, choices);
  return count;
}

}  // namespace touchstone::surface::fuzz
