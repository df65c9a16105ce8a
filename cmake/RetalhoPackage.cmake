# The Debian package: `cpack -G DEB` in a build of its own (scripts/package-test makes it: shared library, prefix /usr).
# One package: program, library, headers, CMake and pkg-config files, manual pages and completion made from the
# program's own help, examples.
include(GNUInstallDirs)
find_program(PYTHON3_PROGRAM python3 PATHS /usr/bin NO_DEFAULT_PATH)
if(TARGET retalho_program AND PYTHON3_PROGRAM AND NOT RETALHO_SANITIZE AND NOT RETALHO_COVERAGE AND NOT CMAKE_CROSSCOMPILING)
  set(manual "${CMAKE_CURRENT_BINARY_DIR}/manual")
  add_custom_command(OUTPUT "${manual}/retalho.bash"
    COMMAND "${PYTHON3_PROGRAM}" "${CMAKE_CURRENT_SOURCE_DIR}/packaging/manual.py" "$<TARGET_FILE:retalho_program>" "${manual}"
    DEPENDS retalho_program packaging/manual.py COMMENT "manual pages and completion" VERBATIM)
  add_custom_target(retalho_manual ALL DEPENDS "${manual}/retalho.bash")
  install(DIRECTORY "${manual}/" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1" COMPONENT program FILES_MATCHING PATTERN "*.1.gz")
  install(FILES "${manual}/retalho.bash" RENAME retalho DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions" COMPONENT program)
endif()
install(DIRECTORY examples/ DESTINATION "${CMAKE_INSTALL_DOCDIR}/examples" COMPONENT program)

if(CMAKE_INSTALL_PREFIX STREQUAL "/usr")
  # What Debian asks of a package and of no other install.
  string(TIMESTAMP RETALHO_DATE "%a, %d %b %Y %H:%M:%S +0000" UTC)  # of SOURCE_DATE_EPOCH where that is set
  configure_file(packaging/changelog.in changelog @ONLY)
  find_program(GZIP_PROGRAM gzip REQUIRED)
  execute_process(COMMAND "${GZIP_PROGRAM}" -9nf changelog WORKING_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}" COMMAND_ERROR_IS_FATAL ANY)
  install(FILES "${CMAKE_CURRENT_BINARY_DIR}/changelog.gz" packaging/copyright DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT library)
  install(FILES packaging/lintian-overrides RENAME retalho DESTINATION "${CMAKE_INSTALL_DATADIR}/lintian/overrides" COMPONENT library)
endif()

set(CPACK_PACKAGE_NAME retalho)
set(CPACK_PACKAGE_CONTACT "Retalho maintainers <maintainers@retalho.example>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "smooth surfaces made of polynomial patches")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
  "Program and C++20 library that build smooth surfaces out of polynomial patches\n from elevation grids, survey points, boundary curves and scanned points, and\n answer exact questions about them: heights, slopes, contour lines, viewsheds,\n triangles to a tolerance, pictures. This package holds the program, the shared\n library, its headers, manual pages, completion and examples.")
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "fonts-dejavu-core")  # captions of pictures
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "python-matplotlib-data, gdal-bin")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA "${CMAKE_CURRENT_SOURCE_DIR}/packaging/triggers")  # ldconfig
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
include(CPack)
