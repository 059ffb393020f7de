#include "ros_tables.h"

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <numeric>

#include "harness/base/error.h"

namespace touchstone::importing {

void RosTables::note_topic(const std::string& name, const std::string& type) {
  list_ += fmt::format("{}{} ({})", list_.empty() ? "" : ", ", name, type);
}

void RosTables::add(const std::string& topic, const std::string& type, RosEncoding encoding,
                    std::span<const std::byte> message, double recorded_s) {
  auto found = topics_.find(topic);
  if (found == topics_.end()) {
    ImportTable table;
    table.names = ros_columns(type, encoding, message);
    if (table.names.empty()) return;
    table.name = topic;
    table.columns.resize(table.names.size());
    table.source = source_;
    table.format = fmt::format("{}, {}", kind_, type);
    table.names_from_file = true;
    found = topics_.emplace(topic, Topic{std::move(table), {}}).first;
  }
  auto& [table, recorded] = found->second;
  const std::string place = fmt::format("{}: topic {}, message {}", source_, topic, table.rows() + 1);
  const auto values = ros_values(type, encoding, message, recorded_s, place);
  if (values.size() != table.columns.size()) {
    throw BadData(fmt::format("{}: has {} values where the first had {}", place, values.size(), table.columns.size()));
  }
  for (std::size_t c = 0; c < values.size(); ++c) table.columns[c].push_back(values[c]);
  recorded.push_back(recorded_s);
}

std::vector<ImportTable> RosTables::finish() {
  std::vector<ImportTable> all;
  for (auto& [name, topic] : topics_) {
    const auto& recorded = topic.recorded_s;
    if (!std::ranges::is_sorted(recorded)) {
      std::vector<std::size_t> order(recorded.size());
      std::iota(order.begin(), order.end(), 0);
      std::ranges::stable_sort(order, {}, [&](std::size_t i) { return recorded[i]; });
      for (auto& column : topic.table.columns) {
        std::vector<double> sorted;
        sorted.reserve(column.size());
        for (const std::size_t i : order) sorted.push_back(column[i]);
        column = std::move(sorted);
      }
    }
    all.push_back(std::move(topic.table));
  }
  if (!all.empty()) return all;
  throw BadData(fmt::format("{}: no topic has messages of a force or pose that can be read; its topics: {}", source_,
                            list_.empty() ? "none" : list_));
}

std::optional<std::string> unpack_chunk(std::string_view packed, std::string_view compression, std::uint64_t size) {
  const std::unique_ptr<archive, int (*)(archive*)> in(archive_read_new(), archive_read_free);
  archive_read_support_format_raw(in.get());
  if (compression == "bz2") archive_read_support_filter_bzip2(in.get());
  if (compression == "lz4") archive_read_support_filter_lz4(in.get());
  if (compression == "zstd") archive_read_support_filter_zstd(in.get());
  archive_entry* entry = nullptr;
  std::string out;
  if (archive_read_open_memory(in.get(), packed.data(), packed.size()) == ARCHIVE_OK &&
      archive_read_next_header(in.get(), &entry) == ARCHIVE_OK) {
    constexpr std::size_t piece = std::size_t{1} << 20;
    while (out.size() <= size) {
      const std::size_t got = out.size();
      out.resize(got + piece);
      const auto more = archive_read_data(in.get(), out.data() + got, piece);
      out.resize(got + static_cast<std::size_t>(std::max<la_ssize_t>(more, 0)));
      if (more <= 0) break;
    }
  }
  return out.size() == size ? std::optional(std::move(out)) : std::nullopt;
}

}  // namespace touchstone::importing
