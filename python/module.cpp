// The module: every subject bound once, then the program's own facts.
#include <pybind11/stl.h>

#include "bindings.h"
#include "signatures.h"

namespace trilens::python {

void bind_program(py::module_& module) {
    module.attr("NONE") = kNone;
    module.def("version", version, "The version of the library that runs, as \"0.3.0\".");
    module.def("library_versions", library_versions,
               "The libraries underneath with their versions: ray tracing, surfaces, images.");
    module.def(
        "set_threads",
        [](int count) {
            if (count < 0) throw UsageError("a number of threads is 0 (all) or more");
            set_threads(count);
        },
        py::arg("threads"),
        "Limits the threads of everything that follows; 0 means all that the machine has. Results do not "
        "depend on it.");
    module.def("threads", threads, "How many threads are used now, at least 1.");
}

/// An object of one of our classes before its constructor; its own function, so that Python sees that it is
/// not the base's, and refuses Class.__new__(Class): a method of what it makes would read what is not there.
PyObject* make_object(PyTypeObject* type, PyObject*, PyObject*) {
    return py::detail::make_new_instance(type);
}

void refuse_new_without_init(py::module_& module) {
    for (const auto& [name, object] : module.attr("__dict__").cast<py::dict>()) {
        if (!PyType_Check(object.ptr()) ||
            !py::detail::get_type_info(reinterpret_cast<PyTypeObject*>(object.ptr())))
            continue;
        auto* const type = reinterpret_cast<PyTypeObject*>(object.ptr());
        type->tp_new = make_object;
        PyType_Modified(type);
    }
}

}  // namespace trilens::python

PYBIND11_MODULE(_trilens, module) {
    namespace bindings = trilens::python;
    module.doc() = "Projects curved mirrors and glass, and measures the error against ray-traced truth.";
    module.attr("__module__") = "trilens";  // where its classes and functions are found
    bindings::bind_errors(module);
    bindings::bind_program(module);
    bindings::bind_image(module);
    bindings::bind_scene_camera(module);
    bindings::bind_scene(module);
    bindings::bind_surface(module);
    bindings::bind_ray_mesh(module);
    bindings::bind_film_camera(module);
    bindings::bind_renderer(module);
    bindings::bind_compare(module);
    bindings::bind_sweep(module);
    bindings::bind_suite(module);
    bindings::bind_inverse(module);
    bindings::refuse_new_without_init(module);
    bindings::give_signatures(module);
    pybind11::delattr(module, "__module__");
}
