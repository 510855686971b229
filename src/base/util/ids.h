// Ids are 32-bit indices; kNone says "there is none".
#pragma once

#include <array>
#include <cstdint>

namespace trilens {

using Id = std::uint32_t;
inline constexpr Id kNone = 4294967295u;
using IdTriple = std::array<Id, 3>;

}  // namespace trilens
