// The program of the lab, touchstone-hil.
#include "apps/program.h"
#include "hil_commands.h"

int main(int argc, char** argv) { return touchstone::apps::run_extra(argc, argv, {touchstone::hil::add_hil}); }
