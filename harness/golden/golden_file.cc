#include "harness/golden/golden_file.h"

#include <fmt/format.h>
#include <hdf5.h>
#include <unistd.h>

#include <fstream>
#include <tuple>
#include <vector>

#include "harness/base/error.h"
#include "harness/base/input_files.h"
#include "harness/base/partial_files.h"
#include "harness/base/version.h"
#include "harness/recording/hdf5_handle.h"
#include "harness/recording/recording_file.h"

namespace touchstone::golden {
namespace {

namespace fs = std::filesystem;

// HDF5 writers choose by extension, so the file being made keeps it; removed unless it was moved into place.
class PartFile {
 public:
  explicit PartFile(const fs::path& target) : target_(target) {
    path_ = target.parent_path() / fmt::format(".{}.{}.part.h5", target.stem().string(), ::getpid());
    std::ignore = make_folders(target.parent_path());  // what fails is said when the file is written
    add_partial_file(path_);
  }
  ~PartFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
    drop_partial_file(path_);
  }
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;
  [[nodiscard]] const fs::path& path() const noexcept { return path_; }
  void commit() const {
    std::error_code error;
    fs::rename(path_, target_, error);
    if (error) throw BadData(fmt::format("{}: cannot be written: {}", target_.string(), error.message()));
    note_output_file(target_);
  }

 private:
  fs::path target_;
  fs::path path_;
};

void set_attributes(const fs::path& path, const Provenance& provenance) {
  const recording::Hdf5Quiet quiet;
  recording::Hdf5File file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT));
  bool good = static_cast<bool>(file);
  for (const auto& [name, value] : provenance) {
    if (!good) break;
    if (H5Aexists(file.get(), name.c_str()) > 0) good = H5Adelete(file.get(), name.c_str()) >= 0;
    good = good && recording::hdf5_write_text_attribute(file.get(), name.c_str(), value);
  }
  if (!good || !file.close()) {
    throw BadData(fmt::format("{}: the provenance cannot be written: {}", path.string(), recording::hdf5_reason()));
  }
}

std::string cpu_model() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

herr_t add_name(hid_t, const char* name, const H5A_info_t*, void* names) {
  static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

}  // namespace

Provenance build_provenance() {
  const BuildInfo& info = build_info();
  return {{"version", info.version},   {"commit", info.commit}, {"dirty", info.dirty ? "yes" : "no"},
          {"compiler", info.compiler}, {"flags", info.flags},   {"cpu", cpu_model()}};
}

void write_golden(const fs::path& path, const recording::RenderedTrajectory& rendered, const Provenance& provenance) {
  refuse_to_replace_input(path);
  const PartFile part(path);
  save_rendered(part.path(), rendered);
  set_attributes(part.path(), provenance);
  part.commit();
}

void copy_golden(const fs::path& from, const fs::path& to, const Provenance& changes) {
  const PartFile part(to);
  std::error_code error;
  fs::copy_file(from, part.path(), fs::copy_options::overwrite_existing, error);
  if (error) throw BadData(fmt::format("{}: cannot be copied: {}", from.string(), error.message()));
  set_attributes(part.path(), changes);
  part.commit();
}

Provenance read_provenance(const fs::path& path) {
  note_input_file(path);
  const recording::Hdf5Quiet quiet;
  const recording::Hdf5File file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  std::vector<std::string> names;
  if (!file || H5Aiterate2(file.get(), H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, &add_name, &names) < 0) {
    throw BadData(fmt::format("{}: cannot be read: {}", path.string(), recording::hdf5_reason()));
  }
  Provenance provenance;
  for (const auto& name : names) provenance[name] = recording::hdf5_text_attribute(file.get(), name.c_str());
  return provenance;
}

}  // namespace touchstone::golden
