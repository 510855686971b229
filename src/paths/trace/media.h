// Nested dielectrics: the interior list of a ray, and its active medium.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "base/util/ids.h"

namespace trilens {

/// Optics in the order in which the ray came into them. Plain data, small: a ray inside of more than kMost
/// bodies at once cannot be told.
struct Media {
    static constexpr int kMost = 8;
    std::array<Id, kMost> optic{};
    std::uint8_t count = 0;

    bool holds(Id asked) const {
        for (int i = 0; i < count; ++i)
            if (optic[static_cast<std::size_t>(i)] == asked) return true;
        return false;
    }
    /// False where there is no room.
    bool enter(Id entered) {
        if (count == kMost) return false;
        optic[count++] = entered;
        return true;
    }
    /// Takes out the last entry of that optic, where it has one.
    void leave(Id left) {
        for (int i = count - 1; i >= 0; --i) {
            if (optic[static_cast<std::size_t>(i)] != left) continue;
            for (int k = i; k + 1 < count; ++k)
                optic[static_cast<std::size_t>(k)] = optic[static_cast<std::size_t>(k) + 1];
            --count;
            return;
        }
    }

    /// The body whose glass the ray runs in: of those that it is inside of the one of highest priority, the
    /// last entered among equals; kNone: air. `priority(optic)` gives an optic's.
    /// Source: Schmidt and Budge, Simple Nested Dielectrics in Ray Traced Images, JGT 2002.
    template <typename Priority>
    Id active(const Priority& priority) const {
        Id best = kNone;
        for (int i = 0; i < count; ++i) {
            const Id one = optic[static_cast<std::size_t>(i)];
            if (best == kNone || priority(one) >= priority(best)) best = one;
        }
        return best;
    }
};

/// What a ray is inside of before and behind a surface.
struct MediaSides {
    Media before, after;
};

/// The sides of a body's surface for a ray that is inside of `media`; it comes to the body's front, from
/// outside, or to its back. One that comes to the back of a body that it did not enter (an open surface)
/// leaves it. None where the ray is inside of too many bodies to tell.
inline std::optional<MediaSides> sides_of(const Media& media, Id body, bool front) {
    MediaSides sides{media, media};
    if (front) {
        if (!sides.after.enter(body)) return std::nullopt;
        return sides;
    }
    if (!media.holds(body) && !sides.before.enter(body)) return std::nullopt;
    sides.after = sides.before;
    sides.after.leave(body);
    return sides;
}

}  // namespace trilens
