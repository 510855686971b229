// Words of events: which history a path is to have, one letter for each meeting with an optic.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "paths/trace/path.h"

namespace trilens {

/// What happens at the optics of a path, in its order from the eye: R it is reflected, T transmitted, ?
/// either of both (Heckbert 1990 writes light paths so). Passing through a surface without an interface
/// (Event::kPass) has no letter. An empty word asks for nothing: every history is right.
class EventWord {
  public:
    static constexpr std::size_t kMost = 64;  // letters

    EventWord() = default;
    /// Throws UsageError for other letters, none at all, or more than kMost.
    explicit EventWord(std::string_view letters);

    bool operator==(const EventWord&) const = default;
    bool asks() const { return !letters_.empty(); }
    std::size_t size() const { return letters_.size(); }
    const std::string& letters() const { return letters_; }

    /// Whether this event may be the one at letter `place`; of an empty word always.
    bool allows(std::size_t place, Event event) const;
    /// Whether a whole history is one that the word asks for.
    bool is(std::span<const Step> steps) const;
    /// Whether some history may begin with these steps.
    bool may_begin(std::span<const Step> steps) const;

  private:
    std::optional<std::size_t> place_after(std::span<const Step> steps) const;

    std::string letters_;
};

}  // namespace trilens
