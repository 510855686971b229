// Rough mirrors and glass: against integrals by quadrature, energy, and what roughness must leave alone.
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "base/util/parallel.h"
#include "laws/pictures.h"
#include "laws/worlds.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr double kRoughPi = std::numbers::pi;

/// A mirror in the plane z = 0, seen by parallel rays from `eye`, in a sky of this grey.
std::string flat_scene(double roughness, const std::string& eye, double sky, const std::string& objects = "",
                       const std::string& material = R"("metallicFactor": 1)") {
    return R"({"version": 1, "film": {"width": 16, "height": 8},
        "cameras": [{"name": "main", "type": "orthographic", "ymag": 0.5,
                     "lookAt": {"eye": )" +
           eye + R"(, "at": [0, 0, 0], "up": [0, 1, 0]}}],
        "background": {"color": [)" +
           std::to_string(sky) + "," + std::to_string(sky) + "," + std::to_string(sky) +
           R"(]}, "render": {"fresnel": false},
        "materials": [{"name": "rough", "roughnessFactor": )" +
           std::to_string(roughness) + "," + material +
           R"(}, {"name": "white", "unlit": true}],
        "meshes": [{"name": "mirror", "role": "optic", "material": "rough", "primitive": {"type": "plane",
            "center": [0, 0, 0], "normal": [0, 0, 1], "tangent": [1, 0, 0], "size": [60, 60]}})" +
           objects + "]}";
}

/// What the mirror shows of directions where `shows` is 1, seen from `view`; by quadrature of the BRDF times
/// the cosine over half vectors, D G1 G1 V.H / N.V, as glTF's appendix B has D and G1; the normal is +Z.
double by_quadrature(double roughness, const Vec3& view, const std::function<double(const Vec3&)>& shows) {
    constexpr int kRings = 1500, kSectors = 720;
    const double a2 = std::pow(roughness, 4);
    const auto masking = [&](double cosine) {
        return 2 / (1 + std::sqrt(1 + a2 * (1 / (cosine * cosine) - 1)));
    };
    double sum = 0;
    for (int i = 0; i < kRings; ++i)
        for (int j = 0; j < kSectors; ++j) {
            const double u = (i + 0.5) / kRings, around = 2 * kRoughPi * (j + 0.5) / kSectors;
            const double cosine = 1 / std::sqrt(1 + a2 * u / (1 - u)), sine = std::sqrt(1 - cosine * cosine);
            const Vec3 half(sine * std::cos(around), sine * std::sin(around), cosine);
            const double seen = dot(view, half);
            const Vec3 out = 2 * seen * half - view;
            if (!(seen > 0 && out.z > 0)) continue;
            sum += masking(view.z) * masking(out.z) * seen / (view.z * cosine) * shows(out);
        }
    return sum / (kRings * kSectors);
}

/// Unpolarised light's reflectance at a smooth interface: from the index of refraction `from` to `to`.
double fresnel_by_hand(double cosine, double from, double to) {
    const double sine2 = std::pow(from / to, 2) * (1 - cosine * cosine);
    if (sine2 >= 1) return 1;
    const double behind = std::sqrt(1 - sine2);
    const double s = (from * cosine - to * behind) / (from * cosine + to * behind),
                 p = (from * behind - to * cosine) / (from * behind + to * cosine);
    return (s * s + p * p) / 2;
}

/// A rough interface in the plane z = 0, looked at along -`view`.
struct RoughInterface {
    double roughness, from, to;  // indices of refraction on the viewer's side and behind
    Vec3 view;                   // z > 0
};

/// Gives `take` directions and their weights, by BSDF and cosine: the integral over the directions
/// themselves, in the plane that touches their sphere at `middle`. Walter et al. 2007: equation 20 of what is
/// reflected, 21 of what is refracted, with the viewer's radiance per squared index; Smith's masking of both
/// directions, and GGX as the paper has them (equations 33 and 34).
void by_walter(const RoughInterface& at, bool reflects, const Vec3& middle,
               const std::function<void(const Vec3& out, double weight)>& take) {
    constexpr int kRings = 1400, kSectors = 480;
    const double alpha = at.roughness * at.roughness;
    const Vec3 across = normalize(cross(middle, Vec3(0.3, 1, 0.2))), along = cross(middle, across);
    const auto masking = [&](const Vec3& v, const Vec3& half) {
        if (dot(v, half) * v.z <= 0) return 0.0;
        const double tan2 = (1 - v.z * v.z) / (v.z * v.z);
        return 2 / (1 + std::sqrt(1 + alpha * alpha * tan2));
    };
    for (int i = 0; i < kRings; ++i)
        for (int j = 0; j < kSectors; ++j) {
            // Dense in the middle of the lobe, with a tail to the horizon.
            const double u = (i + 0.5) / kRings, around = 2 * kRoughPi * (j + 0.5) / kSectors;
            const double radius = alpha * u / (1 - u), stretch = alpha / ((1 - u) * (1 - u));
            const Vec3 out =
                normalize(middle + radius * (std::cos(around) * across + std::sin(around) * along));
            const double solid = radius * stretch * std::pow(dot(out, middle), 3);
            if (reflects ? out.z <= 0 : out.z >= 0) continue;
            Vec3 half = reflects ? at.view + out : -(at.from * at.view + at.to * out);
            half = normalize(half);
            if (half.z < 0) half = -half;
            const double seen = dot(at.view, half), left = dot(out, half);
            if (!(seen > 0)) continue;
            const double cos2 = half.z * half.z, tan2 = (1 - cos2) / cos2;
            const double density =
                alpha * alpha / (kRoughPi * cos2 * cos2 * std::pow(alpha * alpha + tan2, 2));
            const double shared = density * masking(at.view, half) * masking(out, half);
            const double fresnel = fresnel_by_hand(seen, at.from, at.to);
            double bsdf = 0;
            if (reflects)
                bsdf = fresnel * shared / (4 * at.view.z * out.z);
            else if (const double turn = at.from * seen + at.to * left; turn != 0)
                bsdf = seen * std::fabs(left) / (at.view.z * -out.z) * at.to * at.to * (1 - fresnel) *
                       shared / (turn * turn);
            take(out, bsdf * std::fabs(out.z) * solid * 2 * kRoughPi / (kRings * kSectors));
        }
}

double value_of(const Image& image, const char* channel, std::size_t pixel) {
    return double{image.find(channel)->floats()[pixel]};
}

/// With the layers that are not written by default, too.
Image drawn_whole(World& world, int spp, Engine engine) {
    world.scene.film.spp = spp;
    PictureRequest request;
    request.engine = engine;
    request.layers.layers = layer_names();
    return draw_picture(world, request, {}, ignore, nullptr).image;
}

constexpr Engine kBothEngines[] = {Engine::kExact, Engine::kLimitTruth};

}  // namespace

TEST_CASE("the white furnace: a rough mirror in a white sky shows GGX's albedo, never more than the sky",
          "[laws][law][oracle][thorough]") {
    for (const double roughness : {0.05, 0.15, 0.3})
        for (const double height : {0.25, 1.0, 4.0}) {
            const Vec3 view = normalize(Vec3(1, 0, height));
            const auto world = world_from(
                "rough", flat_scene(roughness, "[20,0," + std::to_string(20 * height) + "]", 1), 4);
            world->scene.render.rough_samples = world->scene.render.rough_truth_samples = 4096;
            const double albedo = by_quadrature(roughness, view, [](const Vec3&) { return 1.0; });
            for (const Engine engine : kBothEngines) {
                INFO("roughness " << roughness << ", height " << height << ", " << engine_name(engine));
                const Image image = drawn_by(*world, 1, engine);
                for (std::size_t pixel = 0; pixel < 16 * 8; ++pixel) {
                    CHECK(value_of(image, "G", pixel) <= 1 + 1e-6);
                    CHECK(value_of(image, "G", pixel) == Approx(albedo).margin(2e-3));
                }
            }
        }
}

TEST_CASE("a rough mirror shows the edge of a wall as quadrature does, projected and traced",
          "[laws][law][oracle][thorough]") {
    // A white wall beyond x = 0, five units before the mirror; the camera looks straight down, from nearer.
    const std::string wall = R"(, {"name": "wall", "role": "object", "material": "white",
        "points": [[0,-90,5],[90,-90,5],[90,90,5],[0,90,5]], "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3]})";
    for (const double roughness : {0.1, 0.2, 0.3}) {
        const auto world = world_from("edge", flat_scene(roughness, "[0,0,1]", 0, wall), 4);
        std::array<double, 16> shown;
        for (std::size_t pixel = 0; pixel < shown.size(); ++pixel) {
            const double x = (double(pixel) + 0.5 - 8) / 8;
            shown[pixel] = by_quadrature(
                roughness, {0, 0, 1}, [&](const Vec3& out) { return x + 5 * out.x / out.z > 0 ? 1.0 : 0.0; });
        }
        const auto worst = [&](Engine engine, int samples) {
            world->scene.render.rough_samples = world->scene.render.rough_truth_samples = samples;
            const Image row = row_drawn_by(*world, 4, engine);
            double most = 0;
            for (std::size_t pixel = 0; pixel < shown.size(); ++pixel)
                most = std::max(most, std::fabs(value_of(row, "G", pixel) - shown[pixel]));
            return most;
        };
        for (const Engine engine : kBothEngines) {
            INFO("roughness " << roughness << ", " << engine_name(engine));
            CHECK(worst(engine, 16) < 0.15);
            CHECK(worst(engine, 1024) < 0.01);
        }
    }
}

/// What an interface looked at straight on or aslant shows of the edge of a wall, which is white beyond the
/// place that the smooth ray through the film's middle meets, five units from the plane. side: 1: the viewer
/// is in the air before the plane's front; -1: in glass, behind it.
struct Edge {
    double side;
    bool reflects;
    double roughness, slope;

    RoughInterface interface() const {
        return {roughness, side > 0 ? 1 : 1.5, side > 0 ? 1.5 : 1, normalize(Vec3(slope, 0, 1))};
    }
    /// The way of the smooth ray.
    Vec3 middle() const {
        const auto [alike, from, to, view] = interface();
        const double eta = from / to, cosine = view.z;
        const Vec3 normal(0, 0, 1);
        return reflects
                   ? 2 * cosine * normal - view
                   : (eta * cosine - std::sqrt(1 - eta * eta * (1 - cosine * cosine))) * normal - eta * view;
    }
    double place() const { return 5 * middle().x / std::fabs(middle().z); }
};

constexpr std::array<std::size_t, 6> kEdgePixels{0, 3, 6, 9, 12, 15};  // of a row of 16

/// What these pixels show of it.
std::array<double, kEdgePixels.size()> edge_by_walter(const Edge& edge) {
    const RoughInterface at = edge.interface();
    std::array<double, kEdgePixels.size()> shown{}, nearest{};  // the least way aside that meets white
    for (std::size_t i = 0; i < kEdgePixels.size(); ++i)
        // The film's right is +x for a viewer in front, -x for one behind.
        nearest[i] = edge.place() - edge.side * (double(kEdgePixels[i]) + 0.5 - 8) / 8 / at.view.z;
    by_walter(at, edge.reflects, edge.middle(), [&](const Vec3& out, double weight) {
        for (std::size_t i = 0; i < shown.size(); ++i)
            if (5 * out.x / std::fabs(out.z) > nearest[i]) shown[i] += weight;
    });
    return shown;
}

std::array<double, kEdgePixels.size()> drawn_edge(const Edge& edge, Engine engine) {
    const std::string x = std::to_string(edge.place()),
                      z = std::to_string(5 * edge.side * (edge.reflects ? 1 : -1));
    const std::string wall = R"(, {"name": "wall", "role": "object", "material": "white", "points": [[)" + x +
                             ",-90," + z + "],[90,-90," + z + "],[90,90," + z + "],[" + x + ",90," + z +
                             R"(]], "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3]})";
    std::string text =
        flat_scene(edge.roughness, "[" + std::to_string(edge.slope) + ",0," + std::to_string(edge.side) + "]",
                   0, wall, R"("transmissionFactor": 1, "ior": 1.5)");
    text.replace(text.find(R"("fresnel": false)"), 16, R"("fresnel": true)");
    const auto world = world_from("rough glass", text, 8);
    world->scene.render.rough_samples = world->scene.render.rough_truth_samples = 4096;
    const Image row = row_drawn_by(*world, 4, engine);
    std::array<double, kEdgePixels.size()> drawn;
    for (std::size_t i = 0; i < drawn.size(); ++i) drawn[i] = value_of(row, "G", kEdgePixels[i]);
    return drawn;
}

void check_edge(const Edge& edge) {
    const auto shown = edge_by_walter(edge);
    const double most = *std::max_element(shown.begin(), shown.end());
    CHECK(most > (edge.reflects ? 0.02 : 0.3));
    for (const Engine engine : kBothEngines) {
        const auto drawn = drawn_edge(edge, engine);
        for (std::size_t i = 0; i < shown.size(); ++i) {
            INFO("side " << edge.side << (edge.reflects ? ", reflected" : ", refracted") << ", roughness "
                         << edge.roughness << ", slope " << edge.slope << ", " << engine_name(engine)
                         << ", pixel " << kEdgePixels[i] << ": of " << most);
            CHECK(std::fabs(drawn[i] - shown[i]) < (edge.reflects ? 0.015 : 0.003) * most);
        }
    }
}

TEST_CASE("rough glass shows the edge of a wall, through it and in it, as quadrature of Walter's BSDF does",
          "[laws][law][oracle][thorough]") {
    for (const double side : {1.0, -1.0})
        for (const bool reflects : {false, true})
            for (const double roughness : {0.1, 0.3})
                for (const double slope : {0.0, 0.7}) check_edge({side, reflects, roughness, slope});
}

TEST_CASE("rough glass in a white sky gives back no more than comes, and nearly all", "[laws][law]") {
    for (const char* mesh :
         {R"("type": "sphere", "center": [0, 0, 0], "radius": 0.45)", R"("type": "plane", "center": [0, 0, 0],
             "normal": [0, 0, 1], "tangent": [1, 0, 0], "size": [60, 60])"}) {
        std::string text = flat_scene(0.3, "[0.5,0,1]", 1, "", R"("transmissionFactor": 1, "ior": 1.5)");
        const std::size_t from = text.find(R"("type": "plane")"), to = text.find('}', from);
        text.replace(from, to - from, mesh);
        text.replace(text.find(R"("fresnel": false)"), 16, R"("fresnel": true)");
        const auto world = world_from("glass", text, 8);
        world->scene.render.rough_samples = 256;
        for (const Engine engine : kBothEngines) {
            const Image image = drawn_by(*world, 1, engine);
            double mean = 0;
            for (std::size_t pixel = 0; pixel < 16 * 8; ++pixel) {
                INFO("pixel " << pixel << ", " << engine_name(engine));
                CHECK(value_of(image, "G", pixel) <= 1 + 1e-6);
                CHECK(value_of(image, "G", pixel) > 0.8);  // a ball's rim is grazed twice
                mean += value_of(image, "G", pixel) / (16 * 8);
            }
            CHECK(mean > 0.95);
        }
    }
}

TEST_CASE("roughness leaves alone ids and places, smooth optics beside it, and is the same for any threads",
          "[laws][law]") {
    const auto balls = [](double left, double right) {
        const auto ball = [](const char* name, double x) {
            return std::string(R"({"name": ")") + name + R"(", "role": "optic", "material": ")" + name +
                   R"(", "primitive": {"type": "sphere", "center": [)" + std::to_string(x) +
                   R"(, 0, 0], "radius": 0.8}})";
        };
        const auto metal = [](const char* name, double roughness) {
            return std::string(R"({"name": ")") + name + R"(", "metallicFactor": 1, "roughnessFactor": )" +
                   std::to_string(roughness) + "}";
        };
        return R"({"version": 1, "film": {"width": 40, "height": 24}, "cameras": [{"name": "main", "yfov": 34,
            "lookAt": {"eye": [0, 1, 5], "at": [0, 0, 0], "up": [0, 1, 0]}}], "background": {"color": [0.3, 0.5, 0.8]},
            "materials": [)" +
               metal("left", left) + "," + metal("right", right) +
               R"(, {"name": "checks", "unlit": true, "baseColorTexture": {"pattern": "checker", "count": [9, 9]}}],
            "meshes": [)" +
               ball("left", -3) + "," + ball("right", 0.9) +
               R"(, {"name": "floor", "role": "object", "material": "checks", "primitive": {"type": "plane",
                 "center": [0, -0.8, 0], "normal": [0, 1, 0], "tangent": [1, 0, 0], "size": [9, 9]}}]})";
    };
    const auto smooth = world_from("balls", balls(0, 0), 12), rough = world_from("balls", balls(0, 0.2), 12);
    for (const Engine engine : kBothEngines)
        for (const int spp : {1, 2}) {
            INFO(engine_name(engine) << ", spp " << spp);
            const Image before = drawn_whole(*smooth, spp, engine), after = drawn_whole(*rough, spp, engine);
            CHECK(before.find("optic.object")->ids() == after.find("optic.object")->ids());
            CHECK(before.find("reflectID.primitive")->ids() == after.find("reflectID.primitive")->ids());
            CHECK(before.find("reflectP.X")->floats() == after.find("reflectP.X")->floats());
            CHECK(before.find("G")->floats() != after.find("G")->floats());
            // A smooth ball beside a rough one that it cannot see: the same bits.
            std::size_t compared = 0;
            const std::vector<std::uint32_t>& shown = before.find("optic.object")->ids();
            for (std::size_t pixel = 0; pixel < shown.size(); ++pixel) {
                if (shown[pixel] == 1) continue;
                const bool sees_rough = before.find("path.count")->ids()[pixel] > 1;
                if (sees_rough || spp > 1) continue;
                CHECK(value_of(before, "G", pixel) == value_of(after, "G", pixel));
                ++compared;
            }
            CHECK((spp > 1 || compared > 300));
            const int threads = thread_count();
            set_thread_count(threads == 1 ? 3 : 1);
            const Image again = drawn_by(*rough, spp, engine);
            set_thread_count(0);
            CHECK(again.find("G")->floats() == after.find("G")->floats());
        }
}
