// The program with every command; `touchstone` becomes it for those that it does not have itself.
#include "apps/commands.h"
#include "apps/program.h"

int main(int argc, char** argv) { return touchstone::apps::run_program(argc, argv, touchstone::apps::commands()); }
