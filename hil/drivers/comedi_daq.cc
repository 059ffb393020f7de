#include "drivers/comedi_daq.h"

#include <comedilib.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <vector>

#include "drivers/vendor_library.h"
#include "harness/base/hash.h"

namespace touchstone::hil {
using recording::GaugeVoltages;

namespace {

constexpr unsigned channels = 6;

struct Comedi {
  decltype(&::comedi_open) open = nullptr;
  decltype(&::comedi_close) close = nullptr;
  decltype(&::comedi_errno) error = nullptr;
  decltype(&::comedi_strerror) error_text = nullptr;
  decltype(&::comedi_get_board_name) board = nullptr;
  decltype(&::comedi_get_read_subdevice) read_subdevice = nullptr;
  decltype(&::comedi_get_maxdata) maxdata = nullptr;
  decltype(&::comedi_find_range) find_range = nullptr;
  decltype(&::comedi_get_default_calibration_path) calibration_path = nullptr;
  decltype(&::comedi_parse_calibration_file) parse_calibration = nullptr;
  decltype(&::comedi_cleanup_calibration) forget_calibration = nullptr;
  decltype(&::comedi_get_softcal_converter) software_converter = nullptr;
  decltype(&::comedi_get_hardcal_converter) hardware_converter = nullptr;
  decltype(&::comedi_to_physical) to_volts = nullptr;
  decltype(&::comedi_get_subdevice_flags) flags = nullptr;
  decltype(&::comedi_get_cmd_generic_timed) generic_timed = nullptr;
  decltype(&::comedi_command_test) command_test = nullptr;
  decltype(&::comedi_command) command = nullptr;
  decltype(&::comedi_cancel) cancel = nullptr;
  decltype(&::comedi_fileno) descriptor = nullptr;
};

VendorLibrary load(const std::string& library) {
  return VendorLibrary(
      library.empty() ? std::vector<std::string>{"libcomedi.so.0", "libcomedi.so"} : std::vector<std::string>{library},
      "install libcomedi0");
}

DeviceStatus status_of_errno(int error) {
  return error == ENOENT || error == ENODEV || error == ENXIO ? DeviceStatus::absent
         : error == EACCES || error == EPERM                  ? DeviceStatus::no_permission
         : error == EBUSY                                     ? DeviceStatus::busy
                                                              : DeviceStatus::failed;
}

class Board {
 public:
  Board(const std::string& node, const std::string& library) : library_(load(library)), node_(node) {
    library_.find(c_.open, "comedi_open");
    library_.find(c_.close, "comedi_close");
    library_.find(c_.error, "comedi_errno");
    library_.find(c_.error_text, "comedi_strerror");
    library_.find(c_.board, "comedi_get_board_name");
    library_.find(c_.read_subdevice, "comedi_get_read_subdevice");
    library_.find(c_.maxdata, "comedi_get_maxdata");
    library_.find(c_.find_range, "comedi_find_range");
    library_.find(c_.calibration_path, "comedi_get_default_calibration_path");
    library_.find(c_.parse_calibration, "comedi_parse_calibration_file");
    library_.find(c_.forget_calibration, "comedi_cleanup_calibration");
    library_.find(c_.software_converter, "comedi_get_softcal_converter");
    library_.find(c_.hardware_converter, "comedi_get_hardcal_converter");
    library_.find(c_.to_volts, "comedi_to_physical");
    library_.find(c_.flags, "comedi_get_subdevice_flags");
    library_.find(c_.generic_timed, "comedi_get_cmd_generic_timed");
    library_.find(c_.command_test, "comedi_command_test");
    library_.find(c_.command, "comedi_command");
    library_.find(c_.cancel, "comedi_cancel");
    library_.find(c_.descriptor, "comedi_fileno");
    device_ = c_.open(node.c_str());
    if (device_ == nullptr) {
      const int error = c_.error();
      throw DeviceError(status_of_errno(error), fmt::format("{}: {}", node, c_.error_text(error)));
    }
  }
  ~Board() { c_.close(device_); }
  Board(const Board&) = delete;
  Board& operator=(const Board&) = delete;

  [[noreturn]] void fail(const char* what) const {
    const int error = c_.error();
    throw DeviceError(status_of_errno(error), fmt::format("{}: {}: {}", node_, what, c_.error_text(error)));
  }
  [[nodiscard]] const Comedi& c() const noexcept { return c_; }
  [[nodiscard]] comedi_t* device() const noexcept { return device_; }
  [[nodiscard]] std::string name() const {
    const char* const text = c_.board(device_);
    return text != nullptr ? text : "";
  }

 private:
  VendorLibrary library_;
  Comedi c_;
  comedi_t* device_ = nullptr;
  std::string node_;
};

class ComediAti final : public WrenchSource {
 public:
  explicit ComediAti(const ComediOptions& options)
      : options_(options),
        calibration_(recording::read_ati_calibration(options.calibration_file, options.sensor_serial)),
        board_(options.node, options.library) {
    const auto& c = board_.c();
    const int subdevice = c.read_subdevice(board_.device());
    if (subdevice < 0)
      throw DeviceError(DeviceStatus::failed,
                        fmt::format("{}: {} has no streaming analog input", options.node, board_.name()));
    subdevice_ = static_cast<unsigned>(subdevice);
    const int range = c.find_range(board_.device(), subdevice_, 0, UNIT_volt, -calibration_.gauge_limit_V,
                                   calibration_.gauge_limit_V);
    if (range < 0 || c.maxdata(board_.device(), subdevice_, 0) == 0) {
      throw DeviceError(DeviceStatus::failed, fmt::format("{}: {} has no range of +-{} V, which the calibration needs",
                                                          options.node, board_.name(), calibration_.gauge_limit_V));
    }
    range_index_ = static_cast<unsigned>(range);
    const int flags = c.flags(board_.device(), subdevice_);
    wide_ = (flags & SDF_LSAMPL) != 0;
    const std::string card = find_converters((flags & SDF_SOFT_CALIBRATED) != 0);
    identity_ = {std::string(nano17_device.id), calibration_.serial, board_.name(),
                 fmt::format("{} {}; card {}", options.calibration_file.filename().string(),
                             sha256_file(options.calibration_file), card),
                 options.emulated};
  }
  ~ComediAti() override { stop(); }
  ComediAti(const ComediAti&) = delete;
  ComediAti& operator=(const ComediAti&) = delete;

  [[nodiscard]] const DeviceIdentity& identity() const override { return identity_; }

  void start() override {
    const auto& c = board_.c();
    for (unsigned i = 0; i < channels; ++i) channel_list_[i] = CR_PACK(i, range_index_, AREF_DIFF);
    comedi_cmd command{};
    if (c.generic_timed(board_.device(), subdevice_, &command, channels,
                        static_cast<unsigned>(std::lround(1e9 / options_.rate_Hz))) < 0)
      board_.fail("timed scans");
    command.chanlist = channel_list_.data();
    command.chanlist_len = channels;
    command.stop_src = TRIG_NONE;
    command.stop_arg = 0;
    for (int pass = 0; pass < 2; ++pass) c.command_test(board_.device(), &command);  // rounds to what the card can
    if (c.command(board_.device(), &command) < 0) board_.fail("start");
    running_ = true;
    counters_ = {};
    sequence_ = 0;
    bytes_.clear();
    bias_ = {};
    take_bias();
    counters_ = {};
    sequence_ = 0;
  }

  void stop() noexcept override {
    if (running_) board_.c().cancel(board_.device(), subdevice_);
    running_ = false;
  }

  std::size_t read(std::span<WrenchSample> out, double deadline_s) override {
    const std::size_t scan = channels * (wide_ ? sizeof(lsampl_t) : sizeof(sampl_t));
    const int fd = board_.c().descriptor(board_.device());
    while (bytes_.size() < scan) {
      const double left = std::max(0.0, deadline_s - clock_.now_s());
      pollfd ready{fd, POLLIN, 0};
      if (::poll(&ready, 1, static_cast<int>(std::ceil(std::min(left, 3600.0) * 1e3))) <= 0) {
        if (left <= 0.0) return 0;
        continue;
      }
      unsigned char buffer[4096];
      const auto n = ::read(fd, buffer, sizeof buffer);
      if (n < 0 && (errno == EAGAIN || errno == EINTR)) continue;
      if (n < 0 && errno == EPIPE)
        throw DeviceError(DeviceStatus::failed,
                          fmt::format("{}: the card's buffer overran: samples were lost", options_.node));
      if (n <= 0)
        throw DeviceError(DeviceStatus::gone, fmt::format("{}: the stream ended: {}", options_.node,
                                                          n == 0 ? "end of file" : std::strerror(errno)));
      bytes_.insert(bytes_.end(), buffer, buffer + n);
    }
    const std::size_t n = std::min(out.size(), bytes_.size() / scan);
    const double now = clock_.now_s();
    for (std::size_t i = 0; i < n; ++i) {
      const auto sample = apply_calibration(calibration_, volts_at(bytes_.data() + i * scan), bias_);
      out[i] = {};
      out[i].t_s = now;
      out[i].sequence = sequence_++;
      out[i].wrench = sample.wrench;
      out[i].flags = sample.flags;
    }
    counters_.received += n;
    bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(n * scan));
    return n;
  }

  [[nodiscard]] StreamCounters counters() const override { return counters_; }

 private:
  // The polynomials from counts to volts. Boards that calibrate in software (National Instruments' M series) keep
  // theirs in a file that comedi_soft_calibrate makes: the ideal line is off by per cents there. Returns what was used.
  std::string find_converters(bool in_software) {
    const auto& c = board_.c();
    if (!in_software) {
      for (unsigned k = 0; k < channels; ++k) {
        if (c.hardware_converter(board_.device(), subdevice_, k, range_index_, COMEDI_TO_PHYSICAL, &to_volts_[k]) < 0)
          board_.fail("its calibration");
      }
      return "calibrated in hardware";
    }
    const std::unique_ptr<char, decltype(&std::free)> path(c.calibration_path(board_.device()), &std::free);
    const std::string file = path != nullptr ? path.get() : "";
    const std::unique_ptr<comedi_calibration_t, decltype(c.forget_calibration)> calibration(
        file.empty() ? nullptr : c.parse_calibration(file.c_str()), c.forget_calibration);
    bool found = calibration != nullptr;
    for (unsigned k = 0; found && k < channels; ++k) {
      found =
          c.software_converter(subdevice_, k, range_index_, COMEDI_TO_PHYSICAL, calibration.get(), &to_volts_[k]) >= 0;
    }
    if (!found) {
      throw DeviceError(DeviceStatus::failed,
                        fmt::format("{}: {} calibrates in software, and {} has no calibration of its six channels",
                                    options_.node, board_.name(), file.empty() ? "its calibration file" : file),
                        "run comedi_soft_calibrate --file " + options_.node);
    }
    return fmt::format("calibrated in software by {} {}", std::filesystem::path(file).filename().string(),
                       sha256_file(file));
  }

  GaugeVoltages volts_at(const unsigned char* from) const {
    GaugeVoltages v{};
    for (std::size_t k = 0; k < channels; ++k) {
      lsampl_t count = 0;
      if (wide_) {
        std::memcpy(&count, from + k * sizeof(lsampl_t), sizeof(lsampl_t));
      } else {
        sampl_t narrow = 0;
        std::memcpy(&narrow, from + k * sizeof(sampl_t), sizeof(sampl_t));
        count = narrow;
      }
      last_volts_[k] = v[k] = board_.c().to_volts(count, &to_volts_[k]);
    }
    return v;
  }

  // The mean of a fifth of a second, while nothing touches the probe.
  void take_bias() {
    const auto wanted = static_cast<std::size_t>(0.2 * options_.rate_Hz);
    GaugeVoltages sum{};
    std::size_t n = 0;
    std::vector<WrenchSample> one(1);
    const double deadline = clock_.now_s() + 5.0;
    while (n < wanted) {
      if (read(one, deadline) == 0)
        throw DeviceError(DeviceStatus::timed_out,
                          fmt::format("{}: no samples within 5 s of the start", options_.node));
      for (std::size_t k = 0; k < channels; ++k) sum[k] += last_volts_[k];
      ++n;
    }
    for (std::size_t k = 0; k < channels; ++k) bias_[k] = sum[k] / static_cast<double>(n);
  }

  ComediOptions options_;
  recording::AtiCalibration calibration_;
  Board board_;
  unsigned subdevice_ = 0, range_index_ = 0;
  std::array<comedi_polynomial_t, channels> to_volts_{};
  bool wide_ = false, running_ = false;
  std::array<unsigned, channels> channel_list_{};
  DeviceIdentity identity_;
  MonotonicClock clock_;
  GaugeVoltages bias_{};
  mutable GaugeVoltages last_volts_{};
  std::vector<unsigned char> bytes_;
  std::uint64_t sequence_ = 0;
  StreamCounters counters_;
};

}  // namespace

std::string comedi_board(const std::string& node, const std::string& library) { return Board(node, library).name(); }

std::unique_ptr<WrenchSource> open_comedi_ati(const ComediOptions& options) {
  return std::make_unique<ComediAti>(options);
}

constexpr KnownDevice nano17_device{
    .id = "ati-nano17-daq",
    .name = "ATI Nano17 through a data acquisition card",
    .role = DeviceRole::wrench_source,
    .bus = Bus::comedi,
    .source = "ATI DAQ F/T manual: six gauge voltages and a calibration file",
    .confidence = Confidence::confirmed,
    .note = "the card is seen, the sensor behind it is not: its serial comes from the calibration file",
    .needs_calibration = true,
    .open_force = [](const MappedDevice& device, double card_rate_Hz) -> std::unique_ptr<WrenchSource> {
      ComediOptions options;
      if (!device.address.empty()) options.node = device.address;
      options.library = device.library;
      options.calibration_file = *device.calibration_file;
      options.sensor_serial = device.serial;
      options.rate_Hz = card_rate_Hz;
      return open_comedi_ati(options);
    }};

}  // namespace touchstone::hil
