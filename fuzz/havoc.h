// Files changed at random in several places at once ("havoc": Zalewski, Technical "whitepaper" for afl-fuzz,
// 2014).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace trilens_fuzz {

/// No longer than this, unless the file was.
inline constexpr std::size_t kLongestChanged = 8192;

/// One of the files with one to sixteen changes: bits turned, bytes and numbers replaced, pieces taken out,
/// doubled, overwritten, or put in from any of the files. The same for the same seed. `files`: at least one.
std::string changed_file(std::span<const std::string> files, std::uint64_t seed);

}  // namespace trilens_fuzz
