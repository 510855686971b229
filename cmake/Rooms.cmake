# trilens_room(NAME FOLDER [SEES rooms...] [DOORS libraries...]): one room = one static library that
# links what it may see publicly and its outside libraries privately, so no other room finds their headers.
include(CMakeParseArguments)

add_library(trilens_options INTERFACE)
target_include_directories(trilens_options INTERFACE ${CMAKE_SOURCE_DIR} ${CMAKE_SOURCE_DIR}/src)
# Contraction off: the same source gives the same last bit on every machine.
target_compile_options(trilens_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -ffp-contract=off
  $<$<BOOL:${TRILENS_WERROR}>:-Werror>
  # GCC 12 sees overruns and overreads in std::string's own copies and, sanitized, uninitialized bytes in std::regex; there are none.
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,14>>:-Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread -Wno-restrict>
  $<$<BOOL:${TRILENS_SANITIZE}>:-Wno-maybe-uninitialized>
  $<$<BOOL:${TRILENS_SANITIZE}>:-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer>)
target_link_options(trilens_options INTERFACE
  $<$<BOOL:${TRILENS_SANITIZE}>:-fsanitize=address,undefined>)

function(trilens_room name folder)
  cmake_parse_arguments(ROOM "" "" "SEES;DOORS" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/${folder}/*.cpp)
  if(NOT sources)
    return()
  endif()
  add_library(trilens_${name} STATIC ${sources})
  target_link_libraries(trilens_${name} PUBLIC trilens_options)
  foreach(room IN LISTS ROOM_SEES)
    if(TARGET trilens_${room})
      target_link_libraries(trilens_${name} PUBLIC trilens_${room})
    endif()
  endforeach()
  foreach(door IN LISTS ROOM_DOORS)
    # GLM and libfmt are vocabulary: base passes them on. Every other library stays behind its door.
    if(door STREQUAL "glm::glm" OR door STREQUAL "fmt::fmt")
      target_link_libraries(trilens_${name} PUBLIC ${door})
    else()
      target_link_libraries(trilens_${name} PRIVATE ${door})
    endif()
  endforeach()
endfunction()
