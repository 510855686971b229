#include "paths/facets/optic_paths.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>

#include "paths/facets/divide_facet.h"

namespace trilens {

Id PathNode::facet_of(Id leaf) const {
    const auto found = std::lower_bound(leaves.begin(), leaves.end(), leaf);
    if (found == leaves.end() || *found != leaf) return kNone;
    const Id facet = static_cast<Id>(found - leaves.begin());
    return mesh.has_rays(facet) ? facet : kNone;
}

Id leaf_at(const OpticPaths& paths, Id facet, const Vec3& weights) {
    PathCell cell = paths.cells[facet];
    Vec3 local = weights;
    while (cell.children != kNone) {
        const int child = child_of(local);
        local = child_weights(local, child);
        cell = paths.cells[cell.children + static_cast<Id>(child)];
    }
    return cell.leaf;
}

std::vector<Id> nodes_in_order(const OpticPaths& paths) {
    std::vector<Id> order;
    const auto key = [&](Id n) {
        return std::tuple(paths.nodes[n].step.optic, paths.nodes[n].step.event, paths.nodes[n].colours,
                          paths.nodes[n].medium);
    };
    const std::function<void(Id)> visit = [&](Id parent) {
        std::vector<Id> children;
        for (std::size_t n = 0; n < paths.nodes.size(); ++n)
            if (paths.nodes[n].parent == parent) children.push_back(static_cast<Id>(n));
        std::sort(children.begin(), children.end(), [&](Id a, Id b) { return key(a) < key(b); });
        for (const Id child : children) {
            order.push_back(child);
            visit(child);
        }
    };
    visit(kNone);
    return order;
}

Id film_facet(const FilmWindow& window, const Vec2& pixel) {
    const Vec2 at = (pixel - window.low) / (window.high - window.low) * static_cast<double>(window.n);
    const auto cell = [&](double x) { return std::clamp(static_cast<int>(std::floor(x)), 0, window.n - 1); };
    const int i = cell(at.x), j = cell(at.y);
    const bool above = at.y - j > at.x - i;  // of the diagonal from (i, j)
    return static_cast<Id>(2 * (j * window.n + i) + (above ? 1 : 0));
}

}  // namespace trilens
