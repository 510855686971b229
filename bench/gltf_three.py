#!/usr/bin/python3
"""Draws glTF models in trilens and in three.js, in headless Chromium, and says how unlike the pictures are.

    /usr/bin/python3 bench/gltf_three.py TRILENS FOLDER [THREE]

Ten models of Debian's assimp-testmodels and one that it makes, of plates with a normal map. Both draw the same
camera, two directional lights without shadows, 4 x 4 samples averaged as light, sRGB, no tone curve. THREE: the
folder of three.js, Debian's libjs-three by default. Writes FOLDER/gltf_three.csv (FLIP by `trilens compare`, the
share of pixels that differ by more than 8 of 255, the mean difference in 255ths, and FLIP again where three.js is
told to turn over the green of normal maps of meshes without tangents, as its later releases do), the pictures, and
FOLDER/gltf_three.png: each model by trilens, by three.js, and four times the difference.
"""
import base64
import csv
import functools
import http.server
import json
import math
import pathlib
import shutil
import struct
import subprocess
import sys
import threading
import zlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.image
import matplotlib.pyplot as plt
import numpy as np

WIDTH, HEIGHT, SAMPLES = 320, 240, 4
MODELS = pathlib.Path("/usr/share/assimp/models/glTF2")
THREE = "/usr/share/javascript/three"
# name: file, seconds of its animation
CASES = {
    "BoxTextured": ("BoxTextured-glTF-Binary/BoxTextured.glb", None),
    "2CylinderEngine": ("2CylinderEngine-glTF-Binary/2CylinderEngine.glb", None),
    "ClearCoatTest": ("ClearCoat-glTF/ClearCoatTest.gltf", None),
    "AnimatedMorphCube": ("glTF-Sample-Models/AnimatedMorphCube-glTF/AnimatedMorphCube.gltf", 1.0),
    "simple_skin": ("simple_skin/simple_skin.gltf", 1.0),
    "TextureTransformTest": ("textureTransform/TextureTransformTest.gltf", None),
    "boxTexcoords": ("BoxTexcoords-glTF/boxTexcoords.gltf", None),
    "BoxBadNormals": ("BoxBadNormals-glTF-Binary/BoxBadNormals.glb", None),
    "Cameras": ("cameras/Cameras.gltf", None),
    "Mesh_PrimitiveMode_06": ("glTF-Asset-Generator/Mesh_PrimitiveMode/Mesh_PrimitiveMode_06.gltf", None),
}
LIGHTS = [{"direction": [-0.45, -0.8, -0.6], "intensity": 2.4}, {"direction": [0.8, -0.1, -0.3], "intensity": 0.9}]
BACKGROUND = [0.1, 0.12, 0.15]

PAGE = """<!DOCTYPE html><meta charset="utf-8"><script src="/three/build/three.js"></script>
<script src="/three/examples/js/loaders/GLTFLoader.js"></script><script>
const post = (path, body) => fetch(path, {method: "POST", body});
const srgb = x => x <= 0.0031308 ? 12.92 * x : 1.055 * Math.pow(x, 1 / 2.4) - 0.055;
function draw(renderer, job, gltf, turned) {
    if (turned)
        gltf.scene.traverse(one => {
            if (one.isMesh && one.material.normalScale && !one.geometry.attributes.tangent) one.material.normalScale.y *= -1;
        });
    const scene = new THREE.Scene(), n = job.samples, w = job.width, h = job.height;
    scene.add(gltf.scene);
    if (job.time !== null && gltf.animations.length > 0) {
        const mixer = new THREE.AnimationMixer(gltf.scene);
        mixer.clipAction(gltf.animations[0]).play();
        mixer.update(job.time);
    }
    for (const one of job.lights) {
        const light = new THREE.DirectionalLight(0xffffff, one.intensity);
        light.position.set(...one.direction.map(x => -x));
        scene.add(light);
    }
    const c = job.camera, far = 4 * Math.hypot(...c.eye.map((x, i) => x - c.at[i]));
    const camera = new THREE.PerspectiveCamera(c.yfov, w / h, far / 4000, far);
    camera.position.set(...c.eye);
    camera.up.set(...c.up);
    camera.lookAt(...c.at);
    const target = new THREE.WebGLRenderTarget(n * w, n * h, {type: THREE.FloatType});
    renderer.setRenderTarget(target);
    renderer.setClearColor(new THREE.Color(...job.background), 1);
    renderer.clear();
    renderer.render(scene, camera);
    const all = new Float32Array(4 * n * w * n * h), mean = new Uint8Array(3 * w * h);
    renderer.readRenderTargetPixels(target, 0, 0, n * w, n * h, all);
    for (let y = 0; y < h; ++y)
        for (let x = 0; x < w; ++x)
            for (let k = 0; k < 3; ++k) {
                let sum = 0;
                for (let j = 0; j < n; ++j)
                    for (let i = 0; i < n; ++i) sum += all[4 * ((n * (h - 1 - y) + j) * n * w + n * x + i) + k];
                mean[3 * (y * w + x) + k] = Math.round(255 * srgb(Math.min(Math.max(sum / (n * n), 0), 1)));
            }
    return mean;
}
(async () => {
    try {
        const jobs = await (await fetch("/jobs")).json(), canvas = document.createElement("canvas");
        const context = canvas.getContext("webgl2");
        if (!context.getExtension("EXT_color_buffer_float")) throw new Error("no pictures of floats");
        const renderer = new THREE.WebGLRenderer({canvas, context});
        renderer.physicallyCorrectLights = true;
        for (const job of jobs) {
            for (const turned of [false, true]) {
                const gltf = await new Promise((done, failed) => new THREE.GLTFLoader().load(
                    job.url, done, undefined, e => failed(new Error(job.name + ": " + e))));
                await post("/picture/" + job.name + (turned ? ".turned" : ""), draw(renderer, job, gltf, turned));
            }
        }
        await post("/done", "three.js r" + THREE.REVISION);
    } catch (error) { await post("/failed", String(error)); }
})();
</script>"""


def png(pixels):
    """Bytes of a PNG of height x width x 3 bytes."""
    rows = b"".join(b"\0" + row.tobytes() for row in pixels.astype(np.uint8))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", pixels.shape[1], pixels.shape[0], 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def bumps(size=128):
    """A normal map of four domes, whose light comes from above where +Y is up."""
    y, x = np.mgrid[0:size, 0:size] / size * 4 - 1
    x, y = (x + 1) % 2 - 1, 1 - (y + 1) % 2  # from the dome's middle, y upward
    inside = np.maximum(0.81 - x * x - y * y, 0)
    z = np.where(inside > 0, np.sqrt(inside + 0.19), 1)
    normal = np.stack([np.where(inside > 0, x, 0), np.where(inside > 0, y, 0), z], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return np.round(127.5 * (normal + 1))


def write_plates(file):
    """Plates with domes: without tangents and with; uv as they are, mirrored in u, and turned by a quarter."""
    plates = [(uv, given) for given in (False, True) for uv in ("plain", "mirrored", "turned")]
    views, accessors, meshes, nodes, data = [], [], [], [], b""

    def add(array, kind, component):
        nonlocal data
        raw = np.asarray(array, "<f4" if component == 5126 else "<u2")
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": raw.nbytes})
        accessors.append({"bufferView": len(views) - 1, "componentType": component, "count": len(raw), "type": kind})
        if kind == "VEC3":
            accessors[-1].update(min=raw.min(0).tolist(), max=raw.max(0).tolist())
        data += raw.tobytes()
        return len(accessors) - 1

    corner = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], float)
    points = add(np.c_[corner, np.zeros(4)], "VEC3", 5126)
    normals = add(np.tile([0, 0, 1], (4, 1)), "VEC3", 5126)
    indices = add([0, 1, 2, 0, 2, 3], "SCALAR", 5123)
    for k, (uv, given) in enumerate(plates):
        s, t = (corner.T + 1) / 2
        u, v = {"plain": (s, t), "mirrored": (1 - s, t), "turned": (t, 1 - s)}[uv]
        attributes = {"POSITION": points, "NORMAL": normals, "TEXCOORD_0": add(np.c_[u, 1 - v], "VEC2", 5126)}
        if given:
            tangent = {"plain": [1, 0, 0, 1], "mirrored": [-1, 0, 0, -1], "turned": [0, 1, 0, 1]}[uv]
            attributes["TANGENT"] = add(np.tile(tangent, (4, 1)), "VEC4", 5126)
        meshes.append({"primitives": [{"attributes": attributes, "indices": indices, "material": 0}]})
        nodes.append({"mesh": k, "translation": [2.2 * (k % 3 - 1), 1.1 if k < 3 else -1.1, 0]})

    def uri(kind, content):
        return f"data:{kind};base64," + base64.b64encode(content).decode()

    file.write_text(json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes,
        "meshes": meshes, "accessors": accessors, "bufferViews": views,
        "materials": [{"normalTexture": {"index": 0},
                       "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0.6}}],
        "textures": [{"source": 0}], "images": [{"uri": uri("image/png", png(bumps()))}],
        "buffers": [{"byteLength": len(data), "uri": uri("application/octet-stream", data)}]}))


def run(command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode not in (0, 1):
        sys.exit(f"{' '.join(map(str, command))} failed:\n{done.stderr}")
    return done.stdout


def draw_by_trilens(trilens, folder, model, name, time):
    """Writes the picture; returns the camera, which sees all of the model from before and above."""
    bounds = json.loads(run([trilens, "scene", "info", model, "--json", "-q"]))["bounds"]
    low, high = np.array(bounds["low"]), np.array(bounds["high"])
    at, yfov = (low + high) / 2, 40
    away = np.array([0.5, 0.4, 1])
    eye = at + away / np.linalg.norm(away) * np.linalg.norm(high - low) / 2 / math.sin(math.radians(yfov / 2))
    place = {"eye": eye.tolist(), "at": at.tolist(), "up": [0, 1, 0]}
    wanted = {"file": str(model)} if time is None else {"file": str(model), "time": time}
    scene = {"version": 1, "film": {"width": WIDTH, "height": HEIGHT, "spp": SAMPLES}, "import": wanted,
             "cameras": [{"name": "all of it", "yfov": yfov, "lookAt": place}], "background": {"color": BACKGROUND},
             "lights": [{"name": f"light {i}", "type": "directional", "shadows": False, **light}
                        for i, light in enumerate(LIGHTS)]}
    (folder / f"{name}.json").write_text(json.dumps(scene))
    run([trilens, "render", folder / f"{name}.json", "-q", "-o", folder / f"{name}.trilens.png"])
    return {"yfov": yfov, **place}


class Browser(http.server.BaseHTTPRequestHandler):
    """Serves the page, three.js and the models, and takes the pictures."""

    def __init__(self, desk, *rest):
        self.desk = desk
        super().__init__(*rest)

    def answer(self, content, kind):
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)

    def do_GET(self):
        root, _, rest = self.path[1:].partition("/")
        if root == "page":
            return self.answer(PAGE.encode(), "text/html")
        if root == "jobs":
            return self.answer(json.dumps(self.desk.jobs).encode(), "application/json")
        folder = self.desk.roots.get(root)
        if folder is None or not (folder / rest).is_file():
            return self.send_error(404)
        return self.answer((folder / rest).read_bytes(),
                           "text/javascript" if rest.endswith(".js") else "application/octet-stream")

    def do_POST(self):
        body = self.rfile.read(int(self.headers["Content-Length"]))
        self.answer(b"", "text/plain")
        if self.path.startswith("/picture/"):
            name = self.path.removeprefix("/picture/")
            pixels = np.frombuffer(body, np.uint8).reshape(HEIGHT, WIDTH, 3)
            (self.desk.folder / f"{name}.three.png").write_bytes(png(pixels))
        else:
            self.desk.words = body.decode()
            self.desk.failed = self.path == "/failed"
            self.desk.done.set()

    def log_message(self, *_):
        """The server says nothing."""


class Desk:
    """What the browser is to draw, and what it said."""

    def __init__(self, folder, three):
        self.folder, self.jobs, self.roots = folder, [], {"three": pathlib.Path(three)}
        self.done, self.failed, self.words = threading.Event(), False, ""


def draw_by_three(desk):
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Browser, desk))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    with subprocess.Popen(["chromium", "--headless=new", "--no-sandbox", "--use-angle=swiftshader",
                           "--enable-unsafe-swiftshader", f"--user-data-dir={desk.folder / 'chromium'}",
                           f"http://127.0.0.1:{server.server_port}/page"],
                          stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as chromium:
        finished = desk.done.wait(300)
        chromium.terminate()
    server.shutdown()
    shutil.rmtree(desk.folder / "chromium", ignore_errors=True)
    if not finished or desk.failed:
        sys.exit(f"three.js drew nothing: {desk.words or 'no answer in five minutes'}")
    return desk.words


def flip_of(trilens, reference, test):
    return json.loads(run([trilens, "compare", reference, test, "--json", "-q"]))["metrics"]["RGB"]["flip"]


def write_page(folder, names, rows):
    across = 2
    down = math.ceil(len(names) / across)
    figure, axes = plt.subplots(down, 3 * across, figsize=(3 * across * 2.4, down * 2.05))
    for axis in axes.flat:
        axis.axis("off")
    for k, name in enumerate(names):
        pictures = [matplotlib.image.imread(folder / f"{name}.{by}.png")[..., :3] for by in ("trilens", "three")]
        pictures.append(np.minimum(4 * np.abs(pictures[0] - pictures[1]), 1))
        titles = [name, "three.js", f"4 x difference, FLIP {rows[k]['flip']}"]
        for i, (picture, title) in enumerate(zip(pictures, titles)):
            axis = axes[k // across, 3 * (k % across) + i]
            axis.imshow(picture)
            axis.set_title(title, fontsize=8)
    figure.tight_layout(pad=0.4)
    figure.savefig(folder / "gltf_three.png", dpi=110)


def main():
    if not 3 <= len(sys.argv) <= 4:
        sys.exit(__doc__)
    trilens, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    three = sys.argv[3] if len(sys.argv) > 3 else THREE
    for needed, package in ((MODELS, "assimp-testmodels"), (pathlib.Path(three) / "build/three.js", "libjs-three")):
        if not needed.exists():
            sys.exit(f"skipped: Debian's {package} is not installed")
    if not shutil.which("chromium"):
        sys.exit("skipped: Chromium is not installed")
    folder.mkdir(parents=True, exist_ok=True)
    write_plates(folder / "plates.gltf")
    desk = Desk(folder, three)
    models = {name: (MODELS / file, time) for name, (file, time) in CASES.items()}
    models["plates"] = (folder / "plates.gltf", None)
    for name, (model, time) in models.items():
        desk.roots[name] = model.parent
        desk.jobs.append({"name": name, "url": f"/{name}/{model.name}", "time": time, "lights": LIGHTS,
                          "camera": draw_by_trilens(trilens, folder, model, name, time), "width": WIDTH,
                          "height": HEIGHT, "samples": SAMPLES, "background": BACKGROUND})
    version = draw_by_three(desk)
    rows = []
    for name in models:
        files = [folder / f"{name}.{by}.png" for by in ("three", "trilens")]
        flip, turned = (flip_of(trilens, one, files[1]) for one in (files[0], folder / f"{name}.turned.three.png"))
        three_js, ours = (np.round(255 * matplotlib.image.imread(file)[..., :3]) for file in files)
        unlike = np.mean(np.abs(three_js - ours).max(axis=-1) > 8)
        rows.append({"model": name, "flip": f"{flip:.4f}", "unlike_percent": f"{100 * unlike:.2f}",
                     "mean_difference": f"{np.mean(ours - three_js):+.2f}", "flip_green_turned": f"{turned:.4f}"})
    with open(folder / "gltf_three.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    write_page(folder, list(models), rows)
    print(version)
    print((folder / "gltf_three.csv").read_text(), end="")


if __name__ == "__main__":
    main()
