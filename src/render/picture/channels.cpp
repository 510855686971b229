#include "render/picture/channels.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/util/error.h"
#include "base/util/parallel.h"

namespace trilens {

namespace {

/// Depth of a pixel that sees nothing.
constexpr float kFarDepth = 1e30f;

constexpr std::array kPaths{Path::kDirect, Path::kReflect, Path::kRefract};
constexpr std::array kColours{"R", "G", "B", "A"};
constexpr std::array kAxes{"X", "Y", "Z"};

}  // namespace

namespace {

/// Meetings with optics on the way: of the refracted path, or the reflected where there is none.
Id count_steps(const SampleViews& views, const SampleView& view) {
    const PathEnd* end = views.find(view, Path::kRefract);
    if (!end) end = views.find(view, Path::kReflect);
    if (!end) return view.optic == kNone ? 0 : 1;
    return static_cast<Id>(std::count_if(views.steps_of(*end).begin(), views.steps_of(*end).end(),
                                         [](const Step& step) { return step.event != Event::kPass; }));
}

/// The least float that is no less.
float round_up(double value) {
    const float nearest = static_cast<float>(value);
    return nearest < value ? std::nextafter(nearest, std::numeric_limits<float>::infinity()) : nearest;
}

/// What the camera sees itself.
PathEnd direct_end(const SampleView& view) {
    PathEnd end;
    end.path = Path::kDirect;
    end.ray = view.ray;
    end.hit = view.hit;
    return end;
}

}  // namespace

const std::vector<std::string>& layer_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all{"Z", "optic"};
        for (const Path path : kPaths) all.push_back(path_name(path));
        all.push_back("path");
        all.push_back("stat");
        all.push_back("magnification");
        all.push_back("position");
        all.push_back("ray");
        all.push_back("bound");
        all.push_back("coverage");
        return all;
    }();
    return names;
}

std::size_t Canvas::add_floats(const std::string& name) {
    image_.channels.push_back({name, std::vector<float>()});
    return image_.channels.size() - 1;
}

std::size_t Canvas::add_ids(const std::string& name) {
    image_.channels.push_back({name, std::vector<Id>()});
    return image_.channels.size() - 1;
}

Canvas::Canvas(Image image, const std::vector<std::string>& layers) : image_(std::move(image)) {
    const auto wanted = [&](const std::string& layer) {
        if (layers.empty())
            return layer != "path" && layer != "stat" && layer != "magnification" && layer != "position" &&
                   layer != "ray" && layer != "bound" && layer != "coverage";
        return std::find(layers.begin(), layers.end(), layer) != layers.end();
    };
    for (std::size_t c = 0; c < 4; ++c) rgba_[c] = add_floats(kColours[c]);
    if (wanted("Z")) depth_ = add_floats("Z");
    if (wanted("optic")) {
        optic_object_ = add_ids("optic.object");
        optic_facet_ = add_ids("optic.facet");
        optic_u_ = add_floats("optic.U");
        optic_v_ = add_floats("optic.V");
    }
    for (std::size_t p = 0; p < kPaths.size(); ++p) {
        const std::string layer = path_name(kPaths[p]);
        parts_[p].fill(kNone);
        if (!wanted(layer)) continue;
        for (std::size_t c = 0; c < 3; ++c) parts_[p][c] = add_floats(layer + "." + kColours[c]);
    }
    for (const Path path : kPaths) {
        const std::string layer = path_name(path);
        if (!wanted(path == Path::kDirect ? "position" : layer)) continue;
        EndChannels end{path};
        end.object = add_ids(layer + "ID.object");
        end.primitive = add_ids(layer + "ID.primitive");
        end.x = add_floats(layer + "P.X");
        end.y = add_floats(layer + "P.Y");
        end.z = add_floats(layer + "P.Z");
        end.length = add_floats(layer + "P.length");
        if (path != Path::kDirect && wanted("magnification")) end.area = add_floats(layer + "M.area");
        if (path != Path::kDirect && wanted("ray"))
            for (std::size_t k = 0; k < 3; ++k) {
                end.direction[k] = add_floats(layer + "D." + kAxes[k]);
                end.origin[k] = add_floats(layer + "O." + kAxes[k]);
            }
        ends_.push_back(end);
    }
    if (wanted("path")) path_count_ = add_ids("path.count");
    if (wanted("bound")) bound_ = add_floats("bound");
    if (wanted("coverage")) {
        covered_object_ = add_ids("coverage.object");
        covered_least_ = add_floats("coverage.min");
        covered_most_ = add_floats("coverage.max");
    }
    if (wanted("stat")) {
        method_ = add_ids("stat.method");
        level_ = add_ids("stat.level");
        fragments_ = add_ids("stat.fragments");
    }
    parallel_for(image_.channels.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t c = first; c < last; ++c)
            std::visit([&](auto& values) { values.resize(image_.pixels()); }, image_.channels[c].values);
    });
}

Image Canvas::layout() const {
    Image layout;
    layout.width = image_.width;
    layout.height = image_.height;
    layout.x0 = image_.x0;
    layout.y0 = image_.y0;
    layout.data_width = image_.data_width;
    layout.data_height = image_.data_height;
    for (const Channel& channel : image_.channels) {
        layout.channels.push_back({channel.name, {}});
        if (channel.is_id()) layout.channels.back().values = std::vector<Id>();
    }
    return layout;
}

void Canvas::put_colours(std::span<const SampleColour> means, std::size_t first) {
    constexpr std::array kParts{&SampleColour::direct, &SampleColour::reflect, &SampleColour::refract};
    for (int c = 0; c < 3; ++c) {
        const std::size_t k = static_cast<std::size_t>(c);
        float* out = floats(rgba_[k]).data() + first;
        bool finite = true;
        for (const SampleColour& mean : means) {
            *out = static_cast<float>(mean.direct[c] + mean.reflect[c] + mean.refract[c]);
            finite = finite && std::isfinite(*out++);
        }
        if (!finite) throw ComputationError("a pixel's colour is not finite");
        for (std::size_t p = 0; p < kParts.size(); ++p) {
            if (parts_[p][k] == kNone) continue;
            float* part = floats(parts_[p][k]).data() + first;
            for (const SampleColour& mean : means) *part++ = static_cast<float>((mean.*kParts[p])[c]);
        }
    }
    float* coverage = floats(rgba_[3]).data() + first;
    for (const SampleColour& mean : means) *coverage++ = static_cast<float>(mean.coverage);
}

void Canvas::put_coverage(std::span<const Id> shown, std::span<const CoverageBounds> bounds,
                          std::size_t first) {
    std::copy(shown.begin(), shown.end(), ids(covered_object_).begin() + static_cast<std::ptrdiff_t>(first));
    for (std::size_t p = 0; p < bounds.size(); ++p) {
        floats(covered_least_)[first + p] = bounds[p].low;
        floats(covered_most_)[first + p] = bounds[p].high;
    }
}

void Canvas::put_fragment_count(std::size_t count, std::size_t pixel) {
    if (fragments_ != kNone) ids(fragments_)[pixel] = static_cast<Id>(count);
}

void Canvas::put_end(const World& world, const PathEnd* end, const EndChannels& channels, std::size_t pixel) {
    const bool seen = end && end->hit.seen();
    // Where the path ends in the environment, its direction stands in the place of the point.
    const Vec3 point = seen  ? position(world.objects, end->hit)
                       : end ? normalize_or_zero(end->ray.direction)
                             : Vec3(0);
    ids(channels.object)[pixel] = seen ? world.objects.object[end->hit.triangle] : kNone;
    ids(channels.primitive)[pixel] = seen ? world.objects.primitive[end->hit.triangle] : kNone;
    floats(channels.x)[pixel] = static_cast<float>(point.x);
    floats(channels.y)[pixel] = static_cast<float>(point.y);
    floats(channels.z)[pixel] = static_cast<float>(point.z);
    if (channels.area != kNone)
        floats(channels.area)[pixel] = end ? static_cast<float>(end->magnification) : 0;
    const Ray last = end ? Ray{end->ray.origin, normalize_or_zero(end->ray.direction)} : Ray{};
    for (std::size_t k = 0; k < 3 && channels.direction[k] != kNone; ++k) {
        floats(channels.direction[k])[pixel] = static_cast<float>(last.direction[static_cast<int>(k)]);
        floats(channels.origin[k])[pixel] = static_cast<float>(last.origin[static_cast<int>(k)]);
    }
    floats(channels.length)[pixel] = seen ? static_cast<float>(path_length(*end)) : 0.0f;
}

void Canvas::put_centre(const World& world, const SampleViews& views, const SampleView& view,
                        std::size_t pixel) {
    const bool optic = view.optic != kNone;
    if (depth_ != kNone)
        floats(depth_)[pixel] =
            view.hit.seen() || optic ? static_cast<float>(views.scene_depth(view)) : kFarDepth;
    if (optic_object_ != kNone) {
        ids(optic_object_)[pixel] = optic ? world.optics[view.optic].mesh : kNone;
        ids(optic_facet_)[pixel] = optic ? view.facet : kNone;
        const Vec2 uv = optic ? views.on_optic(view).uv : Vec2(0);
        floats(optic_u_)[pixel] = static_cast<float>(uv.x);
        floats(optic_v_)[pixel] = static_cast<float>(uv.y);
    }
    if (path_count_ != kNone) ids(path_count_)[pixel] = count_steps(views, view);
    if (bound_ != kNone) floats(bound_)[pixel] = optic ? round_up(views.on_optic(view).bound) : 0.0f;
    if (method_ != kNone) {
        ids(method_)[pixel] = view.traced ? 2 : view.level > 0 ? 1 : 0;
        ids(level_)[pixel] = view.level;
    }
    for (const EndChannels& channels : ends_) {
        const PathEnd own = direct_end(view);
        put_end(world,
                channels.path != Path::kDirect ? views.find(view, channels.path)
                : optic                        ? nullptr
                                               : &own,
                channels, pixel);
    }
}

namespace {

double mitchell(double x) {
    if (x < 1) return (7 * x * x * x - 12 * x * x + 16.0 / 3) / 6;
    if (x < 2) return (-7.0 / 3 * x * x * x + 12 * x * x - 20 * x + 32.0 / 3) / 6;
    return 0;
}

double gaussian(double x) {
    constexpr double kReach = 1.5, kDeviation = 0.5;
    const auto bell = [](double at) { return std::exp(-at * at / (2 * kDeviation * kDeviation)); };
    return x < kReach ? bell(x) - bell(kReach) : 0;
}

}  // namespace

SampleColour PixelFilter::averaged(const SampleColour& sample) const {
    if (!shown) return sample;
    const Vec3 light = sample.direct + sample.reflect + sample.refract, wanted = shown(light);
    SampleColour result = sample;
    for (int c = 0; c < 3; ++c) {
        const double share = light[c] > 0 ? wanted[c] / light[c] : 0;
        result.direct[c] *= share;
        result.reflect[c] *= share;
        result.refract[c] *= share;
    }
    return result;
}

PixelFilter make_pixel_filter(FilterKind kind, int side) {
    PixelFilter filter;
    filter.reach = kind == FilterKind::kBox ? 0 : kind == FilterKind::kGaussian ? 1 : 2;
    for (int pixel = -filter.reach; pixel <= filter.reach; ++pixel)
        for (int i = 0; i < side; ++i) {
            const double off = std::fabs(pixel + (i + 0.5) / side - 0.5);
            filter.weights.push_back(kind == FilterKind::kBox        ? 1
                                     : kind == FilterKind::kMitchell ? mitchell(off)
                                                                     : gaussian(off));
        }
    return filter;
}

}  // namespace trilens
