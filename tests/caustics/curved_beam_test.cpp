// Pieces of curved beams at a footprint: those that are left out unseen bring nothing.
#include "caustics/curved_beam.h"

#include <cmath>
#include <random>

#include "support/test.h"

using namespace trilens;

namespace {

ReceiverPlane unit_plane() {
    Receiver receiver;
    receiver.normal = {0, 0, 1};
    receiver.sides = {Vec3(1, 0, 0), Vec3(0, 1, 0)};
    return ReceiverPlane(receiver, 10);
}

/// Light at the footprint, summed over the pieces of a beam that come to it, each with what its middle there
/// has.
struct Gathered {
    double light = 0;
    std::size_t looked_at = 0, pieces = 0;

    void add(const FallenBeam& fallen, const ReceiverPlane& plane) {
        ++looked_at;
        const auto part = part_at_footprint(fallen, plane);
        if (!part) return;
        ++pieces;
        for (int k = 0; k < 3; ++k)
            light += part->density * part->weights[k] * fallen.light[static_cast<std::size_t>(k)].x;
    }
};

/// All pieces, whether they come near or not.
Gathered by_every_piece(const FallenCurve& curve, int sides, const ReceiverPlane& plane) {
    const PieceGrid& grid = PieceGrid::of(sides);
    Gathered all;
    for (std::size_t p = 0; p < grid.pieces; ++p) {
        FallenBeam fallen;
        for (std::size_t k = 0; k < 3; ++k)
            for (std::size_t c = 0; c < 6; ++c) {
                const double weight = grid.quadratic[grid.piece[p][k]][c];
                fallen.at[k] += weight * curve.at[c];
                fallen.light[k] += weight * curve.light[c];
            }
        fallen.measure = 1.0 / static_cast<double>(grid.pieces);
        all.add(fallen, plane);
    }
    return all;
}

}  // namespace

TEST_CASE("pieces of a curved beam that are left out bring nothing to a footprint", "[caustics][oracle]") {
    const ReceiverPlane plane = unit_plane();
    std::mt19937_64 random(7);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> exponent(-2, 2);
    std::size_t met = 0, missed = 0, looked_at = 0, pieces = 0;
    for (int i = 0; i < 30'000; ++i) {
        // Long and short, straight and folded, and of no area.
        const double size = std::pow(10, exponent(random)),
                     bend = 0.3 * size * std::pow(10, exponent(random));
        const Vec2 at(normal(random), normal(random));
        const Vec2 stretch(1, i % 3 == 0 ? std::pow(10, exponent(random) - 2) : i % 7 == 0 ? 0.0 : 1.0);
        FallenCurve curve;
        for (std::size_t k = 0; k < 3; ++k)
            curve.at[k] = at + size * stretch * Vec2(normal(random), normal(random));
        for (std::size_t k = 0; k < 3; ++k)
            curve.at[3 + k] = 0.5 * (curve.at[(k + 1) % 3] + curve.at[(k + 2) % 3]) +
                              bend * stretch * Vec2(normal(random), normal(random));
        for (Vec3& light : curve.light) light = Vec3(std::fabs(normal(random)));

        CurvedBeam beam;
        beam.corners.measure = 1;
        for (const int sides : {1, 2, 4}) {
            const Gathered every = by_every_piece(curve, sides, plane);
            Gathered near;
            beam.for_each_piece(curve, 0.5, sides, [&](const BeamCorners&, const FallenBeam& fallen) {
                near.add(fallen, plane);
            });
            INFO("beam " << i << " in " << sides << " x " << sides << " pieces, " << every.pieces);
            CHECK(near.light == Approx(every.light).epsilon(1e-12).margin(1e-13));
            CHECK(near.pieces == every.pieces);
            ++(every.pieces > 0 ? met : missed);
            looked_at += near.looked_at, pieces += near.pieces;
        }
    }
    CHECK(met > 20'000);
    CHECK(missed > 10'000);
    CHECK(looked_at < pieces + pieces / 10);  // hardly any piece is looked at in vain
}

TEST_CASE("what a square cuts out of pieces by boundary integrals is what clipping leaves of them",
          "[caustics][oracle]") {
    const ReceiverPlane plane = unit_plane();
    std::mt19937_64 random(11);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> exponent(-3, 3);
    std::size_t inside = 0, cut_off = 0, outside = 0;
    for (int i = 0; i < 10'000; ++i) {
        const double size = std::pow(10, exponent(random));
        const Vec2 at(normal(random), normal(random));
        FallenCurve curve;
        for (Vec2& point : curve.at) point = at + size * Vec2(normal(random), normal(random));
        // Sides along the square's, corners on them, and triangles upside down.
        if (i % 5 == 0) curve.at[1].x = curve.at[0].x, curve.at[2].y = curve.at[0].y;
        if (i % 11 == 0) curve.at[0] = {0.5, curve.at[0].y}, curve.at[1] = {0.5, -0.5};
        if (i % 2 == 0)
            for (std::size_t k = 0; k < 3; ++k)
                curve.at[3 + k] = 0.5 * (curve.at[(k + 1) % 3] + curve.at[(k + 2) % 3]);
        for (const int sides : {1, 2, 4}) {
            const PieceGrid& grid = PieceGrid::of(sides);
            CutPieces cut;
            cut_pieces(curve.at, sides, cut);
            REQUIRE(cut.count == grid.pieces);
            for (std::size_t p = 0; p < grid.pieces; ++p) {
                FallenBeam fallen;
                double longest = 0;
                for (std::size_t k = 0; k < 3; ++k)
                    for (std::size_t c = 0; c < 6; ++c)
                        fallen.at[k] += grid.quadratic[grid.piece[p][k]][c] * curve.at[c];
                for (std::size_t k = 0; k < 3; ++k)
                    longest = std::max(longest, length(fallen.at[k] - fallen.at[(k + 1) % 3]));
                const double area =
                    std::fabs(cross(fallen.at[1] - fallen.at[0], fallen.at[2] - fallen.at[0]));
                fallen.measure = 1;
                const auto part = part_at_footprint(fallen, plane);
                // Of a needle neither knows its area to more digits.
                const double room = 1e-14 * longest * std::max(longest, 1.0) / area;
                INFO("beam " << i << " in " << sides << " x " << sides << " pieces, " << p);
                CHECK(cut.share[p] == Approx(part ? part->density : 0).margin(room).epsilon(1e-12));
                if (!part || !(cut.share[p] > 0)) continue;
                for (std::size_t k = 0; k < 3; ++k)
                    CHECK(std::fabs(cut.weight[k][p] - part->weights[static_cast<int>(k)]) <=
                          1e-9 + 10 * room / part->density);
            }
            for (std::size_t p = 0; p < grid.pieces; ++p)
                ++(cut.share[p] == 0 ? outside : cut.share[p] == 1 ? inside : cut_off);
        }
    }
    CHECK(inside > 10'000);
    CHECK(cut_off > 10'000);
    CHECK(outside > 10'000);
}
