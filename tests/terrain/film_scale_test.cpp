// How many pixels a terrain's heights are worth: no less than anywhere asked, little more, nothing out of
// sight.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "support/mountains.h"
#include "support/test.h"
#include "terrain/film_scale.h"
#include "terrain/terrain.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr int kSide = 257;
const SampleSpacing kSpacing{{-4, -3}, {8.0 / (kSide - 1), 6.0 / (kSide - 1)}, 1.5};

/// What a place is worth by a formula; negative: it is not seen.
using Worth = double (*)(const Vec3& place);

FilmMoves moves_by(Worth worth) {
    return [worth](std::span<const FilmMoveQuery> queries) {
        std::vector<FilmMove> moves;
        for (const FilmMoveQuery& query : queries) {
            const double pixels = worth(query.place) * length(query.along);
            moves.push_back(pixels >= 0 ? FilmMove{pixels, true, true} : FilmMove{});
        }
        return moves;
    };
}

double near_an_eye(const Vec3& place) {
    return 100 / length(place - Vec3(0.3, 1.7, 0.4));
}

/// A wedge that begins at a point, as a flat mirror that stands there shows it.
double in_a_wedge(const Vec3& place) {
    const double away = place.x + 1.13;
    return away > 0 && std::fabs(place.z - 0.21 - 0.3 * away) < 0.05 * away ? 40 / (1 + away) : -1;
}

Vec3 sample_place(const HeightGrid& heights, int x, int y) {
    return {kSpacing.first.x + x * kSpacing.step.x, static_cast<double>(heights.at(x, y)) * kSpacing.height,
            kSpacing.first.y + y * kSpacing.step.y};
}

}  // namespace

TEST_CASE("a terrain's scale is no less than that of any sample, and little more", "[terrain]") {
    const HeightGrid heights = mountains(kSide, kSide);
    const HeightSquare square(heights, std::numeric_limits<double>::quiet_NaN());
    for (const Worth worth : {&near_an_eye, &in_a_wedge}) {
        const FilmScale scale(square, kSpacing, moves_by(worth));
        for (const int half : {1, 2, 8, 32, 128})
            for (int y = half; y < kSide; y += 2 * half)
                for (int x = half; x < kSide; x += 2 * half) {
                    double most = 0;
                    for (int j = std::max(0, y - half + 1); j < std::min(kSide, y + half); ++j)
                        for (int i = std::max(0, x - half + 1); i < std::min(kSide, x + half); ++i)
                            most = std::max(most, worth(sample_place(heights, i, j)));
                    REQUIRE(scale.most_around(x, y, half) >= most);
                    if (worth == &near_an_eye) REQUIRE(scale.most_around(x, y, half) <= 4 * most);
                }
    }
}

TEST_CASE("what is not seen of a terrain is worth nothing, but beside what is", "[terrain]") {
    const HeightSquare square(mountains(kSide, kSide), std::numeric_limits<double>::quiet_NaN());
    const FilmScale unseen(square, kSpacing, moves_by([](const Vec3&) { return -1.0; }));
    CHECK(unseen.most_around(128, 128, 128) == 0);
    const FilmScale wedge(square, kSpacing, moves_by(in_a_wedge));
    std::size_t worthless = 0;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) worthless += wedge.most_around(x, y, 1) == 0 ? 1 : 0;
    CHECK(worthless > kSide * kSide * 8 / 10);
}

TEST_CASE("what a terrain's heights are worth is reported while it is asked, and can be stopped", "[terrain]") {
    const HeightSquare square(mountains(kSide, kSide), std::numeric_limits<double>::quiet_NaN());
    for (const Worth worth : {&near_an_eye, &in_a_wedge}) {
        std::vector<double> told;
        const FilmScale scale(square, kSpacing, moves_by(worth), {[&](double done) { told.push_back(done); }});
        CHECK(told.size() >= 4);  // a level each, at least
        CHECK(std::is_sorted(told.begin(), told.end()));
        CHECK(told.front() > 0);
        CHECK(told.back() <= 1);
    }
    std::atomic<bool> cancel = false;
    std::size_t asked = 0;
    const FilmMoves moves = [&](std::span<const FilmMoveQuery> queries) {
        asked += queries.size();
        cancel = true;
        return moves_by(&near_an_eye)(queries);
    };
    CHECK_THROWS_AS(FilmScale(square, kSpacing, moves, {nullptr, &cancel}), Interrupted);
    CHECK(asked <= 64);
}

TEST_CASE("where it is unknown how a terrain is seen all of it is kept, but what is even", "[terrain]") {
    const FilmMoves unknown = moves_by([](const Vec3&) { return std::numeric_limits<double>::infinity(); });
    const HeightGrid heights = mountains(33, 33);
    const Thinning thinning{ThinningRule::kBound, 5, {}, unknown};
    CHECK(make_terrain(heights, {Vec3(8, 1.5, 6), {}}, thinning).triangles.size() == 2 * 32 * 32);
    const HeightGrid even{33, 33, 1, std::vector<float>(33 * 33, 0.5f)};
    CHECK(make_terrain(even, {Vec3(8, 1.5, 6), {}}, thinning).triangles.size() == 2);
}
