// The program of tools with a shape: touchstone-tool.
#include "apps/program.h"
#include "tool_commands.h"

int main(int argc, char** argv) { return touchstone::apps::run_extra(argc, argv, {touchstone::tool::add_tool}); }
