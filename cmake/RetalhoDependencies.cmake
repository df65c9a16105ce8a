# Every library from outside, found once. Each is used behind one header of ours (docs/architecture.md).
find_package(TBB REQUIRED)
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(GDAL REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(PNG REQUIRED)
find_package(ZLIB REQUIRED)  # mesh/quantized_tile: gzip
find_package(Freetype REQUIRED)
# The captions' face; a program that is moved to another machine can name another one in $RETALHO_FONT.
find_file(RETALHO_FONT_FILE DejaVuSans.ttf PATHS /usr/share/fonts/truetype/dejavu /usr/share/fonts/dejavu /usr/share/fonts/TTF NO_DEFAULT_PATH)
find_package(PkgConfig REQUIRED)
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(CAIRO REQUIRED IMPORTED_TARGET cairo)          # render/curve_*: PDF and PNG of curves
pkg_check_modules(MUPARSERX REQUIRED IMPORTED_TARGET muparserx)  # curve/expression: f(x, y) as text
if(RETALHO_SUITESPARSE)
  find_library(CHOLMOD_LIBRARY cholmod)
  find_path(CHOLMOD_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse)
  if(CHOLMOD_LIBRARY AND CHOLMOD_INCLUDE_DIR)
    message(STATUS "Sparse factors by CHOLMOD: the binary is bound by the GPL (README, Licence)")
  else()
    message(STATUS "CHOLMOD is not found: sparse factors by our own method")
  endif()
endif()
include(RetalhoFlatbuffers)
