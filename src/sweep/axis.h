// What a sweep varies, and which part of it one process does: the texts of --over and --shard.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace trilens {

/// A named list of values, positive, ascending, each once, at least one.
struct Axis {
    std::string name;  // "resolution"
    std::vector<int> values;
};

/// Reads "resolution=ITEM,ITEM,...", each ITEM a whole number or a range: "1..64:x2" multiplies by 2 from 1
/// while at most 64, "8..32:+8" adds 8. Throws UsageError: another name, no number, below 1, above 65536, a
/// step that does not grow, a range that runs backwards, a value twice, more than 1000 values.
Axis parse_axis(const std::string& text);

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
