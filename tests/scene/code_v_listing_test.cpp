// A telescope of three tilted mirrors, the last one a Q-type asphere, against the rays that CODE V itself
// lists of it: threemrc_qbfs.lis of ray-optics (M. J. Hayford), written by its version 10.8.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "lens/sequential_rays.h"
#include "scene/formats/lens_file.h"
#include "scene/read/read_lens.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

const std::string kThreeMirrors = R"(
RDM Y; TIT 'F/4.0, 4x4 deg., 3 Mirror Compact'
SO 0 1e11
S 0 300
S -1058.98937 -276.006853 REFL
  CON; K -1.314566
  DAR; YDE 48.695345; ADE 8.438645
S 0 -0.981318
  STO; DAR; YDE 11.444717; ADE 10.219900
S -324.06500 319.160560 REFL
  CON; K 0.889123
  DAR; YDE 17.561821; ADE 9.661580
S -449.67012 -321.621031 REFL
  SPS QBF
  SCO C1 189.86; SCO C3 0.42605; SCO C4 -0.016782; SCO C5 8.2673E-04
  SCO C6 -4.4487E-05; SCO C7 2.5242E-06; SCO C8 -1.3595E-07
  DAR; YDE 67.500535; ADE 9.514418
SI 0 15.407921
  YDE -47.681342; ADE 8.716957
)";

/// On the first surface; on the last mirror, in its own frame, with the slopes behind it.
struct ListedRay {
    Vec2 start, field;  // of whole degrees, as its fields are
    Vec3 end;
    Vec2 end_slope;

    Ray ray() const {
        const auto slope = [](double degrees) { return std::tan(degrees * std::numbers::pi / 180); };
        return {Vec3(start, 0), normalize(Vec3(slope(field.x), slope(field.y), 1))};
    }
};

const std::vector<ListedRay> kListed = {
    {{0, 112.848743}, {0, 2}, {0, -89.201217, -8.867643}, {0, -0.129155}},
    {{0, 162.848743}, {0, 2}, {0, -50.017543, -2.765547}, {0, -0.003490}},
    {{0, 62.848743}, {0, 2}, {0, -127.800704, -18.439086}, {0, -0.260890}},
    {{50, 112.848743}, {0, 2}, {39.590060, -89.256854, -10.650920}, {0.127634, -0.130075}},
    {{0, 144.927530}, {0, 0}, {0, -113.854355, -14.557556}, {0, -0.165989}},
    {{0, 127.959658}, {0, -2}, {0, -174.731602, -35.276604}, {0, -0.340748}},
    {{-81.645678, 178.149440}, {2, -2}, {-13.251352, -139.826156, -22.390946}, {-0.091487, -0.209199}},
    {{18.354322, 178.149440}, {2, -2}, {62.264409, -138.809338, -26.415906}, {0.163414, -0.208606}}};

}  // namespace

TEST_CASE("rays by a Q-type asphere of a sequence come to where CODE V lists them", "[scene][lens][oracle]") {
    const LensPrescription lens = parse_lens(kThreeMirrors, "three.seq");
    const LensPose last = lens_poses(lens)[lens.rows.size() - 1];
    double off = 0, turned = 0;
    for (const ListedRay& listed : kListed) {
        const auto ray = trace_lens(lens, listed.ray(), SpectralLine::kD, ApertureRule::kAll);
        REQUIRE(ray);
        const Vec3 end = last.local_point(ray->origin), way = last.local_direction(ray->direction);
        off = std::max(off, length(end - listed.end));
        turned = std::max(turned, length(Vec2(way) / way.z - listed.end_slope));
    }
    INFO("off by " << off << ", turned by " << turned);
    // Its places have six digits behind the point, coefficients five in all.
    CHECK(off < 2e-5);
    CHECK(turned < 2e-6);
    // Each term counts: without the least one the rim is elsewhere.
    std::string bent = kThreeMirrors;
    bent.replace(bent.find("SCO C4 -0.016782"), 16, "SCO C4 0");
    const LensPrescription other = parse_lens(bent, "three.seq");
    const auto ray = trace_lens(other, kListed[5].ray(), SpectralLine::kD, ApertureRule::kAll);
    REQUIRE(ray);
    const Vec3 way = last.local_direction(ray->direction);
    CHECK(length(Vec2(way) / way.z - kListed[5].end_slope) > 3e-5);
}
