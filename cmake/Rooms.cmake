# trilens_room(NAME FOLDER [LIGHT] [FOLDERS folders...] [SEES rooms...] [DOORS libraries...]): one room = one static
# library that links what it may see publicly and its outside libraries privately, so no other room finds their headers.
# FOLDERS: those inside of the room, each of which may see those named before it; what stands in the room itself, its
# door, sees them all (a test holds that).
include(CMakeParseArguments)

# Contraction off: the same source gives the same last bit on every machine. Names of files as from the source's folder: the
# same source gives the same library wherever it is built (but not where OSS-Fuzz looks for the source of what was reached).
set(fuzz_flags $<AND:$<BOOL:${TRILENS_FUZZ}>,$<NOT:$<BOOL:${TRILENS_FUZZ_ENGINE}>>>)
add_library(trilens_options INTERFACE)
target_compile_options(trilens_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -ffp-contract=off
  $<$<NOT:$<BOOL:${TRILENS_FUZZ_ENGINE}>>:-ffile-prefix-map=${PROJECT_SOURCE_DIR}=.>
  $<$<BOOL:${TRILENS_WERROR}>:-Werror>
  # GCC 12 sees overruns and overreads in std::string's own copies and, sanitized, uninitialized bytes in std::regex; there are none.
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,14>>:-Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread -Wno-restrict>
  $<$<CXX_COMPILER_ID:GNU>:-fno-semantic-interposition>
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<BOOL:${TRILENS_SANITIZE}>>:-Wno-maybe-uninitialized>
  $<${fuzz_flags}:-fsanitize=fuzzer-no-link>
  $<$<OR:$<BOOL:${TRILENS_SANITIZE}>,${fuzz_flags}>:-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer>)
target_compile_options(trilens_options INTERFACE $<$<BOOL:${TRILENS_SANITIZE_THREADS}>:-fsanitize=thread>)
target_compile_definitions(trilens_options INTERFACE $<$<BOOL:${TRILENS_SANITIZE_THREADS}>:TRILENS_PLAIN_THREADS>)
target_link_options(trilens_options INTERFACE $<$<BOOL:${TRILENS_SANITIZE_THREADS}>:-fsanitize=thread>
  $<$<OR:$<BOOL:${TRILENS_SANITIZE}>,${fuzz_flags}>:-fsanitize=address,undefined>)

# A room's units are compiled several together, which reads their headers once. What each calls its own (in an unnamed
# namespace, or by #define) is therefore named once in a room; the compiler says where it is not. Apart: Highway's
# kernels, which include themselves.
option(TRILENS_UNITY "Compile a room's units together: faster as a whole, slower after a small change" ON)
set(TRILENS_UNITY_BATCH 40 CACHE STRING "How many units of a room are compiled together")
set(TRILENS_UNITY_TESTS 16 CACHE STRING "How many units of a room's tests are, which have helpers of like names")
function(trilens_unite target)
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources INCLUDE REGEX "\\.cpp$")
  foreach(source IN LISTS sources)
    file(STRINGS ${source} kernel REGEX "hwy/foreach_target\\.h" LIMIT_COUNT 1)
    if(kernel)
      # Clang takes minutes to check each of them for undefined behaviour, of which vector instructions have little.
      if(TRILENS_SANITIZE)
        set_source_files_properties(${source} TARGET_DIRECTORY ${target} PROPERTIES COMPILE_OPTIONS -fno-sanitize=undefined
          SKIP_PRECOMPILE_HEADERS ON)
      endif()
    else()
      # By rooms, whatever folders are inside of them: src/ROOM/..., tests/ROOM/..., ROOM/...
      file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${source})
      set(together ${TRILENS_UNITY_BATCH})
      if(folder MATCHES "^tests/")
        set(together ${TRILENS_UNITY_TESTS})
      endif()
      string(REGEX REPLACE "^((src|tests)/)?([^/]+)/.*$" "\\3" folder ${folder})
      math(EXPR batch "0${count_${folder}} / ${together}")
      math(EXPR count_${folder} "0${count_${folder}} + 1")
      set_source_files_properties(${source} TARGET_DIRECTORY ${target} PROPERTIES UNITY_GROUP ${folder}_${batch})
    endif()
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${TRILENS_UNITY} UNITY_BUILD_MODE GROUP)
  # A type of one's own in a private class is warned of where it is included, as every unit now is.
  target_compile_options(${target} PRIVATE $<$<AND:$<BOOL:${TRILENS_UNITY}>,$<CXX_COMPILER_ID:GNU>>:-Wno-subobject-linkage>)
endfunction()

# What reads, writes and talks waits for files and for the rooms that compute: compiling it takes a third less time so,
# sanitized less than half, and what it does no more.
function(trilens_light target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1> $<$<BOOL:${TRILENS_SANITIZE}>:-O0>)
  set_property(TARGET ${target} PROPERTY TRILENS_IS_LIGHT ON)
endfunction()

# Of the copies that units have of what headers define, the linker takes the first for all: of targets linked together those
# that compute go first, so that they run what is optimised for them.
function(trilens_light_last list)
  set(first)
  set(last)
  foreach(target IN LISTS ${list})
    get_target_property(is_light ${target} TRILENS_IS_LIGHT)
    if(is_light)
      list(APPEND last ${target})
    else()
      list(APPEND first ${target})
    endif()
  endforeach()
  set(${list} ${first} ${last} PARENT_SCOPE)
endfunction()

# The rooms' own headers, for the rooms and their tests.
add_library(trilens_sources INTERFACE)
target_include_directories(trilens_sources INTERFACE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/src)

# The headers that all rooms read are compiled once for each way of optimising. Where units are compiled apart they are not,
# so that each is seen to include what it uses.
function(trilens_precompile target)
  get_target_property(is_light ${target} TRILENS_IS_LIGHT)
  set(owner trilens_vocabulary)
  if(is_light)
    set(owner trilens_vocabulary_light)
  endif()
  if(NOT TARGET ${owner})
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/${owner}.cpp CONTENT "" @ONLY)
    add_library(${owner} OBJECT ${PROJECT_BINARY_DIR}/${owner}.cpp)
    target_link_libraries(${owner} PRIVATE trilens_options trilens_sources glm::glm)
    target_precompile_headers(${owner} PRIVATE ${PROJECT_SOURCE_DIR}/cmake/vocabulary.h)
    if(is_light)
      trilens_light(${owner})
    endif()
  endif()
  target_precompile_headers(${target} REUSE_FROM ${owner})
endfunction()

function(trilens_room name folder)
  cmake_parse_arguments(ROOM "LIGHT" "" "FOLDERS;SEES;DOORS" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*.cpp)
  if(NOT TARGET trilens_${name})
    add_library(trilens_${name} STATIC)
  endif()
  target_sources(trilens_${name} PRIVATE ${sources})
  target_link_libraries(trilens_${name} PUBLIC trilens_options trilens_sources)
  foreach(room IN LISTS ROOM_SEES)
    target_link_libraries(trilens_${name} PUBLIC trilens_${room})
  endforeach()
  foreach(door IN LISTS ROOM_DOORS)
    # GLM and libfmt are vocabulary, passed on by base, and JSON is, by its room. Every other library stays behind its door.
    if(door STREQUAL "glm::glm" OR door STREQUAL "fmt::fmt" OR door STREQUAL "nlohmann_json::nlohmann_json")
      target_link_libraries(trilens_${name} PUBLIC ${door})
    else()
      target_link_libraries(trilens_${name} PRIVATE ${door})
    endif()
  endforeach()
  set(is_precompiled ${TRILENS_UNITY})
  if("hwy::hwy" IN_LIST ROOM_DOORS AND NOT EMSCRIPTEN)
    # Instruction sets that bring this code nothing: SSSE3, and those of AVX-512 beyond its first (the last two are
    # later versions' names for bits). Sanitized or fuzzed, where it is compiled for minutes: AVX-512 altogether.
    set(without "HWY_SSSE3|HWY_AVX3_DL|(1LL<<6)|(1LL<<4)")
    # On 64-bit ARM: vectors whose length is known only when it runs. NEON is then all there is; the form that Highway
    # chooses has AES, which nothing here uses, so that it runs without, too.
    if(CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64")
      string(APPEND without "|HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128")
      target_compile_options(trilens_${name} PRIVATE -march=armv8-a+crypto)
      set(is_precompiled OFF)  # for other instructions than the other rooms' headers are compiled for
    endif()
    if(TRILENS_SANITIZE OR TRILENS_SANITIZE_THREADS OR TRILENS_FUZZ)
      string(APPEND without "|HWY_AVX3")
    endif()
    target_compile_definitions(trilens_${name} PRIVATE "HWY_DISABLED_TARGETS=(${without})")
  endif()
  set_property(TARGET trilens_${name} PROPERTY TRILENS_DOORS "${ROOM_DOORS}")
  trilens_unite(trilens_${name})
  if(ROOM_LIGHT)
    trilens_light(trilens_${name})
  endif()
  if(is_precompiled)
    trilens_precompile(trilens_${name})
  endif()
endfunction()

# trilens_library(TARGET ROOMS rooms... [ON target]): a shared library made of whole rooms. Only GLM is passed on, which
# stands in the public headers.
function(trilens_library target)
  cmake_parse_arguments(LIB "" "ON" "ROOMS" ${ARGN})
  add_library(${target} SHARED)
  list(TRANSFORM LIB_ROOMS PREPEND trilens_)
  trilens_light_last(LIB_ROOMS)
  foreach(room IN LISTS LIB_ROOMS)
    target_sources(${target} PRIVATE $<TARGET_OBJECTS:${room}>)
    get_target_property(doors ${room} TRILENS_DOORS)
    if(doors)
      target_link_libraries(${target} PRIVATE ${doors})
    endif()
  endforeach()
  target_link_libraries(${target} PUBLIC glm::glm ${LIB_ON} PRIVATE $<BUILD_INTERFACE:trilens_options>)
  set_target_properties(${target} PROPERTIES
    LINKER_LANGUAGE CXX VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  target_compile_features(${target} INTERFACE cxx_std_20)
  target_include_directories(${target} INTERFACE
    $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
endfunction()

# trilens_client(NAME FOLDER [LIGHT] [SEES clients...] [DOORS libraries...]): a room that stands on the public headers, as
# they are installed, and on other such rooms.
function(trilens_client name folder)
  cmake_parse_arguments(CLIENT "LIGHT" "" "SEES;DOORS" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*.cpp)
  add_library(trilens_${name} STATIC ${sources})
  target_include_directories(trilens_${name} BEFORE PUBLIC ${PROJECT_BINARY_DIR}/include)
  target_include_directories(trilens_${name} PUBLIC ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(trilens_${name} PUBLIC trilens PRIVATE trilens_options ${CLIENT_DOORS})
  foreach(room IN LISTS CLIENT_SEES)
    target_link_libraries(trilens_${name} PUBLIC trilens_${room})
  endforeach()
  trilens_unite(trilens_${name})
  if(CLIENT_LIGHT)
    trilens_light(trilens_${name})
  endif()
  if(TRILENS_UNITY)
    trilens_precompile(trilens_${name})
  endif()
endfunction()
