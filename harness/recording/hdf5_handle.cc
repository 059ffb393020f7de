#include "harness/recording/hdf5_handle.h"

#include <cstring>
#include <mutex>
#include <vector>

#if defined(__has_feature)
#if __has_feature(address_sanitizer) && !defined(__SANITIZE_ADDRESS__)
#define __SANITIZE_ADDRESS__
#endif
#endif
#ifdef __SANITIZE_ADDRESS__
// The library forgets memory of its own when it meets a damaged file; that is not ours to find.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5\nleak:H5"; }
#endif

namespace touchstone::recording {
namespace {

// No attribute that this project writes is longer; a file that claims so is damaged.
constexpr std::size_t longest_attribute = 4096;

std::mutex library;
// How many stand inside one another in this thread. A child process that was forked within one starts inside it.
thread_local int depth = 0;

}  // namespace

Hdf5Quiet::Hdf5Quiet() noexcept {
  if (depth++ == 0) library.lock();
  // A damaged file can leave the library unable to close itself at exit, of which it complains on stderr. Handles are
  // closed by their owners, so nothing is lost without. Works only before the library's first use, and only once.
  static const herr_t no_closing_at_exit = H5dont_atexit();
  static_cast<void>(no_closing_at_exit);
  H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Hdf5Quiet::~Hdf5Quiet() {
  H5Eset_auto2(H5E_DEFAULT, print_, data_);
  if (--depth == 0) library.unlock();
}

std::string hdf5_reason() {
  std::string reason;
  const auto keep_first = [](unsigned n, const H5E_error2_t* error, void* data) -> herr_t {
    if (n == 0 && error->desc != nullptr) *static_cast<std::string*>(data) = error->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first, &reason);
  return reason.empty() ? "HDF5 gives no reason" : reason;
}

std::string hdf5_text_attribute(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return "";
  const Hdf5Attribute attribute(H5Aopen(object, name, H5P_DEFAULT));
  if (!attribute) return "";
  const Hdf5Type type(H5Aget_type(attribute.get()));
  const Hdf5Space space(H5Aget_space(attribute.get()));
  if (!type || !space || H5Tget_class(type.get()) != H5T_STRING || H5Sget_simple_extent_npoints(space.get()) != 1) {
    return "";
  }
  if (H5Tis_variable_str(type.get()) > 0) {
    const Hdf5Type memory(H5Tcopy(H5T_C_S1));
    char* text = nullptr;
    H5Tset_size(memory.get(), H5T_VARIABLE);
    H5Tset_cset(memory.get(), H5Tget_cset(type.get()));
    if (H5Aread(attribute.get(), memory.get(), &text) < 0 || text == nullptr) return "";
    std::string result(text, strnlen(text, longest_attribute));
    H5free_memory(text);
    return result;
  }
  const std::size_t size = H5Tget_size(type.get());
  if (size == 0 || size > longest_attribute) return "";
  std::vector<char> text(size + 1, '\0');
  if (H5Aread(attribute.get(), type.get(), text.data()) < 0) return "";
  return text.data();
}

bool hdf5_write_text_attribute(hid_t object, const char* name, const std::string& text) {
  const Hdf5Type type(H5Tcopy(H5T_C_S1));
  const Hdf5Space space(H5Screate(H5S_SCALAR));
  if (!type || !space || H5Tset_size(type.get(), text.size() + 1) < 0) return false;
  const Hdf5Attribute attribute(H5Acreate2(object, name, type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT));
  return attribute && H5Awrite(attribute.get(), type.get(), text.c_str()) >= 0;
}

}  // namespace touchstone::recording
