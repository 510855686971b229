// What `trilens fit` answers.
#pragma once

#include <trilens/fit.h>

#include "terminal/command.h"

namespace trilens {

/// Parameters, residuals and what the pairs do not fix, as text and as JSON.
Answer fit_answer(const FitResult& result, std::span<const Correspondence> pairs);

}  // namespace trilens
