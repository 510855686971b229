// The integral of emission and absorption against closed forms and against small steps.
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/util/error.h"
#include "support/draw.h"
#include "support/test.h"
#include "volume/transfer_function.h"
#include "volume/volume_integral.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// Midpoints of many small steps between any two ends of stretches, each an even medium.
VolumeLight by_small_steps(const std::vector<RayThroughVolume>& volumes, int steps) {
    std::vector<double> ends;
    for (const RayThroughVolume& volume : volumes)
        for (const ScalarStretch& s : volume.stretches) ends.insert(ends.end(), {s.from, s.to});
    std::sort(ends.begin(), ends.end());
    VolumeLight light;
    for (std::size_t e = 0; e + 1 < ends.size(); ++e)
        for (int i = 0; i < steps; ++i) {
            const double step = (ends[e + 1] - ends[e]) / steps, at = ends[e] + (i + 0.5) * step;
            double extinction = 0;
            Vec3 source(0);
            for (const RayThroughVolume& volume : volumes)
                for (const ScalarStretch& s : volume.stretches) {
                    if (!(at > s.from && at < s.to)) continue;
                    const double u = (at - s.from) / (s.to - s.from);
                    const TransferPoint p =
                        volume.transfer->at(s.scalar_from + u * (s.scalar_to - s.scalar_from));
                    extinction += p.extinction;
                    source += p.extinction * p.color;
                }
            if (!(extinction > 0)) continue;
            const double through = std::exp(-extinction * step);
            light.put_behind({(1 - through) * (source / extinction), through});
        }
    return light;
}

TransferFunction random_transfer(Draw& draw, int points) {
    TransferFunction transfer;
    double value = -1;
    for (int i = 0; i < points; ++i) {
        value += draw.uniform(0.05, 0.6);
        transfer.points.push_back(
            {value, glm::abs(draw.in_cube(2)), draw.uniform(0, 1) < 0.3 ? 0.0 : draw.log_uniform(0.01, 20)});
    }
    return transfer;
}

void check_close(const VolumeLight& a, const VolumeLight& b, double room) {
    CHECK(std::fabs(a.transmittance - b.transmittance) < room);
    for (int k = 0; k < 3; ++k) CHECK(std::fabs(a.emission[k] - b.emission[k]) < room);
}

}  // namespace

TEST_CASE("a volume of one colour shows it in the share that it takes away", "[volume][law]") {
    Draw draw(1);
    for (int i = 0; i < 200; ++i) {
        const double k0 = draw.uniform(0, 1) < 0.2 ? 0 : draw.log_uniform(1e-6, 1e5),
                     k1 = draw.log_uniform(1e-6, 1e5), length = draw.log_uniform(1e-4, 1e3);
        const Vec3 color = glm::abs(draw.in_cube(3));
        const LinearMedium medium{color, color, k0, k1};
        const VolumeLight light = integrate({&medium, 1}, length);
        const double through = std::exp(-0.5 * (k0 + k1) * length);
        CHECK(std::fabs(light.transmittance - through) <= 1e-13);
        for (int k = 0; k < 3; ++k)
            CHECK(std::fabs(light.emission[k] - (1 - through) * color[k]) <= 1e-11 * (1 + color[k]));
    }
}

TEST_CASE("linear colour over linear extinction is the closed form with an error function", "[volume][law]") {
    // Integrated by parts: c0 - c1 e^-tau + (c1 - c0) J with J the integral of e^-tau(u) over the stretch.
    Draw draw(2);
    for (int i = 0; i < 200; ++i) {
        const double k0 = draw.log_uniform(0.1, 5), rise = draw.log_uniform(0.5, 20),
                     length = draw.log_uniform(0.2, 3);
        const LinearMedium medium{{0, 1, 0.3}, {1, 0, 0.5}, k0, k0 + rise};
        const double a = 0.5 * rise * length, b = k0 * length, root = std::sqrt(a);
        const double z0 = b / (2 * root), z1 = z0 + root;
        const double j =
            std::exp(z0 * z0) * std::sqrt(std::acos(-1.0)) / (2 * root) * (std::erfc(z0) - std::erfc(z1));
        const double through = std::exp(-a - b);
        const VolumeLight light = integrate({&medium, 1}, length);
        for (int k = 0; k < 3; ++k) {
            const double c0 = medium.color_start[k], c1 = medium.color_end[k];
            CHECK(light.emission[k] == Approx(c0 - c1 * through + (c1 - c0) * j).margin(1e-11));
        }
    }
}

TEST_CASE("rays through piecewise linear transfer functions are those of small steps", "[volume][law]") {
    Draw draw(3);
    for (int i = 0; i < 20; ++i) {
        const TransferFunction transfer = random_transfer(draw, 1 + i % 6);
        RayThroughVolume ray{&transfer, {}};
        double at = draw.uniform(0, 1), scalar = draw.uniform(-1.5, 1.5);
        for (int s = 0; s < 6; ++s) {
            const double to = at + draw.uniform(0.01, 0.5), next = draw.uniform(-1.5, 2.5);
            ray.stretches.push_back({at, to, scalar, next});
            at = to + (s == 2 ? 0.2 : 0);
            scalar = next;
        }
        check_close(integrate({&ray, 1}), by_small_steps({ray}, 20'000), 1e-6);
    }
}

TEST_CASE("volumes that overlap add up", "[volume][law]") {
    Draw draw(4);
    const TransferFunction one = random_transfer(draw, 4), other = random_transfer(draw, 3);
    const std::vector<RayThroughVolume> rays{{&one, {{0, 1, -0.5, 0.8}, {1, 1.7, 0.8, 0}}},
                                             {&other, {{0.4, 1.2, 0.6, -0.4}, {1.5, 2.5, -1, 1}}}};
    check_close(integrate(rays), by_small_steps(rays, 50'000), 1e-6);
    // Twice the same volume is one of twice the extinction.
    TransferFunction doubled = one;
    for (TransferPoint& point : doubled.points) point.extinction *= 2;
    const std::vector<RayThroughVolume> twice{rays[0], rays[0]}, once{{&doubled, rays[0].stretches}};
    check_close(integrate(twice), integrate(once), 1e-12);
}

TEST_CASE("where a ray through a volume is cut changes nothing", "[volume][law]") {
    Draw draw(6);
    for (int i = 0; i < 100; ++i) {
        const TransferFunction transfer = random_transfer(draw, 5);
        const double cut = draw.uniform(0.01, 0.99), s0 = draw.uniform(-1, 2), s1 = draw.uniform(-1, 2);
        const RayThroughVolume whole{&transfer, {{0, 1, s0, s1}}};
        const double middle = s0 + cut * (s1 - s0);
        const RayThroughVolume parts{&transfer, {{0, cut, s0, middle}, {cut, 1, middle, s1}}};
        check_close(integrate({&whole, 1}), integrate({&parts, 1}), 1e-12);
    }
}

TEST_CASE("transfer functions are constant beyond their ends, and maps have their colours", "[volume]") {
    const TransferFunction transfer{{{1, Vec3(0.5), 2}, {3, Vec3(1), 4}}};
    CHECK(transfer.at(0).extinction == 2);
    CHECK(transfer.at(2).extinction == 3);
    CHECK(transfer.at(9).color == Vec3(1));
    for (const std::string& name : color_map_names()) CHECK(color_map(name).size() >= 2);
    CHECK(color_map("viridis").back().y > 0.7);
    CHECK_THROWS_AS(color_map("virdis"), UsageError);
}
