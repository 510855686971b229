#include "cad/cad_names.h"

#include <Interface_InterfaceModel.hxx>
#include <NCollection_DataMap.hxx>
#include <StepBasic_Product.hxx>
#include <StepBasic_ProductDefinition.hxx>
#include <StepBasic_ProductDefinitionFormation.hxx>
#include <StepRepr_CharacterizedDefinition.hxx>
#include <StepRepr_PropertyDefinition.hxx>
#include <StepRepr_Representation.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepRepr_RepresentationRelationshipWithTransformation.hxx>
#include <StepRepr_RepresentedDefinition.hxx>
#include <StepRepr_ShapeRepresentationRelationship.hxx>
#include <StepRepr_ShapeRepresentationRelationshipWithTransformation.hxx>
#include <StepShape_ShapeDefinitionRepresentation.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS_Shape.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_Reader.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <initializer_list>
#include <map>

namespace trilens {
namespace {

/// By a shape without its place.
using ShapeNames = NCollection_DataMap<TopoDS_Shape, std::string, TopTools_ShapeMapHasher>;

std::string text_of(const Handle(TCollection_HAsciiString) & text) {
    return text.IsNull() ? "" : text->ToCString();
}

/// Of the part that a representation is the shape of; empty where there is none.
std::string product_name(const StepShape_ShapeDefinitionRepresentation& of) {
    const Handle(StepRepr_PropertyDefinition) property = of.Definition().PropertyDefinition();
    if (property.IsNull()) return "";
    const Handle(StepBasic_ProductDefinition) definition = property->Definition().ProductDefinition();
    if (definition.IsNull() || definition->Formation().IsNull()) return "";
    const Handle(StepBasic_Product) product = definition->Formation()->OfProduct();
    const std::string name = product.IsNull() ? "" : text_of(product->Name());
    // Its writer counts parts that have no name so.
    return name.starts_with("Open CASCADE STEP translator") ? "" : name;
}

using PartNames = std::map<const StepRepr_Representation*, std::string>;

/// Of representations: those that parts name, and what these are said to be equal to.
PartNames part_names(const Interface_InterfaceModel& model) {
    PartNames names;
    for (int i = 1; i <= model.NbEntities(); ++i) {
        const auto shape = Handle(StepShape_ShapeDefinitionRepresentation)::DownCast(model.Value(i));
        if (shape.IsNull() || shape->UsedRepresentation().IsNull()) continue;
        const std::string name = product_name(*shape);
        if (!name.empty()) names.emplace(shape->UsedRepresentation().get(), name);
    }
    for (int i = 1; i <= model.NbEntities(); ++i) {
        const auto equal = Handle(StepRepr_ShapeRepresentationRelationship)::DownCast(model.Value(i));
        // With a transformation it places a part in another one.
        if (equal.IsNull() ||
            equal->IsKind(STANDARD_TYPE(StepRepr_RepresentationRelationshipWithTransformation)) ||
            equal->IsKind(STANDARD_TYPE(StepRepr_ShapeRepresentationRelationshipWithTransformation)))
            continue;
        const StepRepr_Representation *one = equal->Rep1().get(), *other = equal->Rep2().get();
        if (const auto known = names.find(one); known != names.end()) names.emplace(other, known->second);
        if (const auto known = names.find(other); known != names.end()) names.emplace(one, known->second);
    }
    return names;
}

/// All bodies of a shape that have no name yet.
void name_bodies(const TopoDS_Shape& shape, const std::string& name, ShapeNames& names) {
    for (const TopAbs_ShapeEnum kind : {TopAbs_SOLID, TopAbs_SHELL, TopAbs_FACE})
        for (TopExp_Explorer at(shape, kind); at.More(); at.Next()) {
            const TopoDS_Shape body = at.Current().Located(TopLoc_Location());
            if (!names.IsBound(body)) names.Bind(body, name);
        }
}

}  // namespace

NameOfShape find_names(const XSControl_Reader& reader) {
    const Handle(Interface_InterfaceModel) model = reader.Model();
    const Handle(Transfer_TransientProcess) process = reader.WS()->TransferReader()->TransientProcess();
    ShapeNames names;
    for (int i = 1; i <= model->NbEntities(); ++i) {
        const auto item = Handle(StepRepr_RepresentationItem)::DownCast(model->Value(i));
        if (item.IsNull() || text_of(item->Name()).empty()) continue;
        const TopoDS_Shape shape = TransferBRep::ShapeResult(process, item);
        if (!shape.IsNull()) names.Bind(shape.Located(TopLoc_Location()), text_of(item->Name()));
    }
    const PartNames parts = part_names(*model);
    for (int i = 1; i <= model->NbEntities(); ++i) {
        const auto part = Handle(StepRepr_Representation)::DownCast(model->Value(i));
        const auto name = parts.find(part.get());
        if (name == parts.end()) continue;
        for (int k = 1; k <= part->NbItems(); ++k) {
            const TopoDS_Shape shape = TransferBRep::ShapeResult(process, part->ItemsValue(k));
            if (!shape.IsNull()) name_bodies(shape, name->second, names);
        }
    }
    return [names](const TopoDS_Shape& shape) {
        const std::string* const name = names.Seek(shape.Located(TopLoc_Location()));
        return name ? *name : "";
    };
}

}  // namespace trilens
