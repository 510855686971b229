#include "base/util/check.h"

#include <cstdio>
#include <cstdlib>

namespace trilens {

void check_failed(const char* condition, const char* file, int line, const char* why) {
    std::fprintf(stderr, "%s:%d: bug: %s [%s]\n", file, line, why, condition);
    std::abort();
}

}  // namespace trilens
