// Owning handles for the HDF5 C library, and its errors as text instead of on stderr.
#pragma once

#include <hdf5.h>

#include <string>
#include <utility>

namespace touchstone::recording {

template <herr_t (*Close)(hid_t)>
class Hdf5Handle {
 public:
  Hdf5Handle() = default;
  explicit Hdf5Handle(hid_t id) noexcept : id_(id) {}
  ~Hdf5Handle() { reset(); }
  Hdf5Handle(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(const Hdf5Handle&) = delete;
  Hdf5Handle(Hdf5Handle&& other) noexcept : id_(std::exchange(other.id_, none)) {}
  Hdf5Handle& operator=(Hdf5Handle&& other) noexcept {
    if (this != &other) {
      reset();
      id_ = std::exchange(other.id_, none);
    }
    return *this;
  }

  [[nodiscard]] hid_t get() const noexcept { return id_; }
  explicit operator bool() const noexcept { return id_ >= 0; }
  // Closes now and says whether that worked: closing a file writes what is still in memory.
  bool close() noexcept {
    const hid_t id = std::exchange(id_, none);
    return id < 0 || Close(id) >= 0;
  }

 private:
  static constexpr hid_t none = -1;
  void reset() noexcept { (void)close(); }

  hid_t id_ = none;
};

using Hdf5File = Hdf5Handle<H5Fclose>;
using Hdf5Dataset = Hdf5Handle<H5Dclose>;
using Hdf5Space = Hdf5Handle<H5Sclose>;
using Hdf5Type = Hdf5Handle<H5Tclose>;
using Hdf5Attribute = Hdf5Handle<H5Aclose>;
using Hdf5Properties = Hdf5Handle<H5Pclose>;

// While it lives, HDF5 prints nothing (what went wrong is had from hdf5_reason()), and no other thread may make one: as
// Debian builds it the library is not safe for threads. Stands around every use of it; may stand inside another.
class Hdf5Quiet {
 public:
  Hdf5Quiet() noexcept;
  ~Hdf5Quiet();
  Hdf5Quiet(const Hdf5Quiet&) = delete;
  Hdf5Quiet& operator=(const Hdf5Quiet&) = delete;

 private:
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

// The innermost description on HDF5's error stack of the last failed call, e.g. "truncated file: eof = 96 ...".
std::string hdf5_reason();

// A text attribute of an object, "" where it is absent or not text.
std::string hdf5_text_attribute(hid_t object, const char* name);
// False when HDF5 fails.
bool hdf5_write_text_attribute(hid_t object, const char* name, const std::string& text);

}  // namespace touchstone::recording
