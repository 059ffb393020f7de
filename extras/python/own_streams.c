/* Debian's static HDF5 and matio address stdout and stderr as a program does, which no linker puts into a shared library.
 * `ld --wrap` makes every use of them in this module one of these copies, which point to the same streams. */
#include <stdio.h>

extern FILE* __real_stdout;
extern FILE* __real_stderr;

__attribute__((visibility("hidden"))) FILE* __wrap_stdout;
__attribute__((visibility("hidden"))) FILE* __wrap_stderr;

/* Before the constructors of C++. */
__attribute__((constructor(101))) static void point_to_the_streams(void) {
  __wrap_stdout = __real_stdout;
  __wrap_stderr = __real_stderr;
}
