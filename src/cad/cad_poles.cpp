#include "cad/cad_poles.h"

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_SurfaceOfRevolution.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace trilens {
namespace {

constexpr double kWholeTurn = 2 * std::numbers::pi;
constexpr double kSameTurn = 1e-6;  // files give twelve digits, some fewer

/// The meridian's parameter at a face's only side, a whole turn about the axis with the face after it.
std::optional<double> lone_rim(const TopoDS_Face& face) {
    std::optional<double> rim;
    for (TopExp_Explorer at(face.Oriented(TopAbs_FORWARD), TopAbs_EDGE); at.More(); at.Next()) {
        const TopoDS_Edge edge = TopoDS::Edge(at.Current());
        double first = 0, last = 0;
        const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
        if (rim || curve.IsNull()) return std::nullopt;
        gp_Pnt2d from = curve->Value(first), to = curve->Value(last);
        if (edge.Orientation() == TopAbs_REVERSED) std::swap(from, to);
        // A face lies to the left of its sides.
        if (!(std::fabs(to.X() - from.X() - kWholeTurn) < kSameTurn &&
              std::fabs(to.Y() - from.Y()) < kSameTurn))
            return std::nullopt;
        rim = from.Y();
    }
    return rim;
}

/// The first parameter of the meridian after the rim's where it meets the axis.
std::optional<double> pole_after(double rim, const Geom_SurfaceOfRevolution& surface) {
    const Handle(Geom_Curve) meridian = surface.BasisCurve();
    const gp_XYZ along = surface.Axis().Direction().XYZ();
    const auto from_axis = [&](double t) {
        const gp_XYZ off = meridian->Value(t).XYZ() - surface.Axis().Location().XYZ();
        return off - along * off.Dot(along);
    };
    const gp_XYZ outwards = from_axis(rim).Normalized();
    const auto is_before = [&](double t) { return from_axis(t).Dot(outwards) > 0; };
    // Parabolas and hyperbolas have no last parameter; theirs are lengths, and shares of one.
    const double last = meridian->IsPeriodic() ? rim + meridian->Period()
                                               : std::min(meridian->LastParameter(),
                                                          rim + 4 * std::max(1.0, from_axis(rim).Modulus()));
    constexpr int kSteps = 4096, kHalvings = 60;
    double before = rim;
    for (int i = 1; i <= kSteps; ++i) {
        double after = rim + (last - rim) * i / kSteps;
        if (is_before(after)) {
            before = after;
            continue;
        }
        for (int k = 0; k < kHalvings; ++k) {
            const double middle = 0.5 * (before + after);
            (is_before(middle) ? before : after) = middle;
        }
        return after;
    }
    return std::nullopt;
}

}  // namespace

std::optional<TopoDS_Face> with_pole(const TopoDS_Face& face) {
    const auto surface = Handle(Geom_SurfaceOfRevolution)::DownCast(BRep_Tool::Surface(face));
    if (surface.IsNull()) return std::nullopt;
    const std::optional<double> rim = lone_rim(face);
    if (!rim) return std::nullopt;
    const std::optional<double> pole = pole_after(*rim, *surface);
    if (!pole) return std::nullopt;
    BRepBuilderAPI_MakeFace whole(surface, 0, kWholeTurn, *rim, *pole, 1e-6);
    if (!whole.IsDone()) return std::nullopt;
    return TopoDS::Face(whole.Face().Oriented(face.Orientation()));
}

}  // namespace trilens
