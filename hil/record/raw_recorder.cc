#include "record/raw_recorder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <stop_token>
#include <thread>

#include "harness/base/error.h"

namespace touchstone::hil {
namespace {

// Writes all, or says by errno why not.
bool write_all(int fd, const std::string& bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const auto n = ::write(fd, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

}  // namespace

RawRecorder::RawRecorder(std::filesystem::path path, const RawHeader& header, const RawRecorderOptions& options)
    : path_(std::move(path)), header_(header), options_(options), ring_(options.ring_samples) {
  fd_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (fd_ < 0) {
    throw BadData(fmt::format("{}: cannot be made: {}{}", path_.string(), std::strerror(errno),
                              errno == EEXIST ? "; a recording is never overwritten: choose another name" : ""));
  }
  const auto start = raw_format::file_start(header_);
  if (!write_all(fd_, start) || ::fdatasync(fd_) != 0) {
    const int error = errno;
    ::close(fd_);
    ::unlink(path_.c_str());
    throw BadData(fmt::format("{}: cannot be written: {}", path_.string(), std::strerror(error)));
  }
  good_bytes_ = start.size();
  pending_.reserve(raw_format::block_header_bytes + options_.block_samples * raw_format::largest_sample_bytes);
  thread_ = std::thread([this] { work(); });
}

RawRecorder::~RawRecorder() {
  try {
    finish();
  } catch (const BadData&) {
    // finish() called by the owner says it; a destructor cannot.
  }
}

std::size_t RawRecorder::memory_bytes() const noexcept {
  return ring_.size() * sizeof(RawSample) + pending_.capacity();
}

bool RawRecorder::push(const RawSample& sample) noexcept {
  const std::uint64_t head = head_.load(std::memory_order_relaxed);
  if (head - tail_.load(std::memory_order_acquire) >= ring_.size()) {
    ++lost_;
    return false;
  }
  ring_[head % ring_.size()] = sample;
  head_.store(head + 1, std::memory_order_release);
  return true;
}

std::size_t RawRecorder::take(std::string& samples, std::uint32_t most) {
  const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
  const std::uint64_t n = std::min<std::uint64_t>(head_.load(std::memory_order_acquire) - tail, most);
  samples.clear();
  for (std::uint64_t i = 0; i < n; ++i) raw_format::encode(ring_[(tail + i) % ring_.size()], header_, samples);
  tail_.store(tail + n, std::memory_order_release);
  return static_cast<std::size_t>(n);
}

bool RawRecorder::append(const std::string& bytes) {
  if (write_all(fd_, bytes)) {
    good_bytes_ += bytes.size();
    return true;
  }
  failure_ = std::strerror(errno);
  // Back to the last whole block, so that what is there stays sound.
  if (::ftruncate(fd_, static_cast<off_t>(good_bytes_)) == 0) ::lseek(fd_, static_cast<off_t>(good_bytes_), SEEK_SET);
  return false;
}

void RawRecorder::work() {
  MonotonicClock clock;
  std::string samples;
  std::uint64_t number = 0;
  double taken = clock.now_s();
  // A busy disk takes its time to sync; what comes meanwhile is written, so that a crash of the program costs no more.
  const std::jthread syncing([this](const std::stop_token& stop) {
    std::mutex mutex;
    std::unique_lock lock(mutex);
    std::condition_variable_any ended;
    while (!ended.wait_for(lock, stop, std::chrono::duration<double>(options_.sync_s), [] { return false; }) &&
           !stop.stop_requested()) {
      if (!stalled_) ::fdatasync(fd_);
    }
  });
  for (;;) {
    const bool last = stop_;
    if (pending_samples_ == 0) {
      const std::uint64_t waiting = head_.load() - tail_.load();
      const double now = clock.now_s();
      // A slow stream fills no block in time: what waits is written after block_s, however little it is.
      if (waiting == 0) taken = now;
      if (last || waiting >= options_.block_samples || (waiting > 0 && now - taken >= options_.block_s)) {
        taken = now;
        const auto n = static_cast<std::uint32_t>(take(samples, options_.block_samples));
        if (n > 0) {
          pending_ = raw_format::block(samples, n, number);
          pending_samples_ = n;
          number += n;
        }
      }
    }
    if (pending_samples_ == 0) {
      if (last) return;
      clock.sleep_until(clock.now_s() + 0.005);
    } else if (append(pending_)) {
      written_ += pending_samples_;
      pending_samples_ = 0;
      stalled_ = false;
    } else {
      stalled_ = true;
      if (last) return;  // finish() takes it from here
      clock.sleep_until(clock.now_s() + 0.05);
    }
  }
}

void RawRecorder::spill() {
  const auto folder = options_.spill_folder.empty() ? std::filesystem::temp_directory_path() : options_.spill_folder;
  const auto path = folder / (path_.filename().string() + ".rest");
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  std::uint64_t saved = pending_samples_, number = written_;
  bool good = fd >= 0 && write_all(fd, raw_format::file_start(header_)) && write_all(fd, pending_);
  number += pending_samples_;
  std::string samples;
  while (good) {
    const auto n = static_cast<std::uint32_t>(take(samples, options_.block_samples));
    if (n == 0) break;
    good = write_all(fd, raw_format::block(samples, n, number));
    number += n, saved += n;
  }
  good = good && ::fdatasync(fd) == 0;
  const std::string why = std::strerror(errno);
  if (fd >= 0) ::close(fd);
  pending_samples_ = 0;
  if (good) {
    throw BadData(fmt::format(
        "{}: the disk would not take more ({}): {} samples are there and sound, the last {} are in {}{}; recover both",
        path_.string(), failure_, written_.load(), saved, path.string(),
        lost_ > 0 ? fmt::format(", {} were lost", lost_.load()) : ""));
  }
  throw BadData(fmt::format(
      "{}: the disk would not take more ({}), nor would {} ({}): {} samples are there and sound, later ones are lost",
      path_.string(), failure_, path.string(), why, written_.load()));
}

void RawRecorder::finish() {
  if (fd_ < 0) return;
  stop_ = true;
  thread_.join();
  ::fdatasync(fd_);
  ::close(fd_);
  fd_ = -1;
  if (pending_samples_ > 0) spill();
}

}  // namespace touchstone::hil
