# What `cmake --install` puts where: the library, its public headers, the program, a CMake package and a pkg-config file.
# tests/package builds a consumer against an installed tree in all four ways (CMake or pkg-config, static or shared).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# A header whose comment says "Internal to" is its room's own and stays here (tests/house checks that no public header
# includes one).
file(GLOB_RECURSE headers CONFIGURE_DEPENDS RELATIVE "${CMAKE_CURRENT_SOURCE_DIR}/src" "${CMAKE_CURRENT_SOURCE_DIR}/src/retalho/*.h")
foreach(header IN LISTS headers)
  file(STRINGS "${CMAKE_CURRENT_SOURCE_DIR}/src/${header}" internal REGEX "^// .*Internal to " LIMIT_COUNT 1)
  if(NOT internal)
    get_filename_component(folder "${header}" DIRECTORY)
    install(FILES "src/${header}" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/${folder}" COMPONENT development)
  endif()
endforeach()

install(TARGETS retalho EXPORT retalho_targets
  LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT library NAMELINK_COMPONENT development
  ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT development)
if(TARGET retalho_program)
  # A shared library is found beside the program, wherever the tree is put.
  if(NOT CMAKE_INSTALL_PREFIX STREQUAL "/usr")  # where the loader looks anyway
    set_target_properties(retalho_program PROPERTIES INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
  endif()
  install(TARGETS retalho_program RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT program)
endif()
if(NOT CMAKE_INSTALL_PREFIX STREQUAL "/usr")  # there packaging/copyright stands for them
  install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT library)
endif()
install(FILES NOTICE DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT library)

# What a static library leaves to the consumer's link: found again by the consumer, never as a path of this machine. It is
# read off the library, so that a new one needs a line here only for the name of its pkg-config module.
set(module_of_TBB tbb)
set(module_of_fmt fmt)
set(module_of_GDAL gdal)
set(module_of_PNG libpng)
set(module_of_ZLIB zlib)
set(module_of_Freetype freetype2)
set(RETALHO_LINK_PACKAGES "")
set(RETALHO_LINK_MODULES "")
set(RETALHO_LINK_PLAIN "")
set(RETALHO_FIND_MODULES "")
get_target_property(linked retalho LINK_LIBRARIES)
foreach(library IN LISTS linked)
  if(library MATCHES "^PkgConfig::(.+)$")
    set(name "${CMAKE_MATCH_1}")
    string(APPEND RETALHO_FIND_MODULES "  pkg_check_modules(${name} REQUIRED IMPORTED_TARGET ${${name}_MODULE_NAME})\n")
    list(APPEND RETALHO_LINK_MODULES "${${name}_MODULE_NAME}")
  elseif(library MATCHES "^([A-Za-z0-9]+)::")
    set(name "${CMAKE_MATCH_1}")
    if(NOT DEFINED module_of_${name})
      message(FATAL_ERROR "cmake/RetalhoInstall.cmake: say the pkg-config module of ${library} (set(module_of_${name} ...))")
    endif()
    list(APPEND RETALHO_LINK_PACKAGES "${name}")
    list(APPEND RETALHO_LINK_MODULES "${module_of_${name}}")
  elseif(library MATCHES "^[a-z][a-z0-9_]*$")
    list(APPEND RETALHO_LINK_PLAIN "-l${library}")
  endif()
endforeach()
list(REMOVE_DUPLICATES RETALHO_LINK_PACKAGES)
list(REMOVE_DUPLICATES RETALHO_LINK_MODULES)
list(JOIN RETALHO_LINK_MODULES ", " RETALHO_REQUIRES_PRIVATE)
list(JOIN RETALHO_LINK_PLAIN " " RETALHO_LIBS_PRIVATE)
# A shared library brings its own: pkg-config would ask for their .pc files even for --cflags, and headers need none.
if(BUILD_SHARED_LIBS)
  set(RETALHO_REQUIRES_PRIVATE "")
  set(RETALHO_LIBS_PRIVATE "")
endif()
set(RETALHO_STATIC ON)
if(BUILD_SHARED_LIBS)
  set(RETALHO_STATIC OFF)
endif()

set(package_folder "${CMAKE_INSTALL_LIBDIR}/cmake/retalho")
configure_package_config_file(cmake/retalho-config.cmake.in retalho-config.cmake INSTALL_DESTINATION "${package_folder}" NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(retalho-config-version.cmake COMPATIBILITY SameMinorVersion)
install(EXPORT retalho_targets NAMESPACE retalho:: FILE retalho-targets.cmake DESTINATION "${package_folder}" COMPONENT development)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/retalho-config.cmake" "${CMAKE_CURRENT_BINARY_DIR}/retalho-config-version.cmake"
  DESTINATION "${package_folder}" COMPONENT development)

file(RELATIVE_PATH RETALHO_PREFIX_FROM_PC "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")  # lib may be lib/x86_64-linux-gnu
string(REGEX REPLACE "/$" "" RETALHO_PREFIX_FROM_PC "${RETALHO_PREFIX_FROM_PC}")
configure_file(cmake/retalho.pc.in retalho.pc @ONLY)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/retalho.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT development)
