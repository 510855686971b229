// The JSON Schema of summary.json: what its fields mean.
#pragma once

namespace trilens {

/// JSON Schema (draft 7), as text.
const char* summary_schema();

}  // namespace trilens
