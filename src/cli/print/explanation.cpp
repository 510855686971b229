#include "cli/print/explanation.h"

#include "cli/print/values.h"

namespace trilens {
namespace {

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

Json kind_json(const std::optional<GeneralLinearKind>& kind) {
    return kind ? Json(general_linear_kind_name(*kind)) : Json(nullptr);
}

Json end_json(const Renderer& renderer, const PixelExplanation& pixel, const PathEnd* end) {
    if (!end) return nullptr;
    const SampleViews& views = pixel.views;
    return {{"path", steps_json(renderer, views.steps_of(*end))},
            {"weight", vector_json(end->weight)},
            {"ray", ray_json(end->ray)},
            {"facet_kind", kind_json(pixel.end_kinds[static_cast<std::size_t>(end - views.ends.data())])},
            {"sees", hit_json(renderer, end->hit)}};
}

}  // namespace

Json explanation_json(const Renderer& renderer, const EngineChoice& engine, const PixelExplanation& pixel) {
    const SampleView& view = pixel.view();
    Json fields;
    fields["pixel"] = {pixel.x, pixel.y};
    fields["engine"] = engine_name(engine.engine);
    if (pixel.camera_facet != kNone)
        fields["camera"] = {{"facet", pixel.camera_facet}, {"facet_kind", kind_json(pixel.camera_kind)}};
    fields["ray"] = ray_json(view.ray);
    fields["depth"] = json_number(view.depth);
    fields["sees"] = hit_json(renderer, view.hit);
    if (view.optic != kNone) {
        const OpticInfo optic = renderer.optics()[view.optic];
        const OpticView& on_optic = pixel.views.on_optic(view);
        fields["optic"] = {{"object", optic.object},
                           {"name", optic.name},
                           {"facet", view.facet},
                           {"uv", {json_number(on_optic.uv.x), json_number(on_optic.uv.y)}},
                           {"cos_incident", json_number(on_optic.incidence.cosine)},
                           {"front", on_optic.incidence.front}};
        for (const Path path : {Path::kReflect, Path::kRefract})
            fields[path_name(path)] = end_json(renderer, pixel, pixel.views.find(view, path));
        fields["ends"] = Json::array();
        for (const PathEnd& end : pixel.views.ends_of(view))
            fields["ends"].push_back(end_json(renderer, pixel, &end));
        fields["method"] = view.traced ? "traced" : view.level > 0 ? "subdivided" : "projected";
        fields["level"] = view.level;
    }
    fields["colour"] = {{"direct", vector_json(pixel.colour.direct)},
                        {"reflect", vector_json(pixel.colour.reflect)},
                        {"refract", vector_json(pixel.colour.refract)}};
    return fields;
}

}  // namespace trilens
