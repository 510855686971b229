// The tree holds every item once, below boxes that hold it, and is the same for any number of threads.
#include "projector/scene/bvh.h"

#include <limits>
#include <random>

#include "base/util/parallel.h"
#include "support/test.h"

using namespace trilens;

namespace {

std::vector<Box> random_boxes(std::size_t count, const Vec3& centre, double size) {
    std::mt19937 random(static_cast<unsigned>(count));
    std::uniform_real_distribution<double> unit(-1, 1);
    std::vector<Box> boxes(count);
    for (Box& box : boxes) {
        const Vec3 at = centre + size * Vec3(unit(random), unit(random), unit(random));
        box.include(at);
        box.include(at + size * 0.01 * Vec3(unit(random), unit(random), unit(random)));
    }
    return boxes;
}

Bvh tree_over(const std::vector<Box>& boxes) {
    Bvh bvh = build_bvh(boxes.size(), [&](Id i) { return boxes[i]; });
    fit_boxes(bvh, [&](Id place) { return boxes[bvh.order[place]]; });
    return bvh;
}

bool holds(const Box& outer, const Box& inner) {
    return glm::all(glm::lessThanEqual(outer.low, inner.low)) &&
           glm::all(glm::greaterThanEqual(outer.high, inner.high));
}

/// How often each item is met, below nodes whose boxes all hold it.
std::vector<int> met_items(const Bvh& bvh, const std::vector<Box>& boxes) {
    std::vector<int> met(boxes.size());
    std::vector<std::pair<Id, std::vector<Id>>> open{{0, {}}};
    while (!open.empty()) {
        auto [node, above] = open.back();
        open.pop_back();
        above.push_back(node);
        const BvhNode& now = bvh.nodes[node];
        if (now.count == 0) {
            CHECK(now.first > node);
            open.push_back({now.first, above});
            open.push_back({now.first + 1, above});
        }
        for (Id i = now.first; now.count > 0 && i < now.first + now.count; ++i) {
            const Id item = bvh.order[i];
            bool held = true;
            for (const Id up : above) held = held && holds(bvh.nodes[up].box, boxes[item]);
            met[item] += held;
        }
    }
    return met;
}

}  // namespace

TEST_CASE("every item stands once in the tree, in boxes that hold it", "[projector][bvh][law]") {
    const std::size_t count = GENERATE(1u, 2u, 5u, 17u, 1000u, 20000u);
    const double size = GENERATE(1.0, 1e-4, 1e300), far = GENERATE(0.0, 1e6);
    const std::vector<Box> boxes = random_boxes(count, Vec3(far, -far, far), size);
    const Bvh bvh = tree_over(boxes);
    CHECK(met_items(bvh, boxes) == std::vector<int>(count, 1));
}

TEST_CASE("items in one place are a tree as well", "[projector][bvh]") {
    const std::vector<Box> boxes(5000, random_boxes(1, Vec3(3), 1)[0]);
    const Bvh bvh = tree_over(boxes);
    CHECK(met_items(bvh, boxes) == std::vector<int>(boxes.size(), 1));
    CHECK(build_bvh(0, [](Id) { return Box(); }).nodes.empty());
}

TEST_CASE("the tree is cut where it pays", "[projector][bvh]") {
    // Two far clusters: the root's children are they, and their boxes are small.
    std::vector<Box> boxes = random_boxes(3000, Vec3(0), 1);
    const std::vector<Box> other = random_boxes(3001, Vec3(1000, 0, 0), 1);
    boxes.insert(boxes.end(), other.begin(), other.end());
    const Bvh bvh = tree_over(boxes);
    for (const Id child : {bvh.nodes[0].first, bvh.nodes[0].first + 1})
        CHECK(bvh.nodes[child].box.size().x < 3);
}

TEST_CASE("the same boxes give the same tree for any number of threads", "[projector][bvh][law]") {
    const std::vector<Box> boxes = random_boxes(50000, Vec3(5), 2);
    set_thread_count(1);
    const Bvh one = tree_over(boxes);
    set_thread_count(5);
    const Bvh five = tree_over(boxes);
    set_thread_count(0);
    CHECK(one.order == five.order);
    REQUIRE(one.nodes.size() == five.nodes.size());
    bool same = true;
    for (std::size_t n = 0; n < one.nodes.size(); ++n)
        same = same && one.nodes[n].first == five.nodes[n].first &&
               one.nodes[n].count == five.nodes[n].count && one.nodes[n].box.low == five.nodes[n].box.low &&
               one.nodes[n].box.high == five.nodes[n].box.high;
    CHECK(same);
}
