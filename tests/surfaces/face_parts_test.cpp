// Faces taken apart by their kind against the same faces taken apart one by one.
#include "surfaces/polynomial/face_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>

#include "support/test.h"
#include "surfaces/surfaces.h"
#include "test_cages.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// A rough sheet of triangles: every face of its surface has extraordinary corners. With a crease or without.
Cage rough_sheet(int n, bool has_crease) {
    const Vec3 offset(3, -2, 5);
    std::mt19937 engine(3);
    const auto noise = [&] { return 0.3 * (static_cast<double>(engine()) / 4294967296.0 - 0.5); };
    std::vector<Vec3> points;
    std::vector<std::vector<int>> faces;
    for (int y = 0; y <= n; ++y)
        for (int x = 0; x <= n; ++x) points.push_back(offset + Vec3(x + noise(), y + noise(), noise()));
    const auto at = [&](int x, int y) { return y * (n + 1) + x; };
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const int a = at(x, y), b = at(x + 1, y), c = at(x + 1, y + 1), d = at(x, y + 1);
            faces.insert(faces.end(), {{a, b, c}, {a, c, d}});
        }
    Cage cage = make_cage(points, faces);
    if (has_crease) {
        std::vector<int> chain;
        for (int x = 0; x <= n; ++x) chain.push_back(at(x, n / 2));
        add_crease(cage, chain, 10);
    }
    return cage;
}

struct Apart {
    int by_kind = 0, alone = 0, other_branches = 0;
    double worst = 0;       // between the two ways' positions
    double most_slack = 0;  // of the positions, of the parts' sizes
};

void compare(const TakenFace& one, const TakenFace& other, Apart& apart) {
    const auto same_branch = [](const PartBranch& a, const PartBranch& b) {
        return a.shape.corner == b.shape.corner && a.shape.size == b.shape.size && a.is_part == b.is_part;
    };
    if (!std::ranges::equal(one.branches, other.branches, same_branch)) {
        ++apart.other_branches;
        return;
    }
    for (std::size_t k = 0; k < one.parts.size(); ++k) {
        const FacePart &a = one.parts[k], &b = other.parts[k];
        if (a.is_polynomial != b.is_polynomial) ++apart.other_branches;
        if (!a.is_polynomial) continue;
        for (std::size_t p = 0; p < a.net.points().size(); ++p) {
            const Vec3 off = a.net.point[p] + a.origin - b.net.point[p] - b.origin;
            apart.worst = std::max(apart.worst, length(off));
        }
        apart.most_slack = std::max(apart.most_slack, a.slack[0] / a.shape.size);
    }
}

}  // namespace

TEST_CASE("faces taken apart by their kind are those taken apart alone, to rounding", "[surfaces][law]") {
    for (const bool has_crease : {false, true}) {
        const auto surface = make_limit_surface(rough_sheet(9, has_crease), "sheet", {});
        const FaceTaker taker(*surface);
        Apart apart;
        for (Id face = 0; face < surface->face_count(); ++face) {
            if (!taker.is_of_kind(face)) continue;
            const TakenFace taken = taker.take(face);
            ++(taken.by_kind ? apart.by_kind : apart.alone);
            compare(taken, take_apart(*surface, face), apart);
        }
        CAPTURE(has_crease, apart.by_kind, apart.worst, apart.most_slack);
        CHECK(apart.by_kind > 15);
        CHECK(apart.alone == 0);
        CHECK(apart.other_branches == 0);
        CHECK(apart.worst < 1e-12);
        CHECK(apart.worst > 0);
        CHECK(apart.most_slack < 1e-10);
    }
}

TEST_CASE("no place of faces taken apart by their kind lies outside their bounds", "[surfaces][law]") {
    for (const bool has_crease : {false, true}) {
        const auto surface = make_limit_surface(rough_sheet(9, has_crease), "sheet", {});
        const auto bounder = surface->make_bounder();
        std::mt19937 engine(8);
        const auto uniform = [&] { return static_cast<double>(engine()) / 4294967296.0; };
        int outside = 0;
        for (int k = 0; k < 20000; ++k) {
            const Id face = static_cast<Id>(engine() % surface->face_count());
            const double size = std::ldexp(1, -static_cast<int>(engine() % 21));
            const bool at_corner = engine() % 2 == 0;
            const Vec2 low = at_corner ? Vec2(0) : (1 - size) * Vec2(uniform(), uniform());
            const SurfaceBounds bounds = bounder->bounds(face, low, low + size);
            const SurfacePoint point = surface->eval(face, low + size * Vec2(uniform(), uniform()));
            const std::array<double, kQuantities> radius{bounds.position_radius, bounds.du_radius,
                                                         bounds.dv_radius,       bounds.duu_radius,
                                                         bounds.duv_radius,      bounds.dvv_radius};
            for (std::size_t q = 0; q < kQuantities; ++q)
                if (!(length(point.*kQuantity[q] - bounds.middle.*kQuantity[q]) <= radius[q])) ++outside;
            if (!(length(point.normal - bounds.middle.normal) <= bounds.normal_radius)) ++outside;
        }
        CAPTURE(has_crease);
        CHECK(outside == 0);
    }
}
