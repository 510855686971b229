// A picture's request (frame, engine, layers) and its statistics.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "base/description/optic_description.h"
#include "base/image/image.h"
#include "projector/classic/classic_params.h"

namespace trilens {

/// FrameParams::max_error where no facet is divided for what it is predicted to be off by.
inline constexpr double kAnyError = std::numeric_limits<double>::infinity();

/// Which facets stand for the samples in them. kAll: each that may. kWorthwhile: those that it takes less to
/// probe than to follow their samples' own rays, which the others' are (paths/facets/optic_paths.h).
/// Pictures are drawn so; what facets themselves are good for is seen with all.
enum class FacetUse { kAll, kWorthwhile };

template <>
struct EnumNames<FacetUse> {
    static constexpr std::array kTable{NamedValue<FacetUse>{FacetUse::kAll, "all"},
                                       NamedValue<FacetUse>{FacetUse::kWorthwhile, "worthwhile"}};
};

/// What a picture's rays depend on.
struct FrameParams {
    std::size_t camera = 0;                          // index into Scene::cameras
    int resolution = 0;                              // of every optic's grid, 1..1024; 0: each optic's own
    std::optional<GridKind> grid = std::nullopt;     // of every optic; none: each optic's own
    std::optional<CornerRays> rays = std::nullopt;   // of every optic; none: each optic's own
    std::optional<double> max_error = std::nullopt;  // RenderSettings::max_error; none: the scene's
    std::optional<bool> layered = std::nullopt;  // of every optic, as Mesh::layered; none: each optic's own
    FacetUse facets = FacetUse::kAll;
    // What optics show is proven to be off by no more than max_error, which is above 0; what is not, traced.
    // Also where RenderSettings::certify says so.
    bool certify = false;

    bool operator==(const FrameParams&) const = default;
};

/// kExact: the projector. kClassic: the thesis' engine. kFacetsTruth: Embree on the rays of the same facets.
/// kLimitTruth: Embree on the exact surfaces. The usual approximations, for comparison: kEnvironment: the
/// projector on the facets' rays moved to the optic's centre, as an environment map made there has them;
/// kPlanar: the projector on flat facets. Both end paths after the first optic.
enum class Engine { kExact, kClassic, kFacetsTruth, kLimitTruth, kEnvironment, kPlanar };

template <>
struct EnumNames<Engine> {
    static constexpr std::array kTable{
        NamedValue<Engine>{Engine::kExact, "exact"},        NamedValue<Engine>{Engine::kClassic, "classic"},
        NamedValue<Engine>{Engine::kFacetsTruth, "facets"}, NamedValue<Engine>{Engine::kLimitTruth, "limit"},
        NamedValue<Engine>{Engine::kEnvironment, "envmap"}, NamedValue<Engine>{Engine::kPlanar, "planar"}};
};

/// Whether an engine makes its picture by projection; else it traces rays.
inline bool projects(Engine engine) {
    return engine != Engine::kFacetsTruth && engine != Engine::kLimitTruth;
}

/// Whether an engine follows paths from optic to optic.
inline bool follows_paths(Engine engine) {
    return engine != Engine::kEnvironment && engine != Engine::kPlanar;
}

/// An engine with its settings.
struct EngineChoice {
    Engine engine = Engine::kExact;
    ClassicParams classic;  // of kClassic

    EngineChoice() = default;
    EngineChoice(Engine chosen) : engine(chosen) {}
    EngineChoice(const ClassicParams& params) : engine(Engine::kClassic), classic(params) {}
};

/// "exact", "classic", "facets", "limit", "envmap", "planar".
std::string engine_name(Engine engine);

/// The names of all engines.
const std::vector<std::string>& engine_names();

/// The engine of that name. Throws UsageError, with the nearest name, where there is none.
Engine find_engine(const std::string& name);

/// How the classic engine draws: "arcs", "slices 4, clip screen".
std::string classic_name(const ClassicParams& params);

/// How often a pixel of several samples is shaded. kFragment: once for all its samples that see one triangle
/// through one history, by the engines that project without outlines; all others shade every sample. kSample:
/// at every sample.
enum class Shading { kFragment, kSample };

template <>
struct EnumNames<Shading> {
    static constexpr std::array kTable{NamedValue<Shading>{Shading::kFragment, "fragment"},
                                       NamedValue<Shading>{Shading::kSample, "sample"}};
};

/// The window of the film that is drawn, in pixels [x0, x1) x [y0, y1), and its layers.
struct LayerRequest {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // all zero: the whole film
    // Names to keep beside RGBA, of layer_names(); empty: all but "path", "stat", "magnification",
    // "position", "ray", "bound" and "coverage".
    std::vector<std::string> layers;
    // Of a sample's light what is shown of it, 0..1: the film's filter averages that, R G B are then no
    // light. None: light. A highlight a thousand times as bright as the screen's white else outweighs all
    // samples beside it: edges stay jagged, and filters with negative lobes leave dark rings.
    std::function<Vec3(const Vec3& light)> shown = {};
    Shading shading = Shading::kFragment;
};

struct PictureRequest {
    FrameParams frame;
    EngineChoice engine;
    LayerRequest layers;
    // Told of every strip as it is drawn, beside whoever takes the picture; null: nobody. Changes no pixel.
    // Must live while it is drawn.
    const StripSink* watch = nullptr;
};

/// How it was decided which of an optic's facets are worthwhile.
struct OpticProbes {
    Id object = kNone;         // index into Scene::meshes
    std::size_t surveyed = 0;  // facets probed first, to know what the others are likely to bring
    double least_samples = 0;  // facets that have fewer are traced; infinite: all are
    // In samples' paths followed: probing a facet, and what each of its samples then saves.
    double cost = 0, saved = 0;
};

/// Counts of what the user would want to know.
struct LayerStatistics {
    std::size_t optic_pixels = 0;
    std::size_t pixels_without_ray = 0;  // pixels on an optic that lack a ray a path asked for
    std::size_t subdivided_pixels = 0;   // of the optics' pixels, those of a part of a facet
    std::size_t traced_pixels = 0;       // and those whose own rays were followed
    std::size_t layered_pixels = 0;      // and those that show an optic in an optic as a layer
    std::size_t crowded_out = 0;         // facets whose paths need more memory than is kept for them: traced
    std::size_t projected_facets = 0;    // facets and parts of facets that were drawn through
    double predicted_error = 0;  // pixels: the most that was left of those seen; 0 where none was asked for
    // Pixels of optics whose displacement is proven to be no more than asked for, and the most of these
    // bounds.
    std::size_t certified_pixels = 0;
    double certified_error = 0;
    // Of the layer "coverage", where it is drawn: pixels of which nothing is said.
    std::size_t unbounded_pixels = 0;
    double outline_pixels = 0;  // predicted: that lie between the outlines of optics and of their facets
    // The most that was left out of any pixel, as a share of its light: paths that carry too little, and
    // paths that would go on to another optic after the last that is followed.
    double faint_light = 0, deep_light = 0;
    // Pixels that would show more than kLeastWeight (1 / 512) of their light after the last optic that is
    // followed, and the light of all of them together, in pixels.
    std::size_t deep_pixels = 0;
    double deep_sum = 0;
    // Where pixels are shaded by fragments: those pixels, with the ones around them that a filter reaches;
    // their fragments; of the rays that these shade, those that had to be shaded at each sample, and the
    // pixels that have such rays.
    std::size_t fragment_pixels = 0, fragments = 0, rays_by_sample = 0, pixels_shaded_by_sample = 0;
    // Images of points and labels that are painted, those on the film that something hides, those of labels
    // that give way to others, and the points and labels that have no image.
    std::size_t marks = 0, hidden_marks = 0, crowded_marks = 0, unseen_marks = 0;
    std::vector<OpticProbes> probes;  // per optic, where facets are used that are worthwhile

    /// 0 where no pixel is shaded by fragments.
    double fragments_per_pixel() const {
        return fragment_pixels > 0 ? static_cast<double>(fragments) / static_cast<double>(fragment_pixels)
                                   : 0;
    }
};

struct Picture {
    // With the header fields of the interface. A is 1 where a mesh is seen, an optic included whatever it
    // shows, and 0 where the camera itself sees the environment; Z is the depth of the first surface, the
    // optic's where one is first, and 1e30 in the environment. Where a path ends in the environment its
    // object is 4294967295 and its position the unit direction.
    Image image;
    LayerStatistics statistics;
    double prepare_seconds = 0, draw_seconds = 0;
};

/// The layers that may be asked for beside R G B A: "Z", "optic", "direct", the paths' names, "path",
/// "stat", "magnification" (which goes with a path's own layer), "position" (directID and directP: what the
/// camera sees itself, where no optic is first), "ray" (reflectD and reflectO, refractD and refractO: the
/// last ray's unit direction and its origin, world frame; with a path's own layer), "bound" (pixels: by
/// how much what an optic shows is displaced at most, over all its paths, where that is proven; 0 where it is traced, or not
/// asked) and "coverage" (the mesh that the pixel's centre shows first, and between which shares of the pixel
/// the camera sees it, as is proven for every place in it; 0 and 1 say nothing).
const std::vector<std::string>& layer_names();

}  // namespace trilens
