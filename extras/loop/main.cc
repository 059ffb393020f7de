// The program of the closed loop, touchstone-loop.
#include "apps/program.h"
#include "commands.h"
#include "harness/base/bundled_files.h"
#include "servo/data_sheet.h"

int main(int argc, char** argv) {
  // The data sheets are this program's own: found from it, before bundled recordings are found from touchstone.
  if (const auto own = touchstone::find_bundled("loop")) touchstone::servo::use_sheets_in(*own);
  return touchstone::apps::run_extra(argc, argv, {touchstone::loop::add_loop});
}
