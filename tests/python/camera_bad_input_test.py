"""Scene files whose cameras are none: exit code 3, one message with file and place, nothing written."""
import json

import pytest

LOOK = {"eye": [0, 0, 3], "at": [0, 0, 0]}
VOLUME = {"type": "viewVolume", "vrp": [0, 0, 0], "vpn": [0, 0, 1], "vup": [0, 1, 0], "prp": [0, 0, 3],
          "window": [-1, 1, -1, 1], "projection": "perspective"}
SLITS = {"type": "crossedSlits", "lookAt": LOOK, "slits": [[[0, 0, 3], [0, 1, 0]], [[0, 0, 4], [1, 0, 0]]],
         "window": [-1, 1, -1, 1]}
LENS = {"type": "opencv", "model": "pinhole", "fx": 40, "fy": 40, "cx": 32, "cy": 24, "lookAt": LOOK}
MESH = {"type": "rayMesh", "points": [[0, 0, 3]] * 3, "directions": [[0, 0, -1], [0.1, 0, -1], [0, 0.1, -1]],
        "screen": [[0, 0], [1, 0], [0, 1]], "triangles": [[0, 1, 2]]}


def three_rays(**changes):
    rays = [{"point": [-1, 1, 3], "direction": [-0.3, 0.3, -1], "screen": [0, 0]},
            {"point": [1, 1, 3], "direction": [0.3, 0.3, -1], "screen": [1, 0]},
            {"point": [0, -1, 3], "direction": [0, -0.3, -1], "screen": [0.5, 1]}]
    return {"type": "generalLinear", "lookAt": LOOK, "rays": [{**ray, **changes} for ray in rays]}


CASES = {
    "slits whose rays meet in the film": ({**SLITS, "slits": [[[0, 0, 0], [0, 1, 0]], [[0, 0, 2], [1, 0, 0]]]},
                                          "/cameras/0/slits"),
    "three rays at one place of the film": (three_rays(screen=[0, 0]), "/cameras/0/rays"),
    "three rays of no direction": (three_rays(direction=[0, 0, 0]), "/cameras/0/rays/0/direction"),
    "a corner of no direction": ({**MESH, "directions": [[0, 0, 0], [0.1, 0, -1], [0, 0.1, -1]]},
                                 "/cameras/0/directions/0"),
    "a window of no area before slits": ({**SLITS, "window": [1, 1, -1, 1]}, "/cameras/0/window"),
    "a window of no area on a view plane": ({**VOLUME, "window": [-1, 1, 1, 1]}, "/cameras/0/window"),
    "an eye in the view plane": ({**VOLUME, "prp": [0, 0, 0]}, "/cameras/0/prp"),
    "parallel rays in the view plane": ({**VOLUME, "prp": [1, 0, 0], "projection": "parallel"}, "/cameras/0/prp"),
    "a lens that folds the film": ({**LENS, "distortion": [-2, 0, 0, 0]}, "/cameras/0/distortion"),
    "a fisheye lens that folds the film": ({**LENS, "model": "fisheye", "fx": 20, "fy": 20, "distortion": [-1, 0, 0, 0]},
                                           "/cameras/0/distortion"),
    "a tolerance out of reach": ({"type": "fisheye", "fov": 180, "tolerance": 1e-7, "lookAt": LOOK},
                                 "/cameras/0/tolerance"),
    "a view of no area": ({"type": "multiPerspective", "lookAt": LOOK,
                           "views": [{"yfov": 40, "lookAt": LOOK, "window": [0, 0, 0, 1]}]},
                          "/cameras/0/views/0/window"),
}


def write_scene(folder, camera):
    scene = {"version": 1, "film": {"width": 64, "height": 48}, "cameras": [{"name": "main", **camera}],
             "materials": [{"name": "red", "unlit": True}],
             "meshes": [{"name": "wall", "role": "object", "material": "red",
                         "points": [[-9, -9, -3], [9, -9, -3], [9, 9, -3], [-9, 9, -3]],
                         "faceVertexCounts": [4], "faceVertexIndices": [0, 1, 2, 3]}]}
    file = folder / "scene.json"
    file.write_text(json.dumps(scene))
    return file


@pytest.mark.parametrize("name", CASES)
def test_a_camera_that_is_none_is_refused(name, command, tmp_path):
    camera, place = CASES[name]
    file = write_scene(tmp_path, camera)
    for verb in ("render", "trace"):
        code, answer = command(verb, file, "-o", tmp_path / "out.exr")
        assert code == answer["exit_code"] == 3 and answer["status"] == "error"
        (error,) = answer["errors"]
        assert f"{file}: {place}: " in (error if isinstance(error, str) else error["message"])
        assert not (tmp_path / "out.exr").exists()


@pytest.mark.parametrize("number", ["NaN", "1e999"])
def test_numbers_that_are_none_are_refused(number, command, tmp_path):
    file = write_scene(tmp_path, MESH)
    file.write_text(file.read_text().replace("[0, 0, -1]", f"[{number}, 0, -1]", 1))
    code, answer = command("render", file, "-o", tmp_path / "out.exr")
    assert code == 3 and len(answer["errors"]) == 1 and not (tmp_path / "out.exr").exists()
