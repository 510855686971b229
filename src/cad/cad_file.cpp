#include "cad/cad_file.h"

#include <trilens/error.h>
#include <trilens/scene.h>
#include <trilens/utilities.h>

#include <BRepBndLib.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <IGESControl_Reader.hxx>
#include <IGESGeom_TrimmedSurface.hxx>
#include <IGESSolid_Face.hxx>
#include <Interface_InterfaceModel.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <Poly_Triangulation.hxx>
#include <STEPControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <StepGeom_CartesianPoint.hxx>
#include <StepShape_FaceSurface.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_MapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <memory>
#include <optional>

#include "cad/cad_names.h"
#include "cad/cad_poles.h"
#include "cad/cad_surfaces.h"

namespace trilens {
namespace {

/// Triangles may turn by so much against each other.
constexpr double kMostTurn = 0.2;  // radians

/// The readers of both kinds of file are one class but for their names.
std::unique_ptr<XSControl_Reader> reader_of(const std::string& file) {
    const std::string ending = file_ending(file);
    if (ending == ".step" || ending == ".stp") return std::make_unique<STEPControl_Reader>();
    if (ending == ".iges" || ending == ".igs") return std::make_unique<IGESControl_Reader>();
    throw InputError(file, "", "is neither STEP (.step, .stp) nor IGES (.iges, .igs)");
}

/// Before anything is made of them: with an infinite one OpenCASCADE comes to no end.
void check_points(const XSControl_Reader& reader, const std::string& file) {
    const Handle(Interface_InterfaceModel) model = reader.Model();
    for (int i = 1; i <= model->NbEntities(); ++i) {
        const auto point = Handle(StepGeom_CartesianPoint)::DownCast(model->Value(i));
        for (int k = 1; !point.IsNull() && k <= point->NbCoordinates(); ++k)
            if (!(std::fabs(point->CoordinatesValue(k)) < kLargestCoordinate))
                throw InputError(file, "", "goes beyond coordinates of 1e30");
    }
}

/// Faces that the file speaks of.
std::size_t count_faces(const XSControl_Reader& reader) {
    const Handle(Interface_InterfaceModel) model = reader.Model();
    std::size_t count = 0;
    for (int i = 1; i <= model->NbEntities(); ++i) {
        const Handle(Standard_Transient) entity = model->Value(i);
        count += entity->IsKind(STANDARD_TYPE(StepShape_FaceSurface)) ||
                 entity->IsKind(STANDARD_TYPE(IGESSolid_Face)) ||
                 entity->IsKind(STANDARD_TYPE(IGESGeom_TrimmedSurface));
    }
    return count;
}

void set_triangles(const TopoDS_Face& face, CadFace& into) {
    TopLoc_Location place;
    const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, place);
    if (mesh.IsNull()) return;
    const bool reversed = face.Orientation() == TopAbs_REVERSED;
    const gp_Trsf& world_from_face = place.Transformation();
    for (int i = 1; i <= mesh->NbNodes(); ++i) {
        const gp_Pnt at = mesh->Node(i).Transformed(world_from_face);
        into.points.emplace_back(at.X(), at.Y(), at.Z());
    }
    for (int i = 1; i <= mesh->NbTriangles(); ++i) {
        int a = 0, b = 0, c = 0;
        mesh->Triangle(i).Get(a, b, c);
        if (reversed) std::swap(b, c);
        const auto at = [&](int node) { return into.points[static_cast<std::size_t>(node - 1)]; };
        // At a pole.
        if (length(cross(at(b) - at(a), at(c) - at(a))) == 0) continue;
        into.triangles.push_back({a - 1, b - 1, c - 1});
    }
}

void mesh_shape(const TopoDS_Shape& shape, double deviation) {
    BRepMesh_IncrementalMesh(shape, deviation, false, kMostTurn, false);
}

struct Reading {
    NameOfShape name_of;
    double deviation = 0;  // of triangles, in millimetres
    CadModel model{};
    TopTools_MapOfShape known{};  // what is in one of the bodies

    void add_body(const TopoDS_Shape& shape) {
        const bool is_solid = shape.ShapeType() == TopAbs_SOLID;
        const std::string name = name_of(shape);
        CadBody body{!name.empty() ? name : "body " + std::to_string(model.bodies.size() + 1), is_solid, {}};
        for (TopExp_Explorer at(shape, TopAbs_FACE); at.More(); at.Next()) {
            if (!known.Add(at.Current()) && !is_solid) continue;  // solids may share one
            TopoDS_Face shown = TopoDS::Face(at.Current());
            if (const std::optional<TopoDS_Face> whole = with_pole(shown)) {
                shown = *whole;
                mesh_shape(shown, deviation);
            }
            CadFace& face = body.faces.emplace_back();
            set_surfaces(shown, face);
            set_triangles(shown, face);
        }
        if (!body.faces.empty()) model.bodies.push_back(std::move(body));
    }
};

/// In millimetres, from a share of what all of the file measures.
double length_of(double share, const TopoDS_Shape& all, const std::string& file) {
    Bnd_Box box;
    BRepBndLib::Add(all, box);
    if (box.IsVoid()) return share;
    if (!(box.SquareExtent() < kLargestCoordinate * kLargestCoordinate))
        throw InputError(file, "", "goes beyond coordinates of 1e30");
    return std::max(share * std::sqrt(box.SquareExtent()), 1e-12);
}

}  // namespace

CadModel read_cad_file(const std::string& file, double deviation) {
    // It would write to standard output.
    Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_Printer));
    const auto reader = reader_of(file);
    if (!std::ifstream(file)) throw InputError(file, "", "cannot be read");
    try {
        if (reader->ReadFile(file.c_str()) != IFSelect_RetDone)
            throw InputError(file, "", "cannot be read: what is in it is not what its name says");
        check_points(*reader, file);
        reader->TransferRoots();
        const TopoDS_Shape all = reader->OneShape();
        if (all.IsNull()) throw InputError(file, "", "has no face");
        Reading reading{find_names(*reader), length_of(deviation, all, file)};
        mesh_shape(all, reading.deviation);
        for (const TopAbs_ShapeEnum kind : {TopAbs_SOLID, TopAbs_SHELL, TopAbs_FACE})
            for (TopExp_Explorer at(all, kind); at.More(); at.Next()) reading.add_body(at.Current());
        if (reading.model.bodies.empty()) throw InputError(file, "", "has no face");
        const std::size_t asked = count_faces(*reader),
                          made = static_cast<std::size_t>(reading.known.Extent());
        if (made < asked)
            reading.model.warnings.push_back(std::to_string(asked - made) + " of " + std::to_string(asked) +
                                             " faces are left out: OpenCASCADE makes nothing of them");
        return std::move(reading.model);
    } catch (const Standard_Failure& failure) {
        throw InputError(file, "", std::string("cannot be read: ") + failure.GetMessageString());
    }
}

}  // namespace trilens
