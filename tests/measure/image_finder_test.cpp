// The search against one that tries everything.
#include "measure/displacement/image_finder.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "measure/displacement/image_query.h"
#include "measure/synthetic.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

struct Best {
    double score = 0;
    std::optional<Vec2> shift;
    bool tried = false;
};

/// Every piece at every corner of a cell, each patch made and inverted by itself.
void try_pieces(const ImageFinder& finder, const FieldSample& wanted, Vec2 cell, bool same, Best& best) {
    const PositionField& field = finder.reference().field;
    const int column = static_cast<int>(cell.x), row = static_cast<int>(cell.y);
    SurfaceId piece = piece_of(wanted);
    if (same) piece.primitive = wanted.primitive;
    for (int corner = 0; corner < 4; ++corner) {
        const int x = column + corner % 2, y = row + corner / 2;
        if (!field.contains(x, y)) continue;
        const auto patch = make_patch(field, finder.test().field, {column, row, corner}, piece);
        if (!patch) continue;
        best.tried = true;
        const Vec2 from(wanted.column, wanted.row);
        const auto hit = invert_patch(*patch, wanted.point, glm::clamp(from - cell, Vec2(0), Vec2(1)));
        if (!hit) continue;
        const Vec2 shift = hit->uv + (cell - from);
        const double score =
            glm::length(shift) + kOvershootPenalty * hit->overshoot + (same ? 0 : kOtherPrimitivePenalty);
        if (score < best.score) best = {score, shift, true};
    }
}

void try_cell(const ImageFinder& finder, const FieldSample& wanted, Vec2 cell, Best& best) {
    if (!finder.reference().may_show(wanted.point, static_cast<int>(cell.x), static_cast<int>(cell.y)))
        return;
    best.tried = false;
    try_pieces(finder, wanted, cell, true, best);
    if (!best.tried) try_pieces(finder, wanted, cell, false, best);
}

/// What ImageFinder::find says of one point, by trying every cell of the image.
std::optional<Vec2> plain_find(const ImageFinder& finder, const FieldSample& wanted, double reach) {
    const PositionField& field = finder.reference().field;
    const std::size_t here = field.index(wanted.column, wanted.row);
    const bool is_shown = field.shows(here, piece_of(wanted));
    if (is_shown && field.point(here) == wanted.point) return Vec2(0);

    Best best{reach + kMostPenalty, std::nullopt};
    const auto [side_x, side_y] = likely_side(field, wanted);
    for (const int dy : {side_y, -side_y})
        for (const int dx : {side_x, -side_x}) {
            try_cell(finder, wanted, {wanted.column + std::min(dx, 0), wanted.row + std::min(dy, 0)}, best);
            if (best.shift && best.score < kSurelyNearest) return best.shift;
        }
    bool has_patch = false;
    for (int corner = 0; corner < 4; ++corner)
        has_patch = has_patch || make_patch(field, finder.test().field,
                                            {wanted.column - corner % 2, wanted.row - corner / 2, corner},
                                            piece_of(wanted));
    if (is_shown && !has_patch) {
        const auto shift = find_along_sliver(field, wanted);
        if (shift && glm::length(*shift) < best.score) best = {glm::length(*shift), shift};
    }
    if (best.shift && best.score <= 1) return best.shift;
    best.score = std::min(best.score, farthest_place(field, finder.test().field, wanted));
    for (int row = -1; row < field.height; ++row)
        for (int column = -1; column < field.width; ++column) try_cell(finder, wanted, {column, row}, best);
    return best.shift;
}

/// A field that moves from `first` by a smooth wave, by noise or not at all; with holes and several objects.
Image random_image(std::mt19937_64& random, int width, int height, double amount) {
    std::uniform_real_distribution<double> share(-1, 1);
    const double a = share(random), b = share(random), rough = random() % 3 ? 0 : 0.3 * amount;
    const bool is_folded = random() % 3 == 0, is_even = random() % 7 == 0;
    const int stripe = 3 + static_cast<int>(random() % 9);
    const unsigned holes = random() % 2 ? 40 : 1000000;
    return image_of(width, height, [&](double x, double y) {
        if (random() % holes == 0) return Seen{};
        const double u = x + amount * std::sin(0.3 * y + a) + rough * share(random),
                     v = y + amount * std::cos(0.2 * x + b) + rough * share(random);
        const double across = is_folded ? std::abs(u - width / 2.0) : u;
        const Vec3 p = is_even ? Vec3(1, 2, 3) : Vec3(across, v, 0.02 * across * v + 5);
        const auto part = static_cast<Id>(std::max(0.0, std::floor(u / stripe)));
        return Seen{static_cast<Id>(1 + part / 4 % 2), static_cast<Id>(part % 4), p};
    });
}

std::vector<FieldSample> points_of(const PositionField& field) {
    std::vector<FieldSample> points;
    for (std::size_t i = 0; i < field.links.size(); ++i)
        if (field.sees(i)) points.push_back(field.seen_point(i));
    return points;
}

bool same_bits(const std::optional<Vec2>& a, const std::optional<Vec2>& b) {
    if (a.has_value() != b.has_value()) return false;
    return !a || std::memcmp(&*a, &*b, sizeof *a) == 0;
}

}  // namespace

TEST_CASE("the image finder finds what trying every cell finds, to the last bit",
          "[measure][displacement][oracle][law]") {
    std::mt19937_64 random(11);
    std::size_t found = 0, none = 0, far = 0, wrong = 0, alone = 0;
    for (int trial = 0; trial < 30; ++trial) {
        const int width = 5 + static_cast<int>(random() % 30), height = 5 + static_cast<int>(random() % 24);
        const double amount = std::pow(10.0, std::uniform_real_distribution<double>(-3, 0.9)(random));
        const Image one = random_image(random, width, height, 0.0),
                    other = random_image(random, width, height, amount);
        const FieldPyramid reference(make_seen_field(one, "reflect").value()),
            test(make_seen_field(other, "reflect").value());
        const ImageFinder finder(reference, test);
        const std::vector<FieldSample> wanted = points_of(test.field);
        const double reach = trial % 3 ? std::numeric_limits<double>::infinity() : 4;
        const auto answers = finder.find(wanted, reach);
        REQUIRE(answers.size() == wanted.size());
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            const auto expected = plain_find(finder, wanted[i], reach);
            (expected ? found : none) += 1;
            far += expected && glm::length(*expected) > 1.5;
            wrong += !same_bits(answers[i], expected);
            if (i % 17 == 0) alone += !same_bits(finder.find({&wanted[i], 1}, reach)[0], expected);
        }
    }
    INFO(found << " found (" << far << " of them far), " << none << " not");
    CHECK(wrong == 0);
    CHECK(alone == 0);
    CHECK(found > 4000);
    CHECK(far > 500);
    CHECK(none > 500);
}

TEST_CASE("no patch of a cell answers for a point that the cell's reach does not hold",
          "[measure][displacement][law]") {
    std::mt19937_64 random(12);
    std::normal_distribution<double> normal;
    std::size_t hits = 0, outside = 0, held = 0, in_box = 0;
    for (int trial = 0; trial < 40; ++trial) {
        const double amount = std::pow(10.0, std::uniform_real_distribution<double>(-3, 1)(random));
        const Image one = random_image(random, 14, 11, amount), other = random_image(random, 14, 11, amount);
        const FieldPyramid index(make_seen_field(one, "reflect").value()),
            beside(make_seen_field(other, "reflect").value());
        for (int row = -1; row < 11; ++row)
            for (int column = -1; column < 14; ++column) {
                const FieldCellBounds reach = reach_of_cell(index, beside.field, column, row);
                for (int corner = 0; corner < 4; ++corner) {
                    const int x = column + corner % 2, y = row + corner / 2;
                    if (!index.field.contains(x, y)) continue;
                    const FieldSample seen = index.field.seen_point(index.field.index(x, y));
                    for (const bool whole : {false, true}) {
                        SurfaceId piece = piece_of(seen);
                        if (!whole) piece.primitive = seen.primitive;
                        const auto patch =
                            make_patch(index.field, beside.field, {column, row, corner}, piece);
                        if (!patch) continue;
                        for (int k = 0; k < 12; ++k) {
                            const double off = std::pow(10.0, -k / 4.0);
                            const Vec3 p = patch->nodes[5 + random() % 2 + 4 * (random() % 2)] +
                                           off * Vec3(normal(random), normal(random), 0.3 * normal(random));
                            const bool holds = reach.may_hold(p);
                            held += holds;
                            bool box = true;
                            for (int c = 0; c < 3; ++c)
                                box = box && p[c] >= static_cast<double>(reach.low[c]) &&
                                      p[c] <= static_cast<double>(reach.high[c]);
                            in_box += box;
                            if (!invert_patch(*patch, p, Vec2(0.5))) continue;
                            ++hits;
                            outside += !holds;
                        }
                    }
                }
            }
    }
    INFO(hits << " hits, " << held << " held, " << in_box << " in the box");
    CHECK(outside == 0);
    CHECK(hits > 20000);
    CHECK(held < in_box);
}

TEST_CASE("where a field's index says that a patch is whole, it is", "[measure][displacement]") {
    std::mt19937_64 random(13);
    std::size_t whole = 0, triangles = 0;
    for (int trial = 0; trial < 40; ++trial) {
        const Image image = random_image(random, 17, 15, 1), other = random_image(random, 17, 15, 1);
        const FieldPyramid index(make_seen_field(image, "reflect").value()),
            beside(make_seen_field(other, "reflect").value());
        for (int row = -1; row < 15; ++row)
            for (int column = -1; column < 17; ++column) {
                const std::uint8_t says = index.wholeness(column, row);
                for (int corner = 0; says && corner < 4; ++corner) {
                    const FieldSample seen =
                        index.field.seen_point(index.field.index(column + corner % 2, row + corner / 2));
                    SurfaceId piece = piece_of(seen);
                    auto patch = make_patch(index.field, beside.field, {column, row, corner}, piece);
                    REQUIRE(patch);
                    CHECK(patch->measured == 0xffff);
                    ++whole;
                    piece.primitive = seen.primitive;
                    patch = make_patch(index.field, beside.field, {column, row, corner}, piece);
                    if (says & FieldPyramid::kWholeTriangle) {
                        REQUIRE(patch);
                        CHECK(patch->measured == 0xffff);
                        ++triangles;
                    } else {
                        CHECK((!patch || patch->measured != 0xffff));
                    }
                }
            }
    }
    CHECK(whole > 4000);
    CHECK(triangles > 1000);
    CHECK(triangles < whole);
}
