// A file of raw sensor columns, by name, whatever their meaning: gauge voltages, tracker poses, static orientations.
// CSV, gzip CSV or HDF5, as recordings are.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "harness/base/vec.h"

namespace touchstone::recording {

// The units that a column of forces or torques may name, and what one of each is in SI.
inline const std::vector<std::pair<std::string, double>> force_units{{"N", 1.0}, {"mN", 1e-3}};
inline const std::vector<std::pair<std::string, double>> torque_units{{"Nm", 1.0}, {"Nmm", 1e-3}};

class RawTable {
 public:
  // Throws BadData naming file, line and column for anything that is not a table of numbers.
  explicit RawTable(const std::filesystem::path& path);

  [[nodiscard]] std::size_t rows() const noexcept { return rows_; }
  [[nodiscard]] bool has(const std::string& name) const noexcept;
  // Throws BadData that lists the columns there are.
  [[nodiscard]] const std::vector<double>& column(const std::string& name) const;
  // Time in seconds from t_s, t_ms, t_us (or `t` in the unit given); must increase strictly. Throws naming the line.
  [[nodiscard]] std::vector<double> times_s(const std::string& unit_of_bare_t = {}) const;
  // Three columns prefix + x,y,z with the unit's suffix, e.g. ("f", "", {"N","mN"}) reads fx_N,fy_N,fz_N to SI. A
  // column without a unit is read as SI only where `bare_is_si`.
  [[nodiscard]] std::vector<Vec3> vectors(const std::string& prefix,
                                          const std::vector<std::pair<std::string, double>>& units,
                                          bool bare_is_si) const;
  // qw,qx,qy,qz, or the rows r11..r33 of a rotation matrix; turns the measured frame into the world.
  [[nodiscard]] std::vector<Quat> rotations() const;
  [[nodiscard]] const std::string& source() const noexcept { return source_; }

 private:
  [[nodiscard]] std::string names() const;

  std::string source_;
  std::vector<std::string> names_;
  std::vector<std::vector<double>> columns_;
  std::size_t rows_ = 0;
};

}  // namespace touchstone::recording
