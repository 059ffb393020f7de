// This process's view of the system's clock, CLOCK_REALTIME, which a test sets as an administrator or ntpd does: what
// clock_gettime() answers from then on, and what the kernel stamps packets with (SO_TIMESTAMPNS) that come from then
// on; packets that wait keep their stamps. CLOCK_BOOTTIME and the others run on. The machine's clock is not touched.
#pragma once

namespace touchstone::hil {

// Adds to the system's clock; what earlier calls added stays.
void step_system_clock(double by_s);

}  // namespace touchstone::hil
