// Adaptive sampling of maps, and the targets they lead to: against closed forms and differences.
#include <atomic>
#include <cmath>

#include "inverse/maps/sampled_map.h"
#include "inverse/maps/target.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using trilens_test::Draw;

namespace {

MapImage wave(const Vec2& p, double scale) {
    const Vec2 q = scale * p;
    return {{20 * std::sin(q.x) * std::cos(q.y), 10 * std::exp(0.3 * q.x) * q.y},
            Mat2(scale * Vec2(20 * std::cos(q.x) * std::cos(q.y), 3 * std::exp(0.3 * q.x) * q.y),
                 scale * Vec2(-20 * std::sin(q.x) * std::sin(q.y), 10 * std::exp(0.3 * q.x)))};
}

double sampled_error(const MapLattice& lattice, double scale) {
    const SampledMap map(lattice, [&](std::span<const Vec2> places, std::span<MapImages> images) {
        for (std::size_t i = 0; i < places.size(); ++i) images[i] = {wave(places[i], scale)};
    });
    double worst = 0;
    std::vector<std::atomic<int>> visits(static_cast<std::size_t>(lattice.width * lattice.height));
    const auto pixels = map.pixels();
    map.for_each_pixel([&](int x, int y, std::span<const MapImage>) {
        ++visits[static_cast<std::size_t>(y * lattice.width + x)];
    });
    for (int y = 0; y < lattice.height; ++y)
        for (int x = 0; x < lattice.width; ++x) {
            const auto at = static_cast<std::size_t>(y * lattice.width + x);
            REQUIRE(visits[at] == 1);
            REQUIRE(pixels[at].known);
            const MapImage exact = wave({x + 0.5, y + 0.5}, scale);
            worst = std::max(worst, length(pixels[at].image.position - exact.position));
            CHECK(length(pixels[at].image.jacobian[0] - exact.jacobian[0]) < 0.05 * scale * 20 + 1e-9);
        }
    return worst;
}

}  // namespace

TEST_CASE("a sampled map is within its tolerance, and its patches are of fourth order", "[inverse][law]") {
    for (const double tolerance : {1e-2, 1e-4, 1e-6})
        CHECK(sampled_error({97, 61, 8, tolerance}, 0.05) <= 1.05 * tolerance);
    // One level of cells, none refined: halving them divides the error by 16.
    const double coarse = sampled_error({65, 65, 16, 1e9}, 0.05),
                 fine = sampled_error({65, 65, 8, 1e9}, 0.05);
    CHECK(coarse / fine > 12);
    for (const auto& [width, height] : {std::pair(1, 1), {1, 9}, {9, 1}, {2, 2}, {8, 8}, {10, 3}})
        CHECK(sampled_error({width, height, 8, 1e-3}, 0.05) <= 1.05e-3);
}

TEST_CASE("a sampled map keeps borders, and several images of a place apart", "[inverse]") {
    // One image beyond a line, two that cross within a circle.
    const auto evaluate = [](std::span<const Vec2> places, std::span<MapImages> images) {
        for (std::size_t i = 0; i < places.size(); ++i) {
            const Vec2& p = places[i];
            if (p.x + 0.37 * p.y > 40) images[i].push_back({p, Mat2(1), Vec3(1), 1});
            if (length(p - Vec2(20, 20)) < 9.3) images[i].push_back({2.0 * p, Mat2(2), Vec3(1), 2});
            if (length(p - Vec2(20, 20)) < 9.3)
                images[i].push_back({Vec2(80) - 2.0 * p, Mat2(-2), Vec3(1), 2});
        }
    };
    const SampledMap map({64, 48, 8, 1e-6}, evaluate);
    std::atomic<int> wrong = 0;
    map.for_each_pixel([&](int x, int y, std::span<const MapImage> images) {
        const Vec2 p(x + 0.5, y + 0.5);
        std::vector<MapImages> exact(1);
        evaluate(std::span(&p, 1), exact);
        wrong += exact[0].size() != images.size();
        for (const MapImage& image : images) {
            double nearest = 1e9;
            for (const MapImage& other : exact[0])
                nearest = std::min(nearest, length(image.position - other.position));
            wrong += nearest > 1e-6;
        }
    });
    CHECK(wrong == 0);
    CHECK(map.exact_count() < 64 * 48 / 2);
}

TEST_CASE("targets lead to directions and back, with the derivative of their pixels", "[inverse][oracle]") {
    Scene scene;
    Draw draw(11);
    TargetDescription fisheye{TargetKind::kFisheye, 300, 300};
    fisheye.fov = 220;
    for (const TargetDescription& description :
         {TargetDescription{TargetKind::kEquirect, 400, 200}, {TargetKind::kCubemap, 600, 100}, fisheye}) {
        const Target target(description, scene);
        int inside = 0;
        double whole = 0;
        for (int i = 0; i < 400; ++i) {
            const Vec2 pixel(draw.uniform(0, description.width), draw.uniform(0, description.height));
            const auto place = target.place(pixel);
            if (!place) continue;
            ++inside;
            CHECK(std::fabs(length(place->at) - 1) < 1e-12);
            const auto back = target.pixel_of_direction(draw.log_uniform(1e-3, 1e3) * place->at);
            REQUIRE(back);
            CHECK(length(*back - pixel) < 1e-9);
            const double step = 1e-5;
            const auto before = target.place(pixel - Vec2(step, 0)),
                       behind = target.place(pixel + Vec2(step, 0));
            const auto above = target.place(pixel - Vec2(0, step)),
                       below = target.place(pixel + Vec2(0, step));
            if (!before || !behind || !above || !below) continue;
            CHECK(length((behind->at - before->at) / (2 * step) - place->dx) < 1e-8);
            CHECK(length((below->at - above->at) / (2 * step) - place->dy) < 1e-8);
        }
        CHECK(inside > 250);
        // Solid angles of all pixels: of the sphere, or of the cap.
        for (int y = 0; y < description.height; ++y)
            for (int x = 0; x < description.width; ++x)
                if (const auto place = target.place({x + 0.5, y + 0.5})) whole += target.measure(*place);
        const double pi = 3.14159265358979323846;
        const double cap =
            description.kind == TargetKind::kFisheye ? 2 * pi * (1 - std::cos(110 * pi / 180)) : 4 * pi;
        CHECK(whole == Approx(cap).epsilon(2e-3));
    }
}

TEST_CASE("the resolution of a map is that of its derivative in the tangent plane", "[inverse]") {
    Draw draw(5);
    for (int i = 0; i < 100; ++i) {
        // A map that stretches two orthogonal directions of the plane by known factors.
        const double a = draw.log_uniform(1e-3, 1e3), b = a * draw.log_uniform(1, 1e3),
                     turn = draw.uniform(0, 6);
        const Mat2 rotate(Vec2(std::cos(turn), std::sin(turn)), Vec2(-std::sin(turn), std::cos(turn)));
        const Mat2 stretch = rotate * Mat2(Vec2(a, 0), Vec2(0, b)) * glm::transpose(rotate);
        const Vec3 e1 = draw.unit(), e2 = normalize(cross(e1, draw.unit()));
        const Vec2 px(draw.uniform(-1, 1), draw.uniform(-1, 1)), py(draw.uniform(-1, 1), draw.uniform(-1, 1));
        if (std::fabs(px.x * py.y - px.y * py.x) < 0.05) continue;
        const Resolution r =
            resolution_of(Mat2(stretch * px, stretch * py), px.x * e1 + px.y * e2, py.x * e1 + py.y * e2);
        CHECK(r.least == Approx(a).epsilon(1e-6));
        CHECK(r.most == Approx(b).epsilon(1e-6));
    }
}
