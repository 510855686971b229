// Words of events: which history a path is to have, one letter for each meeting with an optic.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "paths/trace/path.h"
#include "render/frame/request.h"

namespace trilens {

/// What happens at the optics of a path, in its order from the eye: R it is reflected, T transmitted, ?
/// either of both (Heckbert 1990 writes light paths so). Passing through a surface without an interface
/// (Event::kPass) has no letter. An empty word asks for nothing: every history is right.
class EventWord {
  public:
    static constexpr std::size_t kMost = 64;  // letters

    EventWord() = default;
    /// "D", or up to kMost letters R, T and ?. Throws UsageError for others, and none at all.
    explicit EventWord(std::string_view letters);

    bool operator==(const EventWord&) const = default;
    bool asks() const { return !letters_.empty(); }
    /// Of events: 0 of "D", what is seen directly.
    std::size_t size() const { return is_direct() ? 0 : letters_.size(); }
    bool is_direct() const { return letters_ == "D"; }
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

// Shoots rays into the scene, many at once, and tells all that each meets: the camera as a function of
// pixels.

struct World;

/// kSeen: it ends at an object. kEscapes: it ends in the environment. kNoCameraRay: the camera has no ray at
/// that place of the film. kOtherPath: its path is not the word's. kLost: it is inside of more bodies of
/// glass at once than can be told.
enum class ShotState : std::uint8_t { kSeen, kEscapes, kNoCameraRay, kOtherPath, kLost };

template <>
struct EnumNames<ShotState> {
    static constexpr std::array kTable{NamedValue<ShotState>{ShotState::kSeen, "seen"},
                                       NamedValue<ShotState>{ShotState::kEscapes, "escapes"},
                                       NamedValue<ShotState>{ShotState::kNoCameraRay, "no ray"},
                                       NamedValue<ShotState>{ShotState::kOtherPath, "other path"},
                                       NamedValue<ShotState>{ShotState::kLost, "lost"}};
};

/// What became of one ray. Where it was not followed to its end (the last three states) only `state` says
/// anything.
struct ShotRay {
    ShotState state = ShotState::kNoCameraRay;
    std::size_t first_event = 0, event_count = 0;  // of ShotRays::events
    Vec3 origin{0}, direction{0};  // the last ray: from the last optic, or the ray itself where it meets
                                   // none; world, the direction unit
    Id object = kNone;             // kSeen: index into Scene::meshes
    Id primitive = kNone;          // kSeen: as in images, of the mesh
    Vec3 position{0};              // kSeen: world
    double t = 0;                  // kSeen: from `origin` to `position`, scene units
    // The share of each colour of the light from there that the path carries: Fresnel, tint and absorption
    // all along it. Where it escapes inside a body of glass, without that body's absorption on the last ray.
    Vec3 weight{1};
    bool cut = false;  // it would meet another optic, but ends there: the scene's maxDepth (or 256 meetings)

    bool followed() const { return state == ShotState::kSeen || state == ShotState::kEscapes; }
};

/// Rays in the order asked for; the events of all of them, one ray's behind the other's.
struct ShotRays {
    std::vector<ShotRay> rays;
    std::vector<PathEvent> events;

    std::span<const PathEvent> events_of(const ShotRay& ray) const {
        return {events.data() + ray.first_event, ray.event_count};
    }
};

/// One path is followed for each ray, on the exact surfaces, as the limit truth does. Where light branches,
/// at glass, it takes the way that carries more light, the sum of the three colours (where both carry the
/// same, through the glass; through glass that disperses, green's). With a word it takes at each meeting the
/// word's way, and at ? the stronger one; the path must then have exactly those events: where it meets fewer
/// optics, or another one after the last of them, it is another path. The word decides how far it goes,
/// whatever the scene's maxDepth, but where that ends right after the word an optic that follows only counts
/// as `cut`.
struct ShootRequest {
    std::size_t camera = 0;  // index into Scene::cameras; of own rays not asked
    EventWord path = {};
};

/// The camera's rays through places of the film (pixels from its top left, a pixel's centre at .5); places
/// beyond the film too, as far as the camera's law goes on. Deterministic for any number of threads. Throws
/// InputError where the camera is none.
ShotRays shoot_places(const World& world, const ShootRequest& request, std::span<const Vec2> places);

/// Rays of one's own: world, directions of any length; one that is zero or not finite has state kNoCameraRay.
/// What glass a ray starts in is found from where it goes.
ShotRays shoot_rays(const World& world, const ShootRequest& request, std::span<const Ray> rays);

}  // namespace trilens
