// Measurements of LabVIEW and DIAdem, .tdms of version 2.0 ("TDMS File Format Internal Structure", National
// Instruments): segments, each a lead-in, what changed of its objects, and the numbers of its channels, one channel
// after the other or interleaved. A group is a table; the time of a waveform is wf_start_offset + i wf_increment. What
// NI's library would scale, text and raw DAQmx data are left out with that reason.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "array_tables.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "import_table.h"
#include "raw_number.h"

namespace touchstone::importing {
namespace {

enum Contents : std::uint32_t {
  has_metadata = 1U << 1U,
  has_new_list = 1U << 2U,
  has_raw_data = 1U << 3U,
  is_interleaved = 1U << 5U,
  is_big_endian = 1U << 6U,
  has_daqmx_data = 1U << 7U
};

enum Type : std::uint32_t { text_type = 0x20, time_type = 0x44 };

struct TypeOf {
  std::uint32_t type;
  char kind;  // of NumberType; 0: no real number of that size
  std::size_t bytes;
};
// 0x19 and 0x1a are of numbers with a unit; the others without a kind are extended and complex ones.
constexpr auto types = std::to_array<TypeOf>({{1, 'i', 1},
                                              {2, 'i', 2},
                                              {3, 'i', 4},
                                              {4, 'i', 8},
                                              {5, 'u', 1},
                                              {6, 'u', 2},
                                              {7, 'u', 4},
                                              {8, 'u', 8},
                                              {9, 'f', 4},
                                              {10, 'f', 8},
                                              {0x19, 'f', 4},
                                              {0x1a, 'f', 8},
                                              {0x21, 'u', 1},
                                              {11, 0, 16},
                                              {0x1b, 0, 16},
                                              {time_type, 't', 16},
                                              {0x08000c, 0, 8},
                                              {0x10000d, 0, 16}});

TypeOf type_of(std::uint32_t type) {
  const auto found = std::ranges::find(types, type, &TypeOf::type);
  return found == types.end() ? TypeOf{type, 0, 0} : *found;
}

std::size_t bytes_of_type(std::uint32_t type) { return type_of(type).bytes; }

// Nothing for types that are no real number.
std::optional<double> value_at(const char* at, std::uint32_t type, bool big) {
  const TypeOf of = type_of(type);
  if (of.kind == 0) return std::nullopt;
  if (of.kind != 't') return number_at(at, {of.kind, of.bytes, big});
  // Fractions of 2^-64 s and seconds since 1904; the other way round where the most significant byte is first.
  constexpr double to_1970_s = 2082844800.0, fraction_s = 5.421010862427522e-20;
  return static_cast<double>(raw_number<std::int64_t>(at + (big ? 0 : 8), big)) - to_1970_s +
         static_cast<double>(raw_number<std::uint64_t>(at + (big ? 8 : 0), big)) * fraction_s;
}

struct Channel {
  std::string group, name, unit, left_out;  // why it is
  std::optional<double> start_s, increment_s;
  std::uint32_t type = 0;
  std::uint64_t count = 0, bytes = 0;  // of one chunk
  bool has_index = false;
  std::vector<double> values;
};

class TdmsFile {
 public:
  TdmsFile(std::string source, std::string_view bytes) : source_(std::move(source)), file_(bytes) {}

  void read() {
    constexpr std::size_t lead_in = 28;
    while (at_ < file_.size()) {
      segment_at_ = at_;
      end_ = file_.size();
      if (file_.size() - at_ < lead_in || file_.substr(at_, 4) != "TDSm") damaged("no segment begins there");
      contents_ = raw_number<std::uint32_t>(file_.data() + at_ + 4, false);  // whatever the order of the others
      big_ = (contents_ & is_big_endian) != 0;
      at_ += 8;
      take<std::uint32_t>();  // version
      const auto next = take<std::uint64_t>(), raw = take<std::uint64_t>();
      if (next == ~std::uint64_t{0}) damaged("the program that wrote it was stopped before it was finished");
      if (next > file_.size() - at_ || raw > next) damaged("it does not end within the file: was it cut short?");
      const std::size_t raw_at = at_ + raw;
      const std::size_t segment_end = at_ + next;
      end_ = raw_at;
      if ((contents_ & has_metadata) != 0) read_objects();
      end_ = segment_end;
      at_ = raw_at;
      if ((contents_ & has_raw_data) != 0) read_raw(file_.substr(raw_at, segment_end - raw_at));
      at_ = segment_end;
    }
  }

  std::vector<ImportTable> finish() {
    ArrayTables tables(source_, "TDMS");
    std::map<std::pair<std::size_t, std::string>, std::vector<const Channel*>> by_table;
    for (const std::string& path : order_) {
      const Channel& channel = channels_.at(path);
      if (channel.name.empty() || (!channel.has_index && channel.left_out.empty())) continue;
      if (channel.left_out.empty()) by_table[{channel.values.size(), channel.group}].push_back(&channel);
      if (!channel.left_out.empty()) tables.leave_out(channel.group + ":" + channel.name, channel.left_out);
    }
    for (const auto& [key, channels] : by_table) {
      const Channel& first = *channels.front();
      const bool clocked =
          first.increment_s && *first.increment_s > 0.0 && std::ranges::all_of(channels, [&](const Channel* c) {
            return c->increment_s == first.increment_s && c->start_s == first.start_s;
          });
      if (clocked) {
        tables.add(key.second, "waveform time", "s", key.first, 1, [&](std::size_t i, std::size_t) {
          return first.start_s.value_or(0.0) + static_cast<double>(i) * *first.increment_s;
        });
      }
      for (const Channel* channel : channels) {
        tables.add(key.second, channel->name, channel->unit, key.first, 1,
                   [&](std::size_t i, std::size_t) { return channel->values[i]; });
      }
    }
    return tables.finish();
  }

 private:
  [[noreturn]] void damaged(const std::string& why) const {
    throw BadData(fmt::format("{}: damaged TDMS file: the segment at byte {}: {}", source_, segment_at_, why));
  }

  const char* take_bytes(std::uint64_t count) {
    if (count > end_ - at_) damaged("what it says of its channels does not end before their numbers");
    const char* const at = file_.data() + at_;
    at_ += count;
    return at;
  }
  template <class T>
  T take() {
    return raw_number<T>(take_bytes(sizeof(T)), big_);
  }
  std::string take_text() {
    const auto length = take<std::uint32_t>();
    return {take_bytes(length), length};
  }

  void read_objects() {
    if ((contents_ & has_new_list) != 0) active_.clear();
    const auto objects = take<std::uint32_t>();
    for (std::uint32_t i = 0; i < objects; ++i) {
      const std::string path = take_text();
      const auto [found, is_new] = channels_.try_emplace(path);
      Channel& channel = found->second;
      if (is_new) order_.push_back(path), name_channel(path, channel);
      constexpr std::size_t most_objects = 10000;
      if (order_.size() > most_objects) damaged(fmt::format("the file has more than {} channels", most_objects));
      read_index(path, channel);
      const auto properties = take<std::uint32_t>();
      for (std::uint32_t p = 0; p < properties; ++p) read_property(channel);
    }
  }

  // "/'Group'/'Channel'"; a quote within a name stands twice.
  void name_channel(const std::string& path, Channel& channel) const {
    std::vector<std::string> parts;
    for (std::size_t i = 0; i < path.size(); ++i) {
      if (path[i] != '\'') continue;
      parts.emplace_back();
      for (++i; i < path.size() && (path[i] != '\'' || (i + 1 < path.size() && path[i + 1] == '\'')); ++i) {
        if (path[i] == '\'') ++i;
        parts.back() += path[i];
      }
    }
    if (parts.size() > 2) damaged("an object's name has more than a group and a channel");
    if (!parts.empty()) channel.group = parts[0];
    if (parts.size() == 2) channel.name = parts[1];
  }

  // Where the numbers of an object are in the segment.
  void read_index(const std::string& path, Channel& channel) {
    constexpr std::uint32_t none = 0xffffffffU, as_before = 0, daqmx_index = 0x1269, daqmx_scaled_index = 0x1369;
    const auto length = take<std::uint32_t>();
    const auto listed = std::ranges::find(active_, path);
    if (length == none) {
      if (listed != active_.end()) active_.erase(listed);
      return;
    }
    if (length == daqmx_index || length == daqmx_scaled_index || (contents_ & has_daqmx_data) != 0) {
      throw BadData(fmt::format(
          "{}: holds raw data of NI-DAQmx, which only NI's library scales: save it anew with scaled data, or as .lvm",
          source_));
    }
    if (listed == active_.end()) active_.push_back(path);
    if (length == as_before) {
      if (!channel.has_index) damaged("a channel is to have as many numbers as before, but it had none");
      return;
    }
    const auto type = take<std::uint32_t>(), dimension = take<std::uint32_t>();
    if (channel.has_index && channel.type != type) damaged("a channel changes its type");
    channel.type = type;
    channel.count = take<std::uint64_t>();
    channel.has_index = true;
    if (dimension != 1) damaged(fmt::format("a channel has {} dimensions, and only one is known", dimension));
    const std::size_t size = bytes_of_type(channel.type);
    if (channel.type != text_type && size == 0) damaged(fmt::format("type {} is not known", channel.type));
    if (channel.count > file_.size()) damaged("a channel says that it has more values than the file has bytes");
    channel.bytes = channel.type == text_type ? take<std::uint64_t>() : channel.count * size;
    if (channel.type == text_type) channel.left_out = "text";
    if (channel.type != text_type && type_of(channel.type).kind == 0) channel.left_out = "no real numbers";
  }

  void read_property(Channel& channel) {
    const std::string name = take_text();
    const auto type = take<std::uint32_t>();
    if (type == text_type) {
      const std::string text = take_text();
      if (name == "unit_string") channel.unit = text;
      if (name == "NI_Scaling_Status" && text == "unscaled") {
        channel.left_out = "raw counts, which NI's library scales: save it with scaled data";
      }
      return;
    }
    const std::size_t size = bytes_of_type(type);
    if (size == 0)
      damaged(fmt::format("the property '{}' is of type {}, which is not known", name.substr(0, 40), type));
    const auto value = value_at(take_bytes(size), type, big_);
    if (name == "wf_increment") channel.increment_s = value;
    if (name == "wf_start_offset") channel.start_s = value;
  }

  void read_raw(std::string_view raw) {
    std::vector<Channel*> channels;
    std::uint64_t chunk = 0;
    for (const std::string& path : active_) {
      Channel& channel = channels_.at(path);
      if (channel.bytes == 0) continue;
      if (channel.bytes > raw.size() - chunk) damaged("its channels have more numbers than it has bytes");
      channels.push_back(&channel);
      chunk += channel.bytes;
    }
    if (chunk == 0) return;
    if (raw.size() % chunk != 0) damaged("its numbers end within a channel: was it cut short?");
    const std::uint64_t chunks = raw.size() / chunk;
    if ((contents_ & is_interleaved) != 0) return read_interleaved(raw, channels, chunks);
    for (std::uint64_t c = 0; c < chunks; ++c) {
      for (Channel* channel : channels) {
        add_values(*channel, raw, channel->count, bytes_of_type(channel->type));
        raw.remove_prefix(channel->bytes);
      }
    }
  }

  void read_interleaved(std::string_view raw, const std::vector<Channel*>& channels, std::uint64_t chunks) {
    std::size_t row = 0;
    for (const Channel* channel : channels) {
      if (channel->type == text_type || channel->count != channels.front()->count) {
        damaged("its interleaved channels differ in their count");
      }
      row += bytes_of_type(channel->type);
    }
    for (Channel* channel : channels) {
      add_values(*channel, raw, chunks * channel->count, row);
      raw.remove_prefix(bytes_of_type(channel->type));
    }
  }

  void add_values(Channel& channel, std::string_view raw, std::uint64_t count, std::size_t stride) const {
    for (std::uint64_t i = 0; i < count && channel.left_out.empty(); ++i) {
      channel.values.push_back(value_at(raw.data() + i * stride, channel.type, big_).value_or(0.0));
    }
  }

  std::string source_;
  std::string_view file_;
  std::size_t at_ = 0, end_ = 0, segment_at_ = 0;
  std::uint32_t contents_ = 0;
  bool big_ = false;
  std::map<std::string, Channel> channels_;  // by path
  std::vector<std::string> order_, active_;  // paths in the order of the file; those with numbers in the segment
};

}  // namespace

std::vector<ImportTable> read_tdms_file(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  TdmsFile file(path.string(), bytes);
  file.read();
  return file.finish();
}

}  // namespace touchstone::importing
