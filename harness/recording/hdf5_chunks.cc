#include "harness/recording/hdf5_chunks.h"

#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "harness/recording/hdf5_handle.h"

namespace touchstone {
namespace {

// The filters in the order of writing; bit i of `skipped_filters` is the i-th.
constexpr std::array<H5Z_filter_t, 3> pipeline{H5Z_FILTER_SHUFFLE, H5Z_FILTER_DEFLATE, H5Z_FILTER_FLETCHER32};
constexpr unsigned without_shuffle = 1;
constexpr unsigned without_deflate = 2;
constexpr unsigned without_checksum = 4;
constexpr std::size_t checksum_bytes = 4;

// Fletcher's sum over big-endian 16-bit words, as HDF5 computes it.
std::uint32_t fletcher32(std::span<const unsigned char> bytes) {
  constexpr std::size_t words_without_overflow = 360;
  std::uint32_t low = 0;
  std::uint32_t high = 0;
  const auto fold = [](std::uint32_t sum) { return (sum & 0xffffU) + (sum >> 16U); };
  const unsigned char* at = bytes.data();
  for (std::size_t words = bytes.size() / 2; words > 0;) {
    const std::size_t block = std::min(words, words_without_overflow);
    for (std::size_t i = 0; i < block; ++i, at += 2) {
      low += (std::uint32_t{at[0]} << 8U) | at[1];
      high += low;
    }
    low = fold(low);
    high = fold(high);
    words -= block;
  }
  if (bytes.size() % 2 == 1) {
    low = fold(low + (std::uint32_t{*at} << 8U));
    high = fold(high + low);
  }
  return (fold(high) << 16U) | fold(low);
}

// What is left of the stored bytes after the checksum at their end, which must be theirs.
std::optional<std::span<const unsigned char>> without_sum(std::span<const unsigned char> stored) {
  if (stored.size() < checksum_bytes) return std::nullopt;
  const auto body = stored.first(stored.size() - checksum_bytes);
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < checksum_bytes; ++i) sum |= std::uint32_t{stored[body.size() + i]} << (8 * i);
  return sum == fletcher32(body) ? std::optional(body) : std::nullopt;
}

std::uint64_t eight_bytes(const unsigned char* bytes) {
  std::uint64_t word = 0;
  std::memcpy(&word, bytes, sizeof word);
  return word;
}

// Swaps the two off-diagonal blocks of each pair of words.
template <unsigned Bits>
inline void swap_blocks(std::uint64_t& upper, std::uint64_t& lower, std::uint64_t mask) {
  const std::uint64_t other = ((upper >> Bits) ^ lower) & mask;
  lower ^= other;
  upper ^= other << Bits;
}

// Warren, Hacker's Delight, section 7-3, for bytes.
inline void transpose(std::array<std::uint64_t, 8>& r) {
  constexpr std::uint64_t quarters = 0x00000000ffffffffU;
  constexpr std::uint64_t pairs = 0x0000ffff0000ffffU;
  constexpr std::uint64_t single = 0x00ff00ff00ff00ffU;
  swap_blocks<32>(r[0], r[4], quarters);
  swap_blocks<32>(r[1], r[5], quarters);
  swap_blocks<32>(r[2], r[6], quarters);
  swap_blocks<32>(r[3], r[7], quarters);
  swap_blocks<16>(r[0], r[2], pairs);
  swap_blocks<16>(r[1], r[3], pairs);
  swap_blocks<16>(r[4], r[6], pairs);
  swap_blocks<16>(r[5], r[7], pairs);
  swap_blocks<8>(r[0], r[1], single);
  swap_blocks<8>(r[2], r[3], single);
  swap_blocks<8>(r[4], r[5], single);
  swap_blocks<8>(r[6], r[7], single);
}

// The i-th byte of every value stands in the i-th of eight rows of `count` bytes: takes `to.size()` values from the
// `first` on, eight at a time.
void unshuffle(const unsigned char* bytes, std::size_t count, std::size_t first, std::span<double> to) {
  static_assert(std::endian::native == std::endian::little);
  std::size_t done = 0;
  for (; done + 8 <= to.size(); done += 8) {
    std::array<std::uint64_t, 8> rows{};
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = eight_bytes(bytes + i * count + first + done);
    transpose(rows);
    std::memcpy(&to[done], rows.data(), sizeof rows);
  }
  for (; done < to.size(); ++done) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof bits; ++i) bits |= std::uint64_t{bytes[i * count + first + done]} << (8 * i);
    to[done] = std::bit_cast<double>(bits);
  }
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

}  // namespace touchstone
