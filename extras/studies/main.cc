// The program of the studies: touchstone-experiment, and by a link touchstone-blind.
#include "apps/program.h"
#include "commands.h"

int main(int argc, char** argv) {
  return touchstone::apps::run_extra(argc, argv, {touchstone::studies::add_blind, touchstone::studies::add_experiment});
}
