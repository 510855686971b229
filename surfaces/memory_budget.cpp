// The machine's memory against an estimate.
#include "surfaces/memory_budget.h"

#include <unistd.h>

#include <cstdio>

#include "base/util/error.h"

namespace trilens {
namespace {

std::string gibibytes(double bytes) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g GiB", bytes / (1 << 30));
    return text;
}

}  // namespace

double machine_memory() {
    return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

void check_memory(const MemoryNeed& need, const MemoryLimit& limit) {
    if (need.bytes <= limit.bytes) return;
    throw InputError(limit.name, "",
                     need.what + " needs about " + gibibytes(need.bytes) + " of memory, and there are " +
                         gibibytes(limit.bytes) + "; " + need.advice);
}

}  // namespace trilens
