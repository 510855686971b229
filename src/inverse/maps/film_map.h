// Maps between a film and a target, pixel by pixel, both ways: what warps a picture of one into one of the
// other.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/image/image.h"
#include "base/util/names.h"
#include "base/util/progress.h"
#include "inverse/maps/proxy_description.h"
#include "inverse/maps/target.h"
#include "paths/trace/path.h"
#include "render/frame/request.h"
#include "render/shoot/event_word.h"

namespace trilens {

struct World;

/// kUnwrap: a map of the target's size with places on the film: it warps photographs into the target. kView:
/// a map of the film's size with places on the target: it warps pictures of the target into what the camera
/// sees.
enum class MapWay { kUnwrap, kView };

template <>
struct EnumNames<MapWay> {
    static constexpr std::array kTable{NamedValue<MapWay>{MapWay::kUnwrap, "unwrap"},
                                       NamedValue<MapWay>{MapWay::kView, "view"}};
};

struct FilmMapRequest {
    TargetDescription target;
    ProxyDescription proxy;      // of targets of directions
    std::optional<Vec3> center;  // of these; none: the middle of the optic
    MapWay way = MapWay::kUnwrap;
    std::optional<std::size_t> optic;  // index into World::optics; none: any
    std::optional<Path> path;          // kUnwrap; none: reflected by mirrors, refracted by glass
    EventWord word;                    // kView; asks for nothing: the way that carries most light
    double tolerance = 0.01;           // pixels of the source that interpolated places may be off
    FrameParams frame;
};

/// One map: per pixel of the warped picture, rows from the top, where it is taken from.
struct FilmMap {
    int width = 0, height = 0;                // of the warped picture
    int source_width = 0, source_height = 0;  // of the picture that is warped
    std::vector<float> x, y;  // pixels from the source's top left, a pixel's centre at .5; -1 where none
    std::vector<float> jacobian[4];  // dx/dx, dx/dy, dy/dx, dy/dy: source pixels per pixel
    std::vector<unsigned char> valid;
    std::size_t exact_places = 0;
    double worst_accepted = 0;  // source pixels that an interpolated place was found to be off

    std::size_t valid_count() const;
};

/// Where a place is seen several times, the best resolved image is taken. Throws UsageError for what the
/// scene does not have, InputError where nothing is mapped; Interrupted.
FilmMap make_film_map(const World& world, const FilmMapRequest& request, const Progress& progress = {});

/// Pixels between the first exact places: fewer where objects may hide what is seen, of any shape.
int first_cell(bool visibility);

/// The centre of directions: as asked, or the middle of the optics (of one, where that is asked for).
Vec3 center_of_directions(const World& world, const std::optional<Vec3>& asked,
                          const std::optional<std::size_t>& optic);

}  // namespace trilens
