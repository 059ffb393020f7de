#include "harness/recording/hdf5_chunks.h"

#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "harness/recording/hdf5_filters.h"
#include "harness/recording/hdf5_handle.h"

namespace touchstone::recording {
namespace {

// The filters in the order of writing; bit i of `skipped_filters` is the i-th.
constexpr std::array<H5Z_filter_t, 3> pipeline{H5Z_FILTER_SHUFFLE, H5Z_FILTER_DEFLATE, H5Z_FILTER_FLETCHER32};
constexpr unsigned without_shuffle = 1;
constexpr unsigned without_deflate = 2;
constexpr unsigned without_checksum = 4;
constexpr std::size_t checksum_bytes = 4;

// What is left of the stored bytes after the checksum at their end, which must be theirs.
std::optional<std::span<const unsigned char>> without_sum(std::span<const unsigned char> stored) {
  if (stored.size() < checksum_bytes) return std::nullopt;
  const auto body = stored.first(stored.size() - checksum_bytes);
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < checksum_bytes; ++i) sum |= std::uint32_t{stored[body.size() + i]} << (8 * i);
  return sum == fletcher32(body) ? std::optional(body) : std::nullopt;
}

}  // namespace

std::optional<ChunkLayout> checksummed_chunks(hid_t dataset) {
  const Hdf5Properties properties(H5Dget_create_plist(dataset));
  const Hdf5Type type(H5Dget_type(dataset));
  if (!properties || !type || H5Pget_layout(properties.get()) != H5D_CHUNKED) return std::nullopt;
  if (H5Pget_nfilters(properties.get()) != static_cast<int>(pipeline.size())) return std::nullopt;
  for (unsigned i = 0; i < pipeline.size(); ++i) {
    std::size_t values = 0;
    if (H5Pget_filter2(properties.get(), i, nullptr, &values, nullptr, 0, nullptr, nullptr) != pipeline[i])
      return std::nullopt;
  }
  hsize_t rows = 0;
  if (H5Pget_chunk(properties.get(), 1, &rows) != 1 || rows == 0) return std::nullopt;
  unsigned options = 0;  // the last chunk can be stored without filters
  if (H5Pget_chunk_opts(properties.get(), &options) < 0 || options != 0) return std::nullopt;
  ChunkLayout layout{static_cast<std::size_t>(rows), H5Tget_size(type.get())};
  const bool is_double = H5Tequal(type.get(), H5T_IEEE_F64LE) > 0;
  const bool is_byte = H5Tequal(type.get(), H5T_STD_U8LE) > 0;
  // More than a file that Touchstone wrote can hold in a chunk: nothing of that size is made room for.
  constexpr std::size_t most_rows = std::size_t{1} << 20U;
  if ((!is_double && !is_byte) || layout.rows > most_rows) return std::nullopt;
  return layout;
}

ChunkReader::ChunkReader() : decompressor_(libdeflate_alloc_decompressor()) {
  if (decompressor_ == nullptr) throw std::bad_alloc();
}

ChunkReader::~ChunkReader() { libdeflate_free_decompressor(decompressor_); }

bool ChunkReader::fetch(hid_t dataset, const ChunkLayout& layout, hsize_t row, std::span<double> to) {
  layout_ = layout;
  used_ = 0;
  // A chunk that deflate could not shrink is at most itself, the checksum and deflate's own few bytes.
  const hsize_t most_stored = 2 * layout.rows * layout.value_bytes + 1024;
  for (std::size_t done = 0; done < to.size(); ++used_) {
    if (used_ == chunks_.size()) chunks_.emplace_back();
    StoredChunk& chunk = chunks_[used_];
    chunk.row = row + done;
    const hsize_t start = chunk.row - chunk.row % layout.rows;
    chunk.first = static_cast<std::size_t>(chunk.row - start);
    chunk.to = to.subspan(done, std::min(layout.rows - chunk.first, to.size() - done));
    hsize_t size = 0;
    if (H5Dget_chunk_storage_size(dataset, &start, &size) < 0 || size == 0 || size > most_stored) return false;
    chunk.bytes.resize(size);
    if (H5Dread_chunk(dataset, H5P_DEFAULT, &start, &chunk.skipped_filters, chunk.bytes.data()) < 0) return false;
    done += chunk.to.size();
  }
  return true;
}

std::optional<std::string> ChunkReader::decode(const StoredChunk& chunk) {
  const std::size_t whole = layout_.rows * layout_.value_bytes;
  std::span<const unsigned char> bytes = chunk.bytes;
  if ((chunk.skipped_filters & without_checksum) == 0) {
    const auto body = without_sum(bytes);
    if (!body) return "the checksum of its values is wrong";
    bytes = *body;
  }
  if ((chunk.skipped_filters & without_deflate) == 0) {
    scratch_.resize(whole);
    std::size_t got = 0;
    const auto status =
        libdeflate_zlib_decompress(decompressor_, bytes.data(), bytes.size(), scratch_.data(), whole, &got);
    if (status != LIBDEFLATE_SUCCESS || got != whole) return "its values cannot be inflated";
    bytes = scratch_;
  }
  if (bytes.size() != whole) return "a chunk of values has the wrong size";
  if (layout_.value_bytes == 1) {
    std::copy_n(bytes.data() + chunk.first, chunk.to.size(), chunk.to.begin());
  } else if ((chunk.skipped_filters & without_shuffle) == 0) {
    unshuffle(bytes.data(), layout_.rows, chunk.first, chunk.to);
  } else {
    std::memcpy(chunk.to.data(), bytes.data() + chunk.first * sizeof(double), chunk.to.size_bytes());
  }
  return std::nullopt;
}

std::optional<ChunkDamage> ChunkReader::decode() {
  for (std::size_t i = 0; i < used_; ++i) {
    if (auto what = decode(chunks_[i])) return ChunkDamage{chunks_[i].row, std::move(*what)};
  }
  return std::nullopt;
}

}  // namespace touchstone::recording
