#include "radiosity/element_mesh.h"

#include <algorithm>
#include <utility>

#include "base/raymesh/triangle_corners.h"

namespace trilens {
namespace {

using Coordinates = std::array<double, 3>;

bool is_lit_triangle(const World& world, Id triangle) {
    return !world.shading.materials[world.shading.material[triangle]].unlit;
}

/// One point of the triangle scene per corner.
void append_triangle(const std::array<Vec3, 3>& corners, Id object, Id primitive, TriangleScene& scene) {
    const auto first = static_cast<Id>(scene.points.size());
    scene.points.insert(scene.points.end(), corners.begin(), corners.end());
    scene.triangles.push_back({first, first + 1, first + 2});
    scene.object.push_back(object);
    scene.primitive.push_back(primitive);
}

}  // namespace

ElementMesh::ElementMesh(const World& world) : world_(world), parts_(world.scene.meshes.size()) {
    for (std::size_t m = 0; m < parts_.size(); ++m) {
        const ObjectMesh& object = world.scene.meshes[m].object;
        parts_[m].object.points = object.points;
        parts_[m].object.triangles = object.triangles;
        parts_[m].object.material = object.material;
        parts_[m].splitter = std::make_unique<TriangleSplitter>(parts_[m].object);
        parts_[m].element.assign(object.triangles.size(), kNone);
    }
    std::map<Coordinates, Id> known;
    for (Id t = 0; t < world.objects.size(); ++t) {
        if (!is_lit_triangle(world, t)) continue;
        const Id mesh = world.objects.object[t], number = world.objects.primitive[t];
        parts_[mesh].element[number] = static_cast<Id>(elements_.size());
        elements_.push_back({mesh, number, t, kNone});
        IdTriple places;
        const std::array<Vec3, 3> corner = corners_of(world.objects, t);
        for (std::size_t k = 0; k < 3; ++k)
            places[k] = known
                            .emplace(Coordinates{corner[k].x, corner[k].y, corner[k].z},
                                     static_cast<Id>(known.size()))
                            .first->second;
        places_.push_back(places);
    }
    place_count_ = static_cast<Id>(known.size());
}

std::array<Vec3, 3> ElementMesh::corners(std::size_t element) const {
    const RadiosityElement& one = elements_[element];
    const ObjectMesh& object = parts_[one.mesh].object;
    const IdTriple& corner = object.triangles[one.number];
    return {object.points[corner[0]], object.points[corner[1]], object.points[corner[2]]};
}

std::shared_ptr<const TriangleScene> ElementMesh::triangles() const {
    auto scene = std::make_shared<TriangleScene>();
    for (std::size_t e = 0; e < elements_.size(); ++e)
        append_triangle(corners(e), elements_[e].mesh, elements_[e].number, *scene);
    for (Id t = 0; t < world_.objects.size(); ++t)
        if (!is_lit_triangle(world_, t))
            append_triangle(corners_of(world_.objects, t), world_.objects.object[t],
                            world_.objects.primitive[t], *scene);
    for (std::size_t i = 0; i < world_.optics.size(); ++i) {
        if (!world_.optics[i].mirror) continue;
        const TriangleScene facets = optic_facets(world_, i, grid_resolution(world_.optics[i], 0))->scene();
        for (Id f = 0; f < facets.size(); ++f)
            append_triangle(corners_of(facets, f), facets.object[f], facets.primitive[f], *scene);
    }
    return scene;
}

std::size_t ElementMesh::longest(std::size_t element) const {
    const std::array<Vec3, 3> corner = corners(element);
    std::array<double, 3> squared;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 edge = corner[(k + 1) % 3] - corner[k];
        squared[k] = dot(edge, edge);
    }
    return static_cast<std::size_t>(std::max_element(squared.begin(), squared.end()) - squared.begin());
}

double ElementMesh::longest_edge(std::size_t element) const {
    const std::size_t k = longest(element);
    const std::array<Vec3, 3> corner = corners(element);
    return length(corner[(k + 1) % 3] - corner[k]);
}

ElementMesh::Edge ElementMesh::edge_of(std::size_t element, std::size_t k) const {
    return std::minmax(places_[element][k], places_[element][(k + 1) % 3]);
}

/// The edges that are to be halved, each with no place yet: those of these elements, and where one of an
/// element is, its longest one, too.
std::map<ElementMesh::Edge, Id> ElementMesh::marked_edges(const std::vector<char>& halved) const {
    std::vector<std::size_t> longest_of(elements_.size());
    std::map<Edge, std::vector<Id>> around;
    for (Id e = 0; e < elements_.size(); ++e) {
        longest_of[e] = longest(e);
        for (std::size_t k = 0; k < 3; ++k) around[edge_of(e, k)].push_back(e);
    }
    std::map<Edge, Id> marked;
    std::vector<Id> waiting;
    const auto mark = [&](Id e) {
        const Edge edge = edge_of(e, longest_of[e]);
        if (!marked.emplace(edge, kNone).second) return;
        const std::vector<Id>& others = around[edge];
        waiting.insert(waiting.end(), others.begin(), others.end());
    };
    for (Id e = 0; e < elements_.size(); ++e)
        if (halved[e]) mark(e);
    while (!waiting.empty()) {
        const Id e = waiting.back();
        waiting.pop_back();
        mark(e);
    }
    return marked;
}

void ElementMesh::name_patches() {
    for (Id e = 0; e < elements_.size(); ++e) elements_[e].patch = e;
}

double ElementMesh::longest_edge(const std::vector<char>& marked) const {
    double longest = 0;
    for (std::size_t e = 0; e < marked.size(); ++e)
        if (marked[e]) longest = std::max(longest, longest_edge(e));
    return longest;
}

std::size_t ElementMesh::count_after(const std::vector<char>& halved) const {
    const std::map<Edge, Id> marked = marked_edges(halved);
    std::size_t count = elements_.size();
    for (std::size_t e = 0; e < elements_.size(); ++e)
        for (std::size_t k = 0; k < 3; ++k) count += marked.count(edge_of(e, k));
    return count;
}

void ElementMesh::halve(const std::vector<char>& halved) {
    std::map<Edge, Id> marked = marked_edges(halved);
    for (auto& [edge, place] : marked) place = place_count_++;
    const auto count = static_cast<Id>(elements_.size());
    for (Id e = 0; e < count; ++e) split(e, marked);
}

/// Halves the element at its longest edge where that is marked, and then its halves at the others.
void ElementMesh::split(Id element, const std::map<Edge, Id>& new_places) {
    std::size_t k = longest(element);
    auto found = new_places.find(edge_of(element, k));
    for (std::size_t i = 0; i < 3 && found == new_places.end(); ++i)
        found = new_places.find(edge_of(element, k = i));
    if (found == new_places.end()) return;
    const Id other = split_once(element, k, found->second);
    split(element, new_places);
    split(other, new_places);
}

Id ElementMesh::split_once(Id element, std::size_t k, Id new_place) {
    const std::size_t next = (k + 1) % 3;
    MeshPart& part = parts_[elements_[element].mesh];
    const TriangleSplit split{elements_[element].number, static_cast<int>(k)};
    part.splitter->split(split);
    part.splits.push_back(split);
    RadiosityElement other = elements_[element];
    other.number = static_cast<Id>(part.object.triangles.size() - 1);
    const Vec2 middle = 0.5 * (other.barycentrics[k] + other.barycentrics[next]);
    elements_[element].barycentrics[next] = other.barycentrics[k] = middle;
    IdTriple other_places = places_[element];
    places_[element][next] = other_places[k] = new_place;
    const auto number = static_cast<Id>(elements_.size());
    part.element.push_back(number);
    elements_.push_back(other);
    places_.push_back(other_places);
    return number;
}

}  // namespace trilens
