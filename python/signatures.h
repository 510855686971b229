// Signatures that inspect.signature and help() read, from those that pybind11 writes into docstrings.
#pragma once

#include "bindings.h"

namespace trilens::python {

/// Gives every function, method and constructor of the module its text signature, "name(self, a, b=0, *,
/// c=None)" before its docstring, as CPython's own have it; the docstrings stay as they are. Defaults that
/// are no literal read as None. Called once, after everything is bound.
void give_signatures(py::module_& module);

}  // namespace trilens::python
