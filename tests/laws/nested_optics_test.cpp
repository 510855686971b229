// Laws of optics seen in mirrors as layers by history: a flat mirror's layer is what a mirrored camera sees,
// outlines and what is seen converge with second order, and neither engines, crops nor threads change it.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/util/parallel.h"
#include "laws/agreement.h"
#include "laws/worlds.h"
#include "paths/trace/follow.h"
#include "render/engines/engine.h"
#include "render/picture/picture.h"
#include "render/frame/image_chain.h"
#include "render/world/world.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// The inside of a cube of half size 6, a mesh per side.
std::string room() {
    const char* const sides[6] = {
        "[[-6,-6,-6],[6,-6,-6],[6,6,-6],[-6,6,-6]]", "[[-6,-6,6],[6,-6,6],[6,6,6],[-6,6,6]]",
        "[[-6,-6,-6],[-6,6,-6],[-6,6,6],[-6,-6,6]]", "[[6,-6,-6],[6,6,-6],[6,6,6],[6,-6,6]]",
        "[[-6,-6,-6],[6,-6,-6],[6,-6,6],[-6,-6,6]]", "[[-6,6,-6],[6,6,-6],[6,6,6],[-6,6,6]]"};
    std::string text;
    for (int i = 0; i < 6; ++i)
        text += R"(,{"name":"side)" + std::to_string(i) + R"(","role":"object","material":"grey","points":)" +
                sides[i] + R"(,"faceVertexCounts":[4],"faceVertexIndices":[0,1,2,3]})";
    return text;
}

std::string nested_scene(int film, const std::string& camera, const std::string& meshes) {
    return R"({"version":1,"film":{"width":)" + std::to_string(film) + R"(,"height":)" +
           std::to_string(film) + R"(},"cameras":[{"yfov":40,"lookAt":)" + camera +
           R"(}],"materials":[{"name":"grey"},{"name":"chrome","metallicFactor":1},{"name":"glass","transmissionFactor":1}],"meshes":[)" +
           meshes + "]}";
}

/// Two mirror balls in a room; the second, seen first, shows the first, which shows it again.
std::unique_ptr<World> two_balls(int n, int film) {
    return world_from(
        "two balls",
        nested_scene(
            film, R"({"eye":[0.7,0.9,4.4],"at":[0.05,0,0]})",
            R"({"name":"a","role":"optic","material":"chrome","primitive":{"type":"sphere","center":[-0.75,0.1,0],"radius":0.8}},
                {"name":"b","role":"optic","material":"chrome","primitive":{"type":"sphere","center":[1,-0.2,0.3],"radius":0.65}})" +
                room()),
        n);
}

FrameParams layered(bool layers, CornerRays rays = CornerRays::kInterpolated) {
    FrameParams frame;
    frame.layered = layers;
    frame.rays = rays;
    return frame;
}

SampleViews views_of(const World& world, const FrameParams& frame, Engine engine) {
    SampleViews views;
    const Film& film = world.scene.film;
    make_viewer(world, frame, engine, ignore)->view({0, 0, film.width, film.height, 1}, views);
    return views;
}

std::vector<Step> steps_of(const SampleViews& views, std::size_t sample) {
    const PathEnd* end = views.find(views.samples[sample], Path::kReflect);
    if (!end) return {};
    const std::span<const Step> steps = views.steps_of(*end);
    return {steps.begin(), steps.end()};
}

/// Samples of which the exact path or the picture goes over two mirrors or more.
struct LayerErrors {
    std::size_t samples = 0, wrong = 0, layered = 0, divided = 0, traced = 0;
    std::size_t measured = 0, no_image = 0;
    double mean = 0, p99 = 0;  // displacement of what is seen, pixels, exact by Fermat's principle
    double mean_of_two = 0;    // the same over two mirrors alone
};

LayerErrors errors_of(const World& world, const FrameParams& params, const SampleViews& truth) {
    const Frame frame = make_frame(world, params, ignore);
    const SampleViews shown = views_of(world, params, Engine::kExact);
    const int width = world.scene.film.width;
    LayerErrors found;
    std::vector<double> shift, of_two;
    for (std::size_t s = 0; s < shown.samples.size(); ++s) {
        const SampleView& view = shown.samples[s];
        if (view.optic == kNone || truth.samples[s].optic != view.optic) continue;
        const std::vector<Step> steps = steps_of(shown, s), exact = steps_of(truth, s);
        if (std::max(steps.size(), exact.size()) < 2) continue;
        ++found.samples;
        found.traced += view.traced;
        found.divided += !view.traced && view.level > 0;
        found.layered += !view.traced && view.nested > 0;
        if (steps != exact) {
            ++found.wrong;
            continue;
        }
        const Hit hit = shown.hit(view, Path::kReflect);
        if (!hit.seen() || view.traced) continue;
        const Vec2 pixel(static_cast<double>(s % static_cast<std::size_t>(width)) + 0.5,
                         static_cast<double>(s / static_cast<std::size_t>(width)) + 0.5);
        const auto image =
            refine_history_image(history_query(world, frame, steps, position(world.objects, hit)), pixel);
        found.no_image += !image;
        if (!image) continue;
        shift.push_back(length(image->pixel - pixel));
        if (steps.size() == 2) of_two.push_back(shift.back());
    }
    found.measured = shift.size();
    if (of_two.empty()) return found;
    for (const double one : of_two) found.mean_of_two += one / static_cast<double>(of_two.size());
    std::sort(shift.begin(), shift.end());
    for (const double one : shift) found.mean += one / static_cast<double>(shift.size());
    found.p99 = shift[static_cast<std::size_t>(0.99 * static_cast<double>(shift.size() - 1))];
    return found;
}

void print(const char* way, int n, const LayerErrors& e) {
    std::printf(
        "%-8s n=%-3d samples %6zu wrong %5zu | layers %5.1f %% divided %5.1f %% traced %5.1f %% | mean %.4f "
        "(two %.4f) p99 %.3f of %zu, no image %zu\n",
        way, n, e.samples, e.wrong, 100.0 * static_cast<double>(e.layered) / static_cast<double>(e.samples),
        100.0 * static_cast<double>(e.divided) / static_cast<double>(e.samples),
        100.0 * static_cast<double>(e.traced) / static_cast<double>(e.samples), e.mean, e.mean_of_two, e.p99,
        e.measured, e.no_image);
    std::fflush(stdout);
}

/// The camera that a flat mirror makes of another: behind the mirror, the film's picture the same.
CameraRays mirrored_camera(CameraRays camera, const SurfacePoint& mirror) {
    const auto point = [&](const Vec3& p) {
        return p - 2 * dot(p - mirror.position, mirror.normal) * mirror.normal;
    };
    const auto direction = [&](const Vec3& d) { return d - 2 * dot(d, mirror.normal) * mirror.normal; };
    LinearCamera& linear = *camera.linear;
    linear.eye = point(linear.eye);
    linear.view_direction = direction(linear.view_direction);
    for (Vec4* row : {&linear.screen_x, &linear.screen_y, &linear.screen_w}) {
        const Vec3 n = direction(Vec3(*row));
        *row = Vec4(n, row->w + dot(Vec3(*row) - n, mirror.position));
    }
    for (Ray& ray : camera.mesh.rays) ray = {point(ray.origin), direction(ray.direction)};
    return camera;
}

/// The whole picture's pixels in the part's window are the part's, in all channels.
void check_same(const Image& whole, const Image& part) {
    REQUIRE(whole.channels.size() == part.channels.size());
    const auto index = [](const Image& image, int x, int y) {
        return static_cast<std::size_t>(y - image.y0) * static_cast<std::size_t>(image.data_width) +
               static_cast<std::size_t>(x - image.x0);
    };
    for (std::size_t c = 0; c < part.channels.size(); ++c) {
        const Channel &a = whole.channels[c], &b = part.channels[c];
        std::size_t other = 0;
        for (int y = part.y0; y < part.y0 + part.data_height; ++y)
            for (int x = part.x0; x < part.x0 + part.data_width; ++x) {
                const std::size_t i = index(whole, x, y), j = index(part, x, y);
                other += a.is_id() ? a.ids()[i] != b.ids()[j] : a.floats()[i] != b.floats()[j];
            }
        INFO(a.name);
        CHECK(other == 0);
    }
}

const std::string kBall =
    R"({"name":"ball","role":"optic","material":"%","primitive":{"type":"sphere","center":[0.3,0.1,0.4],"radius":0.7}})";
const std::string kPlane =
    R"(,{"name":"plane","role":"optic","material":"chrome","primitive":{"type":"plane","center":[-0.4,0.2,-1.5],"normal":[0.35,0.1,1],"size":[5,5]}})";
const std::string kThings =
    R"(,{"name":"floor","role":"object","material":"grey","points":[[-6,-1,6],[6,-1,6],[6,-1,2],[-6,-1,2]],"faceVertexCounts":[4],"faceVertexIndices":[0,1,2,3]}
       ,{"name":"wall","role":"object","material":"grey","points":[[-6,-1,6],[6,-1,6],[6,5,6],[-6,5,6]],"faceVertexCounts":[4],"faceVertexIndices":[0,1,2,3]}
       ,{"name":"post","role":"object","material":"grey","points":[[0.5,-1,-0.55],[0.65,-1,-0.55],[0.65,2,-0.55],[0.5,2,-0.55]],"faceVertexCounts":[4],"faceVertexIndices":[0,1,2,3]})";

std::string with_material(std::string text, const std::string& material) {
    return text.replace(text.find('%'), 1, material);
}

/// What the flat mirror shows of a ball, beside the same ball before a camera behind the mirror: all ends of
/// all samples that see the ball in it.
void check_flat_layer(const std::string& material, int n) {
    const std::string look = R"({"eye":[-2.2,1.1,5],"at":[-0.5,0.1,-1]})",
                      ball = with_material(kBall, material);
    const auto both = world_from("both", nested_scene(240, look, ball + kPlane + kThings), n);
    const auto alone = world_from("alone", nested_scene(240, look, ball + kThings), n);
    const SampleViews in_mirror = views_of(*both, layered(true), Engine::kExact);
    const CameraRays camera =
        mirrored_camera(make_camera_rays(alone->scene, 0), both->optics[1].surface->eval(0, Vec2(0.5)));
    SampleViews direct;
    make_facet_viewer(*alone, make_frame(*alone, camera, layered(true), ignore), Engine::kExact)
        ->view({0, 0, 240, 240, 1}, direct);

    std::size_t compared = 0, other = 0, ball_only_there = 0;
    for (std::size_t s = 0; s < in_mirror.samples.size(); ++s) {
        const SampleView &a = in_mirror.samples[s], &b = direct.samples[s];
        if (a.optic != 1 || a.traced) continue;
        if (a.nested == 0) ball_only_there += b.optic == 0 && a.level == 0;
        // Parts of divided facets have corners of their own: the mirror divides facets through which it is
        // seen.
        if (a.nested != 1 || b.traced || a.level > 0 || b.level > 0) continue;
        const PathEnd* const here = in_mirror.find(a, Path::kReflect);
        const PathEnd* const there = direct.find(b, material == "glass" ? Path::kRefract : Path::kReflect);
        if (!here) continue;
        const std::span<const Step> steps = in_mirror.steps_of(*here);
        // The mirror itself is seen in the ball here, and not there.
        if (std::count(steps.begin(), steps.end(), Step{1, Event::kReflect}) > 1) continue;
        ++compared;
        bool same = there && here->hit.triangle == there->hit.triangle &&
                    length(here->ray.origin - there->ray.origin) < 1e-9 &&
                    length(here->ray.direction - there->ray.direction) < 1e-8 * length(there->ray.direction);
        if (there) {
            const std::span<const Step> own = direct.steps_of(*there);
            same = same && std::equal(steps.begin() + 1, steps.end(), own.begin(), own.end());
        }
        other += !same;
    }
    INFO(material << " n = " << n << ": " << compared << " compared, " << other << " other, "
                  << ball_only_there);
    CHECK(compared > 400);
    CHECK(other <= compared / 500);
    CHECK(ball_only_there <= 2 + compared / 200);
}

}  // namespace

TEST_CASE("a ball seen in a flat mirror as a layer is the ball before the mirrored camera",
          "[laws][layers][law]") {
    for (const int n : {4, 9}) check_flat_layer("chrome", n);
}

TEST_CASE("the same of a ball of glass", "[laws][layers][law]") {
    check_flat_layer("glass", 9);
}

TEST_CASE("layers lie where the exact paths have them, with second order", "[laws][layers][law]") {
    std::vector<LayerErrors> found;
    for (const int n : {8, 16, 32}) {
        const auto world = two_balls(n, 512);
        const SampleViews truth = views_of(*world, {}, Engine::kLimitTruth);
        found.push_back(errors_of(*world, layered(true), truth));
        print("layers", n, found.back());
        const LayerErrors divided = errors_of(*world, layered(false), truth);
        print("divided", n, divided);
        CHECK(divided.layered == 0);
        CHECK(found.back().layered > 0.8 * static_cast<double>(found.back().samples));
        CHECK(found.back().traced < divided.traced);
    }
    for (std::size_t i = 0; i + 1 < found.size(); ++i) {
        CHECK(std::log2(found[i].mean_of_two / found[i + 1].mean_of_two) > 1.9);
        CHECK(found[i + 1].mean < found[i].mean / 2.5);
        CHECK(found[i].wrong > 2 * found[i + 1].wrong);
    }
}

TEST_CASE("layers at full size beside dividing, with a table", "[.long][layers-table][law]") {
    for (const int n : {8, 16, 32}) {
        const auto world = two_balls(n, 1024);
        const SampleViews truth = views_of(*world, {}, Engine::kLimitTruth);
        for (const bool layers : {true, false})
            for (const CornerRays rays : {CornerRays::kInterpolated, CornerRays::kFitted}) {
                const FrameParams frame = layered(layers, rays);
                print((std::string(layers ? "lay " : "div ") + name_of(rays)).substr(0, 8).c_str(), n,
                      errors_of(*world, frame, truth));
            }
    }
}

TEST_CASE("projector and Embree see the same layers", "[laws][layers][oracle][law]") {
    const auto balls = two_balls(8, 300);
    const SampleViews shown = views_of(*balls, layered(true), Engine::kExact);
    CHECK(std::count_if(shown.samples.begin(), shown.samples.end(),
                        [](const SampleView& view) { return view.nested > 0; }) > 300);
    for (const int n : {3, 8}) {
        const Agreement a = compare_engines(*two_balls(n, 300));
        INFO("n = " << n << ": " << a.first_off_edge);
        CHECK(a.off_edge == 0);
        CHECK(a.seen + a.coverage <= 3);
    }
    const std::string look = R"({"eye":[-2.2,1.1,5],"at":[-0.5,0.1,-1]})";
    const auto glass =
        world_from("glass", nested_scene(240, look, with_material(kBall, "glass") + kPlane + kThings), 8);
    const Agreement a = compare_engines(*glass);
    INFO(a.first_off_edge);
    CHECK(a.off_edge == 0);
    CHECK(a.seen + a.coverage <= 3);
}

TEST_CASE("a scene says whether optics seen in an optic are layers", "[laws][layers][law]") {
    for (const Mesh& mesh : two_balls(8, 200)->scene.meshes) CHECK(mesh.layered);
    const std::string ball =
        R"({"name":"%","role":"optic","material":"chrome","seenOptics":"divided","primitive":{"type":"sphere","center":[%],"radius":0.6}})";
    const auto at = [&](const std::string& name, const std::string& center) {
        std::string text = ball;
        text.replace(text.find('%'), 1, name);
        return text.replace(text.find('%'), 1, center);
    };
    const auto divided =
        world_from("divided",
                   nested_scene(200, R"({"eye":[0.7,0.9,4.4],"at":[0.05,0,0]})",
                                at("a", "-0.75,0.1,0") + "," + at("b", "1,-0.2,0.3") + room()),
                   8);
    PictureRequest request;
    request.layers.layers = layer_names();
    const Picture as_said = draw_picture(*divided, request, {}, ignore);
    CHECK(as_said.statistics.layered_pixels == 0);
    request.frame.layered = false;
    check_same(as_said.image, draw_picture(*divided, request, {}, ignore).image);
    request.frame.layered = true;
    const Picture layers = draw_picture(*divided, request, {}, ignore);
    CHECK(layers.statistics.layered_pixels > 100);
    CHECK(layers.statistics.traced_pixels < as_said.statistics.traced_pixels);
}

TEST_CASE("crops and threads do not change layers", "[laws][layers][law]") {
    const auto world = two_balls(8, 300);
    PictureRequest request;
    request.layers.layers = layer_names();
    set_thread_count(1);
    const Picture whole = draw_picture(*world, request, {}, ignore);
    CHECK(whole.statistics.layered_pixels > 300);
    set_thread_count(4);
    check_same(whole.image, draw_picture(*world, request, {}, ignore).image);
    request.layers.x0 = 150, request.layers.y0 = 120, request.layers.x1 = 260, request.layers.y1 = 231;
    check_same(whole.image, draw_picture(*world, request, {}, ignore).image);
    set_thread_count(0);
}
