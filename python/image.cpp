// Images: channels as numpy arrays that look into the image, without a copy.
#include "arrays.h"
#include "bindings.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "python_call.h"

namespace trilens::python {
namespace {

Channel& channel_of(HeldImage& held, const std::string& name) {
    if (Channel* channel = held.image.find(name)) return *channel;
    throw py::key_error(name);
}

py::array view_of(const py::object& self, const std::string& name) {
    HeldImage& held = self.cast<HeldImage&>();
    Channel& channel = channel_of(held, name);
    const std::vector<py::ssize_t> shape{held.image.data_height, held.image.data_width};
    if (channel.is_id()) return py::array_t<Id>(shape, channel.ids().data(), self);
    return py::array_t<float>(shape, channel.floats().data(), self);
}

std::vector<std::string> names_in(const HeldImage& held) {
    std::vector<std::string> names;
    for (const Channel& channel : held.image.channels) names.push_back(channel.name);
    return names;
}

py::array rgb_of(HeldImage& held, const std::string& layer) {
    const std::string prefix = layer.empty() ? "" : layer + ".";
    const std::size_t pixels = held.image.pixels();
    std::vector<float> rgb(3 * pixels);
    for (std::size_t c = 0; c < 3; ++c) {
        const std::string name = prefix + "RGB"[c];
        const Channel& channel = channel_of(held, name);
        if (channel.is_id()) throw UsageError("the channel " + channel.name + " holds ids, not colours");
        for (std::size_t p = 0; p < pixels; ++p) rgb[3 * p + c] = channel.floats()[p];
    }
    return array_of(std::move(rgb), {held.image.data_height, held.image.data_width, 3});
}

template <class Value>
std::vector<Value> values_of(const py::array& array) {
    const py::array_t<Value, py::array::c_style | py::array::forcecast> values(array);
    return {values.data(), values.data() + values.size()};
}

Channel channel_from(const std::string& name, const py::array& array) {
    const py::dtype type = array.dtype();
    if (type.kind() == 'f') return {name, values_of<float>(array)};
    if (type.kind() == 'u' && type.itemsize() == sizeof(Id)) return {name, values_of<Id>(array)};
    throw UsageError("the channel " + name + " holds floats or uint32 ids, not " + text_of(type));
}

using Metadata = std::map<std::string, std::string>;
using DataWindow = std::array<int, 4>;
using Size = std::array<int, 2>;

HeldImage from_arrays(const py::dict& channels, const std::optional<Size>& size,
                      const std::optional<DataWindow>& window, const Metadata& metadata) {
    HeldImage held;
    Image& image = held.image;
    for (const auto& [key, value] : channels) {
        const auto name = key.cast<std::string>();
        const py::array array = array_from(py::reinterpret_borrow<py::object>(value), name);
        require_shape(array, std::array<py::ssize_t, 2>{-1, -1}, name);
        if (image.channels.empty()) {
            image.data_height = static_cast<int>(array.shape(0));
            image.data_width = static_cast<int>(array.shape(1));
        }
        require_shape(array, std::array<py::ssize_t, 2>{image.data_height, image.data_width}, name);
        image.channels.push_back(channel_from(name, array));
    }

    image.metadata = metadata;
    if (window) {
        image.x0 = (*window)[0], image.y0 = (*window)[1];
        if ((*window)[2] - image.x0 != image.data_width || (*window)[3] - image.y0 != image.data_height)
            throw UsageError("the window (x0, y0, x1, y1) has not the size of the channels");
    }
    image.width = size ? (*size)[0] : image.x0 + image.data_width;
    image.height = size ? (*size)[1] : image.y0 + image.data_height;
    check_image(image);
    return held;
}

py::tuple size_of(const HeldImage& held) {
    return py::make_tuple(held.image.width, held.image.height);
}

py::tuple window_of(const HeldImage& held) {
    const Image& image = held.image;
    return py::make_tuple(image.x0, image.y0, image.x0 + image.data_width, image.y0 + image.data_height);
}

void bind_mapping(py::class_<HeldImage, std::shared_ptr<HeldImage>>& image) {
    image
        .def("__getitem__", view_of, py::arg("name"),
             "The channel as an array (data height, data width), rows from the top: float32, or uint32 for "
             "ids\n"
             "(NONE where there is none). A view: no copy is made, writing changes the image, and the view "
             "keeps\n"
             "the image alive. Raises KeyError.")
        .def("keys", names_in, "The channels' names, in the image's order.")
        .def(
            "values",
            [](const py::object& self) {
                py::list values;
                for (const std::string& name : names_in(self.cast<const HeldImage&>()))
                    values.append(view_of(self, name));
                return values;
            },
            "The channels' arrays, in the image's order: views, as [name] has them.")
        .def(
            "items",
            [](const py::object& self) {
                py::list items;
                for (const std::string& name : names_in(self.cast<const HeldImage&>()))
                    items.append(py::make_tuple(name, view_of(self, name)));
                return items;
            },
            "Names with arrays, in the image's order.")
        .def(
            "get",
            [](const py::object& self, const std::string& name, const py::object& otherwise) -> py::object {
                const bool has = self.cast<const HeldImage&>().image.find(name) != nullptr;
                return has ? py::object(view_of(self, name)) : otherwise;
            },
            py::arg("name"), py::arg("default") = py::none(), "image[name], or the default.")
        .def("__iter__", [](const HeldImage& held) { return py::iter(py::cast(names_in(held))); })
        .def("__len__", [](const HeldImage& held) { return held.image.channels.size(); })
        .def("__contains__",
             [](const HeldImage& held, const std::string& name) { return held.image.find(name) != nullptr; })
        .def("__repr__", [](const HeldImage& held) {
            return "<trilens.Image " + std::to_string(held.image.width) + " x " +
                   std::to_string(held.image.height) + ", " + std::to_string(held.image.channels.size()) +
                   " channels>";
        });
}

void bind_copying(py::class_<HeldImage, std::shared_ptr<HeldImage>>& image) {
    image.def("__copy__", [](const HeldImage& held) { return HeldImage(held); })
        .def("__deepcopy__", [](const HeldImage& held, const py::dict&) { return HeldImage(held); })
        .def(py::pickle(
            [](const py::object& self) {
                const HeldImage& held = self.cast<const HeldImage&>();
                py::dict channels;
                for (const std::string& name : names_in(held)) channels[py::str(name)] = view_of(self, name);
                return py::make_tuple(channels, size_of(held), window_of(held), held.image.metadata,
                                      held.statistics);
            },
            [](const py::tuple& state) {
                HeldImage held = from_arrays(state[0].cast<py::dict>(), state[1].cast<Size>(),
                                             state[2].cast<DataWindow>(), state[3].cast<Metadata>());
                held.statistics = state[4].cast<py::dict>();
                return held;
            }));
}

}  // namespace

void bind_image(py::module_& module) {
    py::class_<HeldImage, std::shared_ptr<HeldImage>> image(
        module, "Image",
        "A picture with named channels: a mapping from names (\"R\", \"optic.object\") to numpy arrays\n"
        "that look into the picture, without a copy.");
    bind_mapping(image);
    bind_copying(image);
    image
        .def_static(
            "from_arrays", from_arrays, py::arg("channels"), py::arg("size") = py::none(),
            py::arg("window") = py::none(), py::arg("metadata") = Metadata(),
            "An image from arrays of one shape (height, width); they are copied. Floats become float32;\n"
            "uint32 arrays are ids.\n\n"
            "size: (width, height) of the film in pixels; None: as far as the window reaches.\n"
            "window: (x0, y0, x1, y1) of the film that the arrays cover; None: from its top left.\n"
            "metadata: texts by names that start with \"trilens:\".\n"
            "Raises UsageError for arrays of unequal shapes or other types, InputError for what is no image.")
        .def_property_readonly("names", names_in, "The channels' names, in the image's order.")
        .def_property_readonly("size", size_of, "(width, height) of the film, in pixels.")
        .def_property_readonly("window", window_of,
                               "(x0, y0, x1, y1): the pixels of the film that the arrays cover.")
        .def_property_readonly(
            "metadata", [](const HeldImage& held) { return held.image.metadata; },
            "Texts by name (\"trilens:scene\"), as a new dict.")
        .def_property_readonly(
            "statistics", [](const HeldImage& held) { return held.statistics; },
            "Of an image that was drawn here, else empty. Pixels: optic_pixels, and of these "
            "pixels_without_ray,\n"
            "subdivided_pixels (of a part of a facet), traced_pixels and layered_pixels (an optic seen in an "
            "optic);\n"
            "projected_facets; probes: a dict for each optic of which facets are traced for what probing "
            "them\ncosts: object (id), surveyed_facets (probed first), least_samples (facets with fewer "
            "are traced),\ncost, saved (in paths of samples: of probing a facet, and what each sample then "
            "saves); "
            "predicted_error: pixels, the most that was left; certified_pixels: whose displacement is "
            "proven,\n"
            "certified_error: the most of these bounds; outline_pixels: predicted, "
            "those between the outlines of optics and of their facets; deep_pixels: where light is "
            "drawn straight on past the optics that it would meet, for maxDepth;\nfragment_pixels (shaded "
            "once or a few times for all their samples), fragments (of "
            "these pixels),\nfragments_per_pixel, rays_by_sample (shaded at each sample), "
            "pixels_shaded_by_sample (that have such rays);\nmarks (images of points and labels that are "
            "painted), hidden_marks (on the film, but hidden), crowded_marks (of labels that give "
            "way),\nunseen_marks (points and labels without an "
            "image); prepare_seconds, draw_seconds.")
        .def("rgb", rgb_of, py::arg("layer") = "",
             "The colours R, G, B of a layer (\"\": the beauty) as a new float32 array (height, width, 3),\n"
             "linear Rec.709. Raises KeyError where the image has none.")
        .def(
            "_repr_png_",
            [](const HeldImage& held) -> py::object {
                for (const char* name : {"R", "G", "B"})
                    if (const Channel* channel = held.image.find(name); !channel || channel->is_id())
                        return py::none();
                const std::vector<unsigned char> bytes =
                    PythonCall().run([&] { return encode_image_as(held.image, ImageFormat::kPng); });
                return py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
            },
            "The beauty as 8-bit sRGB, which notebooks show: the bytes of a PNG; None where R, G or B lacks.")
        .def(
            "save",
            [](const HeldImage& held, const std::filesystem::path& file, double exposure,
               const std::string& tone, double white) {
                PythonCall().run([&] {
                    return write_image(file.string(), held.image, {exposure, tone_curve(tone), white}), true;
                });
            },
            py::arg("file"), py::kw_only(), py::arg("exposure") = 0.0, py::arg("tone") = "none",
            py::arg("white") = ToneMapping().white,
            "Writes OpenEXR, every channel to the last bit (.exr), or the beauty as 8-bit sRGB (.png).\n\n"
            "exposure: stops by which the light is made brighter first; png only, as the rest.\n"
            "tone: \"none\", \"reinhard\" (2002, extended), \"aces\" (Narkowicz's fit) or \"neutral\" "
            "(Khronos).\n"
            "white: the least luminance that \"reinhard\" shows as white.\n"
            "Raises UsageError for other endings and names, InputError for a png without R G B, OutputError "
            "where the\nfile cannot be written.");
    module.def(
        "count_regions",
        [](const HeldImage& held, std::int64_t least) {
            if (least < 0) throw UsageError("least is 0 or more pixels, not " + std::to_string(least));
            return PythonCall().run(
                [&] { return count_regions(held.image, static_cast<std::size_t>(least)); });
        },
        py::arg("image"), py::arg("least") = kSmallestRegion,
        "How many separate shapes stand before the environment: regions of at least least pixels that touch "
        "by\n"
        "sides or corners and whose alpha (channel A) is above 0. Raises InputError for an image without A, "
        "UsageError\n"
        "for a negative least.");
    module.def(
        "read_image",
        [](const std::filesystem::path& file) {
            return HeldImage{PythonCall().run([&] { return read_image(file.string()); }), {}};
        },
        py::arg("file"),
        "Reads every channel of an OpenEXR file in its own type (half becomes float32).\n"
        "Raises InputError where the file cannot be used.");
    module.def(
        "layer_names", layer_names,
        "The layers that may be asked for beside R G B A, and the channels of each, where the scene has what "
        "they show:\n\n"
        "Z: Z (depth of the first surface, 1e30 in the environment).\n"
        "optic: optic.object, optic.facet, optic.U, optic.V (the first optic, its facet, the place in it).\n"
        "direct: direct.R, direct.G, direct.B (what no optic shows).\n"
        "reflect: reflect.R, reflect.G, reflect.B (light), reflectID.object, reflectID.primitive (what is "
        "seen),\n"
        "reflectP.X, reflectP.Y, reflectP.Z (where, world frame), reflectP.length (of the way from the "
        "optic).\n"
        "refract: the same, refract.R and so on.\n"
        "path: path.count (optics on the way).\n"
        "stat: stat.method (projected 0, subdivided 1, traced 2), stat.level (of subdivision), "
        "stat.fragments (of the pixel).\n"
        "magnification: reflectM.area, refractM.area, beside those layers.\n"
        "ray: reflectD.X, reflectD.Y, reflectD.Z, reflectO.X, reflectO.Y, reflectO.Z and refractD, refractO "
        "beside\n"
        "those layers (unit direction and origin of the last ray, world frame).\n"
        "position: directID.object, directID.primitive, directP.X, directP.Y, directP.Z, directP.length "
        "(what the\n"
        "camera sees itself).\n"
        "bound: by how many pixels what a mirror shows is displaced at most, as is proven (render's "
        "certify).\n"
        "coverage: coverage.object (the mesh that the camera sees first at the pixel's centre), "
        "coverage.min, "
        "coverage.max\n(shares of the pixel between which the part that shows it lies, as is proven).");
}

}  // namespace trilens::python
