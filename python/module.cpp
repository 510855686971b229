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
    bindings::bind_lens(module);
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

// Exceptions: what the library throws, as Python classes.

namespace trilens::python {
namespace {

/// Strong references that live as long as the interpreter.
struct ErrorTypes {
    PyObject *base, *usage, *input, *output, *computation, *interrupted;
};
ErrorTypes types;

PyObject* add_error(py::module_& module, const char* name, PyObject* base, ExitCode code, const char* doc) {
    const std::string full_name = std::string("trilens.") + name;
    PyObject* type = PyErr_NewExceptionWithDoc(full_name.c_str(), doc, base, nullptr);
    if (!type) throw py::error_already_set();
    py::handle(type).attr("exit_code") = static_cast<int>(code);
    module.attr(name) = py::handle(type);
    return type;
}

PyObject* type_of(const Error& error) {
    switch (error.code()) {
        case ExitCode::kUsage:
            return types.usage;
        case ExitCode::kInput:
            return types.input;
        case ExitCode::kOutput:
            return types.output;
        case ExitCode::kComputation:
            return types.computation;
        case ExitCode::kInterrupted:
            return types.interrupted;
        default:
            return types.base;
    }
}

void translate(std::exception_ptr thrown) {
    try {
        std::rethrow_exception(std::move(thrown));
    } catch (const Error& error) {
        // Messages name files, whose bytes need not be UTF-8.
        PyObject* message = PyUnicode_DecodeUTF8(error.what(), static_cast<Py_ssize_t>(strlen(error.what())),
                                                 "surrogateescape");
        if (!message) return;
        PyErr_SetObject(type_of(error), message);
        Py_DECREF(message);
    }
}

}  // namespace

void require_known(const std::string& what, const std::string& name, std::span<const std::string> known) {
    for (const std::string& one : known)
        if (one == name) return;
    throw UsageError("there is no " + what + " \"" + name + "\"" + suggestion(name, known));
}

void bind_errors(py::module_& module) {
    types.base = add_error(
        module, "Error", PyExc_Exception, ExitCode::kComputation,
        "What trilens raises: one line, \"file: place: message\". exit_code is that of the command.");
    types.usage = add_error(module, "UsageError", types.base, ExitCode::kUsage,
                            "The call asks for something that does not exist or makes no sense.");
    types.input = add_error(module, "InputError", types.base, ExitCode::kInput,
                            "Input cannot be used: missing, unreadable, contradictory, not comparable.");
    types.output =
        add_error(module, "OutputError", types.base, ExitCode::kOutput, "Output cannot be written.");
    types.computation =
        add_error(module, "ComputationError", types.base, ExitCode::kComputation,
                  "The computation itself failed, for example with pixels that are not finite.");
    types.interrupted = add_error(module, "Interrupted", types.base, ExitCode::kInterrupted,
                                  "A progress callback returned False. (Ctrl-C raises KeyboardInterrupt.)");
    PyObject* warning = PyErr_NewExceptionWithDoc("trilens.TrilensWarning",
                                                  "What the user would want to know but what is no error.",
                                                  PyExc_UserWarning, nullptr);
    if (!warning) throw py::error_already_set();
    module.attr("TrilensWarning") = py::handle(warning);
    py::register_exception_translator(translate);
}

}  // namespace trilens::python
