#include "harness/importing/file_formats.h"

#include <array>

namespace touchstone::importing {
namespace {

constexpr auto layout_part_fields = std::to_array<FormatField>({
    {"separator?", "text", "", "comma, semicolon, tab or space; found from the numbers by default"},
    {"decimal?", "text", "", "point or comma"},
    {"comment?", "text", "", "what begins a comment"},
    {"names?", "list of texts", "", "columns, if the file has no names"},
});
constexpr FormatPart layout_part{layout_part_fields};

constexpr auto term_part_fields = std::to_array<FormatField>({
    {"from", "text or whole number", "", "column: its name, its number from 1, or table:column"},
    {"scale?", "number", "", "factor; 1 by default"},
});
constexpr FormatPart term_part{term_part_fields};

constexpr auto import_fields = std::to_array<FormatField>({
    {"about?", "text", "", "what instrument, which file"},
    {"decide?", "list of texts", "", "what a proposal could not settle; refused until it is empty"},
    {"reasons?", "list of texts", "", "why a proposal reads each column as it does; nothing reads them"},
    {"table?", "object", "", "layout of a text table", &layout_part},
    {"files?", "object", "", "more files, by the names that columns use"},
    {"files.*", "object", "", "one of them"},
    {"files.*.file", "text", "", "relative to the main file"},
    {"files.*.table?", "object", "", "its layout", &layout_part},
    {"files.*.time?", "object", "", "its clock; without one it is joined row by row", &term_part},
    {"stack?", "list of objects", "", "parts of a table that stand side by side, put below one another"},
    {"stack[].reverse?", "flag", "", "turns the part round"},
    {"stack[].padded?", "text", "", "column whose constant beginning is left out"},
    {"stack[].*", "text or whole number", "", "column of the file, by its name in the stacked table"},
    {"rows?", "object", "", "which rows to take"},
    {"rows.from_s?", "number", "s", "first"},
    {"rows.to_s?", "number", "s", "last"},
    {"rows.at?", "text or whole number", "",
     "column whose rows are taken; the others are interpolated there over time"},
    {"rows.where?", "object", "", "columns that must have a value"},
    {"rows.where.*", "number", "", "that value"},
    {"columns", "object", "", "columns of the recording"},
    {"columns.*", "object", "", "one of them, by name and unit: x_mm"},
    {"columns.*.from?", "text or whole number", "", "column of the file"},
    {"columns.*.integrate?", "text or whole number", "", "or a column whose integral over time it is"},
    {"columns.*.sum?", "list of objects", "", "or several columns", &term_part},
    {"columns.*.constant?", "number", "", "or a number"},
    {"columns.*.row_rate_Hz?", "number", "Hz", "or a clock made from row numbers"},
    {"columns.*.scale?", "number", "",
     "factor; 1 by default. Where the file states a unit it must be that of the unit; its sign is free"},
    {"columns.*.offset?", "number", "", "added after scaling; 0 by default"},
    {"columns.*.start?", "number", "", "value at the begin of an integral"},
    {"rotation_rows?", "any", "", "nine columns: the orientation as a matrix, row by row"},
    {"quaternion?", "object", "", "the orientation as a quaternion"},
    {"quaternion.from", "any", "", "four columns"},
    {"quaternion.order", "text", "", "wxyz or xyzw"},
    {"euler?", "object", "", "the orientation as three angles"},
    {"euler.from", "any", "", "three columns"},
    {"euler.order", "text", "", "axes, each turned with the body: \"xyz\""},
    {"euler.unit", "text", "", "deg or rad"},
    {"force_sign?", "number", "", "-1 if the file has the force ON the object"},
    {"force_frame?", "text", "", "object (default), sensor, inverse or transposed"},
    {"shift_force_s?", "number", "s", "added to the force's times"},
    {"status?", "object", "", "status words of a network sensor"},
    {"status.from", "text or whole number", "", "their column"},
    {"status.device", "text", "", "net-ft or ethernet-axia"},
    {"status.bad_samples?", "text", "", "refuse (default), leave out or keep"},
});

}  // namespace

std::span<const FileFormat> file_formats() {
  static const auto formats = std::to_array<FileFormat>({
      {"touchstone-import/1", "map.json", "what the columns of a foreign file mean (docs/how-to/import.md)",
       "`import --guess`", "`import --map`", import_fields},
  });
  return formats;
}

}  // namespace touchstone::importing
