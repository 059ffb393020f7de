// The Net F/T driver against its emulator on loopback, with the faults of networks and sensors. Everything here is
// emulated: it shows that the driver keeps to our reading of the protocol, not that a sensor does.
#include "drivers/netft.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "emulators/netft_answers.h"
#include "emulators/netft_emulator.h"

namespace touchstone::hil {
namespace {

using ::testing::HasSubstr;

Wrench wave(double t) { return {Vec3(std::sin(t), 2.5, -t), Vec3(0.1, -0.02 * t, 0.003)}; }

// Reads until `n` samples came or the deadline passed.
std::vector<WrenchSample> read_samples(WrenchSource& source, std::size_t n, double within_s = 5.0) {
  MonotonicClock clock;
  const double deadline = clock.now_s() + within_s;
  std::vector<WrenchSample> all, some(256);
  while (all.size() < n) {
    const auto got = source.read(some, deadline);
    if (got == 0) break;
    all.insert(all.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(got));
  }
  return all;
}

TEST(NetFtProtocol, RecordsComeBackFromBytes) {
  const RdtRecord r{0xfffffffeU, 7, 0x80000001U, {1, -1, 2147483647, -2147483647 - 1, 0, 123456789}};
  const auto bytes = encode_record(r);
  EXPECT_EQ(bytes[0], 0xff);
  EXPECT_EQ(bytes[3], 0xfe);
  const auto back = decode_record(bytes);
  EXPECT_EQ(back.rdt_sequence, r.rdt_sequence);
  EXPECT_EQ(back.status, r.status);
  EXPECT_EQ(back.counts, r.counts);
  EXPECT_EQ(encode_request(RdtCommand::start_realtime, 0),
            (std::array<unsigned char, 8>{0x12, 0x34, 0, 2, 0, 0, 0, 0}));
  EXPECT_EQ(encode_request(RdtCommand::set_bias, 1), (std::array<unsigned char, 8>{0x12, 0x34, 0, 0x42, 0, 0, 0, 1}));
}

TEST(NetFtProtocol, SequenceNumbersAcrossTheirRollover) {
  SequenceTracker t;
  using V = SequenceTracker::Verdict;
  EXPECT_EQ(t.accept(0xfffffffdU), V::next);
  EXPECT_EQ(t.accept(0xfffffffeU), V::next);
  EXPECT_EQ(t.accept(0xfffffffeU), V::repeated);
  EXPECT_EQ(t.accept(1), V::after_gap);  // ...ff and 0 are missing
  EXPECT_EQ(t.counters().lost, 2U);
  EXPECT_EQ(t.accept(0), V::reordered);
  EXPECT_EQ(t.counters().lost, 1U);
  EXPECT_EQ(t.accept(0), V::repeated);
  EXPECT_EQ(t.accept(2), V::next);
  EXPECT_EQ(t.unwrapped(), 0x100000002ULL);
  EXPECT_EQ(t.counters().received, 4U);
}

TEST(NetFtProtocol, ReadsWhatRealSensorsAnswer) {
  const auto gamma = parse_netft_configuration(netft_gamma_answer, "gamma");
  EXPECT_EQ(gamma.serial, "FT27462");
  EXPECT_EQ(gamma.product, "Net F/T firmware 2.2.59, empty");
  EXPECT_DOUBLE_EQ(gamma.newtons_per_count, 1e-6);
  EXPECT_DOUBLE_EQ(gamma.newton_metres_per_count, 1e-6);
  EXPECT_EQ(gamma.rate_Hz, 100);
  const auto axia = parse_netft_configuration(netft_axia_answer, "axia");
  EXPECT_EQ(axia.serial, "FT31234");
  EXPECT_EQ(axia.rate_Hz, 2000);
  EXPECT_DOUBLE_EQ(axia.newton_metres_per_count, 1e-6) << "N-m";
}

TEST(NetFtProtocol, OnlyCountsAndUnitsAreIndispensable) {
  const auto bare = parse_netft_configuration(
      "<netFTApi><cfgcpf>1000</cfgcpf><cfgcpt>500</cfgcpt><scfgfu> N </scfgfu><scfgtu>Nmm</scfgtu></netFTApi>", "bare");
  EXPECT_DOUBLE_EQ(bare.newtons_per_count, 1e-3);
  EXPECT_DOUBLE_EQ(bare.newton_metres_per_count, 2e-6);
  EXPECT_EQ(bare.serial, "");
  EXPECT_EQ(bare.rate_Hz, 0.0);
  EXPECT_EQ(bare.product, "Net F/T");
  for (const char* const element : {"cfgcpf", "cfgcpt", "scfgfu", "scfgtu"}) {
    auto xml = std::string(netft_gamma_answer);
    const auto begin = xml.find(fmt::format("<{}>", element)), end = xml.find(fmt::format("</{}>", element));
    xml.erase(begin, end + std::string(element).size() + 3 - begin);
    EXPECT_THROW(parse_netft_configuration(xml, "gamma"), BadData) << element;
  }
}

TEST(NetFtProtocol, ConfigurationSaysWhatItCannotRead) {
  const std::string good =
      "<netft><prodname>P</prodname><setserial>FT1</setserial><cfgcpf>1000</cfgcpf><cfgcpt>500</cfgcpt><scfgfu>lbf</"
      "scfgfu><scfgtu>lbf-in</scfgtu></netft>";
  const auto c = parse_netft_configuration(good, "netftapi2.xml");
  EXPECT_NEAR(c.newtons_per_count, 4.4482216152605e-3, 1e-15);
  EXPECT_NEAR(c.newton_metres_per_count, 4.4482216152605 * 0.0254 / 500, 1e-15);
  const auto complaint = [](const std::string& xml) {
    try {
      parse_netft_configuration(xml, "netftapi2.xml");
    } catch (const BadData& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  const auto with = [&](const std::string& from, const std::string& to) {
    auto xml = good;
    return complaint(xml.replace(xml.find(from), from.size(), to));
  };
  EXPECT_THAT(with("lbf<", "stone<"), HasSubstr("\"stone\""));
  EXPECT_THAT(with("1000", "0"), HasSubstr("<cfgcpf> is \"0\""));
  EXPECT_THAT(with("<scfgtu>lbf-in</scfgtu>", ""), HasSubstr("<scfgtu>"));
  EXPECT_THAT(complaint("not xml <"), HasSubstr("netftapi2.xml"));
}

TEST(NetFtEmulated, ForcesArriveInNewtonsAndInOrder) {
  NetFtEmulator emulator(1000, {}, wave);
  const auto source = open_netft(emulator.address(), 2.0, true);
  EXPECT_EQ(source->identity().serial, "FT27462");
  EXPECT_TRUE(source->identity().emulated);
  source->start();
  const auto samples = read_samples(*source, 300);
  ASSERT_GE(samples.size(), 300U);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_EQ(samples[i].sequence, samples[0].sequence + i);
    const Wrench expected = wave(static_cast<double>(samples[i].sequence) / 1000);
    EXPECT_LT((samples[i].wrench.f_N - expected.f_N).norm(), 1e-6);
    EXPECT_LT((samples[i].wrench.torque_Nm - expected.torque_Nm).norm(), 1e-6);
    EXPECT_EQ(samples[i].flags, 0U);
  }
  EXPECT_EQ(source->counters().lost, 0U);
}

TEST(NetFtEmulated, IsKnownForAnEmulatorAlsoByWhoTakesItForHardware) {
  NetFtEmulator emulator(1000, {}, wave);
  EXPECT_TRUE(open_netft(emulator.address(), 2.0, false)->identity().emulated);
  NetFtFaults silent;
  silent.names_itself_a_sensor = true;
  NetFtEmulator impostor(1000, silent, wave);
  const auto source = open_netft(impostor.address(), 2.0, false);
  EXPECT_EQ(source->identity().firmware, "Net F/T firmware 2.2.59, empty");
  EXPECT_TRUE(source->identity().emulated);  // no sensor answers from the loopback
}

TEST(NetFtEmulated, FaultsAreCountedAndFlaggedAndTimeNeverRunsBack) {
  NetFtFaults faults;
  faults.drop_every = 50;
  faults.repeat_every = 33;
  faults.swap_every = 41;
  faults.short_every = 77;
  faults.error_bit_every = 60;
  faults.first_sequence = 0xffffffffU - 100;  // rolls over on the way
  NetFtEmulator emulator(2000, faults, wave);
  const auto source = open_netft(emulator.address(), 2.0, true);
  source->start();
  const auto samples = read_samples(*source, 900);
  ASSERT_GE(samples.size(), 900U);
  const auto c = source->counters();
  fmt::print("emulated faults: received {} lost {} repeated {} reordered {} malformed {} device errors {}\n",
             c.received, c.lost, c.repeated, c.reordered, c.malformed, c.device_errors);
  for (const auto n : {c.lost, c.repeated, c.reordered, c.malformed, c.device_errors}) EXPECT_GE(n, 9U);
  std::size_t flagged = (samples[0].flags & recording::sample_device_error) != 0, gaps = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    EXPECT_GT(samples[i].sequence, samples[i - 1].sequence);
    EXPECT_EQ((samples[i].flags & recording::sample_after_gap) != 0, samples[i].sequence > samples[i - 1].sequence + 1);
    gaps += (samples[i].flags & recording::sample_after_gap) != 0;
    flagged += (samples[i].flags & recording::sample_device_error) != 0;
  }
  EXPECT_EQ(flagged, c.device_errors);
  EXPECT_GT(gaps, 9U);
}

TEST(NetFtEmulated, EveryWaitHasAnEnd) {
  MonotonicClock clock;
  NetFtFaults faults;
  faults.silent_after = 20;
  NetFtEmulator emulator(1000, faults, wave);
  const auto source = open_netft(emulator.address(), 2.0, true);
  source->start();
  EXPECT_EQ(read_samples(*source, 100, 0.3).size(), 20U);
  std::vector<WrenchSample> some(8);
  const double before = clock.now_s();
  EXPECT_EQ(source->read(some, before + 0.05), 0U);
  EXPECT_GE(clock.now_s(), before + 0.05);
}

TEST(NetFtEmulated, ASecondClientTakesTheStreamAndTheFirstSeesSilence) {
  NetFtFaults faults;
  faults.newest_client_wins = true;
  NetFtEmulator emulator(1000, faults, wave);
  const auto first = open_netft(emulator.address(), 2.0, true), second = open_netft(emulator.address(), 2.0, true);
  first->start();
  EXPECT_GE(read_samples(*first, 20).size(), 20U);
  second->start();
  EXPECT_GE(read_samples(*second, 50).size(), 50U);
  read_samples(*first, 1000000, 0.05);  // what was on its way
  EXPECT_EQ(read_samples(*first, 1, 0.1).size(), 0U);
}

TEST(NetFtEmulated, SaysWhyItCannotBeOpened) {
  const auto status = [](const NetFtAddress& address, double timeout) {
    try {
      open_netft(address, timeout, true);
    } catch (const DeviceError& error) {
      return error.device_status();
    } catch (const BadData&) {
      return DeviceStatus::failed;
    }
    return DeviceStatus::present;
  };
  NetFtFaults silent, garbage;
  silent.http_silent = true;
  garbage.http_garbage = true;
  NetFtEmulator mute(100, silent, wave), liar(100, garbage, wave), gone(100, {}, wave);
  EXPECT_EQ(status(mute.address(), 0.2), DeviceStatus::timed_out);
  EXPECT_EQ(status(liar.address(), 1.0), DeviceStatus::failed);
  const auto address = gone.address();
  gone.unplug();
  EXPECT_EQ(status(address, 1.0), DeviceStatus::absent);
}

TEST(NetFtEmulated, AnUnpluggedSensorIsGone) {
  NetFtEmulator emulator(1000, {}, wave);
  const auto source = open_netft(emulator.address(), 2.0, true);
  source->start();
  EXPECT_GE(read_samples(*source, 20).size(), 20U);
  emulator.unplug();
  source->stop();  // on loopback the closed port answers this with "refused", as a rebooting sensor would
  EXPECT_THROW(read_samples(*source, 1000000, 1.0), DeviceError);
}

}  // namespace
}  // namespace touchstone::hil
