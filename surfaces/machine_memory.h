// What does not fit into the machine's memory is refused before it starts.
#pragma once

#include <string>

namespace trilens {

/// Bytes of physical memory of this machine.
double machine_memory();

/// Work that is about to start.
struct MemoryNeed {
    double bytes = 0;
    std::string what;    // "the limit surface of 70000 faces"
    std::string advice;  // what makes it less: "use a cage of fewer faces"
};

struct MemoryLimit {
    double bytes = 0;
    std::string name;  // of what is refused beyond it: a mesh, a file
};

/// Throws InputError(limit.name, "", ...) with the estimate and the advice where the need is above the limit.
void check_memory(const MemoryNeed& need, const MemoryLimit& limit);

}  // namespace trilens
