#include "specular/view_tree.h"

namespace trilens {
namespace {

/// So often cells within cells are asked whether they are hidden.
constexpr int kLooks = 5;

}  // namespace

ViewTree::ViewTree(const Surface& surface, const CellBvh& cells, const SpecularQuery& query, bool asks_rays)
    : surface_(surface),
      cells_(cells),
      query_(query),
      occlusion_(surface, cells),
      may_hide_(asks_rays && cells.occluder() && !query.camera.parallel) {
    begin_anew();
}

void ViewTree::begin_anew() {
    nodes_.clear();
    fresh_.clear();
    terms_.clear();
    faces_.assign(surface_.face_count(), nullptr);
    root_ = cells_.groups().empty() ? nullptr : add_group(cells_.groups().size() - 1);
}

TreeNode* ViewTree::add(const PlaceBounds& place) {
    TreeNode node;
    node.place = place;
    node.view = eye_view(query_, place);
    return &nodes_.add(node);
}

TreeNode* ViewTree::add_group(std::size_t index) {
    TreeNode* node = add(cells_.groups()[index].place);
    node->group = index;
    return node;
}

/// Whether the surface hides a cell of which one side is known to be turned to the eye. What is seen in the
/// middle is taken to be seen all over.
void ViewTree::look_at(TreeNode& cell) {
    if (cell.looks_left == 0 || cell.view.is_behind || !cell.view.knows_side) return;
    const auto ask = [&] { return occlusion_.look(query_.camera.eye, cell.box, *cell.bounds); };
    InSight sight = InSight::kUnknown;
    if (!cell.stored) {
        sight = ask();
    } else {
        const auto [known, is_new] = in_sight_.try_emplace(cell.stored, sight);
        if (is_new) known->second = ask();
        sight = known->second;
    }
    cell.view.is_behind = sight == InSight::kHidden;
    cell.looks_left = sight == InSight::kUnknown ? cell.looks_left - 1 : 0;
}

TreeNode* ViewTree::add_cell(const CellBox& box, const SurfaceBounds& bounds, const SurfaceCell* stored,
                             int looks_left) {
    TreeNode* node = add(place_of(bounds));
    node->box = box;
    node->bounds = &bounds;
    node->stored = stored;
    node->looks_left = looks_left;
    look_at(*node);
    return node;
}

TreeNode* ViewTree::add_stored(const SurfaceCell& cell, int looks_left) {
    if (is_outside(surface_.domain(cell.box.face), cell.box)) return nullptr;
    return add_cell(cell.box, cell.bounds, &cell, looks_left);
}

TreeNode* ViewTree::add_fresh(const CellBox& box, int looks_left) {
    if (is_outside(surface_.domain(box.face), box)) return nullptr;
    return add_cell(box, fresh_.add(cells_.bounder()->bounds(box.face, box.low, box.high)), nullptr,
                    looks_left);
}

TreeNode& ViewTree::face(Id face) {
    if (!faces_[face]) faces_[face] = add_stored(cells_.faces()[face], may_hide_ ? kLooks : 0);
    return *faces_[face];
}

const CellTerms& ViewTree::terms_of(TreeNode& cell) {
    if (!cell.terms) cell.terms = &terms_.add(cell_terms(query_, *cell.bounds, cell.view));
    return *cell.terms;
}

void ViewTree::halve(TreeNode& node) {
    if (node.is_halved) return;
    node.is_halved = true;
    if (!node.bounds) {
        const CellGroup& group = cells_.groups()[node.group];
        node.halves[0] = group.leaf ? &face(static_cast<Id>(group.first)) : add_group(group.first);
        node.halves[1] = group.leaf ? nullptr : add_group(group.second);
    } else if (const CellHalves* halves = node.stored ? cells_.halves(*node.stored) : nullptr) {
        for (std::size_t half = 0; half < 2; ++half)
            node.halves[half] = add_stored((*halves)[half], node.looks_left);
    } else {
        const auto [first, second] = halves_of(node.box, node.bounds->middle);
        node.halves[0] = add_fresh(first, node.looks_left);
        node.halves[1] = add_fresh(second, node.looks_left);
    }
}

}  // namespace trilens
