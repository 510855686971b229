// CPython's text signatures ("name(self, a, b=0)\n--\n\n" before a docstring; Argument Clinic writes the
// same).
#include "signatures.h"

#include <cstdlib>
#include <cstring>
#include <optional>
#include <vector>

namespace trilens::python {
namespace {

constexpr const char* kEnd = "\n--\n\n";

/// Where the brackets or the quoted text that begins at `at` end.
std::size_t after_group(const std::string& text, std::size_t at) {
    std::vector<char> open;
    for (; at < text.size(); ++at) {
        const char c = text[at];
        if (c == '\'' || c == '"') {
            for (++at; at < text.size() && text[at] != c; ++at)
                if (text[at] == '\\') ++at;
        } else if (c == '(' || c == '[' || c == '{') {
            open.push_back(c);
        } else if (c == ')' || c == ']' || c == '}') {
            open.pop_back();
        }
        if (open.empty()) return at + 1;
    }
    return text.size();
}

/// The parts between commas that stand in no brackets and no quotes.
std::vector<std::string> parts_of(const std::string& arguments) {
    std::vector<std::string> parts{""};
    for (std::size_t at = 0; at < arguments.size();) {
        const std::size_t end = std::strchr("([{'\"", arguments[at]) ? after_group(arguments, at) : at + 1;
        if (arguments[at] == ',')
            parts.emplace_back();
        else if (arguments[at] != ' ' || !parts.back().empty())
            parts.back() += arguments.substr(at, end - at);
        at = end;
    }
    if (parts.back().empty()) parts.pop_back();
    return parts;
}

/// Whether Python reads the text as a literal.
bool is_literal(const std::string& text) {
    try {
        py::module_::import("ast").attr("literal_eval")(text);
        return true;
    } catch (py::error_already_set& error) {
        if (!error.matches(PyExc_ValueError) && !error.matches(PyExc_SyntaxError)) throw;
        return false;
    }
}

/// "a: int = 0" as "a=0"; pybind11 writes the type behind the name and the default behind the type.
std::string plain_argument(const std::string& argument) {
    const std::size_t colon = argument.find(':'), equals = argument.rfind(" = ");
    if (colon == std::string::npos) return argument;
    const std::string name = argument.substr(0, colon);
    if (equals == std::string::npos) return name;
    const std::string value = argument.substr(equals + 3);
    return name + "=" + (is_literal(value) ? value : "None");
}

/// The text signature under that name of a docstring that pybind11 wrote; none where it wrote no signature. A
/// constructor's has no self: its class is called without.
std::optional<std::string> signature_of(const char* doc, const std::string& name, bool is_constructor) {
    if (!doc) return std::nullopt;
    const std::string text(doc), line = text.substr(0, text.find('\n'));
    const std::size_t begin = line.find('(');
    if (begin == std::string::npos || text.find(kEnd) != std::string::npos) return std::nullopt;
    const std::string arguments = line.substr(begin + 1, after_group(line, begin) - begin - 2);
    std::string plain;
    for (const std::string& part : parts_of(arguments)) {
        const std::string argument = plain_argument(part);
        if (is_constructor && argument == "self") continue;
        plain += (plain.empty() ? "" : ", ") + argument;
    }
    return name + "(" + plain + ")" + kEnd;
}

void give_function(const py::handle& object) {
    PyObject* function = object.ptr();
    if (PyInstanceMethod_Check(function)) function = PyInstanceMethod_GET_FUNCTION(function);
    if (!PyCFunction_Check(function)) return;
    PyMethodDef* const definition = reinterpret_cast<PyCFunctionObject*>(function)->m_ml;
    const auto signature = signature_of(definition->ml_doc, definition->ml_name, false);
    if (!signature) return;
    // pybind11 made the text with strdup, and frees what it finds here.
    char* const text = strdup((*signature + definition->ml_doc).c_str());
    std::free(const_cast<char*>(definition->ml_doc));
    definition->ml_doc = text;
}

/// A class is called as its constructor.
void give_class(PyTypeObject* type, const py::object& constructor) {
    PyObject* function = constructor.ptr();
    if (PyInstanceMethod_Check(function)) function = PyInstanceMethod_GET_FUNCTION(function);
    if (!PyCFunction_Check(function) || !type->tp_doc) return;
    const std::string whole = type->tp_name;
    const auto signature = signature_of(reinterpret_cast<PyCFunctionObject*>(function)->m_ml->ml_doc,
                                        whole.substr(whole.rfind('.') + 1), true);
    if (!signature) return;
    const std::string text = *signature + type->tp_doc;
    // A type that was made at run time frees its text as an object's.
    auto* const kept = static_cast<char*>(PyObject_Malloc(text.size() + 1));
    if (!kept) throw py::error_already_set();
    std::memcpy(kept, text.c_str(), text.size() + 1);
    PyObject_Free(const_cast<char*>(type->tp_doc));
    type->tp_doc = kept;
}

}  // namespace

void give_signatures(py::module_& module) {
    for (const auto& [name, object] : module.attr("__dict__").cast<py::dict>()) {
        give_function(object);
        if (!PyType_Check(object.ptr())) continue;
        auto* const type = reinterpret_cast<PyTypeObject*>(object.ptr());
        if (!py::detail::get_type_info(type)) continue;
        const py::dict members(py::reinterpret_borrow<py::object>(object).attr("__dict__").attr("copy")());
        if (members.contains("__init__")) give_class(type, members["__init__"]);
        for (const auto& [member, value] : members)
            give_function(PyObject_HasAttrString(value.ptr(), "__func__")
                              ? value.attr("__func__")
                              : py::object(py::reinterpret_borrow<py::object>(value)));
    }
}

}  // namespace trilens::python
