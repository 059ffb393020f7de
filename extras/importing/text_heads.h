// Heads of text tables that say more than a line of names: LabVIEW measurements (NI's specification of .lvm), exports
// of OptiTrack Motive ("Data Export: CSV" of its manual),
// and what ROS 2 prints without any (common_interfaces: sensor_msgs, geometry_msgs).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "import_table.h"

namespace touchstone::importing {

// Of a row of units below the names: "(mm)", "[N]", "s", or a sign for none.
bool is_unit_field(std::string_view field);
// "Load (kN)"; a time of the day is in seconds whatever the name says ("hh:mm:ss"). Empty without a unit.
std::string name_with_unit(const std::string& name, std::string_view unit, bool time_of_day);

bool is_labview_measurement(const std::vector<std::string_view>& lines);
// A row of a LabVIEW measurement may have a comment of any text behind its numbers: leaves the numbers alone. Lines
// before the first names stay as they are.
void drop_labview_comments(std::vector<std::string_view>& lines);
// Units and time from the heads of the segments: the X column, which `X_Columns No` leaves empty, is X0 + i Delta_X.
// `segment` has the number of each row's.
void apply_labview_heads(const std::vector<std::string_view>& lines, char separator, char decimal,
                         const std::vector<double>& segment, ImportTable& table);

// The line "Frame,Time (Seconds),X,Y,..." of a Motive export, above which lines say what each column belongs to; the
// number of lines where this is none.
std::size_t motive_names_line(const std::vector<std::string_view>& lines);
// Names ("Probe.Position.X") and what they mean, from those lines.
void name_motive_columns(const std::vector<std::string_view>& lines, std::size_t names_line, ImportTable& table);

// `ros2 topic echo --csv` writes a message's values without their names: seconds and nanoseconds of the stamp, the
// frame (the text `frame` in the first row), then the rest. Names them where that is what the table is; of six values
// more only where the frame or the file says that they are a wrench, for a twist has as many.
void name_echoed_message(std::string_view frame, ImportTable& table);

}  // namespace touchstone::importing
