// Progress of long work: one line on stderr, redrawn, and only where stderr is a terminal.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace touchstone {

class Progress {
 public:
  // `total` 0: unknown, then only the count and rate show.
  Progress(std::string what, std::uint64_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Cheap: redraws at most ten times a second.
  void update(std::uint64_t done);

 private:
  std::string what_;
  std::uint64_t total_;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point drawn_;
  bool terminal_;
};

}  // namespace touchstone
