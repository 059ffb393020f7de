// Somebody sets a clock while every driver records: the computer's (stepped_clock.h), or the one that stamps a device's
// data. What a device measures is its own time here, so that the table of the recording shows what its axis is off.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <sstream>

#include "drivers/bota.h"
#include "drivers/comedi_daq.h"
#include "drivers/falcon.h"
#include "drivers/haply.h"
#include "drivers/leptrino.h"
#include "drivers/load_cell.h"
#include "drivers/natnet.h"
#include "drivers/ndi.h"
#include "drivers/netft.h"
#include "drivers/onrobot.h"
#include "drivers/plugin_device.h"
#include "drivers/qualisys.h"
#include "drivers/vendor_devices.h"
#include "drivers/vrpn.h"
#include "emulators/ati_calibration_for_test.h"
#include "emulators/haply_emulator.h"
#include "emulators/natnet_emulator.h"
#include "emulators/ndi_emulator.h"
#include "emulators/netft_emulator.h"
#include "emulators/onrobot_emulator.h"
#include "emulators/qualisys_emulator.h"
#include "emulators/serial_emulator.h"
#include "emulators/stepped_clock.h"
#include "emulators/usb_emulator.h"
#include "emulators/vrpn_emulator.h"
#include "harness/base/atomic_file.h"
#include "record/multi_session.h"
#include "record/stream_export.h"

namespace touchstone::hil {
namespace {

namespace fs = std::filesystem;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Each device's time is in its first column, in N or dm.
Wrench force_is_time(double t) { return {Vec3(t, 1, 2), Vec3::Zero()}; }
constexpr double m_per_s = 0.1;
EmulatedPose place_is_time(double t) { return {Vec3(m_per_s * t, 0, 0), Quat::Identity(), true}; }

// What is going on in the streams of a run.
struct Progress {
  std::uint64_t half = 0;          // samples before the step and after it
  std::atomic<int> before, after;  // streams that wait for their first half, and for their second
  std::atomic<bool> stepped{false};
  std::atomic<double> waits_since_s{0.0};  // when the first stream waited; 0: none does
};

// Reads half of the samples, no more until the step, so that some wait meanwhile, and then the other half. Notes by how
// much their times are outside of the calls that read them.
class InTheMiddle final : public Stream {
 public:
  InTheMiddle(std::unique_ptr<Stream> stream, Progress& progress, std::shared_ptr<double> outside_s)
      : stream_(std::move(stream)), progress_(&progress), outside_s_(std::move(outside_s)) {}
  [[nodiscard]] StreamKind kind() const override { return stream_->kind(); }
  [[nodiscard]] RawHeader header() const override { return stream_->header(); }
  void start() override { stream_->start(); }
  void stop() noexcept override { stream_->stop(); }
  std::size_t read(std::span<RawSample> out, double deadline_s) override {
    const double from_s = clock_.now_s();
    const std::size_t n = stream_->read(out, deadline_s);
    const double to_s = clock_.now_s();
    for (std::size_t i = 0; i < n; ++i)
      *outside_s_ = std::max({*outside_s_, from_s - out[i].wrench.t_s, out[i].wrench.t_s - to_s});
    count_ += n;
    if (count_ >= progress_->half && !std::exchange(half_came_, true)) {
      double none = 0.0;
      progress_->waits_since_s.compare_exchange_strong(none, to_s);
      --progress_->before;
      progress_->stepped.wait(false);
      // What queued meanwhile comes at once, late: as much again must come in time.
      until_s_ = 2.0 * clock_.now_s() - to_s;
    }
    if (count_ >= 2 * progress_->half && to_s >= until_s_ && !std::exchange(all_came_, true)) --progress_->after;
    return n;
  }
  [[nodiscard]] StreamCounters counters() const override { return stream_->counters(); }

 private:
  std::unique_ptr<Stream> stream_;
  Progress* progress_;
  std::shared_ptr<double> outside_s_;
  MonotonicClock clock_;
  std::uint64_t count_ = 0;
  bool half_came_ = false, all_came_ = false;
  double until_s_ = 0.0;
};

// A stream, with what keeps its emulator alive, and a second of the device's in its table's second column. 0: the
// stand-in knows no time, and the times are taken in the call that reads.
struct Rig {
  std::string name;
  std::shared_ptr<void> emulator;
  std::unique_ptr<Stream> stream;
  double per_s = 1.0;
  std::shared_ptr<double> outside_s = std::make_shared<double>(0.0);
};

template <class Emulator, class... Args>
std::shared_ptr<Emulator> emulator(Args&&... args) {
  return std::make_shared<Emulator>(std::forward<Args>(args)...);
}

constexpr const char* too_busy = "the machine is too busy to read all devices in time";

class ClockSteps : public ::testing::Test {
 protected:
  void SetUp() override { folder_ = fs::temp_directory_path() / fmt::format("touchstone-clock-{}", ::getpid()); }
  void TearDown() override {
    fs::remove_all(folder_);
    fs::remove(folder_.string() + ".cal");
  }

  static Rig netft() {
    auto sensor = emulator<NetFtEmulator>(5000.0, NetFtFaults{}, force_is_time);
    return {"netft", sensor, stream_of(open_netft(sensor->address(), 3.0, true))};
  }
  static Rig onrobot() {
    auto box = emulator<OnRobotEmulator>(force_is_time);
    return {"onrobot", box, stream_of(open_onrobot({"127.0.0.1", box->port()}, 3.0, true))};
  }
  static Rig bota() {
    auto line = emulator<SerialEmulator>(bota_sensor({}, force_is_time));
    BotaOptions options;
    options.node = line->node();
    return {"bota", line, stream_of(open_bota(options))};
  }
  static Rig leptrino() {
    LeptrinoFaults slow;  // 4 kB, which the line holds, are more than the longest wait
    slow.rate = "150";
    slow.sends_Hz = 150.0;
    auto line = emulator<SerialEmulator>(leptrino_sensor(slow, force_is_time));
    return {"leptrino", line, stream_of(open_leptrino({line->node()}))};
  }
  static Rig load_cell() {
    constexpr double ms_per_s = 1e3;
    auto line = emulator<SerialEmulator>(load_cell_sketch(true, 80.0, [](double t) { return ms_per_s * t; }));
    LoadCellOptions options;
    options.node = line->node();
    options.newtons_per_unit = 1.0 / ms_per_s;
    options.axis = 'x';
    return {"load-cell", line, stream_of(open_load_cell(options))};
  }
  static Rig natnet() {
    auto motive = emulator<NatNetEmulator>(240.0, NatNetFaults{}, place_is_time);
    return {"natnet", motive, stream_of(open_natnet({"127.0.0.1", motive->command_port(), "probe", 3.0, 240.0})),
            m_per_s};
  }
  static std::function<std::uint64_t()> sent_by(const Rig& natnet) {
    return [emulator = std::static_pointer_cast<NatNetEmulator>(natnet.emulator)] { return emulator->sent(); };
  }
  static Rig vrpn() {
    auto server = emulator<VrpnEmulator>(240.0, place_is_time);
    auto options = vrpn_options("127.0.0.1", "Tracker0:0");
    options.port = server->port();
    return {"vrpn", server, stream_of(open_vrpn(options)), m_per_s};
  }
  static Rig qualisys() {
    auto server = emulator<QualisysEmulator>(240.0, QualisysFaults{}, place_is_time);
    return {"qualisys", server, stream_of(open_qualisys({"127.0.0.1", server->port(), "Stylus"})), m_per_s};
  }
  static Rig ndi() {
    auto tracker = emulator<NdiEmulator>(60.0, NdiFaults{}, place_is_time);
    NdiOptions options;
    options.address = "127.0.0.1";
    options.port = tracker->port();
    return {"ndi", tracker, stream_of(open_ndi(options)), m_per_s};
  }
  static Rig haply() {
    auto service = emulator<HaplyEmulator>(HaplyFaults{}, [](double t) { return Vec3(m_per_s * t, 0, 0); });
    return {"haply", service, stream_of(open_haply({"127.0.0.1", service->port(), "", 3.0}), 250.0), m_per_s};
  }
  static Rig vendors(const char* name, std::unique_ptr<HapticDevice> (*open)(const VendorDeviceOptions&)) {
    VendorDeviceOptions options;
    options.library = TOUCHSTONE_STUB_VENDOR, options.emulated = true;
    return {name, nullptr, stream_of(open(options), 250.0), 0.0};
  }
  static Rig comedi(const fs::path& calibration) {
    ComediOptions options;
    options.library = TOUCHSTONE_STUB_COMEDI, options.emulated = true;
    options.calibration_file = calibration;
    write_file(calibration, ati_calibration_for_test());
    return {"comedi", nullptr, stream_of(open_comedi_ati(options)), 0.0};
  }

  static Rig plugin() {
    return {"c-plugin", nullptr, stream_of(open_plugin_device(TOUCHSTONE_EXAMPLE_DEVICE, "press"), 250.0), 0.0};
  }
  // On an emulated bus, under unmodified libusb; its encoders stand still.
  static Rig falcon() {
    struct Plugged {
      FalconModel model{true};
      UsbEmulator usb{UsbEmulator::Identity{}, model};
    };
    auto plugged = std::make_shared<Plugged>();
    FalconOptions options;
    options.emulated = true;
    options.timeout_s = 3.0;
    return {"falcon", plugged, stream_of(open_falcon(options), 250.0), 0.0};
  }

  // Records `half` samples of each, lets some wait, sets the clock, and records as many. `sent` counts what one of the
  // emulators sends.
  // `waited_s_` is how long the first stream waited for the slowest.
  MultiReport record(std::vector<Rig>& rigs, std::uint64_t half, const std::function<std::uint64_t()>& sent,
                     const std::function<void()>& step) {
    constexpr std::uint64_t enough = 3;
    fs::remove_all(folder_);
    const auto all = static_cast<int>(rigs.size());
    Progress progress{half, all, all};
    std::vector<NamedStream> streams;
    for (auto& rig : rigs)
      streams.push_back({rig.name, std::make_unique<InTheMiddle>(std::move(rig.stream), progress, rig.outside_s)});
    MultiOptions options;
    options.silence_s = 30.0;  // of a busy machine
    std::optional<std::uint64_t> sent_before;
    auto report = record_streams(std::move(streams), folder_, options, [&] {
      if (progress.before == 0 && !progress.stepped) {
        if (!sent_before) sent_before = sent();
        if (sent() >= *sent_before + enough) {
          step();
          waited_s_ = MonotonicClock{}.now_s() - progress.waits_since_s;
          progress.stepped = true;
          progress.stepped.notify_all();
        }
      }
      return progress.after == 0;
    });
    export_session(folder_);
    return report;
  }

  // By how much the table's time and the device's, which it holds, moved against each other from its first quarter to
  // its last. Of each the least: on a busy machine arrivals are late, never early, and a clock that steps takes all
  // along.
  [[nodiscard]] double axis_error_s(const Rig& rig) const {
    if (rig.per_s == 0.0) return *rig.outside_s;
    std::istringstream table(read_file(folder_ / (rig.name + ".csv")));
    std::string line;
    std::getline(table, line);
    std::vector<double> off_s;
    double t = 0.0, value = 0.0;
    while (std::getline(table, line)) {
      if (std::sscanf(line.c_str(), "%lf,%lf", &t, &value) == 2) off_s.push_back(t - value / rig.per_s);
    }
    const auto quarter = off_s.size() / 4;
    return *std::min_element(off_s.end() - static_cast<std::ptrdiff_t>(quarter), off_s.end()) -
           *std::min_element(off_s.begin(), off_s.begin() + static_cast<std::ptrdiff_t>(quarter));
  }

  void expect_axes(const std::vector<Rig>& rigs, double step_s) const {
    for (const auto& rig : rigs) {
      const double error_s = axis_error_s(rig);
      fmt::print("{:+.1f} s: {:<16} {:+.3f} ms\n", step_s, rig.name, 1e3 * error_s);
      EXPECT_LT(std::abs(error_s), 0.02) << rig.name << ' ' << step_s;
    }
  }

  // A serial line holds 4 kB and overflows while its stream waits; a device without a count cannot tell that.
  static constexpr double longest_wait_s = 1.0;
  static constexpr int most_tries = 5;
  // Makes the rigs and records them, again where the machine was too busy to read all in time; empty if it always was.
  std::optional<MultiReport> record_in_time(const std::function<std::vector<Rig>()>& make, std::vector<Rig>& rigs,
                                            std::uint64_t half, const std::function<void()>& step) {
    for (int i = 1; i <= most_tries; ++i) {
      try {
        rigs = make();
        MultiReport report = record(rigs, half, sent_by(rigs[0]), step);
        // Nor has it sent all that its rate says, which the recording says of it.
        const auto starved = [](const std::string& problem) { return problem.find("are stated") != std::string::npos; };
        const bool again = i < most_tries && std::ranges::any_of(report.problems(), starved);
        if (waited_s_ < longest_wait_s && !again) return report;
      } catch (const Error&) {
        // A device that gets no processor is late; one that is broken is that each time.
        if (i == most_tries) throw;
      }
    }
    return std::nullopt;
  }

  fs::path folder_;
  double waited_s_ = 0.0;

  void step_this_computer(double step_s) {
    ASSERT_TRUE(UsbEmulator::preloaded()) << "needs LD_PRELOAD=libumockdev-preload.so.0 (ctest sets it)";
    const auto make_all = [&] {
      std::vector<Rig> all;
      all.push_back(natnet());
      for (const auto& make : {netft, onrobot, bota, leptrino, load_cell, qualisys, ndi, haply}) all.push_back(make());
      all.push_back(vrpn());
      all.push_back(comedi(folder_.string() + ".cal"));
      all.push_back(vendors("force-dimension", open_force_dimension));
      all.push_back(vendors("openhaptics", open_openhaptics));
      all.push_back(plugin());
      all.push_back(falcon());
      return all;
    };
    std::vector<Rig> rigs;
    const auto report = record_in_time(make_all, rigs, 30, [&] { step_system_clock(step_s); });
    if (!report) GTEST_SKIP() << too_busy;
    // A busy machine may lose a tick of a handle.
    EXPECT_THAT(report->problems(), Each(HasSubstr("samples were lost on the way"))) << step_s;
    expect_axes(rigs, step_s);
  }
};

TEST_F(ClockSteps, OfThisComputerLeaveEveryAxisAsItWas) {
  for (const double step_s : {0.2, -3.0}) step_this_computer(step_s);
}

TEST_F(ClockSteps, OfThisComputerTheOtherWay) {
  for (const double step_s : {-0.2, 3.0}) step_this_computer(step_s);
}

TEST_F(ClockSteps, OfADeviceAreSaidAndBridged) {
  for (const double step_s : {0.2, -0.2, 3.0, -3.0}) {
    std::vector<Rig> rigs;
    const auto make_both = [] {
      std::vector<Rig> both;
      both.push_back(natnet());
      both.push_back(vrpn());
      return both;
    };
    const auto report = record_in_time(make_both, rigs, 120, [&] {
      std::static_pointer_cast<NatNetEmulator>(rigs[0].emulator)->set_clock(step_s);
      std::static_pointer_cast<VrpnEmulator>(rigs[1].emulator)->set_clock(step_s);
    });
    if (!report) GTEST_SKIP() << too_busy;
    const auto said = HasSubstr("was set 1 time meanwhile");
    EXPECT_THAT(report->problems(), ElementsAre(said, said)) << step_s;
    expect_axes(rigs, step_s);
  }
}

}  // namespace
}  // namespace touchstone::hil
