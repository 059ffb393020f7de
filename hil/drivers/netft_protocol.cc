#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <pugixml.hpp>

#include "drivers/netft.h"
#include "harness/base/error.h"

namespace touchstone::hil {
namespace {

void put(unsigned char* to, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) to[i] = static_cast<unsigned char>(value >> (24 - 8 * i));
}

std::uint32_t get(const unsigned char* from) {
  std::uint32_t value = 0;
  for (int i = 0; i < 4; ++i) value = value << 8U | from[i];
  return value;
}

std::string trimmed(std::string_view word) {
  constexpr std::string_view blank = " \t\r\n";
  const auto first = word.find_first_not_of(blank);
  return first == std::string_view::npos ? ""
                                         : std::string(word.substr(first, word.find_last_not_of(blank) - first + 1));
}

constexpr double pound_N = 4.4482216152605, inch_m = 0.0254, kilogram_force_N = 9.80665;

}  // namespace

NetFtConfiguration parse_netft_configuration(std::string_view xml, const std::string& source) {
  pugi::xml_document document;
  const auto parsed = document.load_buffer(xml.data(), xml.size());
  if (!parsed)
    throw BadData(fmt::format("{}: is not XML: {} at byte {}; is this a Net F/T's address?", source,
                              parsed.description(), parsed.offset));
  const auto root = document.document_element();
  const auto text = [&](const char* name) -> std::string {
    const auto node = root.child(name);
    if (!node) {
      throw BadData(fmt::format(
          "{}: has no <{}>, without which counts are not newtons; is this a Net F/T's netftapi2.xml?", source, name));
    }
    return trimmed(node.child_value());
  };
  const auto number = [&](const char* name) {
    const auto word = text(name);
    double value = 0.0;
    const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
    if (result.ec != std::errc() || result.ptr != word.data() + word.size() || !(value > 0.0) ||
        !std::isfinite(value)) {
      throw BadData(fmt::format("{}: <{}> is \"{}\"; a positive number was expected; set it on the sensor's own page",
                                source, name, word));
    }
    return value;
  };
  const auto unit = [&](const char* name, const std::map<std::string, double>& known) {
    const auto word = text(name);
    const auto found = known.find(word);
    if (found == known.end())
      throw BadData(
          fmt::format("{}: <{}> is the unit \"{}\", which is not known here; choose N or N-m, or the like, on the "
                      "sensor's own page",
                      source, name, word));
    return found->second;
  };
  NetFtConfiguration c;
  const double force = unit("scfgfu", {{"N", 1.0},
                                       {"kN", 1e3},
                                       {"lbf", pound_N},
                                       {"klbf", 1e3 * pound_N},
                                       {"kgf", kilogram_force_N},
                                       {"gf", 1e-3 * kilogram_force_N}});
  const double torque = unit("scfgtu", {{"Nm", 1.0},
                                        {"N-m", 1.0},
                                        {"Nmm", 1e-3},
                                        {"N-mm", 1e-3},
                                        {"kNm", 1e3},
                                        {"lbf-in", pound_N * inch_m},
                                        {"lbf-ft", 12 * pound_N * inch_m},
                                        {"kgf-cm", kilogram_force_N * 1e-2}});
  c.newtons_per_count = force / number("cfgcpf");
  c.newton_metres_per_count = torque / number("cfgcpt");
  // Whatever else there is helps; firmware versions differ in what they say and how they spell it.
  const auto first_of = [&](std::initializer_list<const char*> names) -> std::string {
    for (const char* const name : names) {
      if (const auto word = trimmed(root.child(name).child_value()); !word.empty()) return word;
    }
    return "";
  };
  c.serial = first_of({"cfgcalsn", "setserial"});
  const auto version = first_of({"mfgdigver"}), name = first_of({"cfgnam"});
  c.product = "Net F/T" + (version.empty() ? "" : " firmware " + version) + (name.empty() ? "" : ", " + name);
  const auto rate = first_of({"comrdtrate", "commrdtrate"});
  double value = 0.0;
  const auto result = std::from_chars(rate.data(), rate.data() + rate.size(), value);
  if (result.ec == std::errc() && std::isfinite(value) && value > 0.0) c.rate_Hz = value;
  return c;
}

std::array<unsigned char, rdt_request_bytes> encode_request(RdtCommand command, std::uint32_t samples) {
  std::array<unsigned char, rdt_request_bytes> bytes{0x12, 0x34};
  const auto code = static_cast<std::uint16_t>(command);
  bytes[2] = static_cast<unsigned char>(code >> 8U);
  bytes[3] = static_cast<unsigned char>(code & 0xffU);
  put(bytes.data() + 4, samples);
  return bytes;
}

RdtRecord decode_record(std::span<const unsigned char, rdt_record_bytes> bytes) {
  RdtRecord r;
  r.rdt_sequence = get(bytes.data());
  r.ft_sequence = get(bytes.data() + 4);
  r.status = get(bytes.data() + 8);
  for (std::size_t i = 0; i < 6; ++i) r.counts[i] = static_cast<std::int32_t>(get(bytes.data() + 12 + 4 * i));
  return r;
}

std::array<unsigned char, rdt_record_bytes> encode_record(const RdtRecord& r) {
  std::array<unsigned char, rdt_record_bytes> bytes{};
  put(bytes.data(), r.rdt_sequence);
  put(bytes.data() + 4, r.ft_sequence);
  put(bytes.data() + 8, r.status);
  for (std::size_t i = 0; i < 6; ++i) put(bytes.data() + 12 + 4 * i, static_cast<std::uint32_t>(r.counts[i]));
  return bytes;
}

SequenceTracker::Verdict SequenceTracker::accept(std::uint32_t sequence) {
  if (!started_) {
    started_ = true;
    last_ = sequence;
    seen_ = 1;
    ++counters_.received;
    return Verdict::next;
  }
  const std::uint32_t ahead = sequence - static_cast<std::uint32_t>(last_);  // modulo 2^32: rollover is a step of one
  const std::uint32_t behind = static_cast<std::uint32_t>(last_) - sequence;
  if (behind < 65536) {
    // Within the window we know whether it came before; older ones count as late.
    if (behind < 64 && (seen_ >> behind & 1U) != 0) {
      ++counters_.repeated;
      return Verdict::repeated;
    }
    if (behind < 64) seen_ |= std::uint64_t{1} << behind;
    ++counters_.reordered;
    if (counters_.lost > 0) --counters_.lost;  // it was counted as lost when it was skipped
    return Verdict::reordered;
  }
  last_ += ahead;
  seen_ = ahead < 64 ? seen_ << ahead | 1U : 1U;
  counters_.lost += ahead - 1;
  ++counters_.received;
  return ahead == 1 ? Verdict::next : Verdict::after_gap;
}

}  // namespace touchstone::hil
