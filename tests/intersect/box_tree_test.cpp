// Boxes met by rays against brute force, with and without boxes so far away that the rest is dust.
#include "intersect/box_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <random>
#include <vector>

#include "support/test.h"

using namespace trilens;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Whether the ray meets the box at a t >= 0, by slabs in long double.
bool meets(const Box& box, const Ray& ray) {
    long double enter = 0, leave = kInfinity;
    for (int k = 0; k < 3; ++k) {
        const long double o = ray.origin[k], d = ray.direction[k];
        if (d == 0 && (o < box.low[k] || o > box.high[k])) return false;
        if (d == 0) continue;
        const long double a = (box.low[k] - o) / d, b = (box.high[k] - o) / d;
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    return enter <= leave;
}

std::vector<Id> visited(const BoxTree& tree, const Ray& ray) {
    std::vector<Id> boxes;
    tree.visit(ray, 0, kInfinity, [&](Id box) {
        boxes.push_back(box);
        return kInfinity;
    });
    std::sort(boxes.begin(), boxes.end());
    return boxes;
}

Vec3 random_vec(std::mt19937& random) {
    std::normal_distribution<double> normal;
    return {normal(random), normal(random), normal(random)};
}

/// Boxes of size 1e-3 about the origin.
std::vector<Box> dust(std::size_t count, std::mt19937& random) {
    std::vector<Box> boxes;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3 low = random_vec(random);
        boxes.push_back({low, low + 1e-3});
    }
    return boxes;
}

/// From somewhere about the boxes towards one of them.
Ray random_ray(const std::vector<Box>& boxes, std::mt19937& random) {
    const Box& target = boxes[random() % boxes.size()];
    const Vec3 origin = 3.0 * random_vec(random);
    return {origin, 0.5 * target.low + 0.5 * target.high - origin};
}

}  // namespace

TEST_CASE("every box that a ray meets is visited, once, wherever the boxes lie", "[intersect][truth][law]") {
    std::mt19937 random(50);
    std::uniform_real_distribution<double> exponent(0, 30);
    std::size_t met = 0;
    for (int round = 0; round < 40; ++round) {
        std::vector<Box> boxes = dust(300, random);
        for (unsigned k = random() % 200; k > 0; --k) {  // up to 1e30 away, of any size
            const Vec3 at = std::pow(10, exponent(random)) * random_vec(random);
            const Vec3 size = std::pow(10, exponent(random)) * glm::abs(random_vec(random));
            boxes.push_back({at, at + size});
        }
        const BoxTree tree(boxes);
        for (int i = 0; i < 100; ++i) {
            const Ray ray = random_ray(boxes, random);
            const std::vector<Id> found = visited(tree, ray);
            REQUIRE(std::adjacent_find(found.begin(), found.end()) == found.end());
            for (Id box = 0; box < boxes.size(); ++box) {
                if (!meets(boxes[box], ray)) continue;
                ++met;
                REQUIRE(std::binary_search(found.begin(), found.end(), box));
            }
        }
    }
    CHECK(met > 4000);
}

TEST_CASE("boxes far away leave the others told apart", "[intersect][truth]") {
    std::mt19937 random(51);
    for (const double distance : {0.0, 1e5, 1e9, 1e15, 1e30}) {
        std::vector<Box> boxes = dust(10000, random);
        if (distance > 0)
            for (const double share : {1e-3, 0.3, 1.0})
                boxes.push_back({Vec3(-1, -1, -1), Vec3(share * distance, 0, 0)});
        const BoxTree tree(boxes);
        std::size_t most = 0;
        boxes.resize(10000);
        for (int i = 0; i < 200; ++i) most = std::max(most, visited(tree, random_ray(boxes, random)).size());
        INFO(distance);
        CHECK(most < 40);
    }
}

TEST_CASE("what a visitor says ends the visit in every tree", "[intersect][truth][law]") {
    std::mt19937 random(52);
    std::vector<Box> boxes = dust(1000, random);
    for (const double far : {1e6, 1e12}) boxes.push_back({Vec3(-far), Vec3(far)});
    const BoxTree tree(boxes);
    for (int i = 0; i < 100; ++i) {
        std::size_t count = 0;
        tree.visit(random_ray(boxes, random), 0, kInfinity, [&](Id) {
            ++count;
            return -kInfinity;
        });
        CHECK(count == 1);
    }
}

TEST_CASE("what a visitor throws comes out of the visit", "[intersect][truth]") {
    const std::vector<Box> boxes{{Vec3(-1), Vec3(1)}, {Vec3(2, -1, -1), Vec3(3, 1, 1)}};
    const BoxTree tree(boxes);
    const Ray ray{{-5, 0.1, 0.2}, {1, 0, 0}};
    std::size_t asked = 0;
    CHECK_THROWS_AS(tree.visit(ray, 0, kInfinity,
                               [&](Id) -> double {
                                   ++asked;
                                   throw std::bad_alloc();
                               }),
                    std::bad_alloc);
    CHECK(asked >= 1);
    CHECK(visited(tree, ray).size() == 2);
}
