// The command `trilens`.
#if __has_include(<malloc.h>)
#include <malloc.h>
#endif

#include "cli/commands.h"

namespace {

/// A frame's bands need the same memory again and again: what one frees is kept for the next, instead of
/// being given back to the system and cleared by it anew (a fifth of the time of a picture).
void keep_freed_memory() {
#if defined(__GLIBC__)
    mallopt(M_MMAP_THRESHOLD, 12 << 20);
    mallopt(M_TRIM_THRESHOLD, 512 << 20);
#endif
}

}  // namespace

int main(int argc, char** argv) {
    keep_freed_memory();
    return trilens::run_program(trilens::make_commands(), argc, argv);
}
