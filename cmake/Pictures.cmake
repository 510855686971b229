# The room of pictures as a library that the program loads when it meets the first picture other than OpenEXR and ordinary PNG.
set(pictures_name trilens_pictures-${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
target_compile_definitions(trilens_image PRIVATE
  TRILENS_PICTURES_FILE="${CMAKE_SHARED_MODULE_PREFIX}${pictures_name}${CMAKE_SHARED_MODULE_SUFFIX}"
  TRILENS_IMAGE_LIBRARIES="OpenImageIO ${OpenImageIO_VERSION}, OpenEXR ${OpenEXR_VERSION}")

add_library(trilens_pictures_module MODULE $<TARGET_OBJECTS:trilens_pictures>)
target_link_libraries(trilens_pictures_module PRIVATE trilens_image trilens_base OpenImageIO::OpenImageIO trilens_options)
# What it shares with the program it has a copy of: nothing of it is looked up in the program, or seen by it.
target_link_options(trilens_pictures_module PRIVATE -Wl,--exclude-libs,ALL
  -Wl,-soname,${CMAKE_SHARED_MODULE_PREFIX}${pictures_name}${CMAKE_SHARED_MODULE_SUFFIX})
set_target_properties(trilens_pictures_module PROPERTIES OUTPUT_NAME ${pictures_name} LINKER_LANGUAGE CXX)
add_dependencies(trilens trilens_pictures_module)
