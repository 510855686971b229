// What `trilens cad` does.
#pragma once

#include "cli/cad_options.h"

namespace trilens {

Answer run_cad(const CadOptions& options, Console& console);

}  // namespace trilens
