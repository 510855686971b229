// Kinds of faces that many have: what is made of them once, and how much of it.
#include "surfaces/polynomial/few_points.h"

#include <memory>
#include <vector>

#include "support/test.h"

using namespace trilens;

namespace {

/// Of one control point and `rows` more.
std::unique_ptr<const KindPoints> points_of(std::size_t rows) {
    const auto only_point = [](const Vec2&) { return std::vector<int>{0}; };
    return std::make_unique<KindPoints>(
        KindPoints{std::vector<double>(rows), SubPatches(FaceDomain::kSquare, 1, only_point)});
}

}  // namespace

TEST_CASE("Kinds that many ask for are made once, until their budget is full, and stay", "[surfaces][law]") {
    constexpr int kKinds = 100, kRounds = 200;
    const std::size_t each = points_of(1000)->bytes(), budget = 10 * each - 1;
    ManyKinds kinds(budget);
    int made = 0;
    const auto ask = [&](std::uint64_t kind) {
        return kinds.of(kind, [&] {
            ++made;
            return points_of(1000);
        });
    };
    for (int i = 0; i < 10; ++i) REQUIRE(ask(0) == nullptr);  // few until now
    for (int round = 0; round < kRounds; ++round)
        for (std::uint64_t kind = 0; kind < kKinds; ++kind) ask(kind);
    CHECK(made == 10);
    CHECK(kinds.bytes() == 10 * each);

    const KindPoints* first = ask(0);
    REQUIRE(first != nullptr);
    CHECK(first->rows.size() == 1000);
    CHECK(ask(0) == first);
    CHECK(ask(kKinds - 1) == nullptr);
    CHECK(made == 10);
}
