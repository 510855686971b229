// Paths over coaxial interfaces: the law at each, Newton's method in all parameters, and rays traced one by
// one.
#include "specular/chain/coaxial_chain.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// A parallelogram.
class Plate final : public Surface {
  public:
    Plate(const Vec3& corner, const Vec3& u, const Vec3& v) : corner_(corner), u_(u), v_(v) {}
    std::size_t face_count() const override { return 1; }
    FaceDomain domain(Id) const override { return FaceDomain::kSquare; }
    bool is_flat(Id) const override { return true; }
    SurfacePoint eval(Id, const Vec2& uv) const override {
        SurfacePoint p;
        p.position = corner_ + uv.x * u_ + uv.y * v_;
        p.du = u_, p.dv = v_;
        p.normal = normalize(cross(u_, v_));
        return p;
    }

  private:
    Vec3 corner_, u_, v_;
};

/// A sphere; u is the longitude, v the latitude, both as shares.
class Ball final : public Surface {
  public:
    Ball(const Vec3& centre, double radius) : centre_(centre), radius_(radius) {}
    std::size_t face_count() const override { return 1; }
    FaceDomain domain(Id) const override { return FaceDomain::kSquare; }
    double sphere_curvature() const override { return 1 / radius_; }
    SurfaceParameter sphere_place(const Vec3& n) const override {
        const double turn = std::atan2(n.y, n.x) / (2 * kPi);
        return {0, {turn < 0 ? turn + 1 : turn, std::atan2(std::hypot(n.x, n.y), -n.z) / kPi}};
    }
    SurfacePoint eval(Id, const Vec2& uv) const override {
        const double a = 2 * kPi * uv.x, b = kPi * uv.y;
        const Vec3 round(std::cos(a), std::sin(a), 0), across(-round.y, round.x, 0), up(0, 0, 1);
        SurfacePoint p;
        p.normal = std::sin(b) * round - std::cos(b) * up;
        p.position = centre_ + radius_ * p.normal;
        p.du = 2 * kPi * radius_ * std::sin(b) * across;
        p.dv = kPi * radius_ * (std::cos(b) * round + std::sin(b) * up);
        p.duu = -4 * kPi * kPi * radius_ * std::sin(b) * round;
        p.duv = 2 * kPi * kPi * radius_ * std::cos(b) * across;
        p.dvv = -kPi * kPi * radius_ * p.normal;
        return p;
    }

  private:
    static constexpr double kPi = 3.14159265358979323846;
    Vec3 centre_;
    double radius_;
};

/// Surfaces of a port with its eye; a path leaves through all of them.
struct Port {
    std::deque<Plate> plates;
    std::deque<Ball> balls;
    PathChain chain;
    PerEvent<ChainFace> faces;
    Vec3 axis{0};
    double far = 0;   // the last surface from the eye, or its radius
    double size = 0;  // of the largest surface

    CoaxialChain coaxial() const {
        auto made = CoaxialChain::of(chain, faces);
        REQUIRE(made);
        return *made;
    }
};

/// Plates one behind the other, so many, around the axis; `share` tilts their sides.
Port flat_port(Draw& draw, std::size_t count, double side) {
    Port port;
    port.axis = draw.unit();
    port.size = side;
    const Vec3 u = normalize(cross(port.axis, draw.unit())), v = cross(port.axis, u);
    port.chain.eye.place = 3.0 * draw.unit();
    double index = 1;
    for (std::size_t i = 0; i < count; ++i) {
        port.far += draw.log_uniform(1e-3, 10);
        const bool front = draw.uniform(0, 1) < 0.5;
        const Vec3 middle = port.chain.eye.place + port.far * port.axis;
        const Vec3 a = side * u, b = side * (front ? -1.0 : 1.0) * (v + 0.3 * u);
        port.plates.emplace_back(middle - 0.5 * (a + b), a, b);
        const double next = draw.uniform(1, 2);
        port.chain.events.push_back({&port.plates.back(), index, next, false});
        port.faces.push_back({0, front});
        index = next;
    }
    return port;
}

/// Shells around a centre that is so many of the least radius from the eye.
Port dome_port(Draw& draw, std::size_t count, double off_centre) {
    Port port;
    const Vec3 centre = 3.0 * draw.unit();
    port.axis = draw.unit();
    double radius = draw.log_uniform(1e-2, 10), index = draw.uniform(1, 1.4);
    port.chain.eye.place = centre + off_centre * radius * port.axis;
    for (std::size_t i = 0; i < count; ++i) {
        port.balls.emplace_back(centre, radius);
        const double next = draw.uniform(1, 1.6);
        port.chain.events.push_back({&port.balls.back(), index, next, false});
        port.faces.push_back({0, false});
        index = next;
        port.far = port.size = radius;
        radius *= 1 + draw.log_uniform(1e-3, 1);
    }
    return port;
}

/// Light's path through the port from the eye in a direction; none where it is reflected totally.
std::optional<Ray> traced(const Port& port, const Vec3& direction) {
    Ray ray{port.chain.eye.place, normalize(direction)};
    for (std::size_t i = 0; i < port.chain.events.size(); ++i) {
        const ChainEvent& event = port.chain.events[i];
        Vec3 normal;
        if (port.plates.empty()) {
            const SurfacePoint some = event.surface->eval(0, {0.3, 0.4});
            const double radius = 1 / event.surface->sphere_curvature();
            const Vec3 to = some.position - radius * some.normal - ray.origin;
            const double middle = dot(to, ray.direction);
            ray.origin +=
                (middle + std::sqrt(middle * middle + radius * radius - dot(to, to))) * ray.direction;
            normal = normalize(ray.origin - (some.position - radius * some.normal));
        } else {
            const SurfacePoint some = event.surface->eval(0, {0, 0});
            normal = some.normal;
            ray.origin +=
                dot(some.position - ray.origin, normal) / dot(ray.direction, normal) * ray.direction;
        }
        if (dot(normal, ray.direction) < 0) normal = -normal;
        const double eta = event.index_before / event.index_after, cosine = dot(normal, ray.direction);
        const double squared = 1 - eta * eta * (1 - cosine * cosine);
        if (!(squared > 0)) return std::nullopt;
        ray.direction = normalize(eta * ray.direction + (std::sqrt(squared) - eta * cosine) * normal);
    }
    return ray;
}

/// Snell's law at each place, beyond what rounding of coordinates does to it, and the place on its surface.
double worst_law(const Port& port, const CoaxialPath& path, const Vec3& point) {
    double worst = 0, shortest = 1e300;
    Vec3 from = port.chain.eye.place;
    for (std::size_t i = 0; i < path.places.size(); ++i) {
        const Vec3 to = i + 1 < path.places.size() ? path.places[i + 1] : point, n = path.normals[i];
        const ChainEvent& event = port.chain.events[i];
        const Vec3 in = normalize(path.places[i] - from), out = normalize(to - path.places[i]);
        shortest = std::min({shortest, length(path.places[i] - from), length(to - path.places[i])});
        worst =
            std::max(worst, length(event.index_before * cross(n, in) - event.index_after * cross(n, out)));
        CHECK(dot(in, n) * dot(out, n) > 0);
        CHECK((dot(in, n) <= 0) == port.faces[i].front);
        const SurfacePoint there = event.surface->eval(path.at[i].face, path.at[i].uv);
        CHECK(length(there.position - path.places[i]) < 1e-15 * (10 * port.size + length(path.places[i])));
        CHECK(length(there.normal - n) < 1e-12);
        from = path.places[i];
    }
    return worst - 1e-14 * (3 + length(point)) / shortest;
}

/// Central differences of the first place.
double worst_derivative(const CoaxialChain& chain, const Vec3& point, double step) {
    const auto path = chain.path_to(point);
    REQUIRE(path);
    double worst = 0;
    for (int k = 0; k < 3; ++k) {
        Vec3 by(0);
        by[k] = step;
        const auto after = chain.path_to(point + by), before = chain.path_to(point - by);
        REQUIRE(after);
        REQUIRE(before);
        const Vec3 expected = (after->places[0] - before->places[0]) / (2 * step);
        worst = std::max(worst, length(path->first_by_point[k] - expected) / (1e-3 + length(expected)));
    }
    return worst;
}

}  // namespace

TEST_CASE("a point on a ray through plates is led back along it, and Newton's method agrees",
          "[specular][law]") {
    Draw draw(11);
    int agreed = 0, reached = 0;
    for (int round = 0; round < 3000; ++round) {
        const Port port = flat_port(draw, 1 + static_cast<std::size_t>(round % 6), 1e4);
        const CoaxialChain coaxial = port.coaxial();
        const double slope = round % 50 == 0 ? 0 : draw.log_uniform(1e-9, 30);
        const auto ray = traced(port, port.axis + slope * normalize(cross(port.axis, draw.unit())));
        if (!ray) continue;
        const Vec3 point = ray->origin + draw.log_uniform(1e-3, 1e3) * ray->direction;
        const auto path = coaxial.path_to(point);
        CAPTURE(round, slope);
        REQUIRE(path);
        ++reached;
        CHECK(worst_law(port, *path, point) < 1e-13);
        if (slope < 1)
            CHECK(worst_derivative(coaxial, point, 1e-4 * std::min(port.far, length(point - ray->origin))) <
                  1e-4);
        // Newton's method in all parameters finds no other.
        PathChain chain = port.chain;
        chain.point.place = point;
        const auto newton = solve_chain(chain, path->at);
        if (!newton) continue;
        ++agreed;
        const double far = length(point - port.chain.eye.place);
        for (std::size_t i = 0; i < path->places.size(); ++i)
            CHECK(length(newton->points[i].position - path->places[i]) < 1e-9 * far);
    }
    CHECK(reached > 1500);
    CHECK(agreed > 1000);
}

TEST_CASE("a point on a ray through shells is led back along it, and no other ray comes to it",
          "[specular][law]") {
    Draw draw(12);
    int reached = 0;
    for (int round = 0; round < 2000; ++round) {
        const double off = round % 20 == 0  ? 0
                           : round % 2 == 0 ? draw.log_uniform(1e-9, 0.4)
                                            : draw.uniform(0, 0.4);
        const Port port = dome_port(draw, 1 + static_cast<std::size_t>(round % 4), off);
        const auto coaxial = CoaxialChain::of(port.chain, port.faces);
        if (!coaxial) continue;
        CHECK_FALSE(coaxial->are_planes());
        const Vec3 direction = round % 30 == 0 ? port.axis : round % 30 == 1 ? -port.axis : draw.unit();
        const auto ray = traced(port, direction);
        REQUIRE(ray);
        const Vec3 point = ray->origin + port.far * draw.log_uniform(1e-3, 1e4) * ray->direction;
        const auto path = coaxial->path_to(point);
        CAPTURE(round, off);
        REQUIRE(path);
        ++reached;
        CHECK(worst_law(port, *path, point) < 1e-13);
        CHECK(length(normalize(path->places[0] - port.chain.eye.place) - direction) < 1e-10);
        if (round % 30 > 1)
            CHECK(worst_derivative(*coaxial, point, 1e-5 * length(point - ray->origin)) < 2e-3);
        PathChain chain = port.chain;
        chain.point.place = point;
        if (const auto newton = solve_chain(chain, path->at))
            for (std::size_t i = 0; i < path->places.size(); ++i)
                CHECK(length(newton->points[i].position - path->places[i]) < 1e-10 * port.far);
    }
    CHECK(reached > 1000);
}

TEST_CASE("where shells are proven to show a point once, rays all around turn monotonically",
          "[specular][law]") {
    Draw draw(13);
    int proven = 0, refused = 0;
    for (int round = 0; round < 400; ++round) {
        const Port port = dome_port(draw, 1 + static_cast<std::size_t>(round % 4), draw.uniform(0.1, 0.95));
        const bool is_proven = CoaxialChain::of(port.chain, port.faces).has_value();
        const Vec3 side = normalize(cross(port.axis, draw.unit()));
        const SurfacePoint some = port.balls.front().eval(0, {0.3, 0.4});
        const Vec3 centre = some.position - some.normal / port.balls.front().sphere_curvature();
        const double sphere = port.far * draw.log_uniform(1.001, 100);
        double last = 0;
        bool is_monotonic = true;
        for (int i = 1; i < 400 && is_monotonic; ++i) {
            const double angle = 3.14159265 * i / 400;
            const auto ray = traced(port, std::cos(angle) * port.axis + std::sin(angle) * side);
            if (!ray) {
                is_monotonic = false;
                break;
            }
            const Vec3 to = ray->origin - centre;
            const double along = dot(to, ray->direction);
            const Vec3 end =
                to + (std::sqrt(along * along + sphere * sphere - dot(to, to)) - along) * ray->direction;
            const double turned = std::atan2(dot(end, side), dot(end, port.axis));
            is_monotonic = turned > last;
            last = turned;
        }
        if (is_proven) CHECK(is_monotonic);
        (is_proven ? proven : refused) += 1;
    }
    CHECK(proven > 100);
    CHECK(refused > 50);
}

TEST_CASE("what misses a port's faces has no path, and what is said to go through them does",
          "[specular][law]") {
    Draw draw(14);
    int within = 0, beyond = 0, held = 0;
    for (int round = 0; round < 3000; ++round) {
        const Port port = flat_port(draw, 2 + static_cast<std::size_t>(round % 3), draw.log_uniform(1, 20));
        const CoaxialChain coaxial = port.coaxial();
        const auto on_faces = [&](const Vec3& direction) {
            Port first = port;
            for (std::size_t i = 0; i < port.faces.size(); ++i) {
                first.chain.events.resize(i);
                const auto before = traced(first, direction);
                first.chain.events = port.chain.events;
                if (!before) return false;
                const SurfacePoint plate = port.chain.events[i].surface->eval(0, {0, 0});
                const Vec3 on = before->origin +
                                dot(plate.position - before->origin, plate.normal) /
                                    dot(before->direction, plate.normal) * before->direction -
                                plate.position;
                const Vec3 n = cross(plate.du, plate.dv);
                const double u = dot(on, cross(plate.dv, n)) / dot(plate.du, cross(plate.dv, n)),
                             v = dot(on, cross(n, plate.du)) / dot(plate.dv, cross(n, plate.du));
                if (!(u > 0 && v > 0 && u < 1 && v < 1)) return false;
            }
            return traced(port, direction).has_value();
        };
        const auto slanted = [&] {
            return port.axis + draw.uniform(0, 1.5) * normalize(cross(port.axis, draw.unit()));
        };
        const Vec3 direction = slanted();
        if (const auto ray = traced(port, direction)) {
            const bool goes = on_faces(direction);
            CHECK(coaxial.path_to(ray->origin + draw.log_uniform(0.1, 10) * ray->direction).has_value() ==
                  goes);
            const auto last = coaxial.last_ray(direction);
            CHECK(last.has_value() == goes);
            if (last) CHECK(length(last->origin - ray->origin) < 1e-12 * (port.far + 10));
            if (last) CHECK(length(last->direction - ray->direction) < 1e-12);
            (goes ? within : beyond) += 1;
            CHECK_FALSE(coaxial.path_to(port.chain.eye.place - port.axis));
        }
        const Vec3 middle = slanted();
        const std::array<Vec3, 3> between{middle, middle + 0.2 * draw.unit(), middle + 0.2 * draw.unit()};
        if (!coaxial.holds_rays_between(between)) continue;
        ++held;
        for (int i = 0; i < 10; ++i) {
            const double a = draw.uniform(0, 1), b = draw.uniform(0, 1 - a);
            CHECK(on_faces(a * between[0] + b * between[1] + (1 - a - b) * between[2]));
        }
    }
    CHECK(within > 300);
    CHECK(beyond > 300);
    CHECK(held > 100);
}

TEST_CASE("planes that touch are one: a film of no thickness bends nothing, but may reflect totally",
          "[specular]") {
    Draw draw(15);
    Port port = flat_port(draw, 1, 1e3);
    Port touching = port;
    const double before = port.chain.events[0].index_before, after = port.chain.events[0].index_after;
    const auto with_film = [&](double index) {
        touching.chain.events.clear();
        touching.chain.events.push_back({&port.plates[0], before, index, false});
        touching.chain.events.push_back({&port.plates[0], index, after, false});
        touching.faces = PerEvent<ChainFace>{port.faces[0], port.faces[0]};
        return CoaxialChain::of(touching.chain, touching.faces).value();
    };
    const Vec3 side = normalize(cross(port.axis, draw.unit()));
    const Vec3 point = port.chain.eye.place + (port.far + 1) * port.axis + 3.0 * (port.far + 1) * side;
    const auto plain = port.coaxial().path_to(point), film = with_film(1.3).path_to(point);
    REQUIRE(plain);
    REQUIRE(film);
    for (std::size_t i = 0; i < 2; ++i) CHECK(length(film->places[i] - plain->places[0]) < 1e-13 * port.far);
    CHECK_FALSE(with_film(0.5).path_to(point));
}

TEST_CASE("surfaces that are not coaxial are refused", "[specular]") {
    Draw draw(16);
    const Port flat = flat_port(draw, 3, 1e3), dome = dome_port(draw, 2, 0.2);
    CHECK(CoaxialChain::of(flat.chain, flat.faces));
    REQUIRE(CoaxialChain::of(dome.chain, dome.faces));

    PathChain chain = flat.chain;
    chain.eye.is_direction = true;
    CHECK_FALSE(CoaxialChain::of(chain, flat.faces));
    chain = flat.chain;
    std::swap(chain.events[0].surface, chain.events[2].surface);  // out of order
    CHECK_FALSE(CoaxialChain::of(chain, flat.faces));
    chain = flat.chain;
    const Plate tilted({0, 0, 9}, {1, 0, 0}, {0, 1, 1e-6});
    chain.events[1].surface = &tilted;
    CHECK_FALSE(CoaxialChain::of(chain, flat.faces));
    PerEvent<ChainFace> faces = flat.faces;
    faces[1].front = !faces[1].front;
    CHECK_FALSE(CoaxialChain::of(flat.chain, faces));

    chain = dome.chain;
    chain.events[1].reflects = true;
    CHECK_FALSE(CoaxialChain::of(chain, dome.faces));
    chain.events[1].reflects = false;
    const Ball beside(Vec3(1e-6, 0, 0), 100);
    chain.events[1].surface = &beside;
    CHECK_FALSE(CoaxialChain::of(chain, dome.faces));
}
