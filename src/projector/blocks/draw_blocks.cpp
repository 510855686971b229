// The engine in its plain form: for each block of a facet's samples, the scene's tree is walked with the
// block's beam. Slow, in double throughout: what the vector engine is tested against, and where it turns to.
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "base/util/parallel.h"
#include "projector/blocks/beam.h"
#include "projector/blocks/block_rays.h"
#include "projector/blocks/draw_blocks.h"
#include "projector/blocks/triangle_in_block.h"
#include "projector/exact/first_hits.h"
#include "projector/exact/sample_blocks.h"
#include "projector/scene/prepared_data.h"

namespace trilens {
namespace {

/// A node of the tree that waits, and the smallest t at which a ray of the block can meet it.
struct WaitingBox {
    Id node = 0;
    double nearest = 0;
};

class BlockDrawing {
  public:
    BlockDrawing(const PreparedScene::Data& scene, const BlockRays& block)
        : scene_(scene), block_(block), beam_(block), hits_(block.count) {}

    void draw_all() {
        const auto pass = [&] {
            for (std::size_t i = 0; i < scene_.size(); ++i) draw_one(static_cast<Id>(i));
        };
        pass();
        if (hits_.order_mattered()) hits_.begin_second_pass(), pass();
    }

    void draw_culled(std::vector<WaitingBox>& stack) {
        walk(stack);
        if (hits_.order_mattered()) hits_.begin_second_pass(), walk(stack);
    }

    Hit hit(std::size_t s) const;

  private:
    void draw_one(Id index);
    void push_if_reached(const Bvh& bvh, Id node, std::vector<WaitingBox>& stack) const;
    void walk(std::vector<WaitingBox>& stack);

    const PreparedScene::Data& scene_;
    const BlockRays& block_;
    Beam beam_;
    FirstHits hits_;
};

void BlockDrawing::draw_one(Id index) {
    const LocalTriangle triangle{
        {scene_.corner(0, index, block_.centre), scene_.corner(1, index, block_.centre),
         scene_.corner(2, index, block_.centre)},
        index,
        scene_.rank(index)};
    draw_triangle(block_, triangle, hits_);
}

void BlockDrawing::push_if_reached(const Bvh& bvh, Id node, std::vector<WaitingBox>& stack) const {
    const Box& world = bvh.nodes[node].box;
    const Box box{world.low - block_.centre, world.high - block_.centre};
    if (!beam_.misses(box)) stack.push_back({node, beam_.nearest(box)});
}

void BlockDrawing::walk(std::vector<WaitingBox>& stack) {
    const Bvh& bvh = scene_.bvh();
    stack.clear();
    if (!bvh.nodes.empty()) push_if_reached(bvh, 0, stack);
    while (!stack.empty()) {
        const WaitingBox next = stack.back();
        stack.pop_back();
        if (next.nearest > hits_.farthest()) continue;
        const BvhNode& node = bvh.nodes[next.node];
        if (node.count > 0) {
            for (Id i = node.first; i < node.first + node.count; ++i) draw_one(bvh.order[i]);
            continue;
        }
        // The nearer child is put on top, so that what it hides need not be looked at.
        const std::size_t before = stack.size();
        push_if_reached(bvh, node.first, stack);
        push_if_reached(bvh, node.first + 1, stack);
        if (stack.size() == before + 2 && stack[before].nearest < stack[before + 1].nearest) {
            std::swap(stack[before], stack[before + 1]);
        }
    }
}

Hit BlockDrawing::hit(std::size_t s) const {
    const Id winner = hits_.winner(s);
    return winner == kNone ? Hit{} : scene_hit(scene_, winner, hits_.hit(s));
}

}  // namespace

void draw_block(const PreparedScene::Data& scene, const FacetRays& facet, const SampleGrid& grid,
                std::span<const Id> samples, std::span<Hit> hits) {
    std::vector<WaitingBox> stack;
    const BlockRays rays = make_block_rays(facet, grid, samples);
    BlockDrawing drawing(scene, rays);
    drawing.draw_culled(stack);
    for (std::size_t s = 0; s < samples.size(); ++s) hits[s] = drawing.hit(s);
}

void draw_in_blocks(const PreparedScene& scene, const RayMesh& mesh, const FacetSamples& owned,
                    const SampleGrid& grid, std::span<Hit> hits, bool cull) {
    const std::vector<Strip> strips = make_strips(owned, grid);
    parallel_for(strips.size(), 1, [&](std::size_t first, std::size_t last) {
        std::vector<WaitingBox> stack;
        for (std::size_t i = first; i < last; ++i) {
            const Strip& strip = strips[i];
            if (!mesh.has_rays(strip.facet)) continue;
            const FacetOnScreen on_screen{mesh, strip.facet, facet_weights(mesh, strip.facet)};
            if (on_screen.weights.edge_on) continue;
            const FacetRays facet = make_facet_rays(on_screen);
            const std::span<const Id> samples(owned.sample.data() + strip.first, strip.last - strip.first);
            for_each_block(samples, grid, [&](std::span<const Id> block) {
                const BlockRays rays = make_block_rays(facet, grid, block);
                BlockDrawing drawing(scene.data(), rays);
                if (cull) drawing.draw_culled(stack);
                if (!cull) drawing.draw_all();
                for (std::size_t s = 0; s < block.size(); ++s) hits[block[s]] = drawing.hit(s);
            });
        }
    });
}

}  // namespace trilens
