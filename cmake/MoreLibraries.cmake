# The libraries beyond the core. Debian 12 and 13 differ in versions and in target names.
find_package(OpenSubdiv REQUIRED MODULE)  # Debian's own config names a static library that it does not ship
find_package(nlohmann_json REQUIRED CONFIG)
find_package(CLI11 REQUIRED CONFIG)
find_package(OpenEXR 3.1 REQUIRED CONFIG)
find_package(Isal REQUIRED MODULE)
find_package(PNG REQUIRED)
find_package(OpenImageIO REQUIRED CONFIG)
find_package(TinyGLTF REQUIRED CONFIG)
if(TRILENS_TESTS)
  find_package(tinyobjloader REQUIRED CONFIG)  # reads OBJ files a second time
endif()

# Embree 4 (Debian 13) or 3 (Debian 12).
find_package(embree 4 QUIET CONFIG)
if(embree_FOUND)
  set(TRILENS_EMBREE_MAJOR 4)
else()
  find_package(embree 3 REQUIRED CONFIG)
  set(TRILENS_EMBREE_MAJOR 3)
endif()
add_library(trilens_embree INTERFACE)
target_link_libraries(trilens_embree INTERFACE embree)
target_compile_definitions(trilens_embree INTERFACE TRILENS_EMBREE_MAJOR=${TRILENS_EMBREE_MAJOR})

# tinygltf: the images it may meet are read through the image room, so its own codecs stay off.
add_library(trilens_tinygltf INTERFACE)
target_link_libraries(trilens_tinygltf INTERFACE TinyGLTF::TinyGLTF)

# Debian 12's OpenImageIO names OpenCV's folder of headers, which its package neither has nor needs.
get_target_property(directories OpenImageIO::OpenImageIO INTERFACE_INCLUDE_DIRECTORIES)
foreach(directory IN LISTS directories)
  if(IS_ABSOLUTE "${directory}" AND NOT EXISTS "${directory}")
    list(REMOVE_ITEM directories "${directory}")
  endif()
endforeach()
set_target_properties(OpenImageIO::OpenImageIO PROPERTIES
  INTERFACE_INCLUDE_DIRECTORIES "${directories}")
