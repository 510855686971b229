// Spelling suggestions by edit distance (Damerau and Levenshtein): "did you mean".
#pragma once

#include <span>
#include <string>

namespace trilens {

/// `; did you mean 'X'?` with the known name of the smallest edit distance (insert, delete, replace, swap of
/// neighbours; letter case counts nothing), where that is at most a third of the longer name, rounded up;
/// else
/// `; known: a, b, c`, or "; there are none" for no known names.
std::string suggestion(const std::string& unknown, std::span<const std::string> known);

}  // namespace trilens
