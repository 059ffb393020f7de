// Reads a dataset whose chunks are stored as Touchstone writes them: one value after another in one dimension, doubles
// or bytes, shuffled, deflated, each chunk with a Fletcher-32 checksum (HDF5 file format specification 3.0, IV.A.2.l).
// HDF5's own pipeline does it with zlib behind one lock; here libdeflate decodes, twice as fast, and outside the lock.
#pragma once

#include <hdf5.h>

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

struct libdeflate_decompressor;

namespace touchstone::recording {

// How the chunks of such a dataset are stored.
struct ChunkLayout {
  std::size_t rows = 0;         // values per chunk; the last is padded
  std::size_t value_bytes = 0;  // 8: little-endian double, 1: unsigned
};

// Nothing for a dataset that is stored in any other way: HDF5 itself then reads it. One that is stored so cannot hold
// damaged values unnoticed, and decoding it follows nothing that the file says.
std::optional<ChunkLayout> checksummed_chunks(hid_t dataset);

// A stored chunk and where its values go.
struct StoredChunk {
  std::vector<unsigned char> bytes;
  unsigned skipped_filters = 0;  // a bit for each filter that was not applied
  std::size_t first = 0;         // the first of its values that is wanted
  std::span<double> to;          // as many as are wanted
  hsize_t row = 0;               // of its first wanted value in the dataset
};

struct ChunkDamage {
  hsize_t row = 0;
  std::string what;
};

// Reads and decodes in two calls, so that the second needs no lock; keeps its memory from one to the next.
class ChunkReader {
 public:
  ChunkReader();
  ~ChunkReader();
  ChunkReader(const ChunkReader&) = delete;
  ChunkReader& operator=(const ChunkReader&) = delete;

  // Fetches what gives rows [row, row + to.size()); `to` must live until decode(). False when HDF5 cannot hand the
  // stored chunks out (one was never written, the file is damaged): H5Dread then fills in or says why.
  bool fetch(hid_t dataset, const ChunkLayout& layout, hsize_t row, std::span<double> to);
  // Fills it. Nothing: all is well.
  std::optional<ChunkDamage> decode();

 private:
  std::optional<std::string> decode(const StoredChunk& chunk);

  libdeflate_decompressor* decompressor_;
  ChunkLayout layout_;
  std::vector<StoredChunk> chunks_;
  std::size_t used_ = 0;  // of chunks_
  std::vector<unsigned char> scratch_;
};

}  // namespace touchstone::recording
