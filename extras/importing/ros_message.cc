#include "ros_message.h"

#include <fmt/format.h>

#include <array>
#include <cstring>

#include "harness/base/error.h"

namespace touchstone::importing {
namespace {

// Bytes as one of the encodings lays them out.
class Bytes {
 public:
  Bytes(std::span<const std::byte> bytes, RosEncoding encoding, const std::string& place)
      : bytes_(bytes), cdr_(encoding == RosEncoding::cdr), place_(place) {
    if (!cdr_) return;
    // CDR_LE is 00 01; only little-endian machines write bags that anyone has seen.
    if (bytes_.size() < 4) fail();
    if (bytes_[1] != std::byte{1}) throw BadData(place_ + ": is not little-endian CDR");
    bytes_ = bytes_.subspan(4);
  }
  template <class T>
  T take() {
    if (cdr_) at_ = (at_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
    if (at_ + sizeof(T) > bytes_.size()) fail();
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  std::string text() {
    const auto length = take<std::uint32_t>();
    if (length > bytes_.size() - at_) fail();
    std::string value(reinterpret_cast<const char*>(bytes_.data() + at_), length);
    at_ += length;
    if (cdr_ && !value.empty() && value.back() == '\0') value.pop_back();
    return value;
  }
  std::uint32_t count() {
    const auto n = take<std::uint32_t>();
    if (n > bytes_.size() - at_) fail();  // every element has a byte at least
    return n;
  }

 private:
  [[noreturn]] void fail() const {
    throw BadData(fmt::format("{}: the message ends after {} bytes; the bag is damaged or its type is another", place_,
                              bytes_.size()));
  }
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  bool cdr_;
  const std::string& place_;
};

struct Layout {
  std::string_view type;
  bool header;
  bool child_frame;  // a second name after the header
  std::vector<std::string> numbers;
};

const std::vector<Layout>& layouts() {
  static const std::vector<std::string> wrench{"force.x", "force.y", "force.z", "torque.x", "torque.y", "torque.z"};
  static const std::vector<std::string> pose{"position.x",    "position.y",    "position.z",   "orientation.x",
                                             "orientation.y", "orientation.z", "orientation.w"};
  static const std::vector<std::string> point{"point.x", "point.y", "point.z"};
  static const std::vector<std::string> vector{"vector.x", "vector.y", "vector.z"};  // of anything
  static const std::vector<std::string> twist{"linear.x",  "linear.y",  "linear.z",
                                              "angular.x", "angular.y", "angular.z"};
  static const std::vector<Layout> all{
      {"WrenchStamped", true, false, wrench}, {"Wrench", false, false, wrench},
      {"PoseStamped", true, false, pose},     {"Pose", false, false, pose},
      {"TransformStamped", true, true, pose}, {"Transform", false, false, pose},
      {"Odometry", true, true, pose},         {"PoseWithCovarianceStamped", true, false, pose},
      {"PointStamped", true, false, point},   {"Vector3Stamped", true, false, vector},
      {"TwistStamped", true, false, twist},   {"Float64", false, false, {"data"}}};
  return all;
}

// "geometry_msgs/msg/WrenchStamped" and "geometry_msgs/WrenchStamped" alike.
std::string_view bare(std::string_view type) { return type.substr(type.rfind('/') + 1); }

// Other packages have types of the same name: turtlesim/Pose is two numbers and an angle.
bool of_known_package(std::string_view type) {
  const std::string_view package = type.substr(0, type.find('/'));
  return package == type || package == "geometry_msgs" || package == "sensor_msgs" || package == "std_msgs" ||
         package == "nav_msgs";
}

const Layout* layout_of(std::string_view type) {
  if (!of_known_package(type)) return nullptr;
  for (const Layout& layout : layouts()) {
    if (layout.type == bare(type)) return &layout;
  }
  return nullptr;
}

// ROS 1 counts its headers; ROS 2 does not.
double stamp(Bytes& bytes, RosEncoding encoding) {
  if (encoding == RosEncoding::ros1) bytes.take<std::uint32_t>();
  const double seconds =
      encoding == RosEncoding::ros1 ? bytes.take<std::uint32_t>() : static_cast<double>(bytes.take<std::int32_t>());
  const double t_s = seconds + 1e-9 * bytes.take<std::uint32_t>();
  bytes.text();
  return t_s;
}

std::vector<double> joint_values(Bytes& bytes, RosEncoding encoding, std::vector<std::string>* names) {
  std::vector<double> values{stamp(bytes, encoding)};
  std::vector<std::string> joints(bytes.count());
  for (std::string& joint : joints) joint = bytes.text();
  if (names != nullptr) *names = {"t"};
  for (const char* const what : {"position", "velocity", "effort"}) {
    const std::uint32_t n = bytes.count();
    for (std::uint32_t i = 0; i < n; ++i) {
      values.push_back(bytes.take<double>());
      if (names != nullptr) {
        names->push_back(fmt::format("{}.{}", i < joints.size() ? joints[i] : std::to_string(i), what));
      }
    }
  }
  return values;
}

}  // namespace

std::vector<std::string> ros_columns(std::string_view type, RosEncoding encoding, std::span<const std::byte> first) {
  if (bare(type) == "JointState") {
    const std::string place(type);
    Bytes bytes(first, encoding, place);
    std::vector<std::string> names;
    joint_values(bytes, encoding, &names);
    return names;
  }
  const Layout* const layout = layout_of(type);
  if (layout == nullptr) return {};
  std::vector<std::string> names{"t"};
  names.insert(names.end(), layout->numbers.begin(), layout->numbers.end());
  return names;
}

std::vector<double> ros_values(std::string_view type, RosEncoding encoding, std::span<const std::byte> message,
                               double recorded_s, const std::string& place) {
  Bytes bytes(message, encoding, place);
  if (bare(type) == "JointState") return joint_values(bytes, encoding, nullptr);
  const Layout* const layout = layout_of(type);
  if (layout == nullptr) return {};
  std::vector<double> values{layout->header ? stamp(bytes, encoding) : recorded_s};
  if (layout->child_frame) bytes.text();
  for (std::size_t i = 0; i < layout->numbers.size(); ++i) values.push_back(bytes.take<double>());
  return values;
}

}  // namespace touchstone::importing
