// What a path of light does at each optic that it meets, as letters: R reflected, T transmitted, ? either.
#pragma once

#include <string>

namespace trilens {

/// "R", "TT", "R?T"; "D": direct, over no optic; empty: whatever it is that carries most light.
using PathWord = std::string;

/// Throws UsageError for other letters, and for D among others.
void check_path_word(const PathWord& word);

}  // namespace trilens
