// Long work called from Python: without the GIL, with progress and warnings, stopped by Ctrl-C.
#pragma once

#include <atomic>
#include <exception>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "bindings.h"

namespace trilens::python {

/// The Python side of one call, alive while it runs; made and destroyed with the GIL held.
class PythonCall {
  public:
    /// `progress`: None or False, True (a bar, see trilens/progress_bar.py), or called as progress(done,
    /// job), done in 0..1; an answer of False stops the work. `warn`: None (the warnings module tells), or
    /// called as warn(message). Throws UsageError for what cannot be called.
    explicit PythonCall(py::object progress = py::none(), py::object warn = py::none());
    PythonCall(const PythonCall&) = delete;
    PythonCall& operator=(const PythonCall&) = delete;

    /// What the library is given. Between two reports Ctrl-C is looked for; what Python raises in a callback
    /// stops the work.
    Progress progress(const std::string& job);
    Warn warner();
    /// Tells each of them; called by the work, in `run`.
    void tell_all(const std::vector<std::string>& messages);

    /// Does the work without the GIL and returns its result. What Python raised meanwhile goes before what
    /// the work threw.
    template <class Work>
    std::invoke_result_t<Work> run(const Work& work) {
        std::optional<std::invoke_result_t<Work>> result;
        std::exception_ptr failure;
        {
            const py::gil_scoped_release released;
            try {
                result.emplace(work());
            } catch (...) {
                failure = std::current_exception();
            }
        }
        rethrow(failure);
        return std::move(*result);
    }

  private:
    void report(double done, const std::string& job);
    void tell(const std::string& message);
    void rethrow(const std::exception_ptr& failure) const;

    py::object progress_, warn_;
    std::atomic<bool> cancel_ = false;
    std::exception_ptr raised_;  // by Python; read and written under the GIL
};

}  // namespace trilens::python
