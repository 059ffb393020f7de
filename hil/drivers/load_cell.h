// A load cell behind an HX711 converter and a microcontroller that prints its readings as lines, as the example
// sketches of the Arduino libraries do:
//   HX711 (bogde/HX711, commit be5e3d25):            "one reading:\t12.3\t| average:\t12.4"
//   HX711_ADC (olkal/HX711_ADC, commit 7762bc42):    "Load_cell output val: 12.34"
// Of each line the n-th number is the load, by default the first. Readings have the same words around their numbers:
// once two lines in a row agree in them, lines with others (what a sketch prints while it starts: HX711's example
// prints raw counts) are counted as malformed and left out, as are lines with fewer numbers (greetings,
// questions). Opening the line of most boards resets them: opening waits for the first readings, up to 10 s. A line
// says neither its unit nor its time, and none is numbered: the user states newtons per unit (as 0.00980665 for grams,
// negative where the cell is the other way round), times are arrivals, less what the bytes that came with them took on
// the wire, and a line that is lost cannot be seen.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "devices/interfaces.h"
#include "devices/known_device.h"

namespace touchstone::hil {

struct LoadCellOptions {
  std::string node;
  int baud = 57600;  // HX711_ADC's examples; 38400 in HX711's
  double newtons_per_unit = 0.0;
  int value = 1;         // which number of a line
  char axis = 'z';       // the force is along it; the other components are zero
  double rate_Hz = 0.0;  // where the user states it: 10 or 80 by the converter's pin, less if readings are averaged
};

// The n-th number of a line; nothing where it has fewer, or where nan, inf or ovf stands in its place, as Arduino
// prints what is none.
std::optional<double> number_in_line(std::string_view line, int n);
// Throws UsageError without newtons_per_unit, DeviceError: absent, no_permission, timed_out (no readings).
std::unique_ptr<WrenchSource> open_load_cell(const LoadCellOptions& options);

extern const KnownDevice load_cell_device;

}  // namespace touchstone::hil
