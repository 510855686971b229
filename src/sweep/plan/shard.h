// Which part of a plan one process does: the text of --shard.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace trilens {

/// Job i of a plan belongs to shard i % count.
struct Shard {
    int index = 0, count = 1;

    bool has(std::size_t job) const {
        return job % static_cast<std::size_t>(count) == static_cast<std::size_t>(index);
    }
};

/// Value of an environment variable, or nullptr.
using Environment = std::function<const char*(const char* name)>;

/// Reads "i/n" with 0 <= i < n, or "auto": from the variables of Slurm, Grid Engine, LSF job arrays or of
/// GoogleTest sharding. Throws UsageError.
Shard parse_shard(const std::string& text, const Environment& environment);

}  // namespace trilens
