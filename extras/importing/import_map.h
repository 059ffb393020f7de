// What the columns of a foreign file mean. JSON, schema "touchstone-import/1"; kept beside the data set.
//
//   {"schema": "touchstone-import/1",
//    "about": "what instrument, which file",
//    "table": {"separator": "comma", "decimal": "point", "comment": "%", "names": ["q", "qd", "effort"]},
//    "files": {"pose": {"file": "pose.txt", "table": {}, "time": {"from": "t", "scale": 1e-6}}},
//    "stack": [{"z": 1, "force": 2}, {"z": 3, "force": 4, "reverse": true, "padded": "force"}],
//    "rows": {"from_s": 2, "to_s": 20, "where": {"segment": 0}},
//    "columns": {"t_s":  {"row_rate_Hz": 200},
//                "x_mm": {"from": "pose:x", "scale": 1000},
//                "z_m":  {"sum": [{"from": "height"}, {"from": "force", "scale": 44.8}], "offset": -5e-5},
//                "q_rad": {"integrate": "qd", "start": 0.1},
//                "y_mm": {"constant": 0}},
//    "rotation_rows": ["r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"],
//    "quaternion": {"from": ["qx", "qy", "qz", "qw"], "order": "xyzw"},
//    "euler": {"from": ["roll", "pitch", "yaw"], "order": "xyz", "unit": "deg"},
//    "force_sign": -1, "force_frame": "sensor", "shift_force_s": 0.01,
//    "status": {"from": "Status (hex)", "device": "net-ft", "bad_samples": "leave out"}}
//
// A column is named by its name, by its number from 1, or as "table:column" where the table is a key of `files`, a
// topic of a bag or the length of a .mat file's arrays; without a table it is the first that has it. `files` are
// relative to the main file. Another file (or topic) with a clock is interpolated linearly at the main one's times,
// orientations along the shorter way; without a clock it must have as many rows. `force_frame`: "sensor" turns the
// force by the orientation, "inverse" by its inverse, "transposed" by its square (it had been turned by the transpose).
// `rows`: "at" names a column: the rows in which it has a value are taken, and there the others are interpolated over
// time; loggers that write several topics into one table leave the fields of the others blank.
// `decide`: what a proposal could not settle, as a list of texts; the map is refused until it is empty. `reasons`: why
// it reads the columns so, for people.
// `status`: the status word of a network sensor ("net-ft", "ethernet-axia"). A file with samples that it calls
// saturated or faulty is refused; "bad_samples" may be "leave out" or "keep".
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "import_table.h"
#include "sensor_status.h"

namespace touchstone::importing {

struct ImportTerm {
  std::string column;  // "name", "3" or "table:name"
  double scale = 1.0;
};

struct ImportColumn {
  std::string name;                   // as the result has it: "x_m"
  std::vector<ImportTerm> terms;      // their sum
  double offset = 0.0;                // added after scaling; the start of an integral
  bool integrate = false;             // over time, by the trapezoidal rule
  std::optional<double> row_rate_Hz;  // a clock made from row numbers
};

struct ImportFile {
  std::string name;
  std::filesystem::path file;
  TextLayout layout;
  std::optional<ImportTerm> time;
};

enum class BadSamples { refuse, leave_out, keep };

struct ImportStatus {
  std::string column;
  StatusDevice device = StatusDevice::net_ft;
  BadSamples bad_samples = BadSamples::refuse;
};

enum class ForceFrameReading { object, sensor, inverse, transposed };

struct ImportMap {
  std::string source;  // the map's file
  std::string about;
  TextLayout layout;
  std::vector<ImportFile> files;
  struct Part {
    std::map<std::string, std::string> columns;  // name -> column of the file
    bool reverse = false;
    // Rows at the part's beginning are left out while this column, one of `columns`, keeps its first value, but for the
    // last of them: exports pad curves so. Empty: none are.
    std::string padded;
  };
  std::vector<Part> stack;
  std::optional<double> from_s, to_s;
  std::map<std::string, double> where;
  std::string rows_at;  // the column whose rows are taken; empty: all
  std::vector<ImportColumn> columns;
  std::vector<std::string> rotation_rows;  // nine
  std::vector<std::string> quaternion;     // w, x, y, z
  std::vector<std::string> euler;
  std::string euler_order;
  double euler_scale = 1.0;  // to rad
  double force_sign = 1.0;
  double shift_force_s = 0.0;
  ForceFrameReading force_frame = ForceFrameReading::object;
  std::optional<ImportStatus> status;
};

// Throws BadData naming the file and the place in it.
ImportMap load_import_map(const std::filesystem::path& path);
ImportMap parse_import_map(const nlohmann::json& json, const std::string& source);

}  // namespace touchstone::importing
