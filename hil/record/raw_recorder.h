// Writes a raw recording while it is measured. push() is for the thread that reads the device: it allocates nothing,
// takes no lock and does no I/O; a second thread writes blocks and tells the disk to keep them. Memory is bounded by
// the ring. On a full disk nothing written is harmed: the writer cuts back to the last whole block, tries again while
// the ring holds, and at the end saves the rest to the spill folder.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "record/raw_recording.h"

namespace touchstone::hil {

struct RawRecorderOptions {
  std::uint32_t block_samples = 500;  // a tenth of a second at 5 kHz is what a crash can cost,
  double block_s = 0.05;              // and less for slower streams: samples wait no longer than this for their block
  // 105 s at 5 kHz: with 13 s a busy machine lost samples in an hour; whether disk or scheduling kept the writer is not
  // known.
  std::size_t ring_samples = 1U << 19U;
  double sync_s = 1.0;                 // how often the disk is told to keep it
  std::filesystem::path spill_folder;  // empty: the system's folder for temporary files
};

// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding): the two ends of the ring have a cache line each
class RawRecorder {
 public:
  // Throws BadData when the file exists (a recording is never overwritten) or cannot be made.
  RawRecorder(std::filesystem::path path, const RawHeader& header, const RawRecorderOptions& options);
  ~RawRecorder();
  RawRecorder(const RawRecorder&) = delete;
  RawRecorder& operator=(const RawRecorder&) = delete;

  // False when the ring is full: the sample is lost, and counted.
  bool push(const RawSample& sample) noexcept;
  // Writes the rest and closes. Throws BadData when it had to go elsewhere, naming the spill file, or nowhere.
  void finish();

  [[nodiscard]] std::uint64_t written() const noexcept { return written_; }
  [[nodiscard]] std::uint64_t lost() const noexcept { return lost_; }
  [[nodiscard]] bool stalled() const noexcept { return stalled_; }  // the disk does not take it
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

 private:
  void work();
  std::size_t take(std::string& samples, std::uint32_t most);
  bool append(const std::string& bytes);
  void spill();

  std::filesystem::path path_;
  RawHeader header_;
  RawRecorderOptions options_;
  int fd_ = -1;
  std::uint64_t good_bytes_ = 0;  // the file's length up to the last whole block
  std::vector<RawSample> ring_;
  alignas(64) std::atomic<std::uint64_t> head_{0};  // next to write into the ring
  alignas(64) std::atomic<std::uint64_t> tail_{0};  // next to take out of it
  std::atomic<std::uint64_t> written_{0}, lost_{0};
  std::atomic<bool> stalled_{false}, stop_{false};
  std::string pending_;  // a block that the disk did not take
  std::uint32_t pending_samples_ = 0;
  std::string failure_;
  std::thread thread_;
};

}  // namespace touchstone::hil
