#include "inverse/maps/caustic_map.h"

#include <cmath>

#include "base/util/error.h"
#include "base/util/parallel.h"
#include "caustics/flux_ends.h"
#include "render/world/world.h"
#include "shade/shade.h"

namespace trilens {
namespace {

/// Of the job: while beams are made, and gathered where the object is flat.
constexpr double kBeamsShare = 0.3, kGatheringShare = 0.3;

/// The light of a pixel, and the area of the object in it; none where the object is not.
struct CausticPixel {
    double area = 0;
    Vec3 flux{0};

    bool covered() const { return area > 0; }
    Vec3 irradiance() const { return covered() ? flux / area : Vec3(0); }
};

TriangleScene triangles_of(const FlatRectangle& rectangle) {
    TriangleScene scene;
    const Vec3& o = rectangle.origin;
    scene.points = {o, o + rectangle.u, o + rectangle.u + rectangle.v, o + rectangle.v};
    scene.triangles = {{0, 1, 2}, {0, 2, 3}};
    scene.object = {0, 0};
    scene.primitive = {0, 1};
    return scene;
}

struct PixelParams {
    double lift = 0;  // of shadow rays, off the surface
    const std::atomic<bool>* cancel = nullptr;
};

CausticPixel pixel_at(const std::vector<std::unique_ptr<BeamLight>>& lights, const Target& target,
                      const Vec2& pixel, const CausticMapRequest& request, const PixelParams& params) {
    CausticPixel found;
    for (const TargetPiece& piece : target.pieces(pixel)) {
        const TargetPlace& place = piece.at_middle;
        const Vec3 normal = request.back ? -piece.normal : piece.normal;
        Receiver receiver{place.at, normal, normal, place.at + params.lift * normal, {place.dx, place.dy}};
        receiver.keeps_sides = true;
        if (target.rectangle())
            receiver.triangle = 0;
        else
            receiver.outline = piece.outline;
        receiver.exact = request.exact;
        receiver.cancel = params.cancel;
        const double area = piece.share * length(cross(place.dx, place.dy));
        found.area += area;
        found.flux += area * irradiance(lights, receiver);
    }
    return found;
}

}  // namespace

CausticMap make_caustic_map(const World& world, const CausticMapRequest& request, const Progress& progress) {
    if (request.light >= world.scene.lights.size())
        throw UsageError("the scene has no light " + std::to_string(request.light) + " but " +
                         std::to_string(world.scene.lights.size()) + ", counted from 0");
    if (has_directions(request.target.kind))
        throw UsageError("light falls onto a plane or an object, not onto directions");
    const Target target(request.target, world.scene);
    const PathWorld optics = optics_for_lights(world);
    const BeamGridParams params =
        request.exact ? BeamGridParams::truth(request.tolerance) : BeamGridParams::within(request.tolerance);
    const std::vector<std::unique_ptr<BeamLight>> lights =
        make_beam_lights(world, optics, request.light, params, progress.part(0, kBeamsShare));
    if (target.rectangle()) {
        const auto faces = std::make_shared<ReceiverFaces>(triangles_of(*target.rectangle()));
        for (const auto& light : lights) light->receive_on(faces);
        std::vector<const BeamLight*> all;
        for (const auto& light : lights) all.push_back(light.get());
        const ReceiverSide side{0, request.back};
        if (!request.exact) gather_light(all, {&side, 1}, progress.part(kBeamsShare, kGatheringShare));
    }
    progress.begin_stage("");
    const double prepared = kBeamsShare + kGatheringShare;
    const Progress drawing = progress.part(prepared, 1 - prepared);

    CausticMap map;
    map.width = request.target.width, map.height = request.target.height;
    const auto width = static_cast<std::size_t>(map.width), height = static_cast<std::size_t>(map.height);
    map.irradiance.resize(width * height);
    map.covered.resize(width * height);
    std::vector<Vec3> row_flux(height, Vec3(0));
    LoopProgress drawn(drawing, static_cast<double>(height));
    parallel_for(height, 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t y = from; y < to; ++y) {
            for (std::size_t x = 0; x < width; ++x) {
                const CausticPixel pixel =
                    pixel_at(lights, target, Vec2(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5),
                             request, {kShadowOffset * world.shading.size, progress.cancel});
                map.irradiance[y * width + x] = pixel.irradiance();
                map.covered[y * width + x] = pixel.covered();
                row_flux[y] += pixel.flux;
            }
            drawn.add(1);
        }
    });
    for (const Vec3& flux : row_flux) map.flux_received += flux;
    for (const auto& light : lights) {
        const Beams& beams = light->beams();
        map.flux_in += beams.flux_arriving();
        const FluxEnds ends = light->flux_ends(world.objects);
        map.flux_on_objects += ends.on_objects;
        map.flux_away += ends.away;
        map.beams += beams.beams.size();
        map.histories += beams.histories.size();
        map.coarse += light->losses().coarse;
    }
    map.warnings = lost_light(world, request.light, lights);
    if (map.flux_in == Vec3(0))
        map.warnings.push_back("no light of light " + std::to_string(request.light) +
                               " comes to an optic: the map is dark");
    if (map.coarse > 0)
        map.warnings.push_back(std::to_string(map.coarse) +
                               " parts of the light's film are coarser than the tolerance asks");
    if (target.shares_coordinates())
        map.warnings.push_back("faces of \"" + world.scene.meshes[request.target.object].name +
                               "\" share texture coordinates: the map shows the light of one of them");
    progress(1);
    return map;
}

Image image_of(const CausticMap& map) {
    Image image;
    image.width = image.data_width = map.width;
    image.height = image.data_height = map.height;
    for (int k = 0; k < 3; ++k) {
        std::vector<float> values(map.irradiance.size());
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(map.irradiance[i][k]);
        image.channels.push_back({std::string(1, "RGB"[k]), std::move(values)});
    }
    std::vector<float> covered(map.covered.begin(), map.covered.end());
    image.channels.push_back({"A", std::move(covered)});
    return image;
}

}  // namespace trilens
