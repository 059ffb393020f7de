// The program of the studies: touchstone-experiment, and by links touchstone-atlas, touchstone-blind and
// touchstone-sweep.
#include "apps/program.h"
#include "study_commands.h"

int main(int argc, char** argv) {
  return touchstone::apps::run_extra(argc, argv,
                                     {touchstone::studies::add_atlas, touchstone::studies::add_blind,
                                      touchstone::studies::add_experiment, touchstone::studies::add_sweep});
}
