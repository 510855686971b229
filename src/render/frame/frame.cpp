#include "render/frame/frame.h"

#include <algorithm>
#include <cmath>

#include "base/math/box.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "render/frame/camera_rays.h"

namespace trilens {

namespace {

/// Where an error is asked for, facets are divided down to DivideParams::least_area, whatever their size.
constexpr int kMostLevelsForError = 12;
/// Parts of a facet with fewer samples are traced (measured): their corners' paths and proofs cost as much.
constexpr double kLeastSamples = 32;

/// Facets whose rays turn smoothly show things off by the square of their size. Those that are predicted to
/// be off by more than this, in pixels, lie, and are divided whether an error is asked for or not.
double believable_error(int resolution, int film_height) {
    constexpr double kOnePixelAt = 32, kOnFilm = 480;
    const double coarser = kOnePixelAt / resolution;
    return std::max(1.0, coarser * coarser * film_height / kOnFilm);
}

FramedOptic frame_optic(const World& world, std::size_t index, const Frame& frame,
                        const FrameParams& params) {
    const CameraRays& camera = frame.camera;
    const Optic& optic = world.optics[index];
    const RenderSettings& settings = world.scene.render;
    FramedOptic framed;
    framed.rays = optic_rays(world, index, params);
    framed.resolution = grid_resolution(optic, params.resolution);
    framed.grid = params.grid.value_or(world.scene.meshes[optic.mesh].grid);
    framed.layered = params.layered.value_or(world.scene.meshes[optic.mesh].layered);
    framed.facets = optic_facets(world, index, framed.resolution);
    if (camera.model) {
        framed.model = camera.model;
        if (is_ray_mesh_model(*camera.model)) framed.grid = GridKind::kScreen;
        framed.film_grid =
            std::make_shared<FilmGrid>(make_film_grid(framed.facets->grid(), *camera.model, camera.film));
    }
    const auto add = [&](Path path) {
        const double ior = relative_ior(world, index, frame.camera_media.fixed);
        framed.paths.push_back(
            camera.linear ? make_path_mesh(path, framed.facets->grid(), *camera.linear, ior)
                          : make_path_mesh(path, framed.film_grid->grid, framed.film_grid->views, ior));
    };
    if (settings.reflect) add(Path::kReflect);
    if (settings.refract && !optic.mirror) add(Path::kRefract);
    return framed;
}

/// Why an optic has no layers though they are asked for; empty where it has. Alone, it sees none to have.
std::string reason_for_none(const World& world, const Frame& frame, std::size_t optic) {
    const RenderSettings& settings = world.scene.render;
    if (!world.optics[optic].mirror) return "it is glass";
    if (frame.max_error > 0) return "an error is asked for";
    if (frame.optics[optic].grid == GridKind::kScreen) return "its facets lie on the film";
    if (!frame.camera.linear || frame.camera.linear->parallel) return "the camera has no one eye";
    if (!frame.camera_media.none()) return "the camera may be in glass";
    if (settings.max_depth < 1 || !settings.reflect) return "paths end before them";
    return {};
}

void warn_of_no_nested_optics(const World& world, const Frame& frame, const Warn& warn) {
    if (!warn || world.optics.size() < 2) return;
    for (std::size_t i = 0; i < world.optics.size(); ++i)
        if (const std::string why = reason_for_none(world, frame, i); !why.empty())
            warn("optics seen in " + world.names[world.optics[i].mesh] + " are no layers: " + why +
                 "; its facets are divided where they are seen");
}

}  // namespace

Frame make_frame(const World& world, const FrameParams& params, const Warn& warn) {
    return make_frame(world, make_camera_rays(world.scene, params.camera), params, warn);
}

CornerRays optic_rays(const World& world, std::size_t optic, const FrameParams& params) {
    return params.rays.value_or(world.scene.meshes[world.optics[optic].mesh].rays);
}

Frame make_frame(const World& world, CameraRays camera, const FrameParams& params, const Warn& warn) {
    Frame frame;
    frame.camera = std::move(camera);
    frame.camera_media = camera_media_of(world, frame.camera);
    frame.max_error = params.max_error.value_or(world.scene.render.max_error);
    frame.facets = params.facets;
    frame.certify = params.certify || world.scene.render.certify;
    if (frame.certify && !(frame.max_error > 0))
        throw UsageError("what is to be proven is an error of more than 0 pixels: say which (max-error)");
    check_facet_count(world, params.resolution);
    for (std::size_t i = 0; i < world.optics.size(); ++i) {
        frame.optics.push_back(frame_optic(world, i, frame, params));
        const std::vector<Vec3>& normals = frame.optics.back().facets->grid().corner_normal;
        const auto bad = std::count(normals.begin(), normals.end(), Vec3(0));
        if (bad > 0 && warn)
            warn(world.names[world.optics[i].mesh] + ": " + std::to_string(bad) +
                 " grid corners have no normal; the facets there show nothing");
        const std::shared_ptr<const FilmGrid>& placed = frame.optics.back().film_grid;
        if (placed && placed->lost > 0 && warn)
            warn(world.names[world.optics[i].mesh] + ": " + std::to_string(placed->lost) +
                 " facets lie across a pole of the camera or reach where it has no image; what they reflect "
                 "or refract is not drawn");
    }
    if (params.layered.value_or(false)) warn_of_no_nested_optics(world, frame, warn);
    return frame;
}

PathCamera path_camera(const LinearCamera& camera) {
    PathCamera of_paths;
    of_paths.parallel = camera.parallel;
    of_paths.screen = [&camera](const Vec3& point) { return screen_from_world(camera, point); };
    // The rows of the map, inverted; parallel cameras have w = 1, their depth is free: the image plane's.
    const Mat3 rows(Vec3(camera.screen_x), Vec3(camera.screen_y),
                    camera.parallel ? camera.view_direction : Vec3(camera.screen_w));
    of_paths.point = [&camera, inverse = glm::inverse(glm::transpose(rows))](const Vec3& screen) {
        const Vec3 offset(camera.screen_x.w, camera.screen_y.w,
                          camera.parallel ? -dot(camera.view_direction, camera.eye) : camera.screen_w.w);
        const Vec3 wanted = camera.parallel ? Vec3(Vec2(screen) / screen.z, 0) : screen;
        return inverse * (wanted - offset);
    };
    of_paths.ray = [&camera](const Vec3&, const Vec3& chord) {
        const Vec3 incident = incident_direction(camera, chord);
        return Ray{chord - incident, incident};
    };
    return of_paths;
}

PathCamera path_camera(const CameraRays& camera, double depth) {
    if (camera.linear) return path_camera(*camera.linear);
    PathCamera of_paths;
    of_paths.affine = true;
    if (camera.model) of_paths.breaks = {camera.model->breaks_x(), camera.model->breaks_y()};
    const auto ray_at = [&camera](const Vec3& screen) {
        return exact_ray(camera, Vec2(screen) / screen.z).value_or(Ray{});
    };
    of_paths.point = [ray_at, depth](const Vec3& screen) {
        const Ray ray = ray_at(screen);
        return ray.origin + depth * normalize_or_zero(ray.direction);
    };
    // As long as the way to the chord's point.
    of_paths.ray = [ray_at](const Vec3& screen, const Vec3& chord) {
        const Ray ray = ray_at(screen);
        return Ray{ray.origin, length(chord - ray.origin) * normalize_or_zero(ray.direction)};
    };
    return of_paths;
}

namespace {

/// What the rays through a screen position start in; unset where all start in air.
std::function<Media(const Vec3&)> media_at(const Frame& frame) {
    if (frame.camera_media.none()) return {};
    return [&frame](const Vec3& screen) {
        if (!frame.camera_media.by_ray) return frame.camera_media.fixed;
        const auto ray = screen.z > 0 ? exact_ray(frame.camera, Vec2(screen) / screen.z) : std::nullopt;
        return ray ? frame.camera_media.of(*ray) : Media();
    };
}

/// How many squares along the film's side do for n facets along a face's: a body shows about three faces.
constexpr int kSquaresPerFacet = 2;

/// The optic's bounds on the film.
FilmWindow film_window(const World& world, const FramedOptic& framed, std::span<const CornerView> views) {
    const Vec2 film(world.scene.film.width, world.scene.film.height);
    FilmWindow window{Vec2(1e300), Vec2(-1e300), framed.resolution};
    if (framed.model) window.n *= kSquaresPerFacet;
    Box box;
    double depth = 0;
    for (const Vec3& point : framed.facets->grid().points) box.include(point);
    for (const CornerView& view : views) {
        const Vec3& s = view.screen;
        depth += length(view.incident) / static_cast<double>(views.size());
        if (s.z > 0) {
            window.low = glm::min(window.low, Vec2(s) / s.z);
            window.high = glm::max(window.high, Vec2(s) / s.z);
        } else {  // it reaches behind the eye
            window.low = Vec2(0);
            window.high = film;
        }
    }
    // A pixel more, for the exact outline stands over the facets' by less than that at useful n.
    window.low = glm::clamp(window.low - 1.0, Vec2(0), film);
    window.high = glm::clamp(window.high + 1.0, Vec2(0), film);
    if (!(window.low.x < window.high.x && window.low.y < window.high.y))
        window.low = Vec2(0), window.high = film;
    const auto middle = views.empty() && framed.model ? framed.model->ray(0.5 * film) : std::nullopt;
    if (middle) depth = length(0.5 * (box.low + box.high) - middle->origin);
    window.depth = depth > 0 ? depth : 1;
    window.reach = length(box.size());
    return window;
}

Vec3 middle_of(const SurfaceGrid& grid) {
    Box box;
    for (const Vec3& point : grid.points) box.include(point);
    return 0.5 * (box.low + box.high);
}

/// The grid that the optic's first paths are of, and how the camera sees its corners.
struct SeenGrid {
    const SurfaceGrid* grid = nullptr;
    std::vector<CornerView> views;
};

SeenGrid seen_grid(const Frame& frame, const FramedOptic& framed) {
    if (framed.film_grid) return {&framed.film_grid->grid, framed.film_grid->views};
    return {&framed.facets->grid(), corner_views(framed.facets->grid(), *frame.camera.linear)};
}

}  // namespace

PathBuilder make_optic_paths(const World& world, const Frame& frame, std::size_t optic,
                             const NestedOptics* nested, const PathWorld* followed) {
    const FramedOptic& framed = frame.optics[optic];
    const bool for_error = frame.max_error > 0 && frame.max_error != kAnyError;
    const SeenGrid seen = seen_grid(frame, framed);
    ProbeContext context{followed ? followed : &path_world(world),
                         static_cast<Id>(optic),
                         world.optics[optic].surface.get(),
                         {}};
    const Vec2 film(world.scene.film.width, world.scene.film.height);
    DivideParams params;
    params.fit = framed.rays == CornerRays::kFitted;
    params.fit_all = frame.fit_all;
    params.objects = &object_tracer(world);
    params.estimates = !for_error;
    params.max_error =
        frame.max_error > 0 ? frame.max_error : believable_error(framed.resolution, world.scene.film.height);
    if (for_error) params.most_levels = kMostLevelsForError;
    // Where pixels have many samples a part of a few square pixels has more than its corners' paths are
    // worth.
    const int side = world.scene.film.spp;
    if (frame.facets == FacetUse::kWorthwhile) params.per_pixel = side * side;
    params.least_area = std::min(params.least_area, kLeastSamples / (side * side));
    params.most_levels += static_cast<int>(std::ceil(std::log2(side)));
    if (nested) {
        params.nested_agree = [nested](const Vec2& pixel, Id next) { return nested->agree(pixel, next); };
        params.nested_covers = [nested](Id other, const Vec2& low, const Vec2& high) {
            return nested->may_cover(other, low, high);
        };
    }
    // A camera that is not linear has paths by facets on the film: there its rays are exact.
    if (framed.grid == GridKind::kScreen || framed.model) {
        const FilmWindow window = film_window(world, framed, seen.views);
        context.camera = path_camera(frame.camera, window.depth);
        context.camera.film = film;
        context.camera.around = media_at(frame);
        return paths_over_film(context, window, params);
    }
    context.camera = path_camera(*frame.camera.linear);
    context.camera.film = film;
    context.camera.around = media_at(frame);
    return paths_over_grid(context, *seen.grid, params);
}

std::optional<NestedStage> make_nested_stage(const World& world, const Frame& frame) {
    // Legs that end on a nested optic are drawn to what lies behind it: no measure of a volume.
    if (!frame.camera.linear || frame.camera.linear->parallel || !frame.camera_media.none() ||
        !world.volumes.empty() || world.blended)
        return std::nullopt;
    NestedStage stage;
    stage.world = path_world(world);
    for (std::size_t i = 0; i < world.optics.size(); ++i)
        stage.optics.push_back({world.optics[i].surface.get(), &frame.optics[i].facets->grid(),
                                frame.optics[i].rays == CornerRays::kFitted,
                                has_own_normals(world.scene.meshes[world.optics[i].mesh])});
    stage.camera = path_camera(*frame.camera.linear);
    stage.camera.film = Vec2(world.scene.film.width, world.scene.film.height);
    stage.eye = frame.camera.linear->eye;
    stage.divide.objects = &object_tracer(world);
    return stage;
}

std::unique_ptr<NestedOptics> make_nested_optics(const World& world, const Frame& frame,
                                                 const NestedStage& stage, std::size_t optic) {
    const FramedOptic& framed = frame.optics[optic];
    if (!framed.layered || world.optics.size() < 2 || !reason_for_none(world, frame, optic).empty())
        return nullptr;
    std::vector<Vec3> towards;
    for (const Vec3& point : framed.facets->grid().points) towards.push_back(point - stage.eye);
    auto nested =
        std::make_unique<NestedOptics>(stage, std::vector<Id>{static_cast<Id>(optic)}, std::move(towards));
    nested->set_room(stage.camera.film.x * stage.camera.film.y);
    return nested;
}

PathBuilder make_approximate_paths(const World& world, const Frame& frame, std::size_t optic, Engine engine) {
    const FramedOptic& framed = frame.optics[optic];
    const SeenGrid seen = seen_grid(frame, framed);
    const double ior = relative_ior(world, optic, frame.camera_media.fixed);
    std::vector<PathMesh> meshes;
    for (const PathMesh& path : framed.paths)
        meshes.push_back(engine == Engine::kPlanar
                             ? make_flat_mesh(path.path, *seen.grid, seen.views, ior)
                             : make_environment_mesh(path, middle_of(framed.facets->grid())));
    const auto find = [&](Path path) -> const RayMesh* {
        for (const PathMesh& one : meshes)
            if (one.path == path) return &one.mesh;
        return nullptr;
    };
    ProbeContext context{&path_world(world), static_cast<Id>(optic), world.optics[optic].surface.get(), {}};
    context.camera.around = media_at(frame);
    return first_optic_paths(context,
                             FirstPaths{seen.grid, seen.views, find(Path::kReflect), find(Path::kRefract)});
}

const RayMesh* find_path(const FramedOptic& optic, Path path) {
    for (const PathMesh& one : optic.paths)
        if (one.path == path) return &one.mesh;
    return nullptr;
}

void check_frame(const World& world, const FrameParams& frame) {
    if (frame.camera >= world.scene.cameras.size())
        throw UsageError(fmt::format("there is no camera number {}; the scene has {}", frame.camera,
                                     world.scene.cameras.size()));
    if (frame.resolution < 0 || frame.resolution > kMaxResolution)
        throw UsageError(fmt::format("a resolution of {} is not in 1..{}", frame.resolution, kMaxResolution));
    if (frame.max_error && !(*frame.max_error >= 0 && *frame.max_error <= kMostMaxError))
        throw UsageError(
            fmt::format("an error of {} pixels is not in 0..{}", *frame.max_error, kMostMaxError));
}

namespace {

/// Of what rounding makes of the sums that a position on the screen is.
constexpr double kRounding = 1e-14;

/// How far off a screen position of a point may be, in pixels, and a pixel more.
double room_around(const LinearCamera& camera, const Vec3& point, double w) {
    const Vec4 sizes(glm::abs(point), 1);
    const double terms =
        std::max(dot(glm::abs(camera.screen_x), sizes), dot(glm::abs(camera.screen_y), sizes));
    return 1 + kRounding * terms / w;
}

}  // namespace

SampleGrid optic_window(const FramedOptic& optic, const CameraRays& camera) {
    const Vec2 film(camera.film.width, camera.film.height);
    const SampleGrid all{0, 0, static_cast<int>(film.x), static_cast<int>(film.y), 1};
    if (!camera.linear) return all;
    Vec2 low = film, high(0);
    for (const Vec3& point : optic.facets->grid().points) {
        const Vec3 s = screen_from_world(*camera.linear, point);
        if (!(s.z > 0)) return all;
        const double room = room_around(*camera.linear, point, s.z);
        const Vec2 at = Vec2(s) / s.z;
        if (!std::isfinite(at.x + at.y + room)) return all;
        low = glm::min(low, at - room);
        high = glm::max(high, at + room);
    }
    low = glm::clamp(glm::floor(low), Vec2(0), film);
    high = glm::clamp(glm::ceil(high), low, film);
    return {static_cast<int>(low.x), static_cast<int>(low.y), static_cast<int>(high.x),
            static_cast<int>(high.y), 1};
}

SampleGrid part_in(const SampleGrid& grid, const SampleGrid& window) {
    SampleGrid part = grid;
    if (!grid.chosen.empty()) return part;
    part.x0 = std::clamp(window.x0, grid.x0, grid.x1);
    part.y0 = std::clamp(window.y0, grid.y0, grid.y1);
    part.x1 = std::clamp(window.x1, part.x0, grid.x1);
    part.y1 = std::clamp(window.y1, part.y0, grid.y1);
    return part;
}

}  // namespace trilens
