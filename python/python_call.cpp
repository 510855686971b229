#include "python_call.h"

namespace trilens::python {
namespace {

py::object callable_or_none(py::object object, const char* name) {
    if (object.is_none() || PyCallable_Check(object.ptr())) return object;
    throw UsageError(std::string(name) + " is neither None nor something to call");
}

/// True stands for the package's own bar.
py::object progress_or_none(py::object object) {
    if (object.ptr() == Py_True) return py::module_::import("trilens.progress_bar").attr("ProgressBar")();
    if (object.ptr() == Py_False) return py::none();
    return callable_or_none(std::move(object), "progress");
}

}  // namespace

PythonCall::PythonCall(py::object progress, py::object warn)
    : progress_(progress_or_none(std::move(progress))), warn_(callable_or_none(std::move(warn), "warn")) {}

Progress PythonCall::progress(const std::string& job) {
    return {[this, job](double done) { report(done, job); }, &cancel_};
}

Warn PythonCall::warner() {
    return [this](const std::string& message) { tell(message); };
}

void PythonCall::tell_all(const std::vector<std::string>& messages) {
    for (const std::string& message : messages) tell(message);
}

void PythonCall::report(double done, const std::string& job) {
    const py::gil_scoped_acquire acquired;
    if (raised_) return;
    try {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        if (!progress_.is_none() && progress_(done, job).is(py::handle(Py_False))) cancel_ = true;
    } catch (const py::error_already_set&) {
        raised_ = std::current_exception();
        cancel_ = true;
    }
}

void PythonCall::tell(const std::string& message) {
    const py::gil_scoped_acquire acquired;
    if (raised_) return;
    try {
        if (!warn_.is_none()) {
            warn_(message);
            return;
        }
        const py::object category = py::module_::import("trilens").attr("TrilensWarning");
        if (PyErr_WarnEx(category.ptr(), message.c_str(), 1) != 0) throw py::error_already_set();
    } catch (const py::error_already_set&) {
        raised_ = std::current_exception();
        cancel_ = true;
    }
}

void PythonCall::rethrow(const std::exception_ptr& failure) const {
    if (raised_) std::rethrow_exception(raised_);
    if (failure) std::rethrow_exception(failure);
}

}  // namespace trilens::python
