// The order between threads that oneTBB and Embree keep, told to the thread sanitizer: it cannot see into libraries
// that were not compiled with it, and would call every hand-over of work by them a race. Pieces of work stay unordered
// among themselves: races between those are real. Nothing in other builds.
#pragma once

#include "harness/base/thread_sanitizer.h"
#ifdef TOUCHSTONE_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace touchstone {

// What a thread did before a Whole comes before each Piece of it, and each Piece before what follows the Whole.
class WorkOrder {
 public:
  WorkOrder() = default;
  WorkOrder(const WorkOrder&) = delete;
  WorkOrder& operator=(const WorkOrder&) = delete;

  class Whole {
   public:
    explicit Whole(WorkOrder& order) noexcept : after_(&order.after_) { release(&order.before_); }
    ~Whole() { acquire(after_); }
    Whole(const Whole&) = delete;
    Whole& operator=(const Whole&) = delete;

   private:
    char* after_;
  };

  class Piece {
   public:
    explicit Piece(WorkOrder& order) noexcept : after_(&order.after_) { acquire(&order.before_); }
    ~Piece() { release(after_); }
    Piece(const Piece&) = delete;
    Piece& operator=(const Piece&) = delete;

   private:
    char* after_;
  };

 private:
#ifdef TOUCHSTONE_THREAD_SANITIZER
  static void acquire(char* place) noexcept { __tsan_acquire(place); }
  static void release(char* place) noexcept { __tsan_release(place); }
#else
  static void acquire(char* /*place*/) noexcept {}
  static void release(char* /*place*/) noexcept {}
#endif
  char before_ = 0;
  char after_ = 0;
};

}  // namespace touchstone
