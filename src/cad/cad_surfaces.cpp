#include "cad/cad_surfaces.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepGProp.hxx>
#include <BRepTools.hxx>
#include <BRepTools_WireExplorer.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <GeomConvert.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <cmath>
#include <optional>

namespace trilens {
namespace {

/// A face whose area is this near to its surface's, as a share of it, is all of it.
constexpr double kWhole = 1e-6;

/// Parameters as near as this to an end of the surface's, as a share of the face's range, are that end.
constexpr double kSameParameter = 1e-9;

Vec3 vec_of(const gp_XYZ& at) {
    return {at.X(), at.Y(), at.Z()};
}

double area_of(const TopoDS_Shape& shape) {
    GProp_GProps of;
    BRepGProp::SurfaceProperties(shape, of, 1e-9);
    return std::fabs(of.Mass());
}

/// A knot as often as it counts.
std::vector<double> repeated(const TColStd_Array1OfReal& knots, const TColStd_Array1OfInteger& times) {
    std::vector<double> all;
    for (int i = knots.Lower(); i <= knots.Upper(); ++i)
        all.insert(all.end(), static_cast<std::size_t>(times(i)), knots(i));
    return all;
}

/// What `reversed` says of a face is said by the direction of u here.
CadSurface surface_of(const Handle(Geom_BSplineSurface) & spline, bool reversed) {
    if (spline->IsUPeriodic()) spline->SetUNotPeriodic();
    if (spline->IsVPeriodic()) spline->SetVNotPeriodic();
    if (reversed) spline->UReverse();
    CadSurface surface;
    surface.columns = spline->NbUPoles();
    surface.degree = {spline->UDegree(), spline->VDegree()};
    for (int v = 1; v <= spline->NbVPoles(); ++v)
        for (int u = 1; u <= spline->NbUPoles(); ++u) {
            surface.points.push_back(vec_of(spline->Pole(u, v).XYZ()));
            surface.weights.push_back(spline->Weight(u, v));
        }
    surface.knots = {repeated(spline->UKnots(), spline->UMultiplicities()),
                     repeated(spline->VKnots(), spline->VMultiplicities())};
    return surface;
}

/// A side of a flat face, with the face to its left as seen from its front.
Handle(Geom_BSplineCurve) curve_of(const TopoDS_Edge& edge, bool reversed) {
    double first = 0, last = 0;
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, first, last);
    if (curve.IsNull()) return nullptr;
    Handle(Geom_BSplineCurve) spline =
        GeomConvert::CurveToBSplineCurve(new Geom_TrimmedCurve(curve, first, last));
    if (spline->IsPeriodic()) spline->SetNotPeriodic();
    if ((edge.Orientation() == TopAbs_REVERSED) != reversed) spline->Reverse();
    return spline;
}

using SideCurves = std::vector<Handle(Geom_BSplineCurve)>;

/// Of a face that is not reversed, or as if it were. None where one has no curve in space, or does not meet
/// the next.
std::optional<SideCurves> curves_of(const TopoDS_Wire& wire, const TopoDS_Face& face, bool reversed) {
    SideCurves curves;
    for (BRepTools_WireExplorer at(wire, face); at.More(); at.Next()) {
        curves.push_back(curve_of(at.Current(), reversed));
        if (curves.back().IsNull()) return std::nullopt;
    }
    // The explorer stops where sides do not meet.
    std::size_t sides = 0;
    for (TopExp_Explorer at(wire, TopAbs_EDGE); at.More(); at.Next()) ++sides;
    if (curves.size() != sides) return std::nullopt;
    return curves;
}

/// Between a curve and another one of the same degree and knots, or a point: both lie in the plane.
struct Ruled {
    const Handle(Geom_BSplineCurve) & outer;
    const Handle(Geom_BSplineCurve) & inner;  // null: the point
    Vec3 point{0}, normal{0};

    /// Whether it covers each place once.
    bool is_simple() const {
        constexpr int kPlaces = 256;
        const double first = outer->FirstParameter(), last = outer->LastParameter();
        for (int i = 0; i <= kPlaces; ++i) {
            const double t = first + (last - first) * i / kPlaces;
            gp_Pnt at, in;
            gp_Vec along, within;
            outer->D1(t, at, along);
            Vec3 to = point;
            if (!inner.IsNull()) {
                inner->D1(t, in, within);
                to = vec_of(in.XYZ());
            }
            const Vec3 inwards = to - vec_of(at.XYZ());
            if (!(dot(cross(vec_of(along.XYZ()), inwards), normal) > 0)) return false;
            if (!inner.IsNull() && !(dot(cross(vec_of(within.XYZ()), inwards), normal) > 0)) return false;
        }
        return true;
    }

    CadSurface surface() const {
        CadSurface made;
        made.columns = outer->NbPoles();
        made.degree = {outer->Degree(), 1};
        for (int row = 0; row < 2; ++row)
            for (int i = 1; i <= outer->NbPoles(); ++i) {
                const Handle(Geom_BSplineCurve)& of = row == 1 && !inner.IsNull() ? inner : outer;
                made.points.push_back(row == 1 && inner.IsNull() ? point : vec_of(of->Pole(i).XYZ()));
                made.weights.push_back(of->Weight(i));
            }
        made.knots = {repeated(outer->Knots(), outer->Multiplicities()), {0, 0, 1, 1}};
        return made;
    }
};

/// But for rounding, which one's become when it is turned around.
bool have_same_knots(const Handle(Geom_BSplineCurve) & a, const Handle(Geom_BSplineCurve) & b) {
    const std::vector<double> of_a = repeated(a->Knots(), a->Multiplicities()),
                              of_b = repeated(b->Knots(), b->Multiplicities());
    const double room = 1e-12 * (of_a.back() - of_a.front());
    return a->Degree() == b->Degree() &&
           std::equal(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(),
                      [&](double one, double other) { return std::fabs(one - other) <= room; });
}

/// A flat face within one ring of sides, from its middle; or between two that are one side each, as a ring
/// between circles. Empty where that is not all of it, and nothing else.
std::vector<CadSurface> flat_surfaces(const TopoDS_Face& oriented) {
    const bool reversed = oriented.Orientation() == TopAbs_REVERSED;
    const TopoDS_Face face = TopoDS::Face(oriented.Oriented(TopAbs_FORWARD));
    const TopoDS_Wire outline = BRepTools::OuterWire(face);
    std::vector<TopoDS_Wire> holes;
    for (TopExp_Explorer at(face, TopAbs_WIRE); at.More(); at.Next())
        if (!at.Current().IsSame(outline)) holes.push_back(TopoDS::Wire(at.Current()));
    const std::optional<SideCurves> outer = curves_of(outline, face, reversed);
    if (!outer || holes.size() > 1) return {};

    GProp_GProps mass;
    BRepGProp::SurfaceProperties(face, mass);
    gp_Dir up = BRepAdaptor_Surface(face).Plane().Axis().Direction();
    if (!BRepAdaptor_Surface(face).Plane().Direct()) up.Reverse();
    if (reversed) up.Reverse();
    std::optional<SideCurves> inner;
    if (!holes.empty()) {
        inner = curves_of(holes[0], face, reversed);
        if (!inner || inner->size() != 1 || outer->size() != 1) return {};
        (*inner)[0]->Reverse();
        if (!have_same_knots((*outer)[0], (*inner)[0])) return {};
    }
    std::vector<CadSurface> surfaces;
    for (const Handle(Geom_BSplineCurve) & side : *outer) {
        const Ruled ruled{side, inner ? (*inner)[0] : Handle(Geom_BSplineCurve)(),
                          vec_of(mass.CentreOfMass().XYZ()), vec_of(up.XYZ())};
        if (!ruled.is_simple()) return {};
        surfaces.push_back(ruled.surface());
    }
    return surfaces;
}

struct ParameterRange {
    double first = 0, last = 0;

    /// Without what rounding added beyond the surface's own range, which is a period where `is_periodic`: the
    /// conversions take it for another turn, or refuse it.
    void draw_into(const ParameterRange& own, bool is_periodic) {
        const double room = kSameParameter * (last - first);
        if (is_periodic) {
            if (last - first >= own.last - own.first - room) *this = own;
            return;
        }
        if (first <= own.first + room) first = own.first;
        if (last >= own.last - room) last = own.last;
    }
};

/// What a face's sides span of its surface's parameters.
struct ParameterBox {
    ParameterRange u, v;

    ParameterBox(const TopoDS_Face& face, const Geom_Surface& surface) {
        BRepTools::UVBounds(face, u.first, u.last, v.first, v.last);
        ParameterRange all_u, all_v;
        surface.Bounds(all_u.first, all_u.last, all_v.first, all_v.last);
        u.draw_into(all_u, surface.IsUPeriodic());
        v.draw_into(all_v, surface.IsVPeriodic());
    }
};

}  // namespace

void set_surfaces(const TopoDS_Face& face, CadFace& into) {
    try {
        const Handle(Geom_Surface) whole = BRep_Tool::Surface(face);
        if (whole.IsNull()) {
            into.fault = "it has no surface";
            return;
        }
        const auto [u, v] = ParameterBox(face, *whole);
        if (!(u.first < u.last && v.first < v.last)) {
            into.fault = "as OpenCASCADE reads it, it has no area";
            return;
        }
        into.covered = area_of(face) /
                       area_of(BRepBuilderAPI_MakeFace(whole, u.first, u.last, v.first, v.last, 1e-9).Face());
        if (!(into.covered < 1 - kWhole)) into.covered = 1;
        if (into.covered < 1 && BRepAdaptor_Surface(face).GetType() == GeomAbs_Plane) {
            into.surfaces = flat_surfaces(face);
            if (!into.surfaces.empty()) {
                into.covered = 1;
                return;
            }
        }
        const Handle(Geom_Surface) cut =
            new Geom_RectangularTrimmedSurface(whole, u.first, u.last, v.first, v.last);
        into.surfaces = {
            surface_of(GeomConvert::SurfaceToBSplineSurface(cut), face.Orientation() == TopAbs_REVERSED)};
    } catch (const Standard_Failure& failure) {
        into.surfaces.clear();
        into.fault = std::string("its surface has no form as NURBS (OpenCASCADE: ") +
                     failure.GetMessageString() + "), which mirrors and glass need; as an object it can stay";
    }
}

}  // namespace trilens
