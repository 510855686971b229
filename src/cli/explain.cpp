#include "cli/explain.h"

namespace trilens {
namespace {

Json vector_json(const Vec3& v) {
    return {json_number(v.x), json_number(v.y), json_number(v.z)};
}

Json ray_json(const Ray& ray) {
    return {{"origin", vector_json(ray.origin)}, {"direction", vector_json(ray.direction)}};
}

Json hit_json(const Renderer& renderer, const Hit& hit) {
    if (!hit.seen()) return nullptr;
    const SeenTriangle seen = renderer.seen_triangle(hit);
    return {{"object", seen.object},
            {"name", renderer.scene().meshes[seen.object].name},
            {"primitive", seen.primitive},
            {"t", json_number(hit.t)},
            {"barycentric", {json_number(hit.barycentric.x), json_number(hit.barycentric.y)}},
            {"position", vector_json(seen.position)}};
}

/// The meetings with optics on the way, in their order.
Json steps_json(const Renderer& renderer, std::span<const Step> steps) {
    Json list = Json::array();
    for (const Step& step : steps)
        list.push_back({{"optic", renderer.optics()[step.optic].name}, {"event", event_name(step.event)}});
    return list;
}

Json end_json(const Renderer& renderer, const SampleViews& views, const PathEnd* end) {
    if (!end) return nullptr;
    return {{"path", steps_json(renderer, views.steps_of(*end))},
            {"weight", vector_json(end->weight)},
            {"ray", ray_json(end->ray)},
            {"sees", hit_json(renderer, end->hit)}};
}

}  // namespace

Json explanation_json(const Renderer& renderer, const EngineChoice& engine, const PixelExplanation& pixel) {
    const SampleView& view = pixel.view();
    Json fields;
    fields["pixel"] = {pixel.x, pixel.y};
    fields["engine"] = engine_name(engine.engine);
    fields["ray"] = ray_json(view.ray);
    fields["depth"] = json_number(view.depth);
    fields["sees"] = hit_json(renderer, view.hit);
    if (view.optic != kNone) {
        const OpticInfo optic = renderer.optics()[view.optic];
        fields["optic"] = {{"object", optic.object},
                           {"name", optic.name},
                           {"facet", view.facet},
                           {"uv", {json_number(view.uv.x), json_number(view.uv.y)}},
                           {"cos_incident", json_number(view.incidence.cosine)},
                           {"front", view.incidence.front}};
        for (const Path path : {Path::kReflect, Path::kRefract})
            fields[path_name(path)] = end_json(renderer, pixel.views, pixel.views.find(view, path));
        fields["ends"] = Json::array();
        for (const PathEnd& end : pixel.views.ends_of(view))
            fields["ends"].push_back(end_json(renderer, pixel.views, &end));
        fields["method"] = view.traced ? "traced" : view.level > 0 ? "subdivided" : "projected";
        fields["level"] = view.level;
    }
    fields["colour"] = {{"direct", vector_json(pixel.colour.direct)},
                        {"reflect", vector_json(pixel.colour.reflect)},
                        {"refract", vector_json(pixel.colour.refract)}};
    return fields;
}

}  // namespace trilens
