// "Did you mean": the nearest known word.
#pragma once

#include <span>
#include <string>

namespace trilens {

/// `; did you mean "X"?` for the known word nearest to `word` by edits, or nothing where none is near.
std::string did_you_mean(const std::string& word, std::span<const std::string> known);

}  // namespace trilens
