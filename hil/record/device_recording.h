// A run of the recorder from the ids in a hardware map to tables: the devices are locked, opened and recorded, and what
// came is said in words.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "devices/hardware_map.h"
#include "record/multi_session.h"
#include "record/open_stream.h"
#include "record/record_session.h"
#include "record/stream_export.h"

namespace touchstone::hil {

// The device's entry in the map. Throws UsageError if there is none, BadData if its calibration must not be used.
const MappedDevice& usable_device(const std::string& id, const HardwareMap& map);

// A force sensor alone, into a raw file. Throws as usable_device(), DeviceLock and record_session() do.
RecordReport record_device(const std::string& id, const HardwareMap& map, const std::filesystem::path& file,
                           const RecordOptions& options, const std::function<bool()>& stop);

// Any devices together, into a folder. Throws as usable_device(), DeviceLock, open_stream() and record_streams() do.
MultiReport record_devices(const std::vector<std::string>& ids, const HardwareMap& map,
                           const std::filesystem::path& folder, const StreamSettings& settings,
                           const MultiOptions& options, const std::function<bool()>& stop);

// MultiOptions::show that draws the table of the streams over the last one on standard error; none if that is no
// terminal.
std::function<void(const std::vector<StreamStatus>&, double seconds)> show_on_terminal();

// For people: what was recorded and lost.
std::string record_text(const RecordReport& report, const std::filesystem::path& file);
std::string record_text(const MultiReport& report);
// A line or two for each table of a session: samples, clock, delays.
std::string session_text(const SessionExport& session);
// What was recovered from raw files into a table.
std::string recovery_text(const ExportReport& report, const std::filesystem::path& csv);

// The table of the stream of that kind: the one that is named, or the only one. Throws UsageError, which begins with
// `option`, if there is none or more than one.
std::filesystem::path table_of(const SessionExport& session, StreamKind kind, const std::string& name,
                               const std::string& option);

}  // namespace touchstone::hil
