// The messages of forces and poses as ROS serializes them, to numbers. Layouts: geometry_msgs (WrenchStamped,
// PoseStamped, PoseWithCovarianceStamped, TransformStamped, TwistStamped, PointStamped), nav_msgs/Odometry (its pose),
// sensor_msgs/JointState, std_msgs/Float64. Encodings:
// ROS 1, little-endian without padding (wiki.ros.org/roscpp/Overview/MessagesSerializationAndAdaptingTypes); ROS 2,
// CDR with a header of 4 bytes and values aligned to their size (OMG DDS-XTypes 1.3, section 7.4.3, XCDR version 1).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone::importing {

enum class RosEncoding { ros1, cdr };

// The columns of a message type: "t" (the header's stamp, or the time of recording where there is no header) and its
// numbers ("force.x", "orientation.w"). Empty where the type is not known. A JointState has those of its first message.
std::vector<std::string> ros_columns(std::string_view type, RosEncoding encoding, std::span<const std::byte> first);

// The values of one message in the order of ros_columns(); throws BadData (`place` names the message) where the bytes
// end too early. `recorded_s` stands in where there is no header.
std::vector<double> ros_values(std::string_view type, RosEncoding encoding, std::span<const std::byte> message,
                               double recorded_s, const std::string& place);

}  // namespace touchstone::importing
