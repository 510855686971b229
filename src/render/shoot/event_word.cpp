#include "render/shoot/event_word.h"

#include "base/util/error.h"
#include "base/util/format.h"

namespace trilens {

EventWord::EventWord(std::string_view letters) : letters_(letters) {
    if (letters.empty() || letters.size() > kMost)
        throw UsageError(fmt::format("a path has 1..{} events, not {}", kMost, letters.size()));
    if (letters.find_first_not_of("RT?") != std::string_view::npos)
        throw UsageError(fmt::format(
            "the path \"{}\" holds a letter other than R (reflected), T (transmitted) and ? (either)",
            letters));
}

bool EventWord::allows(std::size_t place, Event event) const {
    if (letters_.empty() || event == Event::kPass) return true;
    if (place >= letters_.size()) return false;
    return letters_[place] == '?' || (letters_[place] == 'R') == (event == Event::kReflect);
}

/// How many letters a beginning of a history takes; none where it is not the word's.
std::optional<std::size_t> EventWord::place_after(std::span<const Step> steps) const {
    std::size_t place = 0;
    for (const Step& step : steps) {
        if (!allows(place, step.event)) return std::nullopt;
        place += step.event != Event::kPass;
    }
    return place;
}

bool EventWord::is(std::span<const Step> steps) const {
    const std::optional<std::size_t> place = place_after(steps);
    return place && (letters_.empty() || *place == letters_.size());
}

bool EventWord::may_begin(std::span<const Step> steps) const {
    return place_after(steps).has_value();
}

}  // namespace trilens
