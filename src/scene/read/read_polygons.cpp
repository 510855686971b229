// Inline cages and subdivision tags out of checked JSON: lengths and indices.
#include <numeric>

#include "scene/read/reading.h"
#include "scene/read/scene_fields.h"

namespace trilens {
namespace {

std::vector<int> read_ints(const Node& node) {
    return node.json.get<std::vector<int>>();
}

/// Indices below `count` of `what`.
std::vector<int> read_indices(const Node& node, std::size_t count, const char* what) {
    std::vector<int> indices = read_ints(node);
    for (std::size_t i = 0; i < indices.size(); ++i)
        if (static_cast<std::size_t>(indices[i]) >= count)
            node[i].fail("index " + std::to_string(indices[i]) + " is out of range: there are " +
                         std::to_string(count) + " " + what);
    return indices;
}

void check_length(const Node& node, long long expected, const std::string& reason) {
    if (static_cast<long long>(node.size()) != expected)
        node.fail("has " + std::to_string(node.size()) + (node.size() == 1 ? " entry" : " entries") +
                  ", must have " + std::to_string(expected) + ": " + reason);
}

void read_uvs(const Node& mesh, PolygonMesh& polygons) {
    const std::size_t corners = polygons.cage.face_vertex_indices.size();
    const Node node = mesh["uvs"];
    std::vector<Vec2> uvs;
    for (const Json& uv : node.json) uvs.push_back(to_vec2(uv));
    if (!mesh.has("uvIndices")) {
        check_length(node, static_cast<long long>(corners),
                     "without uvIndices one per entry of faceVertexIndices");
        polygons.uvs = std::move(uvs);
        return;
    }
    const Node indices = mesh["uvIndices"];
    check_length(indices, static_cast<long long>(corners), "one per entry of faceVertexIndices");
    for (const int index : read_indices(indices, uvs.size(), "uvs"))
        polygons.uvs.push_back(uvs[static_cast<std::size_t>(index)]);
}

void read_creases(const Node& mesh, Cage& cage) {
    const Node indices = mesh["creaseIndices"], sharpnesses = mesh["creaseSharpnesses"];
    cage.crease_indices = read_indices(indices, cage.points.size(), "points");
    const auto count = static_cast<long long>(cage.crease_indices.size());
    if (mesh.has("creaseLengths")) {
        const Node lengths = mesh["creaseLengths"];
        cage.crease_lengths = read_ints(lengths);
        const long long sum = std::accumulate(cage.crease_lengths.begin(), cage.crease_lengths.end(), 0LL);
        if (sum != count)
            lengths.fail("the lengths sum to " + std::to_string(sum) + ", but creaseIndices has " +
                         std::to_string(count) + " entries");
    } else {
        if (count % 2 != 0)
            indices.fail("without creaseLengths the points go in pairs, but there are " +
                         std::to_string(count));
        cage.crease_lengths.assign(static_cast<std::size_t>(count / 2), 2);
    }
    cage.crease_sharpnesses = sharpnesses.json.get<std::vector<double>>();
    const auto chains = static_cast<long long>(cage.crease_lengths.size()), edges = count - chains;
    if (static_cast<long long>(sharpnesses.size()) != edges)
        check_length(sharpnesses, chains, "one per chain, or one per edge (" + std::to_string(edges) + ")");
}

}  // namespace

PolygonMesh read_inline_polygons(const Node& mesh) {
    PolygonMesh polygons;
    Cage& cage = polygons.cage;
    for (const Json& point : mesh["points"].json) cage.points.push_back(to_vec3(point));
    cage.face_vertex_counts = read_ints(mesh["faceVertexCounts"]);
    const Node indices = mesh["faceVertexIndices"];
    cage.face_vertex_indices = read_indices(indices, cage.points.size(), "points");
    check_length(indices,
                 std::accumulate(cage.face_vertex_counts.begin(), cage.face_vertex_counts.end(), 0LL),
                 "the sum of faceVertexCounts");
    if (mesh.has("uvs")) read_uvs(mesh, polygons);
    return polygons;
}

const std::vector<Field<Cage>>& subdivision_fields() {
    static const std::vector<Field<Cage>> fields{
        choice("subdivisionScheme", &Cage::scheme),
        choice("interpolateBoundary", &Cage::interpolate_boundary),
        part<Cage>("creaseIndices", list_of(ref("index")), "Chains of points, one after the other."),
        part<Cage>("creaseLengths", list_of(whole_in(2, kMostIndex)), "Points per chain; absent: pairs."),
        part<Cage>("creaseSharpnesses", list_of(ref("notNegative")),
                   "One per chain, or one per edge; 10 and more is infinite."),
        part<Cage>("cornerIndices", list_of(ref("index"))),
        part<Cage>("cornerSharpnesses", list_of(ref("notNegative"))),
        part<Cage>("holeIndices", list_of(ref("index")), "Faces that are not drawn."),
    };
    return fields;
}

void read_subdivision(const Node& mesh, Cage& cage) {
    read_fields(mesh, subdivision_fields(), cage);
    if (mesh.has("creaseIndices")) read_creases(mesh, cage);
    if (mesh.has("cornerIndices")) {
        cage.corner_indices = read_indices(mesh["cornerIndices"], cage.points.size(), "points");
        check_length(mesh["cornerSharpnesses"], static_cast<long long>(cage.corner_indices.size()),
                     "one per entry of cornerIndices");
        cage.corner_sharpnesses = mesh["cornerSharpnesses"].json.get<std::vector<double>>();
    }
    if (mesh.has("holeIndices"))
        cage.hole_indices = read_indices(mesh["holeIndices"], cage.face_vertex_counts.size(), "faces");
}

void check_scheme(const Node& mesh, const Cage& cage) {
    if (cage.scheme != SubdivisionScheme::kLoop) return;
    for (std::size_t face = 0; face < cage.face_vertex_counts.size(); ++face)
        if (cage.face_vertex_counts[face] != 3)
            mesh["subdivisionScheme"].fail("loop needs triangles, but face " + std::to_string(face) +
                                           " has " + std::to_string(cage.face_vertex_counts[face]) +
                                           " corners");
}

}  // namespace trilens
