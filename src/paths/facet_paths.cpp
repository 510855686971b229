#include "paths/facet_paths.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/parallel.h"
#include "paths/divide_facet.h"
#include "paths/film_reach.h"
#include "paths/fit_nodes.h"
#include "paths/node_corner.h"

namespace trilens {
namespace {

constexpr std::size_t kCornersPerTask = 64, kFacetsPerTask = 16;
constexpr double kFainter = 1.0 / 8;  // as divide_facet has it
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

OpticPaths::OpticPaths(Looking looking, const SurfaceGrid& grid, DivideParams params)
    : looking_(std::move(looking)), grid_(&grid), params_(std::move(params)) {
    set_places(grid);
    outline_.screen.reserve(places_.size());
    for (const Place& place : places_) {
        outline_.screen.push_back(looking_.camera.screen(place.point));
        incident_.push_back(looking_.camera.ray(outline_.screen.back(), place.point).direction);
    }
}

OpticPaths::OpticPaths(Looking looking, const SurfaceGrid& grid, std::span<const CornerView> views,
                       DivideParams params)
    : looking_(std::move(looking)), grid_(&grid), params_(std::move(params)) {
    set_places(grid);
    for (const CornerView& view : views) {
        outline_.screen.push_back(view.screen);
        incident_.push_back(view.incident);
    }
}

void OpticPaths::set_places(const SurfaceGrid& grid) {
    places_.resize(grid.corner_point.size());
    for (std::size_t f = 0; f < grid.facets.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k) {
            const Id corner = grid.facets[f][k];
            places_[corner] = {grid.facet_face[f], grid.facet_uv[f][k],
                               grid.points[grid.corner_point[corner]], grid.corner_normal[corner]};
        }
    outline_.rays.resize(places_.size());
    outline_.facets = grid.facets;
    corner_looks_.resize(2 * places_.size());
    cells_.resize(grid.facets.size());
    prepared_.resize(grid.facets.size());
}

void OpticPaths::set_film_corner(Id corner, const Vec2& pixel) {
    // A point at the surface's depth first; where the ray meets the surface, that point.
    const Vec3 at = looking_.camera.affine ? Vec3(pixel, 1) : Vec3(pixel * window_.depth, window_.depth);
    Chord chord{at, looking_.camera.point(at), 2 * window_.reach};
    auto look = std::make_unique<Look>(
        look_through(looking_, chord, {.side = LookSide::kNearest, .least_weight = kFainter * kLeastWeight}));
    if (!params_.estimates) set_beside(looking_, *look);
    if (look->state != LookState::kMissed) {
        chord.point = look->place.point;
        if (!looking_.camera.affine) chord.screen = look->screen = looking_.camera.screen(chord.point);
        if (look->segments.size() > 1 ||
            (look->segments.size() == 1 && look->segments[0].step.event != Event::kReflect))
            set_kappa(looking_, *look);
        else
            look->kappa.assign(look->segments.size(), 1.0);
    }
    places_[corner].point = chord.point;
    outline_.screen[corner] = chord.screen;
    corner_looks_[2 * corner + 1] = std::move(look);
}

OpticPaths::OpticPaths(Looking looking, const FilmWindow& window, DivideParams params)
    : looking_(std::move(looking)), window_(window), params_(std::move(params)) {
    const Id n = static_cast<Id>(window.n), side = n + 1;
    const std::size_t corners = static_cast<std::size_t>(side) * side;
    places_.resize(corners);
    outline_.rays.resize(corners);
    outline_.screen.resize(corners);
    corner_looks_.resize(2 * corners);
    parallel_for(corners, kCornersPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t c = from; c < to; ++c) {
            const Vec2 share(static_cast<double>(c % side) / n, static_cast<double>(c / side) / n);
            set_film_corner(static_cast<Id>(c), window.low + share * (window.high - window.low));
        }
    });
    for (Id j = 0; j < n; ++j)
        for (Id i = 0; i < n; ++i) {
            const Id a = j * side + i, b = a + 1, c = b + side, d = a + side;
            outline_.facets.push_back({a, b, c});
            outline_.facets.push_back({a, c, d});
        }
    cells_.resize(outline_.facets.size());
    prepared_.resize(outline_.facets.size());
}

Id OpticPaths::film_facet(const Vec2& pixel) const {
    const Vec2 at = (pixel - window_.low) / (window_.high - window_.low) * static_cast<double>(window_.n);
    const auto cell = [&](double x) { return std::clamp(static_cast<int>(std::floor(x)), 0, window_.n - 1); };
    const int i = cell(at.x), j = cell(at.y);
    const bool above = at.y - j > at.x - i;  // of the diagonal from (i, j)
    return static_cast<Id>(2 * (j * window_.n + i) + (above ? 1 : 0));
}

OpticPaths::OpticPaths(Looking looking, const FirstPaths& first)
    : looking_(std::move(looking)), grid_(first.grid), ends_first_(true) {
    const SurfaceGrid& grid = *first.grid;
    const RayMesh *const reflection = first.reflection, *const refraction = first.refraction;
    outline_.facets = grid.facets;
    outline_.rays.resize(first.views.size());
    for (const CornerView& view : first.views) {
        outline_.screen.push_back(view.screen);
        incident_.push_back(view.incident);
    }
    cells_.resize(grid.facets.size());
    prepared_.resize(grid.facets.size());
    const std::size_t facets = grid.facets.size();
    for (std::size_t f = 0; f < facets; ++f) {
        leaves_.push_back({static_cast<Id>(f)});
        cells_[f].leaf = static_cast<Id>(f);
    }
    const Media around = looking_.camera.media(Vec3(0));
    const auto add = [&](const RayMesh& mesh, Event event, const Media& media) -> PathNode& {
        PathSegment segment;
        segment.step = {looking_.optic, event};
        segment.path = event == Event::kReflect ? Path::kReflect : Path::kRefract;
        segment.medium = felt_body(*looking_.world, media);
        PathNode& node = nodes_[node_of(kNone, segment)];
        node.mesh = mesh;
        node.ends.assign(facets, 1);
        node.principal.assign(facets, 1);
        node.next.assign(mesh.rays.size(), kInfinity);
        node.weight.assign(mesh.rays.size(), Vec3(1));
        return node;
    };
    if (reflection) add(*reflection, Event::kReflect, around);
    if (!refraction) return;
    // Facets seen from the front show what is in the glass, those seen from behind what is outside.
    for (const bool into : {true, false}) {
        const std::optional<MediaSides> sides = sides_of(around, looking_.optic, into);
        if (!sides) continue;
        const bool is_interface =
            felt_glass(*looking_.world, sides->before) != felt_glass(*looking_.world, sides->after);
        PathNode& node = add(*refraction, is_interface ? Event::kTransmit : Event::kPass, sides->after);
        for (std::size_t f = 0; f < facets; ++f)
            if (shows_front(static_cast<Id>(f)) != into) node.mesh.facets[f] = {kNone, kNone, kNone};
    }
}

bool OpticPaths::shows_front(Id facet) const {
    return !grid_ || faces_front(*grid_, grid_->facets[facet], incident_[grid_->facets[facet][0]]);
}

void OpticPaths::look_at_corners(std::span<const Id> facets) {
    std::vector<Id> wanted;  // corner and side
    for (const Id f : facets)
        for (const Id corner : outline_.facets[f]) {
            const Id key = 2 * corner + (shows_front(f) ? 1 : 0);
            if (!corner_looks_[key]) wanted.push_back(key);
        }
    std::sort(wanted.begin(), wanted.end());
    wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
    parallel_for(wanted.size(), kCornersPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            const bool front = wanted[i] % 2 == 1;
            const Id corner = wanted[i] / 2;
            auto look = std::make_unique<Look>(look_at(looking_, places_[corner],
                                                       {outline_.screen[corner], incident_[corner]},
                                                       {.side = front ? LookSide::kFront : LookSide::kBack,
                                                        .least_weight = kFainter * kLeastWeight}));
            if (!params_.estimates) set_beside(looking_, *look);
            // The first reflection alone needs no kappa.
            if (look->segments.size() > 1 ||
                (look->segments.size() == 1 && look->segments[0].step.event != Event::kReflect))
                set_kappa(looking_, *look);
            else
                look->kappa.assign(look->segments.size(), 1.0);
            corner_looks_[wanted[i]] = std::move(look);
        }
    });
}

bool OpticPaths::on_film(Id facet) const {
    const IdTriple& corner = outline_.facets[facet];
    const std::array<Vec3, 3> screen{outline_.screen[corner[0]], outline_.screen[corner[1]],
                                     outline_.screen[corner[2]]};
    const bool has_image = std::all_of(screen.begin(), screen.end(), [](const Vec3& s) { return s.z != 0; });
    return has_image && may_reach_film(screen, looking_.camera.film);
}

/// Those of `facets` that are not known, and those that are fitted with them; ascending.
std::vector<Id> OpticPaths::wanted_facets(std::span<const Id> facets) {
    std::vector<Id> fresh;
    std::array<bool, 2> begins{};
    for (const Id f : facets) {
        if (prepared_[f]) continue;
        fresh.push_back(f);
        begins[shows_front(f) ? 1 : 0] = true;
    }
    if (params_.fit)
        for (std::size_t side = 0; side < 2; ++side) {
            if (!begins[side] || side_fitted_[side]) continue;
            side_fitted_[side] = true;
            for (Id f = 0; f < outline_.facets.size(); ++f)
                if (shows_front(f) == (side == 1) && on_film(f)) fresh.push_back(f);
        }
    std::sort(fresh.begin(), fresh.end());
    fresh.erase(std::unique(fresh.begin(), fresh.end()), fresh.end());
    return fresh;
}

void OpticPaths::complete_nodes() {
    for (PathNode& node : nodes_) {
        node.mesh.facets.resize(leaves_.size(), {kNone, kNone, kNone});
        node.ends.resize(leaves_.size(), 1);
        node.principal.resize(leaves_.size(), 0);
    }
}

/// Which facets' paths there is room for, by what the looks at some corners take: the same whatever is asked
/// for first. A facet has four looks of its own and half a corner.
void OpticPaths::keep_room() {
    constexpr std::size_t kFew = 2048, kSample = 64;
    if (!has_room_.empty()) return;
    has_room_.assign(outline_.facets.size(), 1);
    std::vector<Id> shown, sample;
    for (Id f = 0; f < outline_.facets.size(); ++f)
        if (on_film(f)) shown.push_back(f);
    if (shown.size() <= kFew && params_.most_bytes >= DivideParams().most_bytes) return;
    for (std::size_t i = 0; i < shown.size(); i += std::max<std::size_t>(1, shown.size() / kSample))
        sample.push_back(shown[i]);
    look_at_corners(sample);
    double bytes = 0, looks = 0;
    for (const Id f : sample)
        for (const Id corner : outline_.facets[f]) {
            const Look& look = *corner_looks_[2 * corner + (shows_front(f) ? 1 : 0)];
            bytes += static_cast<double>(sizeof(Look) + look.segments.size() * sizeof(PathSegment));
            looks += 1;
        }
    const double room = static_cast<double>(params_.most_bytes) * looks / std::max(1.0, 4.5 * bytes);
    for (std::size_t i = 0; i < shown.size(); ++i) has_room_[shown[i]] = static_cast<double>(i) < room;
    crowded_out_ = static_cast<std::size_t>(std::count(has_room_.begin(), has_room_.end(), 0));
}

void OpticPaths::prepare(std::span<const Id> facets) {
    if (ends_first_) {
        for (const Id f : facets) {
            projected_count_ += !prepared_[f];
            prepared_[f] = 1;
        }
        return;
    }
    keep_room();
    const std::vector<Id> fresh = wanted_facets(facets);
    std::vector<Id> projected;
    std::copy_if(fresh.begin(), fresh.end(), std::back_inserter(projected),
                 [&](Id f) { return has_room_[f]; });
    look_at_corners(projected);

    std::vector<DividedFacet> divided(fresh.size());
    parallel_for(fresh.size(), kFacetsPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            FacetToDivide facet;
            const IdTriple& corners = outline_.facets[fresh[i]];
            if (!has_room_[fresh[i]]) {
                divided[i] = traced_facet(
                    {outline_.screen[corners[0]], outline_.screen[corners[1]], outline_.screen[corners[2]]});
                continue;
            }
            const bool front = shows_front(fresh[i]);
            facet.side = !grid_ ? LookSide::kNearest : front ? LookSide::kFront : LookSide::kBack;
            facet.reach = grid_ ? 0 : 2 * window_.reach;
            for (std::size_t k = 0; k < 3; ++k) {
                const Id key = 2 * corners[k] + (front ? 1 : 0);
                facet.corners[k] = {key, corner_looks_[key].get(), places_[corners[k]].point};
            }
            divided[i] = divide_facet(looking_, facet, params_);
        }
    });
    std::vector<FittedLeaf> whole, open;
    for (std::size_t i = 0; i < fresh.size(); ++i) {
        prepared_[fresh[i]] = 1;
        const Id first_leaf = static_cast<Id>(leaves_.size());
        append(fresh[i], fresh[i], divided[i]);
        for (std::size_t p = 0; p < divided[i].parts.size(); ++p) {
            const FittedLeaf leaf{static_cast<Id>(first_leaf + p), &divided[i].parts[p]};
            if (leaf.part->method != LeafMethod::kProjected) continue;
            open.push_back(leaf);
            if (leaf.part->level == 0)
                whole.push_back(leaf);
            else if (params_.fit)
                fit_alone(leaf, nodes_);
        }
    }
    complete_nodes();
    if (params_.fit) fit_nodes(whole, nodes_);
    divide_by_error(open);
}

/// Cell 0 of `divided` becomes `cell`, the others stand at the end.
void OpticPaths::append(Id facet, Id cell, DividedFacet& divided) {
    const Id first_leaf = static_cast<Id>(leaves_.size()), behind = static_cast<Id>(cells_.size()) - 1;
    const auto number = [&](std::size_t c) { return c == 0 ? cell : behind + static_cast<Id>(c); };
    cells_.resize(cells_.size() + divided.cells.size() - 1);
    leaf_cell_.resize(leaves_.size() + divided.parts.size(), kNone);
    for (std::size_t c = 0; c < divided.cells.size(); ++c) {
        const DividedFacet::Cell& from = divided.cells[c];
        cells_[number(c)] = {from.children == kNone ? kNone : number(from.children),
                             from.part == kNone ? kNone : first_leaf + from.part};
        if (from.part != kNone) leaf_cell_[first_leaf + from.part] = number(c);
    }
    for (FacetPart& part : divided.parts) {
        leaves_.push_back({facet, part.level, part.method, part.centre, 0, part.layered});
        if (part.method != LeafMethod::kProjected) continue;
        ++projected_count_;
        append_part(static_cast<Id>(leaves_.size() - 1), part);
    }
    cut_.faint = std::max(cut_.faint, divided.cut.faint);
    cut_.too_deep = std::max(cut_.too_deep, divided.cut.too_deep);
    cut_.lost = std::max(cut_.lost, divided.cut.lost);
}

Id OpticPaths::node_of(Id parent, const PathSegment& segment) {
    const auto [found, added] = node_by_step_.insert(
        {{parent, segment.step.optic, segment.step.event, segment.colours, segment.medium},
         static_cast<Id>(nodes_.size())});
    if (!added) return found->second;
    PathNode node;
    node.parent = parent;
    node.step = segment.step;
    node.path = segment.path;
    node.colours = segment.colours;
    node.medium = segment.medium;
    node.unfolds = segment.step.event != Event::kTransmit && !looking_.camera.parallel;
    if (parent != kNone) {
        node.unfolds = node.unfolds && nodes_[parent].unfolds;
        node.step_count = static_cast<std::uint16_t>(nodes_[parent].step_count + 1);
    }
    nodes_.push_back(std::move(node));
    corner_of_node_.emplace_back();
    return found->second;
}

void OpticPaths::append_part(Id leaf, FacetPart& part) {
    std::vector<Id>& node_index = part.node;
    node_index.assign(part.histories.size(), kNone);
    const bool alone = params_.fit && part.level > 0;  // fitted by itself
    for (std::size_t h = 0; h < part.histories.size(); ++h) {
        const PathSegment& history = part.histories[h];
        node_index[h] = node_of(history.parent == kNone ? kNone : node_index[history.parent], history);
        PathNode& node = nodes_[node_index[h]];
        const bool first = node.parent == kNone && node.step.event == Event::kReflect;

        // Kappa of corners where it is not known: the others' mean.
        std::array<double, 3> kappa{0, 0, 0};
        double sum = 0, known = 0;
        for (std::size_t k = 0; k < 3 && !first; ++k) {
            kappa[k] = part.corners[k].look->kappa[part.segment[k][h]];
            sum += kappa[k];
            known += kappa[k] > 0;
        }
        IdTriple facet{};
        for (std::size_t k = 0; k < 3; ++k) {
            const Look& look = *part.corners[k].look;
            const bool seen = !part.segment[k].empty();
            const PathSegment* segment = seen ? &look.segments[part.segment[k][h]] : nullptr;
            const bool guessed = !first && kappa[k] == 0;
            const Id shared = guessed || alone ? kNone : part.corners[k].shared;
            if (shared != kNone) {
                const auto found = corner_of_node_[node_index[h]].find(shared);
                if (found != corner_of_node_[node_index[h]].end()) {
                    facet[k] = found->second;
                    continue;
                }
            }
            const double mean = known > 0 ? sum / known : 1;
            const NodeCorner corner =
                first ? first_reflection(look, segment)
                      : later_corner(look, *segment, guessed ? mean : kappa[k], node.unfolds);
            facet[k] = static_cast<Id>(node.mesh.rays.size());
            node.mesh.rays.push_back(corner.ray);
            node.mesh.screen.push_back(corner.screen);
            node.next.push_back(corner.next);
            node.weight.push_back(corner.weight);
            if (shared != kNone) corner_of_node_[node_index[h]].insert({shared, facet[k]});
        }
        node.mesh.facets.resize(leaf + 1, {kNone, kNone, kNone});
        node.mesh.facets[leaf] = facet;
        node.ends.resize(leaf + 1, 1);
        node.ends[leaf] = history.ends;
        node.principal.resize(leaf + 1, 0);
        node.principal[leaf] = history.principal;
    }
}

Id OpticPaths::leaf_at(Id facet, const Vec3& weights) const {
    Cell cell = cells_[facet];
    Vec3 local = weights;
    while (cell.children != kNone) {
        const int child = child_of(local);
        local = child_weights(local, child);
        cell = cells_[cell.children + static_cast<Id>(child)];
    }
    return cell.leaf;
}

std::vector<Id> OpticPaths::nodes_in_order() const {
    std::vector<Id> order;
    const auto key = [&](Id n) {
        return std::tuple(nodes_[n].step.optic, nodes_[n].step.event, nodes_[n].colours, nodes_[n].medium);
    };
    const std::function<void(Id)> visit = [&](Id parent) {
        std::vector<Id> children;
        for (std::size_t n = 0; n < nodes_.size(); ++n)
            if (nodes_[n].parent == parent) children.push_back(static_cast<Id>(n));
        std::sort(children.begin(), children.end(), [&](Id a, Id b) { return key(a) < key(b); });
        for (const Id child : children) {
            order.push_back(child);
            visit(child);
        }
    };
    visit(kNone);
    return order;
}

}  // namespace trilens
