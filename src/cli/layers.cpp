#include "cli/layers.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "refract/snell.h"

namespace trilens {
namespace {

/// Samples that are held at once; bounds the memory of a frame.
constexpr std::size_t kBandSamples = 1u << 18;

/// Depth of a pixel that sees nothing.
constexpr float kFarDepth = 1e30f;

struct OpticWeights {
    Vec3 reflect{0}, refract{0};
};

/// How much of the light of each path the optic passes on.
OpticWeights optic_weights(const World& world, const Optic& optic, const SampleView& view) {
    const Material& material = world.scene.materials[optic.material];
    const bool fresnel = world.scene.render.fresnel;
    OpticWeights weights;
    if (optic.mirror) {
        weights.reflect = fresnel ? metal_reflectance(material.base_color_factor, view.cos_incident)
                                  : material.base_color_factor;
        return weights;
    }
    const double eta = view.front ? 1 / material.ior : material.ior;
    const double reflectance = fresnel ? fresnel_reflectance(view.cos_incident, eta) : 0;
    weights.reflect = Vec3(reflectance);
    weights.refract = (1 - reflectance) * material.base_color_factor;
    return weights;
}

/// Distance from the optic to what is seen, along the secondary ray.
double path_length(const SecondaryView& secondary) {
    return secondary.hit.t * length(secondary.ray.direction);
}

Vec3 refracted_light(const World& world, const Optic& optic, const SampleView& view) {
    const Vec3 light = shade_ray(world.shading, view.refract.hit, view.refract.ray);
    // Entering the body, the light has come through the medium; leaving it, through air.
    if (!view.front || !view.refract.hit.seen()) return light;
    return light * volume_transmittance(world.scene.materials[optic.material], path_length(view.refract));
}

/// The channels of one window, by the places they hold.
struct Canvas {
    Image image;
    std::vector<float>* add_float(const std::string& name) { return &add<float>(name); }
    std::vector<Id>* add_id(const std::string& name) { return &add<Id>(name); }

    template <typename T>
    std::vector<T>& add(const std::string& name) {
        image.channels.push_back({name, std::vector<T>(image.pixels())});
        return std::get<std::vector<T>>(image.channels.back().values);
    }
};

struct SecondaryChannels {
    std::vector<Id>*object = nullptr, *primitive = nullptr;
    std::vector<float>*x = nullptr, *y = nullptr, *z = nullptr, *length = nullptr;
};

struct Channels {
    std::vector<float>* rgba[4] = {};
    std::vector<float>* parts[3][3] = {};  // direct, reflect, refract
    std::vector<float>* depth = nullptr;
    std::vector<Id>*optic_object = nullptr, *optic_facet = nullptr;
    std::vector<float>*optic_u = nullptr, *optic_v = nullptr;
    SecondaryChannels reflect, refract;
};

bool wanted(const LayerRequest& request, const std::string& layer) {
    return request.aovs.empty() ||
           std::find(request.aovs.begin(), request.aovs.end(), layer) != request.aovs.end();
}

SecondaryChannels add_secondary(Canvas& canvas, const std::string& layer) {
    SecondaryChannels channels;
    channels.object = canvas.add_id(layer + ".object");
    channels.primitive = canvas.add_id(layer + ".primitive");
    channels.x = canvas.add_float(layer + ".X");
    channels.y = canvas.add_float(layer + ".Y");
    channels.z = canvas.add_float(layer + ".Z");
    channels.length = canvas.add_float(layer + ".length");
    return channels;
}

Channels add_channels(Canvas& canvas, const LayerRequest& request) {
    canvas.image.channels.reserve(32);  // the pointers below must stay
    Channels channels;
    const char* colours[4] = {"R", "G", "B", "A"};
    for (int c = 0; c < 4; ++c) channels.rgba[c] = canvas.add_float(colours[c]);
    if (wanted(request, "Z")) channels.depth = canvas.add_float("Z");
    if (wanted(request, "optic")) {
        channels.optic_object = canvas.add_id("optic.object");
        channels.optic_facet = canvas.add_id("optic.facet");
        channels.optic_u = canvas.add_float("optic.U");
        channels.optic_v = canvas.add_float("optic.V");
    }
    const char* layers[3] = {"direct", "reflect", "refract"};
    for (int layer = 0; layer < 3; ++layer) {
        if (!wanted(request, layers[layer])) continue;
        for (int c = 0; c < 3; ++c)
            channels.parts[layer][c] = canvas.add_float(std::string(layers[layer]) + "." + colours[c]);
    }
    if (wanted(request, "reflect")) channels.reflect = add_secondary(canvas, "reflect");
    if (wanted(request, "refract")) channels.refract = add_secondary(canvas, "refract");
    return channels;
}

void put_secondary(const World& world, const SecondaryView& view, const SecondaryChannels& channels,
                   std::size_t pixel) {
    if (!channels.object) return;
    const bool seen = view.has_ray && view.hit.seen();
    const Vec3 point = seen ? position(world.objects, view.hit) : Vec3(0);
    (*channels.object)[pixel] = seen ? world.objects.object[view.hit.triangle] : kNone;
    (*channels.primitive)[pixel] = seen ? world.objects.primitive[view.hit.triangle] : kNone;
    (*channels.x)[pixel] = static_cast<float>(point.x);
    (*channels.y)[pixel] = static_cast<float>(point.y);
    (*channels.z)[pixel] = static_cast<float>(point.z);
    (*channels.length)[pixel] = seen ? static_cast<float>(path_length(view)) : 0.0f;
}

void put_centre(const World& world, const SampleView& view, const Channels& channels, std::size_t pixel) {
    if (channels.depth) {
        const bool nothing = !view.hit.seen() && view.optic == kNone;
        (*channels.depth)[pixel] = nothing ? kFarDepth : static_cast<float>(view.depth);
    }
    if (channels.optic_object) {
        const bool optic = view.optic != kNone;
        (*channels.optic_object)[pixel] = optic ? world.optics[view.optic].mesh : kNone;
        (*channels.optic_facet)[pixel] = optic ? view.facet : kNone;
        (*channels.optic_u)[pixel] = static_cast<float>(view.uv.x);
        (*channels.optic_v)[pixel] = static_cast<float>(view.uv.y);
    }
    put_secondary(world, view.reflect, channels.reflect, pixel);
    put_secondary(world, view.refract, channels.refract, pixel);
}

void put_colour(const SampleColour& mean, const Channels& channels, std::size_t pixel) {
    const Vec3 beauty = mean.direct + mean.reflect + mean.refract;
    const Vec3* parts[3] = {&mean.direct, &mean.reflect, &mean.refract};
    for (int c = 0; c < 3; ++c) {
        if (!std::isfinite(beauty[c])) throw ComputationError("a pixel's colour is not finite");
        (*channels.rgba[c])[pixel] = static_cast<float>(beauty[c]);
        for (int layer = 0; layer < 3; ++layer)
            if (channels.parts[layer][c])
                (*channels.parts[layer][c])[pixel] = static_cast<float>((*parts[layer])[c]);
    }
    (*channels.rgba[3])[pixel] = static_cast<float>(mean.coverage);
}

/// Whether a path that the scene asks for has no ray at this sample.
bool lacks_ray(const World& world, const SampleView& view) {
    if (view.optic == kNone) return false;
    const Optic& optic = world.optics[view.optic];
    if (world.scene.render.reflect && !view.reflect.has_ray && optic.mirror) return true;
    const double eta = view.front ? 1 / world.scene.materials[optic.material].ior
                                  : world.scene.materials[optic.material].ior;
    const bool total = fresnel_reflectance(view.cos_incident, eta) >= 1;
    return !optic.mirror && world.scene.render.refract && !view.refract.has_ray && !total;
}

struct Band {
    SampleGrid colours, centres;
};

SampleColour mean_colour(const World& world, std::span<const SampleView> samples) {
    SampleColour sum;
    for (const SampleView& view : samples) {
        const SampleColour one = shade_view(world, view);
        sum.direct += one.direct;
        sum.reflect += one.reflect;
        sum.refract += one.refract;
        sum.coverage += one.coverage;
    }
    const double share = 1.0 / static_cast<double>(samples.size());
    return {share * sum.direct, share * sum.reflect, share * sum.refract, share * sum.coverage};
}

}  // namespace

SampleColour shade_view(const World& world, const SampleView& view) {
    const RenderSettings& settings = world.scene.render;
    SampleColour colour;
    colour.coverage = view.hit.seen() || view.optic != kNone ? 1 : 0;
    if (view.optic == kNone) {
        if (settings.direct) colour.direct = shade_ray(world.shading, view.hit, view.ray);
        return colour;
    }
    const Optic& optic = world.optics[view.optic];
    const OpticWeights weights = optic_weights(world, optic, view);
    if (settings.reflect && view.reflect.has_ray && weights.reflect != Vec3(0))
        colour.reflect = weights.reflect * shade_ray(world.shading, view.reflect.hit, view.reflect.ray);
    if (settings.refract && view.refract.has_ray && weights.refract != Vec3(0))
        colour.refract = weights.refract * refracted_light(world, optic, view);
    return colour;
}

Image draw_layers(const World& world, const Viewer& viewer, const LayerRequest& request,
                  const Progress& progress, LayerStatistics* statistics) {
    Canvas canvas;
    canvas.image.width = world.scene.film.width;
    canvas.image.height = world.scene.film.height;
    canvas.image.x0 = request.x0;
    canvas.image.y0 = request.y0;
    canvas.image.data_width = request.x1 - request.x0;
    canvas.image.data_height = request.y1 - request.y0;
    const Channels channels = add_channels(canvas, request);

    const int side = world.scene.film.spp;
    const std::size_t samples_per_row =
        static_cast<std::size_t>(canvas.image.data_width) * static_cast<std::size_t>(side * side);
    const int rows = static_cast<int>(std::max<std::size_t>(1, kBandSamples / samples_per_row));
    LayerStatistics counts;
    std::vector<SampleView> views, centres;
    for (int y = request.y0; y < request.y1; y += rows) {
        if (progress.cancelled()) throw Interrupted();
        SampleGrid grid{request.x0, y, request.x1, std::min(y + rows, request.y1), side};
        views.assign(grid.size(), {});
        viewer(grid, views);

        // With one sample a pixel its centre is that sample; otherwise the centres are looked at once more.
        const SampleGrid centre_grid{grid.x0, grid.y0, grid.x1, grid.y1, 1};
        if (side > 1) {
            centres.assign(centre_grid.size(), {});
            viewer(centre_grid, centres);
        }
        const std::vector<SampleView>& middle = side > 1 ? centres : views;
        const std::size_t first =
            static_cast<std::size_t>(y - request.y0) * static_cast<std::size_t>(grid.width());
        const std::size_t per_pixel = static_cast<std::size_t>(side * side);
        parallel_for(grid.pixels(), 256, [&](std::size_t from, std::size_t to) {
            for (std::size_t p = from; p < to; ++p) {
                put_colour(mean_colour(world, {&views[p * per_pixel], per_pixel}), channels, first + p);
                put_centre(world, middle[p], channels, first + p);
            }
        });
        for (const SampleView& view : middle) {
            counts.optic_pixels += view.optic != kNone;
            counts.pixels_without_ray += lacks_ray(world, view);
        }
        progress(static_cast<double>(grid.y1 - request.y0) / canvas.image.data_height);
    }
    if (statistics) *statistics = counts;
    return std::move(canvas.image);
}

}  // namespace trilens
