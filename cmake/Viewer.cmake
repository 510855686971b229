# What the viewer's window stands on, where it is: GLFW 3, OpenGL, Dear ImGui with its two backends (Debian:
# libglfw3-dev, libimgui-dev). TRILENS_VIEWER_FOUND: whether it is built.
set(TRILENS_VIEWER_FOUND OFF)
if(NOT TRILENS_VIEWER STREQUAL "OFF")
  find_package(glfw3 3.3 QUIET)
  find_package(OpenGL QUIET)
  find_path(TRILENS_IMGUI_HEADERS imgui.h PATH_SUFFIXES imgui)
  find_path(TRILENS_IMGUI_BACKENDS imgui_impl_glfw.h PATH_SUFFIXES imgui/backends)
  find_library(TRILENS_IMGUI_LIBRARY imgui)
  if(glfw3_FOUND AND TARGET OpenGL::GL AND TRILENS_IMGUI_HEADERS AND TRILENS_IMGUI_BACKENDS AND TRILENS_IMGUI_LIBRARY)
    add_library(imgui::imgui INTERFACE IMPORTED)
    target_include_directories(imgui::imgui INTERFACE ${TRILENS_IMGUI_HEADERS} ${TRILENS_IMGUI_BACKENDS})
    # The backends in the archive ask GLFW, which is therefore named behind it; Debian's has its stb apart.
    find_library(TRILENS_STB_LIBRARY stb)
    target_link_libraries(imgui::imgui INTERFACE ${TRILENS_IMGUI_LIBRARY} glfw
      $<$<BOOL:${TRILENS_STB_LIBRARY}>:${TRILENS_STB_LIBRARY}> ${CMAKE_DL_LIBS})
    # Whether its library has the backends, too.
    include(CheckCXXSourceCompiles)
    set(CMAKE_REQUIRED_LIBRARIES imgui::imgui OpenGL::GL)
    check_cxx_source_compiles("#include <imgui.h>
      #include <imgui_impl_glfw.h>
      #include <imgui_impl_opengl3.h>
      int main() { ImGui_ImplOpenGL3_NewFrame(); ImGui_ImplGlfw_NewFrame(); ImGui::CreateContext(); }" TRILENS_IMGUI_LINKS)
    unset(CMAKE_REQUIRED_LIBRARIES)
    set(TRILENS_VIEWER_FOUND ${TRILENS_IMGUI_LINKS})
  endif()
  if(TRILENS_VIEWER_FOUND)
    message(STATUS "The viewer is built")
  elseif(TRILENS_VIEWER STREQUAL "ON")
    message(FATAL_ERROR "TRILENS_VIEWER is ON, and GLFW 3 or Dear ImGui with its backends is missing (Debian: libglfw3-dev, libimgui-dev)")
  else()
    message(STATUS "The viewer is left out: GLFW 3 or Dear ImGui with its backends is missing (Debian: libglfw3-dev, libimgui-dev)")
  endif()
endif()
