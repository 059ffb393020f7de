// The program of recordings of one axis, touchstone-axis.
#include "apps/program.h"
#include "command_axis.h"

int main(int argc, char** argv) { return touchstone::apps::run_extra(argc, argv, {touchstone::axis::add_axis}); }
