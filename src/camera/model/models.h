// The makers of the cameras that are not linear; each throws InputError with the field at fault.
#pragma once

#include <memory>

#include "base/description/camera_description.h"
#include "camera/model/camera_model.h"

namespace trilens {

/// A description with what all models need of it.
struct ModelSource {
    const CameraDescription& from;
    FilmSize film;
    CameraSite site;

    Placement look_at() const { return {from.eye, from.at, from.up}; }
    FilmAxes axes() const { return make_film_axes(look_at(), site); }
    double focus() const { return length(from.at - from.eye); }
};

using ModelPointer = std::shared_ptr<const CameraModel>;

/// A pinhole as a model, and parallel rays, for views of a multiPerspective camera.
ModelPointer make_linear_model(const ModelSource& source);

/// Longitude across, from -hfov / 2 to hfov / 2 about the up axis. Cylindrical: perspective along the up
/// axis, t the distance from it. Spherical: latitude, t the distance.
ModelPointer make_model(const CylindricalCamera& kind, const ModelSource& source);
ModelPointer make_model(const SphericalCamera& kind, const ModelSource& source);

/// Angle from the view axis by the distance from the film's middle; no rays beyond the circle of `fov`.
ModelPointer make_model(const FisheyeCamera& kind, const ModelSource& source);

/// OpenCV's pinhole model with radial, tangential, thin prism and tilt distortion, or its fisheye model. The
/// camera looks along the view axis, x right, y down. Refuses a lens that is not one-to-one on the film.
ModelPointer make_model(const OpencvLens& kind, const ModelSource& source);

/// Linear pushbroom (Gupta and Hartley, Linear Pushbroom Cameras, 1997): the eye moves by `travel` from the
/// film's left edge to its right, and is lookAt's in the middle; each column is one line of a perspective.
ModelPointer make_model(const PushbroomCamera& kind, const ModelSource& source);

/// Two slits (Zomet et al., Mosaicing New Views: The Crossed-Slits Projection, 2003): the ray of a place of
/// the window, on the plane through lookAt's `at` across the view axis, is the line that meets both slits. It
/// begins at the first slit and goes the way of the view axis.
ModelPointer make_model(const CrossedSlitsCamera& kind, const ModelSource& source);

/// Yu and McMillan, General Linear Cameras, 2004: the affine combinations of three rays, each taken where it
/// meets the plane through lookAt's eye across the view axis, with unit depth.
ModelPointer make_model(const ThreeRayCamera& kind, const ModelSource& source);

/// A perspective inside `detail`; outside of it the angle from the view axis, which goes through the
/// detail's middle, grows evenly to contextFov / 2 at the film's border (Vallance 2005, chapter 6.1).
ModelPointer make_model(const DistortionCamera& kind, const ModelSource& source);

/// Several cameras, each in its window; where windows meet, rays pass from one to the next over `blend`
/// (Vallance 2005, chapter 6 and appendix F). A blend may show a point several times; it is cut into strips,
/// and of several images inside one strip one is found.
ModelPointer make_model(const MultiPerspectiveCamera& kind, const ModelSource& source);

/// Rays from all around a sphere to its centre and on; the film's middle is the sphere's point nearest to
/// the eye of lookAt's direction (Vallance 2005, chapter 6 and appendix G).
ModelPointer make_model(const InwardSphereCamera& kind, const ModelSource& source);

/// The ground bends up: flat as far as `bend` ahead, then along an arc as long as that, then at `angle`. The
/// film shows the bent ground from the eye; each ray is the one of the flat world that meets the same ground
/// point in the same way (after Vallance 2005, appendix E).
ModelPointer make_model(const PlanarContextCamera& kind, const ModelSource& source);

/// That of the description's kind; null for rayMesh.
ModelPointer make_model(const ModelSource& source);

}  // namespace trilens
