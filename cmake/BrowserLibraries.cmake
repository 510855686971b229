# What the core needs, for WebAssembly: the headers of this machine's own libraries alone, and one thread.
foreach(header glm/glm.hpp fmt/core.h hwy/highway.h)
  get_filename_component(library ${header} DIRECTORY)
  find_path(TRILENS_${library}_HEADERS ${header} PATHS /usr/include NO_DEFAULT_PATH NO_CMAKE_FIND_ROOT_PATH REQUIRED)
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/headers)
  file(CREATE_LINK ${TRILENS_${library}_HEADERS}/${library} ${PROJECT_BINARY_DIR}/headers/${library} SYMBOLIC)
  add_library(${library}::${library} INTERFACE IMPORTED)
  target_include_directories(${library}::${library} INTERFACE ${PROJECT_BINARY_DIR}/headers)
endforeach()
target_compile_definitions(fmt::fmt INTERFACE FMT_HEADER_ONLY)
add_library(TBB::tbb INTERFACE IMPORTED)

# Exceptions of WebAssembly's own, and vectors of 128 bits. Highway 1.0's own vectors for WebAssembly have no doubles: its plain ones do, of which the
# compiler makes vectors; what the kernel asks most is written as instructions.
add_compile_options(-fwasm-exceptions -msimd128 -include ${PROJECT_SOURCE_DIR}/browser/older_library.h)
include_directories(BEFORE ${PROJECT_SOURCE_DIR}/browser/vectors)
add_link_options(-fwasm-exceptions)
target_compile_definitions(hwy::hwy INTERFACE "HWY_DISABLED_TARGETS=(HWY_WASM|HWY_WASM_EMU256)")
