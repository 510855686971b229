// The settings of cameras, each with the types that have it.
#include <algorithm>

#include "json/kinds.h"
#include "scene/read/reading.h"

namespace trilens {
namespace {

using Camera = CameraDescription;
using CameraFields = std::vector<Field<Camera>>;

/// A setting of one kind of camera, and of each kind that has the member.
template <typename Kind>
Field<Camera> of(Field<Kind> field, Need need = Need::kNo) {
    return of_kind<Camera>(std::move(field), need);
}

/// Linear views: perspective with a window that may be off the axis, and parallel ones.
CameraFields linear_fields() {
    using Perspective = PerspectiveCamera;
    return {
        of(setting(
            "shift", &Perspective::shift, several(2, number_in(-1000, 1000)),
            "perspective: the window moves by this share of the film's width and height, x right, y up.")),
        of(setting("near", &Perspective::near_depth, ref("notNegative"),
                   "perspective: what lies nearer along the view axis is not seen.")),
        of(setting("far", &Perspective::far_depth, ref("positive"),
                   "perspective: likewise what lies farther."))
            .without_default(),
        of_kinds<Camera>("ymag", TRILENS_MEMBER(ymag), ref("positive"),
                         "orthographic, oblique: half the film's height in the world."),
        of_kinds<Camera>(
            "angle", TRILENS_MEMBER(angle), number_in(-360, 360),
            "oblique: of receding lines on the film, from the right towards the top; planarContext: how "
            "far the ground turns up, at most 90."),
        of(setting("scale", &ObliqueCamera::scale, ref("notNegative"),
                   "oblique: length of receding lines on the film, 1 cavalier, 0.5 cabinet.")),
    };
}

/// A view by view plane, window and projection reference point (Foley et al.), and the window of crossed
/// slits.
CameraFields view_volume_fields() {
    return {
        of(setting("vrp", &ViewVolume::vrp, ref("vec3"), "viewVolume: a point of the view plane.")),
        of(setting("vpn", &ViewVolume::vpn, ref("vec3"), "viewVolume: its normal, towards the viewer.")),
        of(setting("vup", &ViewVolume::vup, ref("vec3"))),
        of(setting("prp", &ViewVolume::prp, ref("vec3"),
                   "viewVolume: the eye in (u, v, n) from the vrp; parallel: rays go from it to the "
                   "window's middle."),
           Need::kYes),
        of_kinds<Camera>("window", TRILENS_MEMBER(window), several(4, ref("number")),
                         "viewVolume, crossedSlits: umin, umax, vmin, vmax on the view plane (crossedSlits: "
                         "through 'at' of "
                         "lookAt), which fill the film.",
                         Need::kYes),
        of(either("projection", &ViewVolume::parallel, {"perspective", "parallel"}), Need::kYes),
        of(setting("front", &ViewVolume::front, ref("number"),
                   "viewVolume: n of the clipping plane; without it none."))
            .without_default(),
        of(setting("back", &ViewVolume::back, ref("number"), "viewVolume: likewise.")).without_default(),
    };
}

/// Panoramas, fisheyes and calibrated lenses.
CameraFields lens_fields() {
    Field<OpencvLens> distortion = part<OpencvLens>(
        "distortion",
        {{"type", "array"}, {"maxItems", 14}, {"items", ref("number")}, {"default", Json::array()}},
        "opencv: k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 tx ty (4, 5, 8, 12 or 14 of them), or the fisheye's k1 "
        "k2 k3 k4.");
    distortion.read = [](const Json& json, OpencvLens& into) {
        into.distortion = json.get<std::vector<double>>();
    };
    return {
        of_kinds<Camera>("hfov", TRILENS_MEMBER(hfov), number_above(0, 360),
                         "Longitudes across the film, degrees."),
        of_kinds<Camera>("vfov", TRILENS_MEMBER(vfov), number_above(0, 180),
                         "Latitudes over the film, degrees."),
        of(choice("mapping", &FisheyeCamera::mapping,
                  "fisheye: how the distance from the film's middle grows with the angle from the axis.")),
        of(setting("fov", &FisheyeCamera::fov, number_above(0, 360),
                   "fisheye: degrees across the film's smaller side; beyond that circle there are no rays.")),
        of(either("model", &OpencvLens::fisheye, {"pinhole", "fisheye"}), Need::kYes),
        of(setting("fx", &OpencvLens::fx, ref("positive"), "opencv: pixels of the film."), Need::kYes),
        of(setting("fy", &OpencvLens::fy, ref("positive")), Need::kYes),
        of(setting("cx", &OpencvLens::cx, ref("number"),
                   "opencv: pixels from the film's left edge, where a pixel's centre is at .5: OpenCV's own "
                   "cx + 0.5."),
           Need::kYes),
        of(setting("cy", &OpencvLens::cy, ref("number"), "opencv: likewise from the top."), Need::kYes),
        of(std::move(distortion)),
    };
}

/// Cameras of lines, and of three rays.
CameraFields line_fields() {
    return {
        of(setting("travel", &PushbroomCamera::travel, ref("vec3"),
                   "pushbroom: the eye's way from the film's left edge to its right; lookAt's eye is in the "
                   "middle."),
           Need::kYes),
        of(part<CrossedSlitsCamera>("slits", several(2, several(2, ref("vec3"))),
                                    "crossedSlits: a point and a direction each; rays begin at the first."),
           Need::kYes),
        of(part<ThreeRayCamera>(
               "rays", several(3, ref("placedRay")),
               "generalLinear: affine combinations of these by film place, after each direction d "
               "is scaled to d . w = 1 and each point p slid along it to (p - eye) . w = 0; w is "
               "unit, from lookAt's eye to its at."),
           Need::kYes),
    };
}

/// Cameras that show one part in detail and the rest as its context, or several views in one.
CameraFields context_fields() {
    using Bent = PlanarContextCamera;
    Json views = list_of(ref("view"), 1);
    views["maxItems"] = 64;
    return {
        of(setting("detail", &DistortionCamera::detail, several(4, ref("share")),
                   "distortion: x0, y0, x1, y1 of the film from its top left, drawn in perspective."),
           Need::kYes),
        of(setting("contextFov", &DistortionCamera::context_fov, number_above(0, 360),
                   "distortion: twice the angle from the view axis at the film's border.")),
        of(part<MultiPerspectiveCamera>("views", std::move(views),
                                        "multiPerspective: a view without a lookAt has the camera's."),
           Need::kYes),
        of(setting(
            "blend", &MultiPerspectiveCamera::blend, ref("share"),
            "multiPerspective: share of the film's width and height over which rays pass from one view "
            "to the next.")),
        of(setting("center", &InwardSphereCamera::center, ref("vec3"),
                   "inwardSphere: rays go to it, and on."),
           Need::kYes),
        of(setting("radius", &InwardSphereCamera::radius, ref("positive"), "inwardSphere: rays begin there."),
           Need::kYes),
        of(part<Bent>("ground", several(2, ref("vec3")), "planarContext: a point and the normal."),
           Need::kYes),
        of(setting("bend", &Bent::bend, ref("positive"),
                   "planarContext: distance from which the ground turns up, over an arc as long."),
           Need::kYes),
    };
}

/// How fine the mesh of a camera is that is not linear, or the mesh itself.
CameraFields fineness_fields() {
    const auto not_linear = [](Field<Camera> field) {
        field.kinds = kinds_with<CameraKind>([]<typename Kind>(const Kind&) { return kChoosesFacets<Kind>; });
        return field;
    };
    Field<Camera> facets = setting("facets", &Camera::facets, whole_in(1, kMostCameraFacets),
                                   "N x N over the film, where a camera is not linear.");
    facets.schema["default"] = kDefaultCameraFacets;
    const auto of_mesh = [](const char* key, Json values, const char* help) {
        return of(part<RayMeshCamera>(key, std::move(values), help), Need::kYes);
    };
    return {
        not_linear(std::move(facets)),
        not_linear(
            setting("tolerance", &Camera::tolerance, ref("positive"),
                    "Pixels: as many facets as leave no place further off, at the distance of `at` and far "
                    "away, but within 8 pixels of folds of the camera's own picture, where places have no "
                    "bound; along a panorama's rows near its poles a pixel counts as the angle it stands "
                    "for. Instead of facets."))
            .without_default(),
        of_mesh("points", list_of(ref("vec3"), 3), "rayMesh: origin of each corner's ray."),
        of_mesh("directions", list_of(ref("vec3"), 3),
                "rayMesh: one per corner, any length but 0; lengths weigh when rays between "
                "corners are interpolated."),
        of_mesh("screen", list_of(several(2, number_in(-1000, 1000)), 3),
                "rayMesh: one per corner, 0..1 from the film's top left; a facet may reach beyond the "
                "film."),
        of_mesh("triangles", list_of(several(3, ref("index")), 1), "rayMesh: three corners each."),
    };
}

CameraFields all_camera_fields() {
    Field<Camera> type = type_field<Camera>();
    type.schema["default"] = PerspectiveCamera::kName;
    Field<Camera> look_at = part<Camera>("lookAt", ref("lookAt"));
    look_at.kinds = kinds_with<CameraKind>([]<typename Kind>(const Kind&) { return kHasLookAt<Kind>; });
    look_at.needed_by = look_at.kinds;
    std::erase(look_at.needed_by, MultiPerspectiveCamera::kName);  // its views have their own
    CameraFields fields{
        setting("name", &Camera::name, ref("name")),
        std::move(type),
        of_kinds<Camera>("yfov", TRILENS_MEMBER(yfov), number_between(0, 180),
                         "The whole vertical angle, degrees; distortion: of the detail."),
        std::move(look_at),
    };
    for (CameraFields (*const chapter)() :
         {linear_fields, view_volume_fields, lens_fields, line_fields, context_fields, fineness_fields})
        for (Field<Camera>& field : chapter()) fields.push_back(std::move(field));
    return fields;
}

/// A view of a multi-perspective camera: a camera, its window a part of the film, whose facets are the
/// whole's.
std::vector<FieldSchema> view_fields() {
    const std::vector<std::string> whole{"viewVolume", "crossedSlits", "multiPerspective", "rayMesh"};
    const auto drop_whole = [&](std::vector<std::string>& kinds) {
        std::erase_if(kinds, [&](const std::string& kind) {
            return std::find(whole.begin(), whole.end(), kind) != whole.end();
        });
    };
    std::vector<FieldSchema> fields;
    for (const Field<Camera>& of_camera : camera_fields()) {
        FieldSchema field = of_camera;
        if (field.key == "facets" || field.key == "tolerance") continue;
        if (field.key == "window") field = part<Camera>("window", several(4, ref("share")));
        if (field.key == "lookAt") field.needed_by.clear();
        if (field.key == "type") {
            std::vector<std::string> names = kind_names<CameraKind>();
            drop_whole(names);
            field.schema["enum"] = names;
        }
        const bool of_all = field.kinds.empty();
        drop_whole(field.kinds);
        drop_whole(field.needed_by);
        if (of_all || !field.kinds.empty()) fields.push_back(std::move(field));
    }
    return fields;
}

}  // namespace

const std::vector<Field<CameraDescription>>& camera_fields() {
    static const CameraFields fields = all_camera_fields();
    return fields;
}

Json camera_schema() {
    return object_schema({.title = "a camera", .kind_title = "a # camera", .default_kind = "perspective"},
                         camera_fields());
}

Json view_schema() {
    return object_schema(
        {.title = "a view",
         .description =
             "A camera of a multiPerspective one, with its window: x0, y0, x1, y1 in shares of the "
             "film from its top left.",
         .required = {"window"},
         .kind_title = "a # view",
         .default_kind = "perspective"},
        view_fields());
}

}  // namespace trilens
