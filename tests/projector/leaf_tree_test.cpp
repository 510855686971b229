// The wide tree: every triangle in one leaf, inside every box above it; a leaf's floats are its corners.
#include "projector/scene/bvh.h"

#include <memory>

#include "base/util/parallel.h"
#include "random_cases.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

struct Count {
    std::vector<int> seen;
    std::size_t outside = 0, inexact = 0, wide = 0;
};

struct FloatBounds {
    Vec3 low{-1e300}, high{1e300};  // from the tree's centre
};

void visit(const PreparedScene::Data& data, std::int32_t child, const FloatBounds& above, Count& count) {
    const LeafTree& tree = data.leaves;
    if (child >= 0) {
        const WideNode& node = tree.nodes[static_cast<std::size_t>(child)];
        count.wide += node.count >= 2;
        for (std::size_t k = 0; k < node.count; ++k) {
            const FloatBounds box{Vec3(node.low[0][k], node.low[1][k], node.low[2][k]),
                                  Vec3(node.high[0][k], node.high[1][k], node.high[2][k])};
            visit(data, node.child[k], box, count);
        }
        return;
    }
    const Leaf& leaf = tree.leaves[static_cast<std::size_t>(~child)];
    const Vec3 centre(leaf.centre[0], leaf.centre[1], leaf.centre[2]);
    for (std::size_t k = 0; k < leaf.count; ++k) {
        ++count.seen[leaf.triangle[k]];
        for (std::size_t c = 0; c < 3; ++c) {
            const Vec3 exact = data.corner(c, leaf.triangle[k], centre);
            const Vec3 stored(leaf.x[c][k], leaf.y[c][k], leaf.z[c][k]);
            const Vec3 from_tree = data.corner(c, leaf.triangle[k], tree.centre);
            for (int a = 0; a < 3; ++a) {
                count.inexact += std::fabs(stored[a] - exact[a]) > 0x1p-24 * std::fabs(exact[a]);
                count.outside += std::fabs(stored[a]) > leaf.half[a] || from_tree[a] < above.low[a] ||
                                 from_tree[a] > above.high[a] || std::fabs(from_tree[a]) > tree.half[a];
            }
        }
    }
}

}  // namespace

TEST_CASE("every triangle is in one leaf, inside all boxes above it", "[projector][law]") {
    Random random(31);
    for (const int size : {1, 16, 17, 40, 300, 5000}) {
        for (int i = 0; i < 5; ++i) {
            Frame frame = random_frame(random);
            if (i == 4) frame.offset = random.in_cube(1e6);
            const TriangleScene scene = random_triangles(random, frame, size);
            const PreparedScene prepared(scene);
            Count count;
            count.seen.resize(scene.size(), 0);
            visit(prepared.data(), prepared.data().leaves.root, {}, count);
            CHECK(std::count(count.seen.begin(), count.seen.end(), 1) ==
                  static_cast<std::ptrdiff_t>(scene.size()));
            CHECK(count.outside == 0);
            CHECK(count.inexact == 0);
            CHECK(count.wide == prepared.data().leaves.nodes.size());
        }
    }
}

TEST_CASE("triangles that all coincide still make a tree", "[projector]") {
    constexpr int kCount = 5000;
    TriangleScene scene;
    for (int i = 0; i < kCount; ++i) add_triangle(scene, {0, 0, 1}, {1, 0, 1}, {0, 1, 1});
    const PreparedScene prepared(scene);
    Count count;
    count.seen.resize(scene.size(), 0);
    visit(prepared.data(), prepared.data().leaves.root, {}, count);
    CHECK(std::count(count.seen.begin(), count.seen.end(), 1) == kCount);
}

TEST_CASE("a large triangle shares no leaf with small ones", "[projector]") {
    Random random(33);
    for (const int small : {1, 30, 300, 5000}) {
        for (const int large : {1, 12, 40}) {
            if (small + large <= static_cast<int>(kLanes)) continue;
            const auto is_large = [&](Id place) { return static_cast<int>(place) < large; };
            TriangleScene scene;
            for (int i = 0; i < small + large; ++i) {
                const double half = is_large(static_cast<Id>(i)) ? 9 : 0.1;
                const Vec3 p = random.in_cube(10 - half);
                add_triangle(scene, p, p + Vec3(half, 0, 0.1 * half), p + Vec3(0, half, half));
            }
            const PreparedScene prepared(scene);
            Count count;
            count.seen.resize(scene.size(), 0);
            visit(prepared.data(), prepared.data().leaves.root, {}, count);
            CHECK(std::count(count.seen.begin(), count.seen.end(), 1) == small + large);
            CHECK(count.outside == 0);
            for (const Leaf& leaf : prepared.data().leaves.leaves) {
                std::uint32_t of_large = 0;
                for (std::size_t k = 0; k < leaf.count; ++k)
                    of_large += is_large(prepared.data().triangles[leaf.triangle[k]].triangle());
                CHECK((of_large == 0 || of_large == leaf.count));
            }
        }
    }
}

TEST_CASE("any number of threads makes the same tree", "[projector][law]") {
    Random random(32);
    const TriangleScene scene = random_triangles(random, random_frame(random), 40000);
    std::vector<std::unique_ptr<PreparedScene>> made;
    for (const int threads : {1, 2, 5}) {
        set_thread_count(threads);
        made.push_back(std::make_unique<PreparedScene>(scene));
    }
    set_thread_count(0);
    const PreparedScene::Data& one = made.front()->data();
    for (const auto& prepared : made) {
        const PreparedScene::Data& other = prepared->data();
        CHECK(other.leaves.root == one.leaves.root);
        REQUIRE(other.leaves.nodes.size() == one.leaves.nodes.size());
        for (std::size_t i = 0; i < one.leaves.nodes.size(); ++i) {
            const WideNode &a = one.leaves.nodes[i], &b = other.leaves.nodes[i];
            REQUIRE(std::equal(&a.low[0][0], &a.low[0][0] + 3 * kLanes, &b.low[0][0]));
            REQUIRE(std::equal(&a.high[0][0], &a.high[0][0] + 3 * kLanes, &b.high[0][0]));
            REQUIRE(std::equal(a.child, a.child + kLanes, b.child));
        }
        for (std::size_t i = 0; i < one.size(); ++i)
            REQUIRE(other.triangles[i].triangle() == one.triangles[i].triangle());
    }
}
