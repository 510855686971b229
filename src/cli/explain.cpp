#include "cli/explain.h"

#include "base/error.h"

namespace trilens {
namespace {

Json vector_json(const Vec3& v) {
    return {json_number(v.x), json_number(v.y), json_number(v.z)};
}

Json ray_json(const Ray& ray) {
    return {{"origin", vector_json(ray.origin)}, {"direction", vector_json(ray.direction)}};
}

Json hit_json(const World& world, const Hit& hit) {
    if (!hit.seen()) return nullptr;
    const Id object = world.objects.object[hit.triangle];
    return {{"object", object},
            {"name", world.names[object]},
            {"primitive", world.objects.primitive[hit.triangle]},
            {"t", json_number(hit.t)},
            {"barycentric", {json_number(hit.barycentric.x), json_number(hit.barycentric.y)}},
            {"position", vector_json(position(world.objects, hit))}};
}

Json secondary_json(const World& world, const SecondaryView& view) {
    if (!view.has_ray) return nullptr;
    return {{"ray", ray_json(view.ray)}, {"sees", hit_json(world, view.hit)}};
}

}  // namespace

Json explain_pixel(const World& world, const PictureRequest& request, int x, int y, Console& console) {
    const Film& film = world.scene.film;
    if (x < 0 || y < 0 || x >= film.width || y >= film.height)
        throw UsageError("--pixel " + std::to_string(x) + "," + std::to_string(y) + " is outside the " +
                         std::to_string(film.width) + " x " + std::to_string(film.height) + " film");
    const Viewer viewer = make_viewer(world, request.camera, request.engine, console.warner());
    std::vector<SampleView> views(1);
    viewer({x, y, x + 1, y + 1, 1}, views);

    const SampleView& view = views[0];
    const SampleColour colour = shade_view(world, view);
    Json fields;
    fields["pixel"] = {x, y};
    fields["engine"] = engine_name(request.engine.engine);
    fields["ray"] = ray_json(view.ray);
    fields["depth"] = json_number(view.depth);
    fields["sees"] = hit_json(world, view.hit);
    if (view.optic != kNone) {
        const Optic& optic = world.optics[view.optic];
        fields["optic"] = {{"object", optic.mesh},
                           {"name", world.names[optic.mesh]},
                           {"facet", view.facet},
                           {"uv", {json_number(view.uv.x), json_number(view.uv.y)}},
                           {"cos_incident", json_number(view.cos_incident)},
                           {"front", view.front}};
        fields["reflect"] = secondary_json(world, view.reflect);
        fields["refract"] = secondary_json(world, view.refract);
    }
    fields["colour"] = {{"direct", vector_json(colour.direct)},
                        {"reflect", vector_json(colour.reflect)},
                        {"refract", vector_json(colour.refract)}};
    return fields;
}

}  // namespace trilens
